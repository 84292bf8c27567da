#include "app/accuracy/accuracy_internal.h"
#include "base/statistics.h"

#include <math.h>
#include <stdlib.h>

#define ROUNDS_MAX 1000 // as --rounds has it
#define LEAST 1e-6      // ms: for logarithms of what took no time

static int runs_of_dem(const Accuracy *accuracy) {
    return accuracy->plan.variant_count * accuracy->plan.tau_count;
}

AccuracyRun *accuracy_run_at(const Accuracy *accuracy, int dem, int variant, int tau) {
    return &accuracy->runs[(dem * accuracy->plan.variant_count + variant) * accuracy->plan.tau_count + tau];
}

int accuracy_jump_free(const Accuracy *accuracy, int dem) {
    const AccuracyDem *d = &accuracy->dems[dem];
    int count = 0;
    for (int i = 0; i < d->pose_count; i++)
        count += !d->poses[i].jump;
    return count;
}

// ---- times ----

typedef double Figure(const AccuracyTimes *times);
static double select_of(const AccuracyTimes *t) {
    return t->select_ms;
}
static double refine_of(const AccuracyTimes *t) {
    return t->refine_ms;
}
static double upload_of(const AccuracyTimes *t) {
    return t->upload_ms;
}
static double draw_of(const AccuracyTimes *t) {
    return t->draw_ms;
}
static double frame_of(const AccuracyTimes *t) {
    return t->frame_ms;
}
static double update_of(const AccuracyTimes *t) {
    return t->select_ms + t->refine_ms;
}

// Of one frame over the rounds: sorted into `values`.
static void sort_rounds(const AccuracyTimes *times, int rounds, int poses, Figure *figure, double *values) {
    for (int round = 0; round < rounds; round++)
        values[round] = figure(&times[(size_t)round * (size_t)poses]);
    statistics_sort(values, rounds);
}

static double median_of(const AccuracyTimes *times, int rounds, int poses, Figure *figure) {
    double values[ROUNDS_MAX];
    sort_rounds(times, rounds, poses, figure, values);
    return statistics_percentile(values, rounds, 0.5);
}

static void summarize_frame(const AccuracyTimes *times, int rounds, int poses, AccuracyFrame *frame) {
    double values[ROUNDS_MAX];
    frame->median = (AccuracyTimes){.select_ms = median_of(times, rounds, poses, select_of),
                                    .refine_ms = median_of(times, rounds, poses, refine_of),
                                    .upload_ms = median_of(times, rounds, poses, upload_of),
                                    .draw_ms = median_of(times, rounds, poses, draw_of)};
    sort_rounds(times, rounds, poses, frame_of, values);
    frame->median.frame_ms = statistics_percentile(values, rounds, 0.5);
    frame->frame_least_ms = values[0];
    frame->frame_most_ms = values[rounds - 1];
}

// Of the frames that do not jump, what `times` has for them, `stride` bytes apart: sorted into `values`.
static int sort_frames(const AccuracyDem *dem, const AccuracyTimes *times, size_t stride, Figure *figure,
                       double *values) {
    int count = 0;
    for (int pose = 0; pose < dem->pose_count; pose++)
        if (!dem->poses[pose].jump)
            values[count++] = figure((const AccuracyTimes *)((const char *)times + (size_t)pose * stride));
    statistics_sort(values, count);
    return count;
}

static AccuracyPercentiles percentiles_of(const AccuracyDem *dem, const AccuracyRun *run, Figure *figure,
                                          double *values) {
    int count = sort_frames(dem, &run->frames[0].median, sizeof run->frames[0], figure, values);
    return (AccuracyPercentiles){statistics_percentile(values, count, 0.50), statistics_percentile(values, count, 0.95),
                                 statistics_percentile(values, count, 0.99), statistics_percentile(values, count, 1.0)};
}

static void add_times(AccuracyTimes *sum, const AccuracyTimes *times, double share) {
    sum->select_ms += share * times->select_ms;
    sum->refine_ms += share * times->refine_ms;
    sum->upload_ms += share * times->upload_ms;
    sum->draw_ms += share * times->draw_ms;
    sum->frame_ms += share * times->frame_ms;
}

static void summarize_counts(const AccuracyDem *dem, AccuracyRun *run, int counted) {
    AccuracySummary *s = &run->summary;
    for (int pose = 0; pose < dem->pose_count; pose++) {
        const AccuracyFrame *frame = &run->frames[pose];
        s->triangles_mean += (double)frame->triangles / dem->pose_count;
        s->vram_bytes = frame->vram_bytes > s->vram_bytes ? frame->vram_bytes : s->vram_bytes;
        s->memory_bytes = frame->memory_bytes > s->memory_bytes ? frame->memory_bytes : s->memory_bytes;
        if (dem->poses[pose].jump)
            continue;
        s->rebuilt_share += frame->rebuilt_share / counted;
        s->upload_bytes_mean += (double)frame->upload_bytes / counted;
        add_times(&s->mean, &frame->median, 1.0 / counted);
    }
}

static void summarize_rounds(const AccuracyDem *dem, const AccuracyTimes *times, int rounds, double *values,
                             AccuracySummary *s) {
    s->round_p50_least_ms = INFINITY;
    for (int round = 0; round < rounds; round++) {
        const AccuracyTimes *of_round = times + (size_t)round * (size_t)dem->pose_count;
        int count = sort_frames(dem, of_round, sizeof *of_round, frame_of, values);
        double p50 = statistics_percentile(values, count, 0.5);
        s->round_p50_least_ms = fmin(s->round_p50_least_ms, p50);
        s->round_p50_most_ms = fmax(s->round_p50_most_ms, p50);
    }
}

Result accuracy_summarize_times(Accuracy *accuracy, int dem, const AccuracyTimes *times) {
    const AccuracyDem *d = &accuracy->dems[dem];
    int rounds = accuracy->plan.rounds;
    double *values = malloc(sizeof *values * (size_t)d->pose_count);
    if (!values)
        return RESULT_MEMORY;
    for (int i = 0; i < runs_of_dem(accuracy); i++) {
        AccuracyRun *run = &accuracy->runs[dem * runs_of_dem(accuracy) + i];
        const AccuracyTimes *of_run = times + (size_t)i * (size_t)rounds * (size_t)d->pose_count;
        for (int pose = 0; pose < d->pose_count; pose++)
            summarize_frame(of_run + pose, rounds, d->pose_count, &run->frames[pose]);
        summarize_counts(d, run, accuracy_jump_free(accuracy, dem));
        summarize_rounds(d, of_run, rounds, values, &run->summary);
        run->summary.frame_ms = percentiles_of(d, run, frame_of, values);
        run->summary.refine_ms = percentiles_of(d, run, update_of, values);
    }
    free(values);
    return RESULT_OK;
}

// ---- errors ----

static bool is_whole(const Measure *m) {
    return !m->t_junctions && !m->holes && !m->overlaps;
}

// How much of what was tolerated is used up; infinite where the surface is not whole.
double accuracy_badness(const AccuracyFrame *frame) {
    return is_whole(&frame->measure) ? frame->measure.max_px / frame->reached_px : INFINITY;
}

static void add_errors(AccuracySummary *s, const AccuracyFrame *frame, int frames) {
    const Measure *m = &frame->measure;
    s->max_px = fmax(s->max_px, m->max_px);
    s->p999_px = fmax(s->p999_px, m->p999_px);
    s->p99_px = fmax(s->p99_px, m->p99_px);
    s->rms_px += m->rms_px * m->rms_px / frames; // of squares until the end
    s->above_tau_share += m->above_tau_share / frames;
    s->t_junctions += m->t_junctions;
    s->holes += m->holes;
    s->overlaps += m->overlaps;
    s->reached_px = fmax(s->reached_px, frame->reached_px);
    if (isfinite(frame->popping_px))
        s->popping_px = fmax(s->popping_px, frame->popping_px);
    s->promised = s->promised && frame->promises;
    s->held = s->held && is_whole(m) && m->max_px <= frame->reached_px;
}

static void summarize_run(const AccuracyDem *dem, AccuracyRun *run) {
    AccuracySummary *s = &run->summary;
    s->promised = s->held = true;
    for (int pose = 0; pose < dem->pose_count; pose++) {
        add_errors(s, &run->frames[pose], dem->pose_count);
        if (accuracy_badness(&run->frames[pose]) > accuracy_badness(&run->frames[s->worst_frame]))
            s->worst_frame = pose;
    }
    s->rms_px = sqrt(s->rms_px);
}

void accuracy_summarize_errors(Accuracy *accuracy, int dem) {
    for (int i = 0; i < runs_of_dem(accuracy); i++)
        summarize_run(&accuracy->dems[dem], &accuracy->runs[dem * runs_of_dem(accuracy) + i]);
}

// What is condemned: a promise that was not kept, and a surface that is not whole, promised or not.
bool accuracy_run_holds(const AccuracyRun *run) {
    const AccuracySummary *s = &run->summary;
    bool whole = !s->t_junctions && !s->holes && !s->overlaps;
    return whole && (s->held || !s->promised);
}

bool accuracy_holds(const Accuracy *accuracy) {
    for (int i = 0; i < accuracy->run_count; i++)
        if (!accuracy_run_holds(&accuracy->runs[i]))
            return false;
    return true;
}

// ---- equal errors ----

static double between(double low, double high, double share) {
    return exp((1.0 - share) * log(fmax(low, LEAST)) + share * log(fmax(high, LEAST)));
}

AccuracyCost accuracy_cost_at(const Accuracy *accuracy, int dem, int variant, double measured_px) {
    for (int tau = 0; tau + 1 < accuracy->plan.tau_count; tau++) {
        const AccuracySummary *a = &accuracy_run_at(accuracy, dem, variant, tau)->summary;
        const AccuracySummary *b = &accuracy_run_at(accuracy, dem, variant, tau + 1)->summary;
        if (!(a->max_px > 0.0 && a->max_px <= measured_px && measured_px <= b->max_px && a->max_px < b->max_px))
            continue;
        double share = log(measured_px / a->max_px) / log(b->max_px / a->max_px);
        return (AccuracyCost){between(a->frame_ms.p50, b->frame_ms.p50, share),
                              between(a->refine_ms.p50, b->refine_ms.p50, share),
                              between(a->triangles_mean, b->triangles_mean, share)};
    }
    return (AccuracyCost){NAN, NAN, NAN};
}
