// The thread of a Monitor: measures drawn cuts and samples other tolerances in turn.
#define _POSIX_C_SOURCE 200809L
#include "app/live/monitor_internal.h"

#include "base/clock.h"
#include "base/log.h"
#include "terrain/measure/measure.h"

#include <string.h>
#include <time.h>

#define PIECE_NS 1000000       // of work between two rests
#define HURRY_NS 4000000000    // of work when the panel opens, at most: somebody waits for its first numbers
#define HURRY_LEFT_NS 30000000 // once the first is there
#define HOLD_WAIT_NS 25000000  // for a frame, before looking whether the panel was closed
#define HOLD_WAITS 40          // before sampling is gone on with
#define COPY_BYTES_MOST ((size_t)512 << 20)
#define FAILED_REST_NS 10000000000 // memory may have come back
#define TURN_REST_NS 100000000     // at least, between two turns
#define SAMPLE_MS_MOST 25.0        // finer tolerances than one that takes longer are not sampled

static bool is_wanted(const Watch *watch) {
    return watch->open && !watch->leaving;
}

// Under the lock. Until something changes, or until `until_ns` at most; false: it has come.
static bool wait_until(Watch *watch, int64_t until_ns) {
    const struct timespec until = {until_ns / 1000000000, until_ns % 1000000000};
    if (watch->resting)
        return pthread_cond_wait(&watch->changed, &watch->lock) == 0;
    return clock_now_ns() < until_ns && pthread_cond_timedwait(&watch->changed, &watch->lock, &until) == 0;
}

// Rests, unless the work is not wanted any more: then false, and at once.
static bool rest_for(Watch *watch, int64_t rest_ns) {
    pthread_mutex_lock(&watch->lock);
    int64_t now_ns = watch->resting ? watch->resting_since_ns : clock_now_ns();
    int64_t until_ns = now_ns - watch->rested_ns + rest_ns;
    watch->findings.spent_ns = pace_thread_ns();
    while (is_wanted(watch) && wait_until(watch, until_ns + watch->rested_ns)) {
    }
    bool wanted = is_wanted(watch);
    pthread_mutex_unlock(&watch->lock);
    return wanted;
}

static bool rest(Watch *watch) {
    return rest_for(watch, pace_rest_ns(&watch->pace));
}

static void hurry(Watch *watch) {
    watch->pace.hurry_ns = HURRY_NS;
}

// ---- the error of a drawn cut ----

static bool is_of_held(const WatchFindings *findings, const PipelineHeld *held) {
    return findings->error_method == held->method && findings->error_px_per_rad == held->cut.view.px_per_rad;
}

// What was measured whole is not given up for a part, as long as it is of the same method and lens.
static void tell_error(Watch *watch, const RenderAccuracyError *error) {
    const PipelineHeld *held = &watch->held;
    WatchFindings *findings = &watch->findings;
    pthread_mutex_lock(&watch->lock);
    bool stays = error->state == RENDER_ACCURACY_SO_FAR && findings->error.state == RENDER_ACCURACY_MEASURED &&
                 is_of_held(findings, held);
    if (is_wanted(watch) && !stays) {
        findings->error = *error;
        findings->error_method = held->method;
        findings->error_px_per_rad = held->cut.view.px_per_rad;
        findings->drawn_ns = held->drawn_ns;
    }
    pthread_mutex_unlock(&watch->lock);
}

static RenderAccuracyError error_of(const PipelineHeld *held, RenderAccuracyState state) {
    return (RenderAccuracyError){.state = state,
                                 .tau_px = held->cut.view.tau_px,
                                 .promised_px = held->cut.reached_px,
                                 .promises = held->cut.promises};
}

static void tell_measured(Watch *watch, const Measure *measure) {
    RenderAccuracyError error = error_of(&watch->held, RENDER_ACCURACY_MEASURED);
    error.share = 1.0;
    error.max_px = measure->max_px;
    error.p999_px = measure->p999_px;
    error.above_tau_share = measure->above_tau_share;
    error.cracks = measure->t_junctions + measure->holes + measure->overlaps;
    tell_error(watch, &error);
    log_debug("accuracy: a cut of %s is measured: %.3f px at most", lod_method_name(watch->held.method),
              measure->max_px);
}

static bool go_on(void *user, const MeasureSoFar *so_far) {
    Watch *watch = user;
    if (pace_worked_ns(&watch->pace) < PIECE_NS)
        return true;
    if (so_far->share > 0.0) {
        RenderAccuracyError error = error_of(&watch->held, RENDER_ACCURACY_SO_FAR);
        error.share = so_far->share;
        error.max_px = so_far->max_px;
        tell_error(watch, &error);
    }
    return rest(watch);
}

static RenderAccuracyState state_before_measuring(const PipelineHeld *held) {
    if (held->cut.resident)
        return RENDER_ACCURACY_RESIDENT;
    return held->partial ? RENDER_ACCURACY_PARTIAL : RENDER_ACCURACY_NOTHING;
}

static bool hold_drawn(Watch *watch) {
    for (int i = 0; i < HOLD_WAITS; i++) {
        if (pipeline_hold(watch->options.pipeline, clock_now_ns() + HOLD_WAIT_NS, &watch->held))
            return true;
        if (!rest_for(watch, 0))
            return false;
    }
    return false;
}

static RenderAccuracyState measure_copy(Watch *watch) {
    Measure measure = {0};
    const MeasurePace pace = {go_on, watch};
    const Terrain *terrain = watch->options.terrain;
    cut_copy_sort(&watch->copy);
    Result result =
        measure_cut_paced(terrain_dem(terrain), terrain_grid(terrain), &watch->copy.cut, watch->one, &pace, &measure);
    if (result == RESULT_BUDGET) // not wanted any more
        return RENDER_ACCURACY_NOTHING;
    if (result != RESULT_OK)
        return RENDER_ACCURACY_FAILED;
    tell_measured(watch, &measure);
    return RENDER_ACCURACY_MEASURED;
}

// The pipeline waits for nobody: the cut is copied, let go, and measured then.
static void measure_drawn(Watch *watch) {
    LodMethod before = watch->held.method;
    if (!hold_drawn(watch))
        return;
    if (watch->held.method != before)
        hurry(watch);
    RenderAccuracyState state = state_before_measuring(&watch->held);
    Result result =
        state == RENDER_ACCURACY_NOTHING ? cut_copy_take(&watch->copy, &watch->held.cut, COPY_BYTES_MOST) : RESULT_OK;
    pipeline_let_go(watch->options.pipeline);
    if (result != RESULT_OK)
        state = result == RESULT_BUDGET ? RENDER_ACCURACY_LARGE : RENDER_ACCURACY_FAILED;
    if (state == RENDER_ACCURACY_NOTHING)
        state = measure_copy(watch);
    if (state == RENDER_ACCURACY_NOTHING)
        return;
    watch->pace.hurry_ns = watch->pace.hurry_ns < HURRY_LEFT_NS ? watch->pace.hurry_ns : HURRY_LEFT_NS;
    if (state != RENDER_ACCURACY_MEASURED) {
        const RenderAccuracyError error = error_of(&watch->held, state);
        tell_error(watch, &error);
    }
    if (state == RENDER_ACCURACY_FAILED)
        rest_for(watch, FAILED_REST_NS);
}

// ---- other tolerances ----

static bool is_refused(const Watch *watch, LodMethod method) {
    return watch->sampler_refused && watch->sampler_refused_method == method;
}

static void refuse(Watch *watch, LodMethod method) {
    watch->sampler_refused = true;
    watch->sampler_refused_method = method;
    sampler_destroy(&watch->sampler);
}

static bool has_sampler(Watch *watch, LodMethod method) {
    if (watch->sampler && sampler_method(watch->sampler) != method)
        sampler_destroy(&watch->sampler);
    // Every sample is drawn whatever the tolerance.
    if (watch->sampler || method == LOD_BRUTE || is_refused(watch, method))
        return watch->sampler;
    watch->next_sample = CURVE_SAMPLES - 1;
    memset(watch->pages_made, 0, sizeof watch->pages_made);
    if (sampler_create(&watch->options.lod, method, watch->options.terrain, &watch->sampler) != RESULT_OK)
        refuse(watch, method);
    watch->pace.rested_at_ns = pace_thread_ns(); // once a method, and not to be waited for a hundred times over
    return watch->sampler;
}

static void tell_sample(Watch *watch, int index, const CurveSample *sample, const WatchSubject *subject) {
    pthread_mutex_lock(&watch->lock);
    WatchFindings *findings = &watch->findings;
    if (!watch_same(&findings->samples_of, subject))
        memset(findings->samples, 0, sizeof findings->samples);
    findings->samples_of = *subject;
    if (is_wanted(watch))
        findings->samples[index] = *sample;
    pthread_mutex_unlock(&watch->lock);
}

// From the coarsest to the finest, and again.
static bool sample_next(Watch *watch) {
    pthread_mutex_lock(&watch->lock);
    const SamplerView view = watch->view;
    const WatchSubject subject = watch->subject;
    pthread_mutex_unlock(&watch->lock);
    if (!has_sampler(watch, subject.method))
        return false;
    CurveSample sample = {0};
    int index = watch->next_sample;
    Result result = sampler_take(watch->sampler, &view, curve_sample_tau(index), watch->one, &sample);
    // The first one has made its pages besides, as no frame does that follows another.
    if (result == RESULT_OK && !watch->pages_made[index])
        result = sampler_take(watch->sampler, &view, curve_sample_tau(index), watch->one, &sample);
    watch->pages_made[index] = true;
    if (result != RESULT_OK && result != RESULT_BUDGET) {
        refuse(watch, subject.method);
        return false;
    }
    tell_sample(watch, index, &sample, &subject);
    bool slow = result == RESULT_BUDGET || sample.refine_ms > SAMPLE_MS_MOST;
    watch->next_sample = index == 0 || slow ? CURVE_SAMPLES - 1 : index - 1;
    if (watch->next_sample > index || index == 0)
        log_debug("accuracy: other tolerances are sampled, down to %.2f px", curve_sample_tau(index));
    return rest(watch);
}

// ---- the thread ----

// A quarter as long for the samples as for the error, and one sample at least.
static void take_turn(Watch *watch) {
    int64_t begin_ns = pace_thread_ns();
    measure_drawn(watch);
    int64_t measured_ns = pace_thread_ns();
    if (!rest_for(watch, TURN_REST_NS) || !rest(watch))
        return;
    while (sample_next(watch) && 4 * (pace_thread_ns() - measured_ns) < measured_ns - begin_ns) {
    }
}

static void forget(Watch *watch) {
    sampler_destroy(&watch->sampler);
    cut_copy_free(&watch->copy);
    watch->sampler_refused = false;
    hurry(watch);
}

void watch_run(Watch *watch) {
    watch->pace = pace_begin(MONITOR_SHARE);
    hurry(watch);
    pthread_mutex_lock(&watch->lock);
    while (!watch->leaving) {
        bool open = watch->open;
        pthread_mutex_unlock(&watch->lock);
        if (open)
            take_turn(watch);
        else
            forget(watch);
        pthread_mutex_lock(&watch->lock);
        while (!watch->open && !watch->leaving && !open)
            pthread_cond_wait(&watch->changed, &watch->lock);
    }
    pthread_mutex_unlock(&watch->lock);
    forget(watch);
}
