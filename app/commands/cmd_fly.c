#include "app/commands/command.h"
#include "app/flight/flight_loop.h"
#include "app/flight/flight_pipeline.h"
#include "app/flight/flight_report.h"
#include "app/picture_options.h"
#include "app/pipeline/picture.h"
#include "base/log.h"
#include "config/files.h"

#include <stdlib.h>

// Everything a flight needs, in the order of its making.
typedef struct Fly {
    const Options *options;
    bool window;
    Context *context;
    World world;
    FlightSession *session;
    Pipeline *pipeline;
    Monitor *monitor;
} Fly;

// Pictures that repeat must not depend on how long the one before took.
static Result check_target(const Options *options) {
    if (!options_is_set(options, OPTION_TARGET_MS) || !options_flag(options, OPTION_LOCKSTEP))
        return RESULT_OK;
    log_error(
        "--target-ms and --lockstep: expected one of them: a tolerance that follows the frame time would make the "
        "pictures depend on the clock; take --tau or --max-triangles with --lockstep");
    return RESULT_USAGE;
}

static Result check_outputs(const Options *options) {
    const char *screenshot = options_text(options, OPTION_SCREENSHOT),
               *pictures = options_text(options, OPTION_PICTURES);
    Result result = screenshot ? picture_check_name(screenshot, "--screenshot") : RESULT_OK;
    if (result == RESULT_OK && pictures)
        result = files_make_folder(pictures);
    return result == RESULT_OK && pictures ? files_check_folder(pictures) : result;
}

// Whether the flight ends by itself, so that it makes sense without a window.
static bool ends_by_itself(const Options *options) {
    return options_integer(options, OPTION_FRAMES) > 0 || options_flag(options, OPTION_DEMO);
}

static Result open_context(Fly *fly) {
    ContextOptions wanted = picture_context_options(fly->options);
    wanted.fullscreen = options_flag(fly->options, OPTION_FULLSCREEN);
    fly->window = options_flag(fly->options, OPTION_WINDOW);
    if (!fly->window)
        return context_create_offscreen(&wanted, &fly->context);
    Result result = context_create_window(&wanted, &fly->context);
    if (result == RESULT_OK)
        return result;
    log_info("For a window: run overfly in a desktop session, log in with 'ssh -X', or give it a virtual display:\n"
             "  xvfb-run -a -s '-screen 0 1280x800x24' overfly ...\n"
             "Without one: overfly fly --no-window --demo --pictures DIR");
    if (!ends_by_itself(fly->options))
        return result;
    log_warn("flying on without a window, as with --no-window, because this flight ends by itself");
    fly->window = false;
    return context_create_offscreen(&wanted, &fly->context);
}

static Result start_session(Fly *fly) {
    fly->session = calloc(1, sizeof *fly->session);
    if (!fly->session) {
        log_error("no memory for the flight");
        return RESULT_MEMORY;
    }
    return session_create(&fly->world, fly->options, fly->session);
}

static Result fly_loop(Fly *fly) {
    const Options *options = fly->options;
    const double *size = options_numbers(options, OPTION_SIZE);
    FlightLoop loop = {.session = fly->session,
                       .pipeline = fly->pipeline,
                       .monitor = fly->monitor,
                       .context = fly->context,
                       .window = fly->window,
                       .lockstep = options_flag(options, OPTION_LOCKSTEP),
                       .fps = options_number(options, OPTION_FPS),
                       .frames = options_integer(options, OPTION_FRAMES),
                       .screenshot = options_text(options, OPTION_SCREENSHOT),
                       .pictures = options_text(options, OPTION_PICTURES),
                       .picture_count = (int)options_integer(options, OPTION_PICTURE_COUNT),
                       .width = (int)size[0],
                       .height = (int)size[1]};
    return flight_loop_run(&loop);
}

static Result report(const Fly *fly) {
    FlightReport report = {.session = fly->session,
                           .stats = pipeline_stats(fly->pipeline),
                           .times = pipeline_times(fly->pipeline),
                           .accuracy = monitor_shown(fly->monitor),
                           .context = fly->context,
                           .window = fly->window};
    Result result = RESULT_OK;
    if (options_flag(fly->options, OPTION_JSON))
        result = flight_report_json(&report);
    else
        flight_report_log(&report);
    return result == RESULT_OK ? report.stats.picture_failure : result;
}

static Result prepare(Fly *fly) {
    Result result = check_target(fly->options);
    if (result == RESULT_OK)
        result = check_outputs(fly->options);
    if (result == RESULT_OK)
        result = world_check_inputs(fly->options);
    if (result == RESULT_OK)
        result = open_context(fly);
    if (result == RESULT_OK)
        result = world_load(fly->options, &fly->world);
    if (result == RESULT_OK)
        result = start_session(fly);
    if (result == RESULT_OK)
        result = flight_pipeline_create(fly->options, &fly->world, fly->session, fly->context, &fly->pipeline);
    const MonitorOptions monitor = {scene_lod_options(fly->options), fly->world.terrain, fly->pipeline};
    return result == RESULT_OK ? monitor_create(&monitor, &fly->monitor) : result;
}

Result cmd_fly(const Options *options) {
    Fly fly = {.options = options};
    Result result = prepare(&fly);
    if (result == RESULT_OK)
        result = fly_loop(&fly);
    if (result == RESULT_OK)
        result = report(&fly);
    monitor_destroy(&fly.monitor);
    pipeline_destroy(&fly.pipeline);
    free(fly.session);
    world_unload(&fly.world);
    context_destroy(&fly.context);
    return result;
}
