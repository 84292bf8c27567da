#include "app/accuracy/accuracy_report.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static int64_t cracks_of(const AccuracySummary *s) {
    return s->t_junctions + s->holes + s->overlaps;
}

void accuracy_fault(const Accuracy *accuracy, const AccuracyRun *run, char out[ACCURACY_TEXT_BYTES]) {
    const AccuracySummary *s = &run->summary;
    const AccuracyVariant *variant = &accuracy->plan.variants[run->variant];
    const AccuracyFrame *frame = &run->frames[s->worst_error];
    out[0] = '\0';
    if (accuracy_run_holds(run))
        return;
    int used = snprintf(out, ACCURACY_TEXT_BYTES, "%s at tau %g px over %s", variant->name, run->tau_px,
                        accuracy->dems[run->dem].name);
    if (cracks_of(s))
        used += snprintf(out + used, (size_t)(ACCURACY_TEXT_BYTES - used),
                         ": %" PRId64 " T-junctions, %" PRId64 " holes, %" PRId64 " overlaps", s->t_junctions, s->holes,
                         s->overlaps);
    if (s->promised && !(frame->measure.max_px <= frame->reached_px))
        used += snprintf(out + used, (size_t)(ACCURACY_TEXT_BYTES - used),
                         "%s %.4g px measured where at most %.4g were promised", cracks_of(s) ? ";" : ":",
                         frame->measure.max_px, frame->reached_px);
    if (!s->same_cuts)
        snprintf(out + used, (size_t)(ACCURACY_TEXT_BYTES - used), ": other cuts were timed than measured");
}

typedef struct Tally {
    int promised, held, cracked, untrue; // untrue: timed were others than measured
    double most;                         // of what was tolerated, in the runs that promise
} Tally;

static Tally tally_of(const Accuracy *accuracy) {
    Tally tally = {0};
    for (int i = 0; i < accuracy->run_count; i++) {
        const AccuracyRun *run = &accuracy->runs[i];
        const AccuracyFrame *frame = &run->frames[run->summary.worst_error];
        tally.promised += run->summary.promised;
        tally.held += run->summary.promised && accuracy_run_holds(run);
        tally.cracked += cracks_of(&run->summary) > 0;
        tally.untrue += !run->summary.same_cuts;
        if (run->summary.promised)
            tally.most = fmax(tally.most, frame->measure.max_px / frame->reached_px);
    }
    return tally;
}

static int64_t frames_of(const Accuracy *accuracy) {
    int64_t frames = 0;
    for (int i = 0; i < accuracy->run_count; i++)
        frames += accuracy->dems[accuracy->runs[i].dem].pose_count;
    return frames;
}

static const char *plural(int count) {
    return count == 1 ? "" : "s";
}

// Of those that promise, and all did; or of all, and none promises.
static void name_runs(int count, bool promise, char out[80]) {
    if (promise)
        snprintf(out, 80, count == 1 ? "the one run that promises a bound" : "all %d runs that promise a bound", count);
    else
        snprintf(out, 80, count == 1 ? "the one run has no bound" : "none of the %d runs has a bound", count);
}

// Behind the verdict of those that were.
static void name_unfinished(const Accuracy *accuracy, char out[ACCURACY_TEXT_BYTES]) {
    size_t used = strlen(out);
    int unfinished = accuracy->dems_planned - accuracy->dems_finished;
    if (unfinished > 0)
        snprintf(out + used, ACCURACY_TEXT_BYTES - used,
                 " It was interrupted: of %d elevation models, %d could not be finished and %s not in it.",
                 accuracy->dems_planned, unfinished, unfinished == 1 ? "is" : "are");
}

static void judge_runs(const Accuracy *accuracy, char out[ACCURACY_TEXT_BYTES]) {
    Tally tally = tally_of(accuracy);
    char runs[80];
    name_runs(tally.promised ? tally.promised : accuracy->run_count, tally.promised > 0, runs);
    if (!accuracy_holds(accuracy))
        snprintf(out, ACCURACY_TEXT_BYTES,
                 "BROKEN: %d of %d run%s that promise%s a bound kept it; %d of %d run%s had cracks, in %" PRId64
                 " frames measured at every sample%s.",
                 tally.held, tally.promised, plural(tally.promised), tally.promised == 1 ? "s" : "", tally.cracked,
                 accuracy->run_count, plural(accuracy->run_count), frames_of(accuracy),
                 tally.untrue ? "; some were timed over other cuts than measured" : "");
    else if (tally.promised == 0)
        snprintf(out, ACCURACY_TEXT_BYTES,
                 "Nothing was promised: %s; no surface had a crack, in %" PRId64 " frames measured at every sample.",
                 runs, frames_of(accuracy));
    else
        snprintf(out, ACCURACY_TEXT_BYTES,
                 "Every promise held: %s kept it, using up at most %.2f %% of it, and no "
                 "surface had a crack, in %" PRId64 " frames measured at every sample.",
                 runs, 100.0 * tally.most, frames_of(accuracy));
}

void accuracy_verdict(const Accuracy *accuracy, char out[ACCURACY_TEXT_BYTES]) {
    judge_runs(accuracy, out);
    name_unfinished(accuracy, out);
}

static void write_run(const Accuracy *accuracy, const AccuracyRun *run, FILE *to) {
    const AccuracySummary *s = &run->summary;
    char popping[16] = "none";
    if (s->popping_px > 0.0)
        snprintf(popping, sizeof popping, "%.2f", s->popping_px);
    fprintf(to, "%-28s %5g  %8.3f %8.3f %8.3f %8.4f  %-9s %7s %7" PRId64 "  %9.0f %5.1f  %8.2f %8.2f %8.2f\n",
            accuracy->plan.variants[run->variant].name, run->tau_px, s->max_px, s->p999_px, s->rms_px,
            100.0 * s->above_tau_share,
            !accuracy_run_holds(run) ? "BROKEN"
            : s->promised            ? "held"
                                     : "none",
            popping, cracks_of(s), s->triangles_mean, 100.0 * s->rebuilt_share, s->update_ms.p50, s->frame_ms.p50,
            s->frame_ms.p99);
}

void accuracy_write_text(const Accuracy *accuracy, FILE *to) {
    char text[ACCURACY_TEXT_BYTES];
    for (int dem = 0; dem < accuracy->plan.dem_count; dem++) {
        const AccuracyDem *d = &accuracy->dems[dem];
        int of_dem = accuracy->plan.variant_count * accuracy->plan.tau_count;
        fprintf(to, "%s, %d x %d samples; %d frames of %d flight%s, %d round%s; %s%s\n\n", d->name, d->width, d->height,
                d->pose_count, accuracy->plan.flight_count, plural(accuracy->plan.flight_count), accuracy->plan.rounds,
                plural(accuracy->plan.rounds), *accuracy->renderer ? accuracy->renderer : "nothing drawn",
                accuracy->software ? ", a software renderer" : "");
        fprintf(to, "%-28s %5s  %8s %8s %8s %8s  %-9s %7s %7s  %9s %5s  %8s %8s %8s\n", "method", "tau", "max px",
                "p99.9", "rms", "% above", "promise", "popping", "cracks", "triangles", "% new", "refine", "frame p50",
                "p99 ms");
        for (int i = dem * of_dem; i < (dem + 1) * of_dem; i++)
            write_run(accuracy, &accuracy->runs[i], to);
        fprintf(to, "\npopping: the largest found in %d pairs of frames a run; of a longer flight it may be more\n\n",
                accuracy_run_at(accuracy, dem, 0, 0)->summary.popping_pairs);
    }
    accuracy_verdict(accuracy, text);
    fprintf(to, "%s\n", text);
    if (accuracy->worst.run < 0)
        return;
    char *command = accuracy_command(accuracy, &accuracy->runs[accuracy->worst.run], accuracy->worst.frame);
    fprintf(to, "The worst frame again: %s\n", command ? command : "(no memory)");
    free(command);
}
