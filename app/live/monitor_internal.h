// app/live/monitor_internal.h: what the two threads of a Monitor share.
// As app/live/monitor.h.
// The watch belongs to the monitor; who touches what is said beside each part.
#pragma once
#include "app/live/monitor.h"
#include "app/live/pace.h"
#include "app/live/sampler.h"
#include "terrain/lod/cut_copy.h"

#include <pthread.h>

// What the thread found, of which method.
typedef struct WatchFindings {
    RenderAccuracyError error; // without age_s
    LodMethod error_method;
    int64_t drawn_ns; // when the frame measured was drawn
    CurveSample samples[CURVE_SAMPLES];
    LodMethod samples_method;
    bool samples_split;
    int64_t spent_ns;
} WatchFindings;

typedef struct Watch {
    MonitorOptions options;

    pthread_mutex_t lock;
    pthread_cond_t changed; // its clock is the monotonic one
    // Under the lock.
    bool open, leaving;
    SamplerView view;
    LodMethod method; // that is flown
    bool split;
    WatchFindings findings;

    // Of the thread.
    Pace pace;
    Jobs *one;
    CutCopy copy;
    Sampler *sampler;
    int next_sample;
    bool pages_made[CURVE_SAMPLES];
    bool sampler_refused; // for sampler_refused_method, since the panel was opened
    LodMethod sampler_refused_method;
} Watch;

// The thread's whole life.
void watch_run(Watch *watch);
