#include "app/accuracy/accuracy_hitches.h"

#include "base/statistics.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct Search {
    const AccuracyDem *dem;
    double p50[ACCURACY_FLIGHTS_MAX]; // of the medians of each flight's frames, in the run that is looked at
    double *values;                   // [pose_count], for sorting
    AccuracyHitch *out;
    int count, found;
} Search;

static void find_medians(Search *s, const AccuracyRun *run) {
    for (int flight = 0; flight < ACCURACY_FLIGHTS_MAX; flight++) {
        int count = 0;
        for (int pose = 0; pose < s->dem->pose_count; pose++)
            if (s->dem->poses[pose].flight == flight && !s->dem->poses[pose].jump)
                s->values[count++] = run->frames[pose].median.frame_ms;
        statistics_sort(s->values, count);
        s->p50[flight] = statistics_percentile(s->values, count, 0.5);
    }
}

// In all rounds: which stage is further above the run's mean than the others. What none accounts for lies between them.
static void tell_stage(const AccuracyRun *run, const AccuracyFrame *frame, char out[ACCURACY_CAUSE_BYTES]) {
    const AccuracyTimes *t = &frame->median, *mean = &run->summary.mean;
    double refine = t->select_ms + t->refine_ms - mean->select_ms - mean->refine_ms;
    double upload = t->upload_ms - mean->upload_ms, draw = t->draw_ms - mean->draw_ms;
    double rest = t->frame_ms - mean->frame_ms - refine - upload - draw;
    if (rest > refine && rest > upload && rest > draw)
        snprintf(out, ACCURACY_CAUSE_BYTES, "all rounds: between the stages");
    else if (refine > upload && refine > draw)
        snprintf(out, ACCURACY_CAUSE_BYTES, "all rounds: refinement, %.1f %% of the triangles anew",
                 100.0 * frame->rebuilt_share);
    else if (upload > draw)
        snprintf(out, ACCURACY_CAUSE_BYTES, "all rounds: upload, %.0f kB", (double)frame->upload_bytes / 1e3);
    else
        snprintf(out, ACCURACY_CAUSE_BYTES, "all rounds: drawing, %.2f times the run's mean triangles",
                 (double)frame->triangles / run->summary.triangles_mean);
}

// Keeps the list sorted, and drops what falls off its end.
static void insert(Search *s, const AccuracyHitch *hitch) {
    int at = s->count;
    s->found++;
    while (at > 0 && s->out[at - 1].times < hitch->times)
        at--;
    if (at == ACCURACY_HITCHES_MAX)
        return;
    int last = s->count < ACCURACY_HITCHES_MAX ? s->count++ : ACCURACY_HITCHES_MAX - 1;
    for (int i = last; i > at; i--)
        s->out[i] = s->out[i - 1];
    s->out[at] = *hitch;
}

static void look_at_frame(Search *s, const AccuracyRun *run, int pose) {
    const AccuracyFrame *frame = &run->frames[pose];
    double median = frame->median.frame_ms, most = frame->most.frame_ms, p50 = s->p50[s->dem->poses[pose].flight];
    AccuracyHitch hitch = {.run = run, .pose = pose};
    if (median > ACCURACY_HITCH_TIMES * p50) {
        hitch.ms = median;
        hitch.times = median / p50;
        tell_stage(run, frame, hitch.cause);
        insert(s, &hitch);
    } else if (most > ACCURACY_HITCH_TIMES * median) {
        hitch.ms = most;
        hitch.times = most / median;
        snprintf(hitch.cause, ACCURACY_CAUSE_BYTES, "one round: the system; %.2f ms in their median", median);
        insert(s, &hitch);
    }
}

int accuracy_hitches(const Accuracy *accuracy, int dem, AccuracyHitch out[ACCURACY_HITCHES_MAX], int *found) {
    Search s = {.dem = &accuracy->dems[dem], .out = out};
    s.values = malloc(sizeof *s.values * (size_t)s.dem->pose_count);
    for (int i = 0; i < accuracy->run_count && s.values; i++) {
        const AccuracyRun *run = &accuracy->runs[i];
        if (run->dem != dem)
            continue;
        find_medians(&s, run);
        for (int pose = 0; pose < s.dem->pose_count; pose++)
            if (!s.dem->poses[pose].jump)
                look_at_frame(&s, run, pose);
    }
    free(s.values);
    *found = s.found;
    return s.count;
}
