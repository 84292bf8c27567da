// How long a benchmark will take, once a round is flown: the rounds as the first one, and measuring as one cut of each
// variant takes.
#include "app/accuracy/accuracy_internal.h"
#include "base/clock.h"
#include "base/log.h"

#include <math.h>
#include <stdio.h>

#define MINUTES_FROM_S 120.0

#define FRAMES_TRIED 4 // of a stretch

// Its first frame, which is whole, and one of the others.
static Result time_stretch(Accuracy *accuracy, AccuracyPass *pass, const AccuracyRun *run, double *first_s,
                           double *next_s) {
    AccuracyRun tried = *run;
    int64_t begin = clock_now_ns();
    Result result = accuracy_stretch(accuracy, pass, 0, 1, &tried);
    int64_t middle = clock_now_ns();
    if (result == RESULT_OK)
        result = accuracy_stretch(accuracy, pass, 0, FRAMES_TRIED, &tried);
    *first_s = (double)(middle - begin) * 1e-9;
    *next_s = fmax((double)(clock_now_ns() - middle) * 1e-9 - *first_s, 0.0) / (FRAMES_TRIED - 1);
    return result;
}

// Adds how long all of the variant's takes.
static Result measure_one(Accuracy *accuracy, const AccuracyDem *dem, const AccuracyRun *run, double *seconds) {
    AccuracyPlan plan = accuracy->plan;
    plan.tamper = NULL; // nothing is told of these cuts
    AccuracyPass pass = {.lod = NULL};
    Measure measure;
    double first_s = 0.0, next_s = 0.0;
    int64_t begin = clock_now_ns();
    Result result = accuracy_pass_begin(&plan, dem, run, 1, &pass);
    if (result == RESULT_OK)
        result = accuracy_pass_refine(&pass, 0);
    if (result == RESULT_OK)
        result = measure_cut(pass.world->terrain, &pass.cut, pass.world->jobs, &measure);
    double frame_s = (double)(clock_now_ns() - begin) * 1e-9;
    if (result == RESULT_OK)
        result = time_stretch(accuracy, &pass, run, &first_s, &next_s);
    accuracy_pass_end(&pass);
    *seconds += plan.tau_count * (frame_s * dem->pose_count + first_s * plan.flight_count +
                                  next_s * (plan.stretch - 1) * plan.flight_count);
    return result;
}

static void name_duration(double seconds, char out[32]) {
    if (seconds < MINUTES_FROM_S)
        snprintf(out, 32, "%.0f s", seconds);
    else
        snprintf(out, 32, "%.0f minutes", seconds / 60.0);
}

Result accuracy_estimate(Accuracy *accuracy, int dem, double round_s) {
    const AccuracyPlan *plan = &accuracy->plan;
    Result result = RESULT_OK;
    double measure_s = 0.0;
    for (int i = 0; i < plan->variant_count && result == RESULT_OK; i++) { // of a tolerance in the middle
        int run = (dem * plan->variant_count + i) * plan->tau_count + plan->tau_count / 2;
        result = measure_one(accuracy, &accuracy->dems[dem], &accuracy->runs[run], &measure_s);
    }
    if (result != RESULT_OK || !accuracy_goes_on(accuracy))
        return result;
    char one[32], all[32];
    name_duration(plan->rounds * round_s + measure_s, one);
    name_duration(plan->dem_count * (plan->rounds * round_s + measure_s), all);
    const char *end = "--frames and --tau make it shorter";
    if (plan->dem_count > 1)
        log_info("bench: flying and measuring take about %s a model of this size, %s for all %d; interrupted, it tells "
                 "of the finished ones; %s",
                 one, all, plan->dem_count, end);
    else
        log_info("bench: flying and measuring take about %s; nothing is written before the end; %s", one, end);
    return RESULT_OK;
}
