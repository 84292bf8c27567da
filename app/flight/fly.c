#include "app/flight/fly.h"

#include "app/demo/demo_list.h"
#include "app/flight/flight_loop.h"
#include "app/flight/flight_pipeline.h"
#include "app/flight/flight_report.h"
#include "app/flight/fly_outputs.h"
#include "app/picture_options.h"
#include "app/replay/replay_scene.h"
#include "app/track/track_options.h"
#include "base/log.h"

#include <stdlib.h>

// Everything a flight needs, in the order of its making.
typedef struct Fly {
    const Options *options;
    const char *track; // NULL: flown
    bool window;
    Context *context;
    World world;
    Playback *playback;
    FlightSession *session;
    Pilot *pilot;
    FlightRecorder *recorder;
    Telemetry *telemetry;
    Video *video;
    Pipeline *pipeline;
    Monitor *monitor;
} Fly;

// Whether the flight ends by itself, so that it makes sense without a window.
static bool ends_by_itself(const Fly *fly) {
    return options_integer(fly->options, OPTION_FRAMES) > 0 || options_flag(fly->options, OPTION_DEMO) ||
           options_command(fly->options) == COMMAND_DEMO || fly->track;
}

static Result open_context(Fly *fly) {
    ContextOptions wanted = picture_context_options(fly->options);
    wanted.fullscreen = options_flag(fly->options, OPTION_FULLSCREEN);
    // A film is drawn as fast as it can be, and none of its frames is of another size.
    fly->window = options_flag(fly->options, OPTION_WINDOW) && !options_text(fly->options, OPTION_VIDEO);
    if (!fly->window)
        return context_create_offscreen(&wanted, &fly->context);
    wanted.optional = ends_by_itself(fly);
    Result result = context_create_window(&wanted, &fly->context);
    if (result == RESULT_OK)
        return result;
    if (wanted.optional) {
        log_warn("flying on without a window, as with --no-window, because this flight ends by itself; --pictures DIR "
                 "keeps some of what it would show");
        fly->window = false;
        return context_create_offscreen(&wanted, &fly->context);
    }
    log_info("For a window: run overfly in a desktop session, log in with 'ssh -X', or give it a virtual display:\n"
             "  xvfb-run -a -s '-screen 0 1280x800x24' overfly ...\n"
             "Without one: overfly fly --no-window --demo --pictures DIR");
    return result;
}

// Before anything slow: whether the track can be read at all.
static Result check_track(const Fly *fly) {
    const TrackFormat *format = NULL;
    bool other = fly->track && !playback_is_recording(fly->track);
    Result result = other ? track_format_of_file(fly->track, &format) : RESULT_OK;
    if (result == RESULT_OK && fly->track)
        track_warn_of_unused(fly->options, fly->track, format);
    return result;
}

// Likewise what is known by a name, which may be mistyped. What is wrong in the files is found by who reads them.
static Result check_named(const Fly *fly) {
    const Options *options = fly->options;
    char path[PATHS_BYTES_MAX];
    Result result = RESULT_OK;
    if (options_command(options) == COMMAND_DEMO)
        result = demo_find(options_positionals(options)[0], path);
    if (result == RESULT_OK && options_is_given(options, OPTION_AIRCRAFT))
        result = aircraft_find(options_where(options, OPTION_AIRCRAFT), options_text(options, OPTION_AIRCRAFT), path);
    return result;
}

static Result start_replay(Fly *fly) {
    PlaybackOptions playback = {.how = track_reading_of(fly->options, fly->world.geoid),
                                .aircraft = replay_aircraft(fly->options),
                                .ground = fly->session->flight.ground,
                                .dem_hash = dem_hash(terrain_dem(fly->world.terrain))};
    Result result = playback_open(fly->track, &playback, &fly->playback);
    return result == RESULT_OK ? session_begin_replay(fly->session, fly->playback, fly->options) : result;
}

// Where nobody sees the flight, pads only disturb it, unless they are asked for.
static bool wants_joystick(const Fly *fly) {
    bool wanted = options_flag(fly->options, OPTION_JOYSTICK);
    return wanted && (fly->window || options_is_set(fly->options, OPTION_JOYSTICK));
}

static Result start_session(Fly *fly) {
    fly->session = calloc(1, sizeof *fly->session);
    if (!fly->session) {
        log_error("no memory for the flight");
        return RESULT_MEMORY;
    }
    Result result = session_create(&fly->world, fly->options, fly->session);
    if (result == RESULT_OK && wants_joystick(fly))
        result = pilot_create(&fly->pilot);
    fly->session->pilot = fly->pilot;
    if (result == RESULT_OK && fly->track)
        result = start_replay(fly);
    const RecordedFlight flown = {&fly->session->flight, fly->session->aircraft_name};
    if (result == RESULT_OK)
        result = recorder_create(&fly->world, fly->options, &flown, &fly->recorder);
    fly->session->recorder = fly->recorder;
    if (result == RESULT_OK && options_text(fly->options, OPTION_TELEMETRY))
        result = telemetry_create(options_text(fly->options, OPTION_TELEMETRY), &fly->telemetry);
    fly->session->telemetry = fly->telemetry;
    return result;
}

static Result start_video(Fly *fly) {
    const double *size = options_numbers(fly->options, OPTION_SIZE);
    const VideoOptions video = {.path = options_text(fly->options, OPTION_VIDEO),
                                .width = (int)size[0],
                                .height = (int)size[1],
                                .fps = (int)options_number(fly->options, OPTION_FPS)};
    return video.path ? video_create(&video, &fly->video) : RESULT_OK;
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
                       .every = options_is_set(options, OPTION_EVERY) ? options_integer(options, OPTION_EVERY) : 0,
                       .film = fly->video != NULL,
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
    Result result = fly_check_outputs(fly->options);
    if (result == RESULT_OK)
        result = check_track(fly);
    if (result == RESULT_OK)
        result = check_named(fly);
    if (result == RESULT_OK)
        result = fly->track ? replay_check_scene(fly->options, fly->track) : world_check_inputs(fly->options);
    if (result == RESULT_OK)
        result = open_context(fly);
    if (result == RESULT_OK)
        result = fly->track ? replay_load_scene(fly->options, fly->track, &fly->world)
                            : world_load(fly->options, &fly->world);
    if (result == RESULT_OK)
        result = start_session(fly);
    if (result == RESULT_OK)
        result = start_video(fly);
    if (result == RESULT_OK)
        result =
            flight_pipeline_create(fly->options, &fly->world, fly->session, fly->context, fly->video, &fly->pipeline);
    const MonitorOptions monitor = {scene_lod_options(fly->options), fly->world.terrain, fly->pipeline};
    return result == RESULT_OK ? monitor_create(&monitor, &fly->monitor) : result;
}

// The film's end is told after the last frame of it.
static Result end(Fly *fly) {
    monitor_destroy(&fly->monitor);
    pipeline_destroy(&fly->pipeline);
    Result result = video_end(&fly->video), recorded = recorder_close(&fly->recorder);
    if (fly->session)
        session_end(fly->session);
    free(fly->session);
    telemetry_destroy(&fly->telemetry);
    pilot_destroy(&fly->pilot);
    playback_close(&fly->playback);
    world_unload(&fly->world);
    context_destroy(&fly->context);
    return result != RESULT_OK ? result : recorded;
}

Result fly_run(const Options *options, const char *track) {
    Fly fly = {.options = options, .track = track};
    Result result = prepare(&fly);
    if (result == RESULT_OK)
        result = fly_loop(&fly);
    if (result == RESULT_OK)
        result = report(&fly);
    Result ended = end(&fly);
    return result != RESULT_OK ? result : ended;
}
