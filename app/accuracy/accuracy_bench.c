// `overfly bench [SCENE|DEM]...`: what accuracy costs in time.
#define _POSIX_C_SOURCE 200809L
#include "app/accuracy/accuracy_report.h"
#include "app/bench/bench.h"
#include "app/signals.h"
#include "base/log.h"

#include <stdio.h>
#include <stdlib.h>

static Result print_json(const Accuracy *accuracy) {
    Json *json = accuracy_make_json(accuracy);
    Result result = json_print(json);
    json_destroy(&json);
    return result;
}

// What was measured is told even where the report could not be written.
static Result deliver(const Accuracy *accuracy, const char *folder) {
    const Options *options = accuracy->plan.options;
    Result written = folder ? accuracy_write_report(accuracy, folder) : RESULT_OK, told = RESULT_OK;
    if (options_flag(options, OPTION_JSON))
        told = print_json(accuracy);
    else
        accuracy_write_text(accuracy, stdout);
    fflush(stdout); // before what is logged, where both go to one file
    if (written == RESULT_OK && folder)
        log_info("%s: open report.html in a browser; frames.csv, summary.csv, summary.json and plots lie beside it",
                 folder);
    return written == RESULT_OK ? told : written;
}

// A broken promise is a failure, once all of it is written down.
static Result judge(const Accuracy *accuracy) {
    char fault[ACCURACY_TEXT_BYTES];
    if (accuracy_holds(accuracy))
        return RESULT_OK;
    for (int i = 0; i < accuracy->run_count; i++) {
        accuracy_fault(accuracy, &accuracy->runs[i], fault);
        if (*fault)
            log_error("bench: %s", fault);
    }
    return RESULT_RANGE;
}

// What a signal leaves of it: a report of the models that were finished, if any.
static Result run_until_signal(const AccuracyPlan *plan, Accuracy *accuracy) {
    sigset_t before;
    signals_hold(&before);
    Result result = accuracy_run(plan, accuracy);
    for (int came; (came = signals_take()) != 0;) // what was measured is told first
        accuracy->signal = came;
    signals_restore(&before);
    if (result == RESULT_OK && accuracy_is_interrupted(accuracy))
        log_warn("bench: interrupted; %d of %d models finished%s", accuracy->plan.dem_count, plan->dem_count,
                 accuracy->plan.dem_count ? "" : ", so nothing is written");
    return result;
}

static Result tell(const Accuracy *accuracy, const char *folder) {
    if (accuracy->plan.dem_count == 0)
        return RESULT_OK;
    Result result = deliver(accuracy, folder);
    return result == RESULT_OK ? judge(accuracy) : result;
}

Result bench_accuracy(const Options *options) {
    AccuracyPlan *plan = calloc(1, sizeof *plan);
    Accuracy *accuracy = calloc(1, sizeof *accuracy);
    const char *folder = options_text(options, OPTION_REPORT_FOLDER);
    Result result = plan && accuracy ? accuracy_plan(options, plan) : RESULT_MEMORY;
    if (result == RESULT_OK && folder)
        result = accuracy_check_report(options, folder);
    if (result == RESULT_OK && !folder && !options_flag(options, OPTION_JSON))
        log_info("bench: a table only: no report is written without -o DIR");
    if (result == RESULT_OK)
        result = run_until_signal(plan, accuracy);
    if (result == RESULT_OK)
        result = tell(accuracy, folder);
    int came = accuracy ? accuracy->signal : 0;
    if (accuracy)
        accuracy_clear(accuracy);
    if (plan)
        accuracy_plan_clear(plan);
    free(accuracy);
    free(plan);
    if (came)
        raise(came); // for a shell, which then ends what it was in
    return result;
}
