// `overfly reproduce PAPER`: the experiment of a paper, its figures beside ours.
#define _DEFAULT_SOURCE // getloadavg
#define _POSIX_C_SOURCE 200809L
#include "app/bench/bench.h"
#include "app/commands/command.h"
#include "app/outputs.h"
#include "app/reproduce/reproduce.h"
#include "app/reproduce/reproduce_figures.h"
#include "app/signals.h"
#include "base/clock.h"
#include "base/log.h"
#include "config/files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BUSY_SHARE 0.4 // of the processors

typedef struct Experiment {
    const char *name;
    const FiguresPaper *paper;
    Result (*run)(Reproduce *run);
} Experiment;

static const Experiment experiments[] = {
    {"loeffler", &figures_loeffler, reproduce_loeffler},
    {"biedermann", &figures_biedermann, reproduce_biedermann},
    {"yalcin", &figures_yalcin, reproduce_yalcin},
    {"ye", &figures_ye, reproduce_ye},
};

static const Experiment *find_experiment(const Options *options) {
    const char *name = options_positional_count(options) ? options_positionals(options)[0] : "";
    for (size_t i = 0; i < COUNT_OF(experiments); i++)
        if (strcmp(experiments[i].name, name) == 0)
            return &experiments[i];
    log_error("reproduce: expected 'loeffler', 'biedermann', 'yalcin' or 'ye', found '%s'; for example: overfly "
              "reproduce loeffler --quick",
              name);
    return NULL;
}

static Result read_options(const Options *options, Reproduce *run) {
    const char *folder = options_text(options, OPTION_OUTPUT_FOLDER);
    const char *sides = options_text(options, OPTION_REPRODUCE_SIDES);
    const char *const begins[] = {run->report.paper, NULL};
    run->options = options;
    run->quick = options_flag(options, OPTION_QUICK);
    run->seconds = options_is_set(options, OPTION_SECONDS) ? options_number(options, OPTION_SECONDS) : 0.0;
    Result result = sides ? bench_read_sides(sides, REPRODUCE_SIDES_MAX, run->sides, &run->side_count) : RESULT_OK;
    if (result == RESULT_OK && folder)
        result = files_check_folder(folder);
    return result == RESULT_OK && folder ? outputs_check_folder(options, "--output", folder, begins) : result;
}

static Result start_workers(Reproduce *run) {
    sigset_t before;
    signals_hold_all(&before);
    Result result = jobs_create(1, &run->one);
    if (result == RESULT_OK)
        result = jobs_create((int)options_integer(run->options, OPTION_THREADS), &run->all);
    signals_restore(&before);
    return result;
}

// Frames are drawn where that is possible; the rest of an experiment needs no GL.
static void open_context(Reproduce *run) {
    ContextOptions options = {.width = 1280, .height = 800};
    if (run->quick) {
        report_note(&run->report.left_out, "drawing: frames a second are of refinement alone");
        return;
    }
    if (context_create_offscreen(&options, &run->context) == RESULT_OK)
        snprintf(run->report.renderer, sizeof run->report.renderer, "%s%s", context_renderer_name(run->context),
                 context_is_software(run->context) ? ", a software renderer" : "");
    else
        report_note(&run->report.left_out, "drawing: there is no GL context; frames a second are of refinement alone");
}

static Result open_run(const Options *options, Reproduce *run) {
    Result result = site_open(options, &run->site);
    if (result == RESULT_OK)
        result = start_workers(run);
    if (result != RESULT_OK)
        return result;
    run->report.threads = jobs_worker_count(run->all);
    open_context(run);
    return RESULT_OK;
}

static Result deliver(Reproduce *run) {
    const char *folder = options_text(run->options, OPTION_OUTPUT_FOLDER);
    Result result = folder ? report_write_files(&run->report, folder) : RESULT_OK;
    if (result == RESULT_OK && options_flag(run->options, OPTION_JSON))
        return report_write_json(&run->report, stdout);
    if (!folder)
        report_write_text(&run->report, stdout);
    else if (result == RESULT_OK)
        log_info("%s: the tables are in %s.md, %s.json and %s_*.csv", folder, run->report.paper, run->report.paper,
                 run->report.paper);
    return result;
}

static void close_run(Reproduce *run) {
    report_clear(&run->report);
    context_destroy(&run->context);
    if (run->all)
        jobs_destroy(&run->all);
    if (run->one)
        jobs_destroy(&run->one);
    site_close(&run->site);
}

// A machine that does other work gives two threads little more than one: the tables say so, and so does a warning.
static double machine_load(void) {
    double load = 0.0;
    if (getloadavg(&load, 1) != 1)
        return NAN;
    if (load > BUSY_SHARE * bench_machine().processors)
        log_warn("the machine is busy (load %.1f): times, and above all gains by threads, will be worse than they are",
                 load);
    return load;
}

Result cmd_reproduce(const Options *options) {
    const Experiment *experiment = find_experiment(options);
    Reproduce run = {0};
    if (!experiment)
        return RESULT_USAGE;
    int64_t begin = clock_now_ns();
    run.report.load = machine_load();
    run.report.paper = experiment->name;
    run.report.title = experiment->paper->title;
    run.report.paper_hardware = experiment->paper->hardware;
    Result result = read_options(options, &run);
    run.report.quick = run.quick;
    if (result == RESULT_OK)
        result = open_run(options, &run);
    if (result == RESULT_OK)
        result = experiment->run(&run);
    run.report.wall_s = (double)(clock_now_ns() - begin) * 1e-9;
    if (result == RESULT_OK)
        result = deliver(&run);
    close_run(&run);
    return result;
}
