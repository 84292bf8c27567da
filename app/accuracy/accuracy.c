#define _GNU_SOURCE // getloadavg, open_memstream
#include "app/accuracy/accuracy_internal.h"
#include "app/scene_load.h"
#include "app/signals.h"
#include "base/clock.h"
#include "base/log.h"
#include "terrain/jobs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

static bool is_plain(const char *text) {
    return strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./:+,=-") == strlen(text);
}

// Quoted for a shell where that is needed.
static void quote(const char *text, FILE *to) {
    if (is_plain(text)) {
        fputs(text, to);
        return;
    }
    fputc('\'', to);
    for (; *text; text++)
        fprintf(to, *text == '\'' ? "'\\''" : "%c", *text);
    fputc('\'', to);
}

// The options of a subcommand that were given, by whomever, but for some.
static void put_options(const Options *options, unsigned command, const OptionId *but, size_t but_count, FILE *to) {
    for (int id = 0; id < OPTION_COUNT; id++) {
        const OptionSpec *spec = option_spec((OptionId)id);
        bool skip = !(spec->commands & command) || !(spec->commands & COMMAND_BENCH) ||
                    !options_is_given(options, (OptionId)id);
        for (size_t i = 0; i < but_count; i++)
            skip = skip || but[i] == (OptionId)id;
        if (skip)
            continue;
        fprintf(to, " --%s=", spec->name);
        quote(options_text(options, (OptionId)id), to);
    }
}

static Result describe_given(Accuracy *accuracy) {
    size_t count;
    FILE *memory = open_memstream(&accuracy->given, &count);
    if (!memory)
        return RESULT_MEMORY;
    put_options(accuracy->plan.options, COMMAND_BENCH, NULL, 0, memory);
    return fclose(memory) == 0 ? RESULT_OK : RESULT_MEMORY;
}

static void describe_system(Accuracy *accuracy) {
    struct utsname name;
    if (uname(&name) == 0)
        snprintf(accuracy->system, sizeof accuracy->system, "%.40s %.50s %.30s", name.sysname, name.release,
                 name.machine);
    accuracy->memory_gb = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE) * 1e-9;
}

static Result create_runs(Accuracy *accuracy) {
    const AccuracyPlan *plan = &accuracy->plan;
    int of_dem = plan->variant_count * plan->tau_count;
    accuracy->run_count = plan->dem_count * of_dem;
    accuracy->runs = calloc((size_t)accuracy->run_count, sizeof *accuracy->runs);
    if (!accuracy->runs)
        return RESULT_MEMORY;
    for (int i = 0; i < accuracy->run_count; i++) {
        AccuracyRun *run = &accuracy->runs[i];
        run->dem = i / of_dem;
        run->variant = i % of_dem / plan->tau_count;
        run->tau_px = plan->tau_px[i % plan->tau_count];
        run->summary.same_cuts = true;
    }
    return RESULT_OK;
}

static Result create_frames(Accuracy *accuracy, int dem) {
    int of_dem = accuracy->plan.variant_count * accuracy->plan.tau_count;
    for (int i = dem * of_dem; i < (dem + 1) * of_dem; i++) {
        AccuracyRun *run = &accuracy->runs[i];
        run->frames = calloc((size_t)accuracy->dems[dem].pose_count, sizeof *run->frames);
        if (!run->frames)
            return RESULT_MEMORY;
    }
    return RESULT_OK;
}

// Frames are drawn where that is possible.
static void open_context(Accuracy *accuracy, Context **context) {
    const ContextOptions options = {.width = accuracy->plan.width, .height = accuracy->plan.height};
    if (context_create_offscreen(&options, context) != RESULT_OK) {
        log_warn("bench: without a GL context nothing is drawn; a frame's time is that of its refinement");
        *context = NULL;
        return;
    }
    snprintf(accuracy->renderer, sizeof accuracy->renderer, "%s", context_renderer_name(*context));
    accuracy->software = context_is_software(*context);
}

bool accuracy_goes_on(Accuracy *accuracy) {
    int came = signals_take();
    accuracy->signal = came ? came : accuracy->signal;
    return accuracy->signal == 0;
}

static Result measure_dem(Accuracy *accuracy, int dem, Context *context) {
    Result result = accuracy_measure(accuracy, dem);
    if (result != RESULT_OK || !accuracy_goes_on(accuracy))
        return result;
    result = accuracy_keep_worst(accuracy, dem, context);
    if (result == RESULT_OK && dem == 0)
        result = accuracy_scale(&accuracy->plan, &accuracy->dems[0], &accuracy->scaling);
    accuracy->dems_finished += result == RESULT_OK;
    return result;
}

static Result run_dem(Accuracy *accuracy, int dem, Context *context) {
    Result result = accuracy_load(&accuracy->plan, dem, &accuracy->dems[dem]);
    if (result == RESULT_OK)
        accuracy->threads = jobs_worker_count(accuracy->dems[dem].worlds[0].jobs);
    if (result == RESULT_OK)
        result = create_frames(accuracy, dem);
    if (result == RESULT_OK && accuracy_goes_on(accuracy))
        result = accuracy_time(accuracy, dem, context);
    if (result == RESULT_OK && accuracy_goes_on(accuracy))
        result = measure_dem(accuracy, dem, context);
    accuracy_unload(&accuracy->dems[dem]);
    return result;
}

// Tells of the finished ones alone.
static void leave_out_unfinished(Accuracy *accuracy) {
    accuracy->plan.dem_count = accuracy->dems_finished;
    accuracy->run_count = accuracy->dems_finished * accuracy->plan.variant_count * accuracy->plan.tau_count;
}

Result accuracy_run(const AccuracyPlan *plan, Accuracy *out) {
    Context *context = NULL;
    int64_t begin = clock_now_ns();
    *out = (Accuracy){.plan = *plan, .worst = {.run = -1, .frame = -1}, .unix_s = (int64_t)time(NULL)};
    out->dems_planned = plan->dem_count;
    for (int i = 0; i < plan->flight_count; i++) // they lie in the plan
        out->plan.flights[i] = out->plan.flight_text + (plan->flights[i] - plan->flight_text);
    if (getloadavg(&out->load, 1) != 1)
        out->load = NAN;
    describe_system(out);
    open_context(out, &context);
    Result result = create_runs(out);
    if (result == RESULT_OK)
        result = describe_given(out);
    for (int dem = 0; dem < plan->dem_count && result == RESULT_OK && accuracy_goes_on(out); dem++)
        result = run_dem(out, dem, context);
    if (result == RESULT_OK)
        leave_out_unfinished(out);
    context_destroy(&context);
    out->wall_s = (double)(clock_now_ns() - begin) * 1e-9;
    if (result == RESULT_MEMORY)
        log_error("bench: not enough memory for %d runs", out->run_count);
    return result;
}

bool accuracy_is_interrupted(const Accuracy *accuracy) {
    return accuracy->dems_finished < accuracy->dems_planned;
}

void accuracy_clear(Accuracy *accuracy) {
    int of_dem = accuracy->plan.variant_count * accuracy->plan.tau_count;
    for (int i = 0; accuracy->runs && i < accuracy->dems_planned * of_dem; i++) {
        free(accuracy->runs[i].frames);
        free(accuracy->runs[i].frame_ms);
    }
    free(accuracy->runs);
    for (int i = 0; i < ACCURACY_DEMS_MAX; i++) {
        accuracy_unload(&accuracy->dems[i]);
        for (int k = 0; k < ACCURACY_FLIGHTS_MAX; k++)
            track_clear(&accuracy->dems[i].tracks[k]);
        free(accuracy->dems[i].poses);
    }
    preprocess_clear(&accuracy->scaling.preprocess);
    free(accuracy->worst.heat.rgb);
    free(accuracy->worst.picture.rgb);
    free(accuracy->given);
    *accuracy = (Accuracy){.runs = NULL};
}

// What `mesh` has to be told besides the view.
static void put_mesh_options(const Options *options, FILE *to) {
    static const OptionId told[] = {OPTION_METHOD,  OPTION_BOUND, OPTION_ERROR,  OPTION_SIZE,
                                    OPTION_FOV,     OPTION_EYE,   OPTION_LOOK,   OPTION_JSON,
                                    OPTION_THREADS, OPTION_QUIET, OPTION_VERBOSE};
    put_options(options, COMMAND_MESH, told, COUNT_OF(told), to);
}

static void put_command(const Accuracy *accuracy, const AccuracyRun *run, int frame, FILE *to) {
    const AccuracyPlan *plan = &accuracy->plan;
    const AccuracyVariant *variant = &plan->variants[run->variant];
    const Viewpoint *at = &accuracy->dems[run->dem].poses[frame].at;
    const char *place = plan->dems[run->dem];
    quote(options_program(plan->options), to);
    fputs(place ? " mesh " : " mesh", to);
    quote(place ? place : "", to);
    const char *bound = scene_bound_corner(plan->options)    ? " --bound corner"
                        : variant->bound == LOD_BOUND_CENTRE ? " --bound centre"
                                                             : "";
    fprintf(to, " --method %s%s --error %s --tau %.17g --size %dx%d --fov %.17g --eye %.9f,%.9f,%.3f --look %.6f,%.6f",
            lod_method_name(variant->method), bound, plan->kinds[variant->kind].name, run->tau_px, plan->width,
            plan->height, options_number(plan->options, OPTION_FOV), at->lat_deg, at->lon_deg, at->alt_m,
            at->heading_deg, at->pitch_deg);
    put_mesh_options(plan->options, to);
}

char *accuracy_command(const Accuracy *accuracy, const AccuracyRun *run, int frame) {
    char *text = NULL;
    size_t count;
    FILE *memory = open_memstream(&text, &count);
    if (!memory)
        return NULL;
    put_command(accuracy, run, frame, memory);
    if (fclose(memory) == 0)
        return text;
    free(text);
    return NULL;
}
