// `overfly bench governor`: how well the governor holds a frame time: on the built-in ridge flight, and on a view that
// stands still. Drawn by the threaded pipeline, as `overfly fly --no-window --target-ms` draws.
#define _DEFAULT_SOURCE // getloadavg
#include "app/bench/bench.h"
#include "app/flight/flight_pipeline.h"
#include "app/flight/flight_session.h"
#include "app/picture_options.h"
#include "app/scene_load.h"
#include "app/track/track.h"
#include "base/log.h"
#include "base/statistics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define FRAME_S (1.0 / 60.0) // of the flight, whatever a frame takes
#define FRAMES_DEFAULT 1200
#define TRACK_SPEED_M_S 100.0 // of the built-in flights
#define FIND_S 2.0            // until then a tolerance is being found, and frames do not count
#define PICK_FRAMES 120       // at PICK_TAU_PX, to find a target that can be reached; the last half counts
#define PICK_TAU_PX 1.0
#define PICK_START_PX 4.0 // where the governor then begins
#define ON_THEIR_WAY 4    // frames between the order and the picture, at most
#define WITHIN (GOVERNOR_PROMISE - 1.0)

// One flight: what is flown, what came of it.
typedef struct Part {
    const char *name;
    const Track *track; // NULL: the eye stays at `eye`
    Viewpoint eye;
    double pace; // times the track's own speed
    double target_ms, tau_px;
    int frames;

    double *frame_ms, *tau_of; // [count], of the frames that count
    int count;
    int64_t seen, in_reach, changes, reversals, triangles;
    double passed_s, settle_s;   // NAN: it did not settle
    double drawn_px, reached_px; // of the last frame: tolerance; error kept, which a triangle budget decides as well
    double rest_s;               // since when both are that
    int64_t steady_from;         // the first frame that was asked for after it settled; 0: it did not
    int64_t changes_drawn;       // of the tolerance, in the frames from there on
    double last_tau, direction;
    Governor governor; // at the end
} Part;

typedef struct Bench {
    const Options *options;
    Context *context;
    World world;
    Track ridge;
    Viewpoint still;
    double start_px;
    double target_ms;
    bool picked;
    double load; // average of the minute before: others' work is in the times
    char renderer[160];
    bool software;
} Bench;

static Result part_begin(Part *part) {
    part->frame_ms = calloc((size_t)part->frames, sizeof *part->frame_ms);
    part->tau_of = calloc((size_t)part->frames, sizeof *part->tau_of);
    part->settle_s = NAN;
    part->last_tau = part->tau_px;
    if (part->frame_ms && part->tau_of)
        return RESULT_OK;
    log_error("no memory for the times of %d frames", part->frames);
    return RESULT_MEMORY;
}

static void part_end(Part *part) {
    free(part->frame_ms);
    free(part->tau_of);
}

static void count_tolerance(Part *part, const Governor *governor) {
    double step = governor->tau_px - part->last_tau;
    if (step != 0.0) {
        part->reversals += step * part->direction < 0.0;
        part->direction = step;
        part->last_tau = governor->tau_px;
    }
    if (governor->settled && isnan(part->settle_s)) {
        part->settle_s = part->passed_s;
        part->steady_from = part->seen + ON_THEIR_WAY;
    }
}

// What was drawn, whatever the governor says of itself.
static void watch_rest(Part *part, const PipelineFrame *frame) {
    bool other = frame->tau_px != part->drawn_px;
    if (other || frame->reached_px != part->reached_px)
        part->rest_s = part->passed_s;
    part->changes_drawn += other && part->steady_from > 0 && part->seen > part->steady_from;
    part->drawn_px = frame->tau_px;
    part->reached_px = frame->reached_px;
}

static bool counts(const Part *part) {
    if (!(part->target_ms > 0.0))
        return part->seen >= PICK_FRAMES / 2;
    return part->passed_s > FIND_S && (part->track || !isnan(part->settle_s));
}

// The frames that were drawn since the last call.
static void collect(Part *part, const PipelineStats *stats, const Governor *governor) {
    if (part->seen < stats->frames - PIPELINE_FRAMES_KEPT)
        part->seen = stats->frames - PIPELINE_FRAMES_KEPT;
    for (; part->seen < stats->frames; part->seen++) {
        const PipelineFrame *frame = &stats->latest[part->seen % PIPELINE_FRAMES_KEPT];
        part->passed_s += frame->frame_ms * 1e-3;
        watch_rest(part, frame);
        if (!counts(part) || part->count == part->frames)
            continue;
        part->frame_ms[part->count] = frame->frame_ms;
        part->tau_of[part->count++] = frame->tau_px;
        part->in_reach += governor->reach == GOVERNOR_IN_REACH;
        part->triangles += frame->triangles;
    }
    count_tolerance(part, governor);
}

// The session's own picture and display, seen from elsewhere.
static void look_from(const World *world, const Viewpoint *at, FrameOrder *order) {
    order->look.camera.eye_ecef = order->view.eye_ecef = world_viewpoint_ecef(world, at);
    order->look.camera.camera_from_ecef = viewpoint_camera(at);
    order->view.forward_ecef = viewpoint_forward(at);
}

static Viewpoint viewpoint_at(const Part *part, int frame) {
    return part->track ? track_at(part->track, frame * FRAME_S * part->pace) : part->eye;
}

static Result fly_frames(const Bench *bench, Part *part, FlightSession *session, Pipeline *pipeline) {
    const double *size = options_numbers(bench->options, OPTION_SIZE);
    Progress progress = progress_begin(part->name);
    Result result = RESULT_OK;
    for (int i = 0; i < part->frames && result == RESULT_OK; i++) {
        PipelineStats stats = pipeline_stats(pipeline);
        FrameOrder order;
        Viewpoint at = viewpoint_at(part, i);
        session_govern(session, &stats);
        collect(part, &stats, &session->governor);
        session_order(session, (int)size[0], (int)size[1], stats.frame_ms, stats.frame_p99_ms, &order);
        look_from(&bench->world, &at, &order);
        result = pipeline_submit(pipeline, &order, true);
        progress_update(&progress, (double)i / part->frames);
    }
    if (result == RESULT_OK)
        result = pipeline_drain(pipeline);
    progress_end(&progress);
    if (result == RESULT_OK) {
        PipelineStats stats = pipeline_stats(pipeline);
        session_govern(session, &stats);
        collect(part, &stats, &session->governor);
    }
    return result;
}

static Result fly_part(const Bench *bench, Part *part) {
    FlightSession *session = calloc(1, sizeof *session);
    Pipeline *pipeline = NULL;
    Result result = session ? part_begin(part) : RESULT_MEMORY;
    if (result == RESULT_OK)
        result = session_create(&bench->world, bench->options, session);
    if (result == RESULT_OK) {
        session->settings.target_ms = part->target_ms;
        session->settings.tau_px = part->tau_px;
        session->governor = governor_create(part->target_ms, part->tau_px);
        result = flight_pipeline_create(bench->options, &bench->world, session, bench->context, NULL, &pipeline);
    }
    if (result == RESULT_OK)
        result = fly_frames(bench, part, session, pipeline);
    if (result == RESULT_OK)
        part->governor = session->governor;
    pipeline_destroy(&pipeline);
    free(session);
    return result;
}

// A target that can be reached: what 95 of 100 frames take at 1 px, on the ridge.
static Result pick_target(Bench *bench) {
    Part part = {.name = "pick", .track = &bench->ridge, .pace = 1.0, .tau_px = PICK_TAU_PX, .frames = PICK_FRAMES};
    Result result = fly_part(bench, &part);
    if (result == RESULT_OK) {
        statistics_sort(part.frame_ms, part.count);
        bench->target_ms = statistics_percentile(part.frame_ms, part.count, 0.95);
        bench->picked = true;
        log_info("target %.1f ms: what 95 of 100 frames take at %g px on the ridge", bench->target_ms, PICK_TAU_PX);
    }
    part_end(&part);
    return result;
}

static Result prepare(Bench *bench) {
    ContextOptions wanted = picture_context_options(bench->options);
    Result result = bench_tau(bench->options, &bench->start_px);
    if (result == RESULT_OK)
        result = context_create_offscreen(&wanted, &bench->context);
    if (result == RESULT_OK)
        result = world_load(bench->options, &bench->world);
    if (result == RESULT_OK)
        result = world_viewpoint(&bench->world, bench->options, &bench->still);
    if (result == RESULT_OK)
        result = track_builtin(&bench->world, TRACK_RIDGE, &bench->ridge);
    if (result != RESULT_OK)
        return result;
    if (options_is_set(bench->options, OPTION_TARGET_MS)) {
        bench->target_ms = options_number(bench->options, OPTION_TARGET_MS);
        return RESULT_OK;
    }
    if (!options_is_set(bench->options, OPTION_BENCH_TAU))
        bench->start_px = PICK_START_PX;
    return pick_target(bench);
}

// ---- what came of it ----

static double p95_over_target(Part *part) {
    statistics_sort(part->frame_ms, part->count);
    return part->count ? statistics_percentile(part->frame_ms, part->count, 0.95) / part->target_ms : NAN;
}

static void add_times(Json *json, Part *part) {
    Json *times = json_add_object(json, "frame_ms");
    statistics_sort(part->frame_ms, part->count);
    json_add_number(times, "p50", statistics_percentile(part->frame_ms, part->count, 0.5));
    json_add_number(times, "p95", statistics_percentile(part->frame_ms, part->count, 0.95));
    json_add_number(times, "p99", statistics_percentile(part->frame_ms, part->count, 0.99));
    json_add_number(times, "max", statistics_percentile(part->frame_ms, part->count, 1.0));
}

static void add_tolerances(Json *json, Part *part) {
    Json *tau = json_add_object(json, "tau_px");
    statistics_sort(part->tau_of, part->count);
    json_add_number(tau, "min", part->count ? part->tau_of[0] : NAN);
    json_add_number(tau, "median", statistics_percentile(part->tau_of, part->count, 0.5));
    json_add_number(tau, "max", statistics_percentile(part->tau_of, part->count, 1.0));
}

static double share_in_reach(const Part *part) {
    return part->count ? (double)part->in_reach / part->count : 0.0;
}

static bool is_within(Part *part) {
    return fabs(p95_over_target(part) - 1.0) <= WITHIN;
}

static bool is_late(Part *part) {
    return p95_over_target(part) > 1.0 + WITHIN;
}

// Frames that do not hold the target are not called in reach, whatever the governor says of itself.
static bool is_met(Part *part) {
    return share_in_reach(part) >= 0.95 && !is_late(part);
}

// What stands in the way: the limits of the tolerance, or time that was too short or frames that changed.
static const char *name_outcome(Part *part) {
    if (is_met(part))
        return "in reach";
    // On the way it may have been out of reach, too quick at the finest tolerance as well as too slow at the coarsest.
    return is_late(part) && !governor_is_out_of_reach(part->governor.reach) ? "NOT MET" : "OUT OF REACH";
}

static void add_part(Json *json, Part *part) {
    Json *object = json_add_object(json, part->name);
    json_add_number(object, "target_ms", part->target_ms);
    json_add_integer(object, "frames", part->frames);
    json_add_integer(object, "frames_counted", part->count);
    add_times(object, part);
    json_add_number(object, "p95_over_target", p95_over_target(part));
    json_add_bool(object, "within_15_percent", is_within(part));
    json_add_bool(object, "reachable", is_met(part));
    json_add_text(object, "reach", governor_reach_name(part->governor.reach));
    json_add_number(object, "in_reach_share", share_in_reach(part));
    add_tolerances(object, part);
    json_add_number(object, "triangles_mean", part->count ? (double)part->triangles / part->count : NAN);
    json_add_integer(object, "changes", part->governor.changes);
    json_add_integer(object, "reversals", part->reversals);
    if (part->track)
        return;
    json_add_bool(object, "settled", part->governor.settled);
    json_add_number(object, "settle_s", part->settle_s);
    json_add_integer(object, "changes_settled", part->changes_drawn);
    json_add_number(object, "reached_px", part->reached_px);
    json_add_number(object, "rest_s", part->rest_s);
}

static Result print_json(const Bench *bench, Part *ridge, Part *still) {
    Json *json = json_create();
    bench_add_machine(json);
    json_add_text(json, "dem", terrain_dem(bench->world.terrain)->file);
    json_add_text(json, "method", options_text(bench->options, OPTION_METHOD));
    json_add_text(json, "renderer", bench->renderer);
    json_add_bool(json, "software", bench->software);
    json_add_number(json, "load", bench->load);
    json_add_number(json, "target_ms", bench->target_ms);
    json_add_bool(json, "target_picked", bench->picked);
    json_add_number(json, "start_tau_px", bench->start_px);
    json_add_number(json, "ridge_s", track_duration_s(&bench->ridge));
    add_part(json, ridge);
    add_part(json, still);
    Result result = json_print(json);
    json_destroy(&json);
    return result;
}

static void print_part(Part *part) {
    double over = p95_over_target(part);
    statistics_sort(part->tau_of, part->count);
    printf("%-6s p95 %.1f ms, %.2f of the target%s; tau %.2f .. %.2f px, median %.2f; %s", part->name,
           over * part->target_ms, over, is_within(part) ? "" : " (NOT WITHIN 15 %)",
           statistics_percentile(part->tau_of, part->count, 0.0), statistics_percentile(part->tau_of, part->count, 1.0),
           statistics_percentile(part->tau_of, part->count, 0.5), name_outcome(part));
    if (part->track)
        printf("\n");
    else
        printf("; settled after %.2f s, %lld changes since\n", part->settle_s, (long long)part->changes_drawn);
}

static Result report(const Bench *bench, Part *ridge, Part *still) {
    if (options_flag(bench->options, OPTION_JSON))
        return print_json(bench, ridge, still);
    printf("target %.1f ms%s, from %g px, %s, %s\n", bench->target_ms, bench->picked ? " (picked)" : "",
           bench->start_px, options_text(bench->options, OPTION_METHOD), bench->renderer);
    print_part(ridge);
    print_part(still);
    return RESULT_OK;
}

static Part part_of(const Bench *bench, const char *name, const Track *track) {
    const Options *options = bench->options;
    int frames = (int)options_integer(options, OPTION_FRAMES);
    double speed = options_is_set(options, OPTION_SPEED) ? options_number(options, OPTION_SPEED) : TRACK_SPEED_M_S;
    return (Part){.name = name,
                  .track = track,
                  .eye = bench->still,
                  .pace = speed / TRACK_SPEED_M_S,
                  .target_ms = bench->target_ms,
                  .tau_px = bench->start_px,
                  .frames = frames > 0 ? frames : FRAMES_DEFAULT};
}

static Result measure(const Bench *bench) {
    Part ridge = part_of(bench, "ridge", &bench->ridge), still = part_of(bench, "fixed", NULL);
    Result result = fly_part(bench, &ridge);
    if (result == RESULT_OK)
        result = fly_part(bench, &still);
    if (result == RESULT_OK)
        result = report(bench, &ridge, &still);
    part_end(&ridge);
    part_end(&still);
    return result;
}

Result bench_governor(const Options *options) {
    Bench bench = {.options = options};
    if (getloadavg(&bench.load, 1) != 1)
        bench.load = NAN;
    Result result = prepare(&bench);
    if (result == RESULT_OK) {
        snprintf(bench.renderer, sizeof bench.renderer, "%s", context_renderer_name(bench.context));
        bench.software = context_is_software(bench.context);
        result = measure(&bench);
    }
    track_clear(&bench.ridge);
    world_unload(&bench.world);
    context_destroy(&bench.context);
    return result;
}
