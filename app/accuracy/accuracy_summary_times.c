#include "app/accuracy/accuracy_internal.h"
#include "base/log.h"
#include "base/statistics.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

typedef double Figure(const AccuracyTimes *times);

static double frame_of(const AccuracyTimes *t) {
    return t->frame_ms;
}

static double update_of(const AccuracyTimes *t) {
    return t->select_ms + t->refine_ms;
}

// The figures of a frame, each to be summarised by itself.
static const size_t FIGURES[] = {offsetof(AccuracyTimes, select_ms), offsetof(AccuracyTimes, refine_ms),
                                 offsetof(AccuracyTimes, upload_ms), offsetof(AccuracyTimes, draw_ms),
                                 offsetof(AccuracyTimes, frame_ms)};

static double *figure_in(AccuracyTimes *times, size_t figure) {
    return (double *)(void *)((char *)times + FIGURES[figure]);
}

// One pass over all rounds of a run: [round][pose].
typedef struct Rounds {
    const AccuracyDem *dem;
    const AccuracyTimes *times;
    int rounds;
    double *values; // [rounds * pose_count], for sorting
} Rounds;

static const AccuracyTimes *times_at(const Rounds *r, int round, int pose) {
    return &r->times[(size_t)round * (size_t)r->dem->pose_count + (size_t)pose];
}

static void summarize_frame(const Rounds *r, int pose, AccuracyFrame *frame) {
    for (size_t figure = 0; figure < COUNT_OF(FIGURES); figure++) {
        for (int round = 0; round < r->rounds; round++) {
            AccuracyTimes times = *times_at(r, round, pose);
            r->values[round] = *figure_in(&times, figure);
        }
        statistics_sort(r->values, r->rounds);
        *figure_in(&frame->median, figure) = statistics_percentile(r->values, r->rounds, 0.5);
        *figure_in(&frame->least, figure) = r->values[0];
        *figure_in(&frame->most, figure) = r->values[r->rounds - 1];
    }
}

// Of the frames of rounds [begin, end) that do not jump: sorted into `values`.
static int sort_frames(const Rounds *r, int begin, int end, Figure *figure) {
    int count = 0;
    for (int round = begin; round < end; round++)
        for (int pose = 0; pose < r->dem->pose_count; pose++)
            if (!r->dem->poses[pose].jump)
                r->values[count++] = figure(times_at(r, round, pose));
    statistics_sort(r->values, count);
    return count;
}

static AccuracyPercentiles percentiles_of(const Rounds *r, Figure *figure) {
    int count = sort_frames(r, 0, r->rounds, figure);
    const double *v = r->values;
    return (AccuracyPercentiles){statistics_percentile(v, count, 0.50), statistics_percentile(v, count, 0.95),
                                 statistics_percentile(v, count, 0.99), statistics_percentile(v, count, 1.0)};
}

static AccuracySpread spread_of(const Rounds *r, Figure *figure) {
    AccuracySpread spread = {INFINITY, 0.0};
    for (int round = 0; round < r->rounds; round++) {
        int count = sort_frames(r, round, round + 1, figure);
        double p50 = statistics_percentile(r->values, count, 0.5);
        spread.least = fmin(spread.least, p50);
        spread.most = fmax(spread.most, p50);
    }
    return spread;
}

static void summarize_counts(const AccuracyDem *dem, AccuracyRun *run, int counted) {
    AccuracySummary *s = &run->summary;
    for (int pose = 0; pose < dem->pose_count; pose++) {
        AccuracyFrame *frame = &run->frames[pose];
        s->triangles_mean += (double)frame->triangles / dem->pose_count;
        s->vram_bytes = frame->vram_bytes > s->vram_bytes ? frame->vram_bytes : s->vram_bytes;
        s->memory_bytes = frame->memory_bytes > s->memory_bytes ? frame->memory_bytes : s->memory_bytes;
        if (dem->poses[pose].jump)
            continue;
        s->rebuilt_share += frame->rebuilt_share / counted;
        s->upload_bytes_mean += (double)frame->upload_bytes / counted;
        for (size_t figure = 0; figure < COUNT_OF(FIGURES); figure++)
            *figure_in(&s->mean, figure) += *figure_in(&frame->median, figure) / counted;
    }
}

static Result keep_sorted(const Rounds *r, AccuracyRun *run) {
    run->frame_ms_count = sort_frames(r, 0, r->rounds, frame_of);
    run->frame_ms = malloc(sizeof *run->frame_ms * (size_t)(run->frame_ms_count + 1));
    if (!run->frame_ms)
        return RESULT_MEMORY;
    memcpy(run->frame_ms, r->values, sizeof *run->frame_ms * (size_t)run->frame_ms_count);
    return RESULT_OK;
}

static Result summarize_run(const Rounds *r, int counted, AccuracyRun *run) {
    for (int pose = 0; pose < r->dem->pose_count; pose++)
        summarize_frame(r, pose, &run->frames[pose]);
    summarize_counts(r->dem, run, counted);
    run->summary.frame_ms = percentiles_of(r, frame_of);
    run->summary.update_ms = percentiles_of(r, update_of);
    run->summary.frame_p50 = spread_of(r, frame_of);
    run->summary.update_p50 = spread_of(r, update_of);
    return keep_sorted(r, run);
}

Result accuracy_summarize_times(Accuracy *accuracy, int dem, const AccuracyTimes *times) {
    int runs = accuracy->plan.variant_count * accuracy->plan.tau_count;
    Rounds r = {.dem = &accuracy->dems[dem], .rounds = accuracy->plan.rounds};
    size_t count = (size_t)r.rounds * (size_t)r.dem->pose_count;
    r.values = malloc(sizeof *r.values * count);
    Result result = r.values ? RESULT_OK : RESULT_MEMORY;
    for (int i = 0; i < runs && result == RESULT_OK; i++) {
        r.times = times + (size_t)i * count;
        result = summarize_run(&r, accuracy_jump_free(accuracy, dem), &accuracy->runs[dem * runs + i]);
    }
    if (result == RESULT_MEMORY)
        log_error("bench: no memory to sort the times of %zu frames", count);
    free(r.values);
    return result;
}
