// Errors of one DEM's runs: the same cuts once more, each against every sample of the elevation model, in passes of
// their own, so that measuring does not disturb the timing.
#include "app/accuracy/accuracy_internal.h"
#include "base/log.h"

#include <math.h>
#include <stdlib.h>

typedef struct Measuring {
    Accuracy *accuracy;
    const AccuracyDem *dem;
    float *rise_m[2]; // [height][width] of the frame before and of this one
} Measuring;

static Result measure_frame(Measuring *m, const AccuracyPass *pass, AccuracyRun *run, int pose) {
    AccuracyFrame *frame = &run->frames[pose];
    const AccuracyPlan *plan = &m->accuracy->plan;
    LodCut cut = pass->cut;
    if (plan->tamper)
        plan->tamper(plan->tamper_user, pass->world->terrain, &cut);
    const MeasureMaps maps = {.rise_m = m->rise_m[pose & 1]};
    run->summary.same_cuts = run->summary.same_cuts && accuracy_cut_outline(&pass->cut) == frame->cut_outline;
    frame->cut_hash = accuracy_cut_hash(&pass->cut);
    frame->reached_px = cut.reached_px;
    frame->promises = cut.promises;
    frame->popping_px = NAN;
    Result result = measure_cut_maps(pass->world->terrain, &cut, pass->world->jobs, &maps, &frame->measure);
    if (result != RESULT_OK || m->dem->poses[pose].jump)
        return result;
    MeasurePopping popping;
    result = measure_popping(pass->world->terrain, &cut.view, m->rise_m[(pose & 1) ^ 1], maps.rise_m, pass->world->jobs,
                             &popping);
    frame->popping_px = popping.max_px;
    return result;
}

static Result measure_run(Measuring *m, AccuracyRun *run) {
    AccuracyPass pass = {.lod = NULL};
    Result result = accuracy_pass_begin(&m->accuracy->plan, m->dem, run, 1, &pass);
    for (int pose = 0; pose < m->dem->pose_count && result == RESULT_OK && accuracy_goes_on(m->accuracy); pose++) {
        result = accuracy_pass_refine(&pass, pose);
        if (result == RESULT_OK)
            result = measure_frame(m, &pass, run, pose);
    }
    for (int flight = 0; flight < m->accuracy->plan.flight_count && result == RESULT_OK; flight++)
        result = accuracy_stretch(m->accuracy, &pass, flight, m->accuracy->plan.stretch, run);
    accuracy_pass_end(&pass);
    return result;
}

Result accuracy_measure(Accuracy *accuracy, int dem) {
    Measuring m = {.accuracy = accuracy, .dem = &accuracy->dems[dem]};
    size_t samples = (size_t)m.dem->width * (size_t)m.dem->height;
    int runs = accuracy->plan.variant_count * accuracy->plan.tau_count;
    Result result = RESULT_OK;
    for (int i = 0; i < 2; i++) {
        m.rise_m[i] = malloc(samples * sizeof *m.rise_m[i]);
        if (!m.rise_m[i])
            result = RESULT_MEMORY;
    }
    if (result == RESULT_MEMORY)
        log_error("bench: no memory to measure %d x %d samples", m.dem->width, m.dem->height);
    Progress progress = progress_begin("measuring");
    for (int i = 0; i < runs && result == RESULT_OK && accuracy_goes_on(accuracy); i++) {
        result = measure_run(&m, &accuracy->runs[dem * runs + i]);
        progress_update(&progress, (double)(i + 1) / runs);
    }
    progress_end(&progress);
    if (result == RESULT_OK && accuracy_goes_on(accuracy))
        accuracy_summarize_errors(accuracy, dem);
    free(m.rise_m[0]);
    free(m.rise_m[1]);
    return result;
}
