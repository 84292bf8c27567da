#define _POSIX_C_SOURCE 200809L
#include "app/accuracy/accuracy_internal.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

#define VIEWS_MAX 8
#define TAU_PX 1.0
#define STRIDE 8
#define FRAME_BLOCK_BYTES (1 << 20)

static const LodMethod METHODS[] = {LOD_HYBRID, LOD_ROAM_PARALLEL, LOD_DIAMOND};

typedef struct Racer {
    Jobs *jobs;
    Lod *lod;
    Arena *frame;
    uint64_t drawn;
    double *ms; // [rounds]
} Racer;

typedef struct Scaling {
    const AccuracyPlan *plan;
    const AccuracyDem *dem;
    AccuracyScaling *out;
    Racer racers[ACCURACY_SPEEDS_MAX];
    int poses[VIEWS_MAX];
} Scaling;

static Result enter(Scaling *s, LodMethod method, int threads) {
    Racer *racer = &s->racers[s->out->speed_count];
    LodOptions options = scene_lod_options(s->plan->options);
    options.method = method;
    options.reuse = false;
    options.partitions = 0;
    s->out->speeds[s->out->speed_count++] = (AccuracySpeed){.method = method, .threads = threads};
    racer->ms = calloc((size_t)s->plan->rounds, sizeof *racer->ms);
    Result result = racer->ms ? jobs_create(threads, &racer->jobs) : RESULT_MEMORY;
    if (result == RESULT_OK)
        result = arena_create(FRAME_BLOCK_BYTES, &racer->frame);
    return result == RESULT_OK ? lod_create(&options, s->dem->worlds[0].terrain, &racer->lod) : result;
}

static Result enter_all(Scaling *s) {
    int all = jobs_worker_count(s->dem->worlds[0].jobs);
    Result result = RESULT_OK;
    for (size_t i = 0; i < COUNT_OF(METHODS); i++)
        for (int threads = 1; threads <= all && result == RESULT_OK; threads = preprocess_next_threads(threads, all))
            if (s->out->speed_count < ACCURACY_SPEEDS_MAX)
                result = enter(s, METHODS[i], threads);
    return result;
}

static Result refine_views(const Scaling *s, Racer *racer, double *ms) {
    Result result = RESULT_OK;
    *ms = 0.0;
    for (int i = 0; i < s->out->views && result == RESULT_OK; i++) {
        LodView view = accuracy_view(s->plan, s->dem, s->poses[i], TAU_PX);
        LodCut cut;
        lod_release(racer->lod, racer->drawn);
        arena_reset(racer->frame);
        int64_t begin = clock_now_ns();
        result = lod_update(racer->lod, &view, racer->jobs, racer->frame, &cut);
        *ms += (double)(clock_now_ns() - begin) * 1e-6;
        racer->drawn = cut.frame;
        result = result == RESULT_BUDGET ? RESULT_OK : result;
    }
    return result;
}

// The first round makes pages, and does not count.
static Result race(Scaling *s) {
    Result result = RESULT_OK;
    for (int round = -1; round < s->plan->rounds && result == RESULT_OK; round++)
        for (int i = 0; i < s->out->speed_count && result == RESULT_OK; i++) {
            double ms;
            Racer *racer = &s->racers[(i + round + 1) % s->out->speed_count];
            result = refine_views(s, racer, &ms);
            if (round >= 0)
                racer->ms[round] = ms;
        }
    return result;
}

// Of the same method with one worker.
static const Racer *single_of(const Scaling *s, int i) {
    while (s->out->speeds[i].threads > 1)
        i--;
    return &s->racers[i];
}

static Result count(Scaling *s) {
    int rounds = s->plan->rounds;
    double *ratios = malloc(sizeof *ratios * (size_t)rounds);
    if (!ratios)
        return RESULT_MEMORY;
    for (int i = 0; i < s->out->speed_count; i++) {
        for (int round = 0; round < rounds; round++)
            ratios[round] = single_of(s, i)->ms[round] / s->racers[i].ms[round];
        statistics_sort(ratios, rounds);
        s->out->speeds[i].speedup = statistics_percentile(ratios, rounds, 0.5);
        s->out->speeds[i].least_speedup = ratios[0];
        s->out->speeds[i].most_speedup = ratios[rounds - 1];
    }
    for (int i = 0; i < s->out->speed_count; i++) {
        AccuracySpeed *speed = &s->out->speeds[i];
        statistics_sort(s->racers[i].ms, rounds);
        speed->ms = statistics_percentile(s->racers[i].ms, rounds, 0.5);
        speed->least_ms = s->racers[i].ms[0];
        speed->most_ms = s->racers[i].ms[rounds - 1];
    }
    free(ratios);
    return RESULT_OK;
}

// The bounded kind that is flown, too.
static int stride_of(const AccuracyPlan *plan) {
    for (int i = 0; i < plan->kind_count; i++)
        if (plan->kinds[i].terrain.error_stride)
            return plan->kinds[i].terrain.error_stride;
    return STRIDE;
}

static Result preprocess(Scaling *s) {
    static const int full[] = {513, 1025, 2049}, quick[] = {257, 513};
    const int *sides = s->plan->quick ? quick : full;
    int count = s->plan->quick ? (int)COUNT_OF(quick) : (int)COUNT_OF(full);
    return preprocess_measure(sides, count, s->plan->rounds, jobs_worker_count(s->dem->worlds[0].jobs),
                              stride_of(s->plan), &s->out->preprocess);
}

static void choose_views(Scaling *s) {
    int step = s->dem->pose_count / VIEWS_MAX > 0 ? s->dem->pose_count / VIEWS_MAX : 1;
    for (int i = 0; i < s->dem->pose_count && s->out->views < VIEWS_MAX; i += step)
        s->poses[s->out->views++] = i;
}

Result accuracy_scale(const AccuracyPlan *plan, const AccuracyDem *dem, AccuracyScaling *out) {
    Scaling s = {.plan = plan, .dem = dem, .out = out};
    *out = (AccuracyScaling){.tau_px = TAU_PX};
    choose_views(&s);
    Result result = enter_all(&s);
    if (result == RESULT_OK)
        result = race(&s);
    if (result == RESULT_OK)
        result = count(&s);
    if (result == RESULT_OK)
        result = preprocess(&s);
    for (int i = 0; i < out->speed_count; i++) {
        lod_destroy(&s.racers[i].lod);
        arena_destroy(&s.racers[i].frame);
        if (s.racers[i].jobs)
            jobs_destroy(&s.racers[i].jobs);
        free(s.racers[i].ms);
    }
    if (result == RESULT_MEMORY)
        log_error("bench: no memory to race %d numbers of workers", out->speed_count);
    return result;
}
