#define _POSIX_C_SOURCE 200809L
#include "app/live/monitor.h"

#include "app/live/curve.h"
#include "app/live/history.h"
#include "app/live/monitor_internal.h"
#include "app/signals.h"
#include "base/clock.h"
#include "base/log.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define REFRESH_NS 250000000 // of what is read and not watched: painting it is dear
#define REFRESH_FRAMES 12    // of slow ones, for the same reason
#define AXIS_ROOM 1.12       // above the highest point
#define AXIS_EMPTY 0.4       // of the axis in use, below which it shrinks
#define AXIS_FAR 4.0         // times the present: samples beyond do not stretch the axis

struct Monitor {
    Watch watch;
    pthread_t thread;
    bool thread_runs;

    // Of the thread that submits.
    Curve curve;
    History history;
    RenderAccuracy shown;
    int64_t heard; // the last frame
    int64_t refreshed_ns, refreshed_frame;
    WatchSubject refreshed; // what was drawn
    double refreshed_target_ms;
    bool was_open;
};

static void *run_watch(void *user) {
    watch_run(user);
    return NULL;
}

static Result start_thread(Monitor *monitor) {
    sigset_t before;
    signals_hold_all(&before);
    monitor->thread_runs = pthread_create(&monitor->thread, NULL, run_watch, &monitor->watch) == 0;
    signals_restore(&before);
    if (!monitor->thread_runs)
        log_error("a thread cannot be started; is the limit of processes reached (ulimit -u)?");
    return monitor->thread_runs ? RESULT_OK : RESULT_MEMORY;
}

static void begin_waiting(Watch *watch) {
    pthread_condattr_t monotonic;
    pthread_condattr_init(&monotonic);
    pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    pthread_mutex_init(&watch->lock, NULL);
    pthread_cond_init(&watch->changed, &monotonic);
    pthread_condattr_destroy(&monotonic);
}

Result monitor_create(const MonitorOptions *options, Monitor **out) {
    Monitor *monitor = calloc(1, sizeof *monitor);
    if (!monitor) {
        log_error("no memory for the panel of accuracy");
        return RESULT_MEMORY;
    }
    monitor->watch.options = *options;
    begin_waiting(&monitor->watch);
    Result result = jobs_create(1, &monitor->watch.one);
    if (result == RESULT_OK)
        result = start_thread(monitor);
    if (result == RESULT_OK)
        *out = monitor;
    else
        monitor_destroy(&monitor);
    return result;
}

void monitor_destroy(Monitor **monitor) {
    Monitor *self = *monitor;
    if (!self)
        return;
    pthread_mutex_lock(&self->watch.lock);
    self->watch.leaving = true;
    pthread_cond_broadcast(&self->watch.changed);
    pthread_mutex_unlock(&self->watch.lock);
    if (self->thread_runs)
        pthread_join(self->thread, NULL);
    if (self->watch.one)
        jobs_destroy(&self->watch.one);
    pthread_cond_destroy(&self->watch.changed);
    pthread_mutex_destroy(&self->watch.lock);
    free(self);
    *monitor = NULL;
}

// ---- between the threads ----

static SamplerView view_of(const FrameOrder *order) {
    int width = order->compare ? render_left_width(order->width) : order->width;
    return (SamplerView){order->view, order->look.camera, width > 0 ? width : 1, order->height};
}

// The view is the order's; what draws it is what drew the last frame, as an order may not be met.
static WatchSubject subject_of(const Monitor *monitor, const FrameOrder *order) {
    const PipelineFrame *last = &monitor->curve.last;
    bool flown = last->tau_px > 0.0;
    return (WatchSubject){.method = flown ? last->method : order->method,
                          .split = flown ? last->split : order->compare,
                          .px_per_rad = order->view.px_per_rad,
                          .width = order->width,
                          .height = order->height};
}

// Hands the view over and takes what was found.
static WatchFindings exchange(Monitor *monitor, bool open, const FrameOrder *order) {
    Watch *watch = &monitor->watch;
    pthread_mutex_lock(&watch->lock);
    if (watch->open != open) {
        watch->open = open;
        watch->findings = (WatchFindings){.spent_ns = watch->findings.spent_ns};
        pthread_cond_broadcast(&watch->changed);
    }
    watch->view = view_of(order);
    watch->subject = subject_of(monitor, order);
    WatchFindings findings = watch->findings;
    pthread_mutex_unlock(&watch->lock);
    return findings;
}

// ---- what is shown ----

static void hear_frames(Monitor *monitor) {
    PipelineFrame frames[PIPELINE_FRAMES_KEPT];
    int count = pipeline_frames(monitor->watch.options.pipeline, monitor->heard, frames, PIPELINE_FRAMES_KEPT);
    for (int i = 0; i < count; i++) {
        // The first frame brings everything to the GPU.
        if (frames[i].number > 1)
            curve_add_frame(&monitor->curve, &frames[i]);
        history_add(&monitor->history, &frames[i]);
        monitor->heard = frames[i].number;
    }
}

static WatchSubject subject_drawn(const PipelineFrame *frame) {
    return (WatchSubject){frame->method, frame->split, frame->px_per_rad, frame->width, frame->height};
}

static void take_samples(Curve *curve, const WatchFindings *findings) {
    const WatchSubject drawn = subject_drawn(&curve->last);
    if (watch_same(&findings->samples_of, &drawn))
        memcpy(curve->samples, findings->samples, sizeof curve->samples);
    else
        memset(curve->samples, 0, sizeof curve->samples);
}

// An error of another method or lens than the one that is flown says nothing.
static RenderAccuracyError error_now(const WatchFindings *findings, const PipelineFrame *flown, int64_t now_ns) {
    RenderAccuracyError error = findings->error;
    if (error.state == RENDER_ACCURACY_NOTHING || findings->error_method != flown->method ||
        findings->error_px_per_rad != flown->px_per_rad)
        return (RenderAccuracyError){.state = RENDER_ACCURACY_NOTHING};
    error.age_s = (double)(now_ns - findings->drawn_ns) * 1e-9;
    return error;
}

// 1, 2, 3, 5 or 8 times a power of ten.
static double round_up(double ms) {
    static const double STEPS[] = {1.0, 2.0, 3.0, 5.0, 8.0};
    double power = pow(10.0, floor(log10(ms)));
    for (size_t i = 0; i < COUNT_OF(STEPS); i++)
        if (ms <= STEPS[i] * power)
            return STEPS[i] * power;
    return 10.0 * power;
}

// Steady: it moves only when something leaves it, or when most of it is empty.
static double axis_of(const RenderAccuracy *shown) {
    double most = fmax(fmax(shown->frame_ms, shown->target_ms), 1e-3);
    double far = AXIS_FAR * most;
    for (int i = 0; i < shown->point_count; i++)
        most = fmax(most, fmin((double)shown->points[i].frame_ms, far));
    most *= AXIS_ROOM;
    return most > shown->axis_ms || most < AXIS_EMPTY * shown->axis_ms ? round_up(most) : shown->axis_ms;
}

static void refresh(Monitor *monitor, const WatchFindings *findings, int64_t now_ns) {
    RenderAccuracy *shown = &monitor->shown;
    Curve *curve = &monitor->curve;
    take_samples(curve, findings);
    shown->show = true;
    shown->revision++;
    shown->error = error_now(findings, &curve->last, now_ns);
    shown->point_count = curve_points(curve, now_ns, shown->points);
    shown->slope_known = curve_slope(curve, now_ns).known;
    shown->tau_px = curve->last.tau_px;
    shown->frame_ms = history_present_ms(&monitor->history);
    history_summarise(&monitor->history, now_ns, shown);
    history_fill_frames(&monitor->history, shown);
    shown->axis_ms = axis_of(shown);
    monitor->refreshed_ns = now_ns;
    monitor->refreshed_frame = monitor->heard;
}

// At once where the pilot has changed something; what a governor changes all the time is not that.
static bool is_stale(const Monitor *monitor, int64_t now_ns) {
    const PipelineFrame *last = &monitor->curve.last;
    const RenderAccuracy *shown = &monitor->shown;
    bool steered = shown->target_ms != monitor->refreshed_target_ms ||
                   (!(shown->target_ms > 0.0) && last->tau_px != shown->tau_px) ||
                   last->method != monitor->refreshed.method;
    const WatchSubject drawn = subject_drawn(last);
    bool is_other = !watch_same(&drawn, &monitor->refreshed); // a lens may go on changing
    return !monitor->was_open || steered ||
           (now_ns - monitor->refreshed_ns >= REFRESH_NS &&
            (is_other || monitor->heard - monitor->refreshed_frame >= REFRESH_FRAMES));
}

void monitor_follow(Monitor *monitor, bool open, FrameOrder *order) {
    int64_t now_ns = clock_now_ns();
    hear_frames(monitor);
    WatchFindings findings = exchange(monitor, open, order);
    monitor->shown.target_ms = order->look.hud.target_ms;
    if (open && is_stale(monitor, now_ns)) {
        refresh(monitor, &findings, now_ns);
        monitor->refreshed = subject_drawn(&monitor->curve.last);
        monitor->refreshed_target_ms = monitor->shown.target_ms;
    }
    monitor->was_open = open;
    if (open)
        order->look.hud.accuracy = monitor->shown;
}

// The frames drawn meanwhile are skipped, so that a refresh comes after as many as ever that show the panel.
static void skip_frames(Monitor *monitor, int64_t rested_ns) {
    int64_t skipped = pipeline_stats(monitor->watch.options.pipeline).frames - monitor->heard;
    monitor->heard += skipped;
    monitor->refreshed_frame += skipped;
    monitor->refreshed_ns += rested_ns;
}

void monitor_rest(Monitor *monitor, bool resting) {
    Watch *watch = &monitor->watch;
    int64_t now_ns = clock_now_ns();
    if (resting && !watch->resting) // `resting` is written by this thread alone
        hear_frames(monitor);
    pthread_mutex_lock(&watch->lock);
    bool ends = watch->resting && !resting;
    int64_t rested_ns = ends ? now_ns - watch->resting_since_ns : 0;
    if (resting && !watch->resting)
        watch->resting_since_ns = now_ns;
    watch->resting = resting;
    watch->rested_ns += rested_ns;
    pthread_cond_broadcast(&watch->changed);
    pthread_mutex_unlock(&watch->lock);
    if (ends)
        skip_frames(monitor, rested_ns);
}

const RenderAccuracy *monitor_shown(const Monitor *monitor) {
    return &monitor->shown;
}

double monitor_spent_ms(Monitor *monitor) {
    pthread_mutex_lock(&monitor->watch.lock);
    double spent_ms = (double)monitor->watch.findings.spent_ns * 1e-6;
    pthread_mutex_unlock(&monitor->watch.lock);
    return spent_ms;
}
