#include "app/accuracy/accuracy_hitches.h"

#include <stdio.h>

// What the stages do not account for is the system's, or the program's between them.
static void tell_cause(const AccuracyRun *run, const AccuracyFrame *frame, char out[ACCURACY_CAUSE_BYTES]) {
    const AccuracyTimes *t = &frame->median, *mean = &run->summary.mean;
    double refine = t->select_ms + t->refine_ms - mean->select_ms - mean->refine_ms;
    double upload = t->upload_ms - mean->upload_ms, draw = t->draw_ms - mean->draw_ms;
    double rest = t->frame_ms - mean->frame_ms - refine - upload - draw;
    if (rest > refine && rest > upload && rest > draw)
        snprintf(out, ACCURACY_CAUSE_BYTES, "between the stages: the system");
    else if (refine > upload && refine > draw)
        snprintf(out, ACCURACY_CAUSE_BYTES, "refinement: %.1f %% of the triangles anew", 100.0 * frame->rebuilt_share);
    else if (upload > draw)
        snprintf(out, ACCURACY_CAUSE_BYTES, "upload: %.0f kB", (double)frame->upload_bytes / 1e3);
    else
        snprintf(out, ACCURACY_CAUSE_BYTES, "drawing: %.2f times the mean triangles",
                 (double)frame->triangles / run->summary.triangles_mean);
}

// Keeps the list sorted, and drops what falls off its end.
static int insert(AccuracyHitch *list, int count, const AccuracyHitch *hitch) {
    int at = count;
    while (at > 0 && list[at - 1].times < hitch->times)
        at--;
    if (at == ACCURACY_HITCHES_MAX)
        return count;
    int last = count < ACCURACY_HITCHES_MAX ? count : ACCURACY_HITCHES_MAX - 1;
    for (int i = last; i > at; i--)
        list[i] = list[i - 1];
    list[at] = *hitch;
    return last + 1;
}

int accuracy_hitches(const Accuracy *accuracy, int dem, AccuracyHitch out[ACCURACY_HITCHES_MAX], int *found) {
    const AccuracyDem *d = &accuracy->dems[dem];
    int count = 0;
    *found = 0;
    for (int i = 0; i < accuracy->run_count; i++) {
        const AccuracyRun *run = &accuracy->runs[i];
        for (int pose = 0; run->dem == dem && pose < d->pose_count; pose++) {
            double times = run->frames[pose].median.frame_ms / run->summary.frame_ms.p50;
            if (d->poses[pose].jump || !(times > ACCURACY_HITCH_TIMES))
                continue;
            AccuracyHitch hitch = {.run = run, .pose = pose, .times = times};
            tell_cause(run, &run->frames[pose], hitch.cause);
            count = insert(out, count, &hitch);
            ++*found;
        }
    }
    return count;
}
