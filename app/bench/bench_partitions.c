// `overfly bench partitions`: roam against roam-parallel, both built anew, at a number of vertices: Biedermann, Rivara,
// table 1. Frame by frame in turn, so that a busy machine harms both alike. Nothing is drawn.
#include "app/bench/bench.h"
#include "app/reproduce/reproduce_race.h"
#include "app/scene_load.h"
#include "base/log.h"

#include <math.h>
#include <stdio.h>

#define FRAME_HZ 60.0
#define DEFAULT_SPEED_M_S 100.0
#define DEFAULT_FRAMES 200
#define WARM_UP_FRAMES 5 // pages are made, and work is predicted from the frame before
#define TURN_RAD_S 0.5   // the head's: the observer line passes over all squares
#define TAU_STEPS 30
#define CLOSE_SHARE 0.01 // of the vertices asked for

enum { SERIAL, PARALLEL };

typedef struct Bench {
    const Options *options;
    World world;
    Jobs *one;
    LodView start;
    Race race;
    double cut_vertices, worst_balance;
} Bench;

static LodOptions lod_options(const Bench *bench, LodMethod method) {
    LodOptions options = scene_lod_options(bench->options);
    options.method = method;
    options.reuse = false;
    return options;
}

// Straight on over the ground's curve, the head turning.
static LodView view_of_frame(const Bench *bench, int frame) {
    LodView view = bench->start;
    double speed =
        options_is_set(bench->options, OPTION_SPEED) ? options_number(bench->options, OPTION_SPEED) : DEFAULT_SPEED_M_S;
    double radius = vec3d_length(view.eye_ecef), seconds = frame / FRAME_HZ, angle = TURN_RAD_S * seconds;
    Vec3d up = vec3d_normalize(view.eye_ecef), right = vec3d_normalize(vec3d_cross(view.forward_ecef, up));
    Vec3d ahead = vec3d_cross(up, right);
    view.eye_ecef = vec3d_scale(vec3d_normalize(vec3d_mad(view.eye_ecef, ahead, speed * seconds)), radius);
    view.forward_ecef = vec3d_add(vec3d_scale(ahead, cos(angle)), vec3d_scale(right, sin(angle)));
    return view;
}

static bool is_sought(const Bench *bench) {
    return !options_is_set(bench->options, OPTION_BENCH_TAU);
}

static bool is_close(double found, double asked) {
    return fabs(found - asked) <= CLOSE_SHARE * asked;
}

// Fewer than every view needs, more than there are samples or the triangle budget allows, or a step between.
static void warn_if_far(const Bench *bench, double found, double asked) {
    if (!is_close(found, asked))
        log_warn("bench: %.0f vertices were asked for, tau %.4g px comes to %.0f, and no tau tried to within %g %%: "
                 "give another --vertices, or --tau",
                 asked, bench->start.tau_px, found, 100.0 * CLOSE_SHARE);
}

// The tolerance at which roam draws so many vertices from the start; one as near as the search came where none does.
static Result find_tau(Bench *bench, double vertices) {
    Race race;
    LodOptions options = lod_options(bench, LOD_ROAM);
    double low = log(1e-3), high = log(1e3), found = 0.0, ms;
    race_begin(bench->world.terrain, 1, &race);
    Result result = race_enter(&race, &options, bench->one);
    for (int i = 0; i < TAU_STEPS && result == RESULT_OK && !is_close(found, vertices); i++) {
        bench->start.tau_px = exp(0.5 * (low + high));
        result = racer_refine(&race.racers[0], &bench->start, &ms);
        found = (double)race.racers[0].cut.stats.vertices;
        *(found > vertices ? &low : &high) = 0.5 * (low + high);
    }
    race_end(&race);
    if (result == RESULT_OK)
        warn_if_far(bench, found, vertices);
    return result;
}

static Result prepare(Bench *bench, int frames) {
    Viewpoint start;
    Result result = world_viewpoint(&bench->world, bench->options, &start);
    if (result != RESULT_OK)
        return result;
    bench->start = world_lod_view(&bench->world, bench->options, &start);
    result = bench_tau(bench->options, &bench->start.tau_px);
    if (result == RESULT_OK)
        result = jobs_create(1, &bench->one);
    if (result == RESULT_OK && is_sought(bench))
        result = find_tau(bench, (double)options_integer(bench->options, OPTION_VERTICES));
    race_begin(bench->world.terrain, frames, &bench->race);
    LodOptions serial = lod_options(bench, LOD_ROAM), parallel = lod_options(bench, LOD_ROAM_PARALLEL);
    if (result == RESULT_OK)
        result = race_enter(&bench->race, &serial, bench->one);
    if (result == RESULT_OK)
        result = race_enter(&bench->race, &parallel, bench->world.jobs);
    return result;
}

static Result race(Bench *bench, int frames) {
    Progress progress = progress_begin("partitions");
    Result result = RESULT_OK;
    for (int frame = 0; frame < frames + WARM_UP_FRAMES && result == RESULT_OK; frame++) {
        LodView view = view_of_frame(bench, frame);
        result = race_step(&bench->race, &view, frame >= WARM_UP_FRAMES);
        if (frame >= WARM_UP_FRAMES)
            bench->worst_balance = fmax(bench->worst_balance, bench->race.racers[PARALLEL].cut.stats.balance);
        progress_update(&progress, (double)frame / frames);
    }
    progress_end(&progress);
    return result;
}

// ---- what came of it ----

static double mean_of(const Bench *bench, int racer, double sum) {
    return race_mean(&bench->race, racer, sum);
}

static double surplus_share(const Bench *bench) {
    const Racer *r = bench->race.racers;
    return (r[PARALLEL].triangles - r[SERIAL].triangles) / r[SERIAL].triangles;
}

static void add_racer(Json *parent, const Bench *bench, int racer, const char *name) {
    RaceTimes times = race_times(&bench->race, racer);
    const Racer *r = &bench->race.racers[racer];
    Json *object = json_add_object(parent, name);
    json_add_number(object, "triangles_mean", mean_of(bench, racer, r->triangles));
    json_add_number(object, "vertices_mean", mean_of(bench, racer, r->vertices));
    json_add_number(object, "update_ms_p50", times.p50_ms);
    json_add_number(object, "update_ms_p99", times.p99_ms);
    json_add_number(object, "ns_per_triangle", 1e6 * times.p50_ms / mean_of(bench, racer, r->triangles));
}

static Result print_json(const Bench *bench) {
    const Racer *parallel = &bench->race.racers[PARALLEL];
    Json *json = json_create();
    bench_add_machine(json);
    json_add_text(json, "dem", terrain_dem(bench->world.terrain)->file);
    json_add_number(json, "tau_px", bench->start.tau_px);
    if (is_sought(bench))
        json_add_integer(json, "vertices_asked", options_integer(bench->options, OPTION_VERTICES));
    json_add_integer(json, "frames", parallel->frames);
    json_add_integer(json, "threads", jobs_worker_count(bench->world.jobs));
    json_add_integer(json, "partitions", parallel->cut.stats.partitions);
    add_racer(json, bench, SERIAL, "roam");
    add_racer(json, bench, PARALLEL, "roam_parallel");
    json_add_number(json, "speedup_p50", race_ratio(&bench->race, SERIAL, PARALLEL));
    json_add_number(json, "surplus_share", surplus_share(bench));
    json_add_number(json, "balance_mean", mean_of(bench, PARALLEL, parallel->balance));
    json_add_number(json, "balance_worst", bench->worst_balance);
    json_add_number(json, "cut_vertices_mean", mean_of(bench, PARALLEL, parallel->cut_vertices));
    Result result = json_print(json);
    json_destroy(&json);
    return result;
}

static void print_text(const Bench *bench) {
    const Racer *serial = &bench->race.racers[SERIAL], *parallel = &bench->race.racers[PARALLEL];
    RaceTimes slow = race_times(&bench->race, SERIAL), fast = race_times(&bench->race, PARALLEL);
    printf("tau %.3g px, %d frames, %d threads, %d partitions\n", bench->start.tau_px, parallel->frames,
           jobs_worker_count(bench->world.jobs), parallel->cut.stats.partitions);
    printf("vertices         %.0f, triangles %.0f; %.0f vertices on the cut\n",
           mean_of(bench, SERIAL, serial->vertices), mean_of(bench, SERIAL, serial->triangles),
           mean_of(bench, PARALLEL, parallel->cut_vertices));
    printf("roam             p50 %.2f ms, p99 %.2f ms, %.1f ns a triangle\n", slow.p50_ms, slow.p99_ms,
           1e6 * slow.p50_ms / mean_of(bench, SERIAL, serial->triangles));
    printf("roam-parallel    p50 %.2f ms, p99 %.2f ms: %.2f times as fast\n", fast.p50_ms, fast.p99_ms,
           race_ratio(&bench->race, SERIAL, PARALLEL));
    printf("balance          %.3f, at worst %.3f: the longest partition's time over their mean\n",
           mean_of(bench, PARALLEL, parallel->balance), bench->worst_balance);
    printf("surplus          %.3f %% of the triangles\n", 100.0 * surplus_share(bench));
}

Result bench_partitions(const Options *options) {
    Bench bench = {.options = options};
    int frames = (int)options_integer(options, OPTION_FRAMES);
    frames = frames ? frames : DEFAULT_FRAMES;
    Result result = world_load(options, &bench.world);
    if (result == RESULT_OK)
        result = prepare(&bench, frames);
    if (result == RESULT_OK)
        result = race(&bench, frames);
    if (result == RESULT_OK && options_flag(options, OPTION_JSON))
        result = print_json(&bench);
    else if (result == RESULT_OK)
        print_text(&bench);
    race_end(&bench.race);
    if (bench.one)
        jobs_destroy(&bench.one);
    world_unload(&bench.world);
    return result;
}
