// How long a benchmark will take, once a round is flown: the rounds as the first one, and measuring as one cut of each
// variant takes.
#include "app/accuracy/accuracy_internal.h"
#include "base/clock.h"
#include "base/log.h"

#include <stdio.h>

#define MINUTES_FROM_S 120.0

static Result measure_one(const AccuracyPlan *plan, const AccuracyDem *dem, const AccuracyRun *run) {
    AccuracyPass pass = {.lod = NULL};
    Measure measure;
    Result result = accuracy_pass_begin(plan, dem, run, 1, &pass);
    if (result == RESULT_OK)
        result = accuracy_pass_refine(&pass, 0);
    if (result == RESULT_OK)
        result = measure_cut(pass.world->terrain, &pass.cut, pass.world->jobs, &measure);
    accuracy_pass_end(&pass);
    return result;
}

static void name_duration(double seconds, char out[32]) {
    if (seconds < MINUTES_FROM_S)
        snprintf(out, 32, "%.0f s", seconds);
    else
        snprintf(out, 32, "%.0f minutes", seconds / 60.0);
}

Result accuracy_estimate(const Accuracy *accuracy, int dem, double round_s) {
    const AccuracyPlan *plan = &accuracy->plan;
    Result result = RESULT_OK;
    int64_t begin = clock_now_ns();
    for (int i = 0; i < plan->variant_count && result == RESULT_OK; i++) { // of a tolerance in the middle
        int run = (dem * plan->variant_count + i) * plan->tau_count + plan->tau_count / 2;
        result = measure_one(plan, &accuracy->dems[dem], &accuracy->runs[run]);
    }
    if (result != RESULT_OK)
        return result;
    double measure_s = (double)(clock_now_ns() - begin) * 1e-9 * plan->tau_count * accuracy->dems[dem].pose_count;
    char one[32], all[32];
    name_duration(plan->rounds * round_s + measure_s, one);
    name_duration(plan->dem_count * (plan->rounds * round_s + measure_s), all);
    const char *end = "nothing is written before the end; --frames and --tau make it shorter";
    if (plan->dem_count > 1)
        log_info("bench: flying and measuring take about %s a model of this size, %s for all %d; %s", one, all,
                 plan->dem_count, end);
    else
        log_info("bench: flying and measuring take about %s; %s", one, end);
    return RESULT_OK;
}
