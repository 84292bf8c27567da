// app/live/monitor_internal.h: what the two threads of a Monitor share.
// As app/live/monitor.h.
// The watch belongs to the monitor; who touches what is said beside each part.
#pragma once
#include "app/live/monitor.h"
#include "app/live/pace.h"
#include "app/live/sampler.h"
#include "terrain/lod/cut_copy.h"

#include <pthread.h>

// What a finding is of; it says nothing of another picture.
typedef struct WatchSubject {
    LodMethod method;
    bool split;
    double px_per_rad;
    int width, height;
} WatchSubject;

typedef struct WatchFindings {
    RenderAccuracyError error; // without age_s
    LodMethod error_method;
    double error_px_per_rad;
    int64_t drawn_ns; // when the frame measured was drawn
    CurveSample samples[CURVE_SAMPLES];
    WatchSubject samples_of;
    int64_t spent_ns;
} WatchFindings;

typedef struct Watch {
    MonitorOptions options;

    pthread_mutex_t lock;
    pthread_cond_t changed; // its clock is the monotonic one
    // Under the lock.
    bool open, leaving;
    bool resting;      // all stays as it is
    int64_t rested_ns; // so long, altogether: what is waited for comes that much later
    int64_t resting_since_ns;
    SamplerView view;
    WatchSubject subject; // that is flown
    WatchFindings findings;

    // Of the thread.
    Pace pace;
    Jobs *one;
    PipelineHeld held; // whose cut is measured; it is let go, `copy` has it
    CutCopy copy;
    Sampler *sampler;
    int next_sample;
    bool pages_made[CURVE_SAMPLES];
    bool sampler_refused; // for sampler_refused_method, since the panel was opened
    LodMethod sampler_refused_method;
} Watch;

static inline bool watch_same(const WatchSubject *a, const WatchSubject *b) {
    return a->method == b->method && a->split == b->split && a->px_per_rad == b->px_per_rad && a->width == b->width &&
           a->height == b->height;
}

// The thread's whole life.
void watch_run(Watch *watch);
