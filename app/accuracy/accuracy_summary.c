#include "app/accuracy/accuracy_internal.h"

#include <math.h>

#define LEAST 1e-6 // ms: for logarithms of what took no time

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

// ---- errors ----

static bool is_whole(const Measure *m) {
    return !m->t_junctions && !m->holes && !m->overlaps;
}

static double used_share(const AccuracyFrame *frame) {
    return frame->measure.max_px / frame->reached_px;
}

double accuracy_badness(const AccuracyFrame *frame) {
    return is_whole(&frame->measure) ? used_share(frame) : INFINITY;
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
    if (isfinite(frame->popping_px)) {
        s->popping_px = fmax(s->popping_px, frame->popping_px);
        s->popping_pairs++;
    }
    s->promised = s->promised && frame->promises;
    s->held = s->held && is_whole(m) && m->max_px <= frame->reached_px;
}

static void summarize_run(const AccuracyDem *dem, AccuracyRun *run) {
    AccuracySummary *s = &run->summary;
    s->promised = s->held = true;
    s->popping_px = run->stretch_px;
    s->popping_pairs = run->stretch_pairs;
    for (int pose = 0; pose < dem->pose_count; pose++) {
        add_errors(s, &run->frames[pose], dem->pose_count);
        if (accuracy_badness(&run->frames[pose]) > accuracy_badness(&run->frames[s->worst_frame]))
            s->worst_frame = pose;
        if (used_share(&run->frames[pose]) > used_share(&run->frames[s->worst_error]))
            s->worst_error = pose;
    }
    s->rms_px = sqrt(s->rms_px);
}

void accuracy_summarize_errors(Accuracy *accuracy, int dem) {
    for (int i = 0; i < runs_of_dem(accuracy); i++)
        summarize_run(&accuracy->dems[dem], &accuracy->runs[dem * runs_of_dem(accuracy) + i]);
}

// What is condemned: a promise that was not kept, a surface that is not whole, promised or not, and times of other
// cuts.
bool accuracy_run_holds(const AccuracyRun *run) {
    const AccuracySummary *s = &run->summary;
    bool whole = !s->t_junctions && !s->holes && !s->overlaps;
    return whole && s->same_cuts && (s->held || !s->promised);
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
        return (AccuracyCost){.frame_ms = between(a->frame_ms.p50, b->frame_ms.p50, share),
                              .frame_least_ms = between(a->frame_p50.least, b->frame_p50.least, share),
                              .frame_most_ms = between(a->frame_p50.most, b->frame_p50.most, share),
                              .update_ms = between(a->update_ms.p50, b->update_ms.p50, share),
                              .triangles = between(a->triangles_mean, b->triangles_mean, share)};
    }
    return (AccuracyCost){NAN, NAN, NAN, NAN, NAN};
}
