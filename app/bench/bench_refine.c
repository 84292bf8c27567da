// `overfly bench refine`: what one frame's refinement costs along a straight flight, and whether what is kept from
// frame to frame equals a refinement from scratch. Nothing is drawn.
#include "app/bench/bench.h"
#include "app/scene_load.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/statistics.h"
#include "terrain/geodesy.h"
#include "terrain/lod/lod.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FRAME_HZ 60.0
#define DEFAULT_SPEED_M_S 100.0
#define FRAME_BLOCK_BYTES (1 << 20)
#define WARM_UP_FRAMES 10   // pages of the first frames are made once, and loading is not what is measured
#define FULL_EVERY 20       // frames between comparisons with a refinement from scratch
#define CLEARANCE_SHARE 0.5 // the flight climbs over ground that comes closer than this share of the height

typedef struct Flight {
    const World *world;
    Viewpoint at; // alt_m: metres above the ellipsoid here
    double height_m, speed_m_s;
} Flight;

typedef struct Totals {
    double triangles, vertices, patches, reused, rebuilt, evaluated, index_bytes;
    int frames;
} Totals;

typedef struct Bench {
    const Options *options;
    double tau_px;
    World world;
    Flight flight;
    Lod *lod, *full;
    Arena *frame, *full_frame;
    Totals totals;
    double *update_ms, *full_ns;
    int frames, full_count;
    bool equal, promised;
    double load_ms;
    int64_t resident_bytes; // once loaded
    double reached_px;
} Bench;

static double ground_at(const Flight *flight, double lat_deg, double lon_deg, double otherwise) {
    double h;
    return terrain_ground_m(flight->world->terrain, lat_deg, lon_deg, &h) ? h : otherwise;
}

static void flight_begin(Flight *flight, const World *world, const Viewpoint *from, const Options *options) {
    *flight = (Flight){.world = world, .at = *from, .height_m = options_number(options, OPTION_HEIGHT)};
    flight->speed_m_s =
        options_is_set(options, OPTION_SPEED) ? options_number(options, OPTION_SPEED) : DEFAULT_SPEED_M_S;
    double above = world_ellipsoid_m(world, from->lat_deg, from->lon_deg, from->alt_m);
    flight->at.alt_m = ground_at(flight, from->lat_deg, from->lon_deg, above) + flight->height_m;
}

// Straight on; back the way it came where the DEM ends.
static void flight_step(Flight *flight, double seconds) {
    Viewpoint *at = &flight->at;
    double heading = at->heading_deg * GEODESY_RAD_PER_DEG, metres = flight->speed_m_s * seconds;
    double lat = at->lat_deg + metres * cos(heading) / GEODESY_A_M / GEODESY_RAD_PER_DEG;
    double lon = at->lon_deg +
                 metres * sin(heading) / (GEODESY_A_M * cos(at->lat_deg * GEODESY_RAD_PER_DEG)) / GEODESY_RAD_PER_DEG;
    double ground;
    if (!terrain_ground_m(flight->world->terrain, lat, lon, &ground)) {
        at->heading_deg = fmod(at->heading_deg + 180.0, 360.0);
        return;
    }
    at->lat_deg = lat;
    at->lon_deg = lon;
    at->alt_m = fmax(at->alt_m, ground + CLEARANCE_SHARE * flight->height_m);
}

static LodView flight_view(const Flight *flight, const Options *options, double tau_px) {
    Geodetic eye = {flight->at.lat_deg * GEODESY_RAD_PER_DEG, flight->at.lon_deg * GEODESY_RAD_PER_DEG,
                    flight->at.alt_m};
    return (LodView){.eye_ecef = geodesy_to_ecef(eye),
                     .forward_ecef = viewpoint_forward(&flight->at),
                     .px_per_rad = scene_px_per_rad(options),
                     .tau_px = tau_px};
}

static bool same_item(const LodItem *a, const LodItem *b) {
    return a->index_count == b->index_count && a->page->vertex_count == b->page->vertex_count &&
           a->page->col0 == b->page->col0 && a->page->row0 == b->page->row0 &&
           memcmp(a->indices, b->indices, sizeof *a->indices * (size_t)a->index_count) == 0 &&
           memcmp(a->page->vertices, b->page->vertices, sizeof *a->page->vertices * (size_t)a->page->vertex_count) == 0;
}

static bool same_cut(const LodCut *a, const LodCut *b) {
    if (a->item_count != b->item_count)
        return false;
    for (int32_t i = 0; i < a->item_count; i++)
        if (!same_item(&a->items[i], &b->items[i]))
            return false;
    return true;
}

// A refinement from scratch of the same view, twice: the first makes the pages that are missing, the second is timed.
static Result compare_with_full(Bench *bench, const LodView *view, const LodCut *cut) {
    LodCut full;
    Result result = RESULT_OK;
    int64_t begin = 0;
    for (int pass = 0; pass < 2 && (result == RESULT_OK || result == RESULT_BUDGET); pass++) {
        arena_reset(bench->full_frame);
        begin = clock_now_ns();
        result = lod_update(bench->full, view, bench->world.jobs, bench->full_frame, &full);
        if (pass == 0 && (result == RESULT_OK || result == RESULT_BUDGET))
            lod_release(bench->full, full.frame);
    }
    if (result != RESULT_OK && result != RESULT_BUDGET)
        return result;
    bench->full_ns[bench->full_count++] = (double)(clock_now_ns() - begin) / (double)full.stats.triangles;
    bench->equal = bench->equal && same_cut(cut, &full);
    lod_release(bench->full, full.frame);
    return RESULT_OK;
}

static void add_frame(Totals *totals, const LodStats *stats) {
    totals->frames++;
    totals->triangles += (double)stats->triangles;
    totals->vertices += (double)stats->vertices;
    totals->patches += (double)stats->patches;
    totals->reused += (double)stats->patches_reused / (double)stats->patches;
    totals->rebuilt += (double)stats->triangles_rebuilt / (double)stats->triangles;
    totals->evaluated += (double)stats->vertices_evaluated / (double)stats->vertices;
    totals->index_bytes += (double)stats->index_bytes;
}

static Result fly_frame(Bench *bench, int frame) {
    LodView view = flight_view(&bench->flight, bench->options, bench->tau_px);
    LodCut cut;
    arena_reset(bench->frame);
    int64_t begin = clock_now_ns();
    Result result = lod_update(bench->lod, &view, bench->world.jobs, bench->frame, &cut);
    double ms = (double)(clock_now_ns() - begin) * 1e-6;
    if (result != RESULT_OK && result != RESULT_BUDGET)
        return result;
    bench->reached_px = fmax(bench->reached_px, cut.reached_px);
    bench->promised = cut.promises;
    result = RESULT_OK;
    if (frame >= WARM_UP_FRAMES) {
        bench->update_ms[bench->totals.frames] = ms;
        add_frame(&bench->totals, &cut.stats);
        if ((frame - WARM_UP_FRAMES) % FULL_EVERY == 0)
            result = compare_with_full(bench, &view, &cut);
    }
    lod_release(bench->lod, cut.frame);
    flight_step(&bench->flight, 1.0 / FRAME_HZ);
    return result;
}

static Result prepare(Bench *bench) {
    LodOptions options = scene_lod_options(bench->options);
    Viewpoint start;
    Result result = world_viewpoint(&bench->world, bench->options, &start);
    if (result != RESULT_OK)
        return result;
    flight_begin(&bench->flight, &bench->world, &start, bench->options);
    bench->update_ms = calloc((size_t)bench->frames, sizeof *bench->update_ms);
    bench->full_ns = calloc((size_t)(bench->frames / FULL_EVERY + 1), sizeof *bench->full_ns);
    if (!bench->update_ms || !bench->full_ns)
        return RESULT_MEMORY;
    result = arena_create(FRAME_BLOCK_BYTES, &bench->frame);
    if (result == RESULT_OK)
        result = arena_create(FRAME_BLOCK_BYTES, &bench->full_frame);
    if (result == RESULT_OK)
        result = lod_create(&options, bench->world.terrain, &bench->lod);
    options.reuse = false;
    return result == RESULT_OK ? lod_create(&options, bench->world.terrain, &bench->full) : result;
}

static Result fly(Bench *bench) {
    Progress progress = progress_begin("refine");
    Result result = RESULT_OK;
    for (int frame = 0; frame < bench->frames + WARM_UP_FRAMES && result == RESULT_OK; frame++) {
        result = fly_frame(bench, frame);
        progress_update(&progress, (double)frame / bench->frames);
    }
    progress_end(&progress);
    return result;
}

static double samples(const Bench *bench) {
    const Dem *dem = terrain_dem(bench->world.terrain);
    return (double)dem->width * dem->height;
}

static Result print_json(Bench *bench) {
    const Totals *t = &bench->totals;
    double n = t->frames;
    Json *json = json_create();
    bench_add_machine(json);
    json_add_text(json, "dem", terrain_dem(bench->world.terrain)->file);
    json_add_text(json, "method", options_text(bench->options, OPTION_METHOD));
    json_add_text(json, "error", options_text(bench->options, OPTION_ERROR));
    json_add_number(json, "tau_px", bench->tau_px);
    json_add_number(json, "reached_px", bench->reached_px);
    json_add_bool(json, "promised", bench->promised);
    json_add_integer(json, "threads", jobs_worker_count(bench->world.jobs));
    json_add_integer(json, "frames", t->frames);
    json_add_number(json, "triangles_mean", t->triangles / n);
    json_add_number(json, "vertices_mean", t->vertices / n);
    json_add_number(json, "patches_mean", t->patches / n);
    json_add_number(json, "patches_reused_share", t->reused / n);
    json_add_number(json, "triangles_rebuilt_share", t->rebuilt / n);
    json_add_number(json, "vertices_evaluated_share", t->evaluated / n);
    json_add_number(json, "load_ms", bench->load_ms);
    json_add_number(json, "bytes_per_sample", (double)terrain_sample_bytes(bench->world.terrain) / samples(bench));
    json_add_number(json, "resident_bytes_per_sample", (double)bench->resident_bytes / samples(bench));
    bench_add_percentiles(json, "update_ms", bench->update_ms, t->frames);
    json_add_number(json, "full_ns_per_triangle", statistics_percentile(bench->full_ns, bench->full_count, 0.5));
    json_add_number(json, "index_bytes_per_frame", t->index_bytes / n);
    json_add_bool(json, "equal_to_full", bench->equal);
    Result result = json_print(json);
    json_destroy(&json);
    return result;
}

static void print_text(Bench *bench) {
    const Totals *t = &bench->totals;
    double n = t->frames, *ms = bench->update_ms;
    statistics_sort(ms, t->frames);
    printf("%s, tau %g px (%g %s), %d frames at %g m/s, %d threads\n", options_text(bench->options, OPTION_METHOD),
           bench->tau_px, bench->reached_px, bench->promised ? "held" : "asked for, none promised", t->frames,
           bench->flight.speed_m_s, jobs_worker_count(bench->world.jobs));
    printf("loaded           in %.0f ms, %.2f bytes a sample\n", bench->load_ms,
           (double)terrain_sample_bytes(bench->world.terrain) / samples(bench));
    printf("triangles        %.0f in %.0f patches\n", t->triangles / n, t->patches / n);
    printf("patches reused   %.1f %%\n", 100.0 * t->reused / n);
    printf("rebuilt          %.1f %% of the triangles, %.0f bytes of indices a frame\n", 100.0 * t->rebuilt / n,
           t->index_bytes / n);
    printf("update           p50 %.2f ms, p99 %.2f ms, max %.2f ms\n", statistics_percentile(ms, t->frames, 0.5),
           statistics_percentile(ms, t->frames, 0.99), statistics_percentile(ms, t->frames, 1.0));
    printf("from scratch     %.1f ns a triangle, %s\n", statistics_percentile(bench->full_ns, bench->full_count, 0.5),
           bench->equal ? "the same triangles" : "OTHER TRIANGLES");
}

static void release(Bench *bench) {
    lod_destroy(&bench->full);
    lod_destroy(&bench->lod);
    arena_destroy(&bench->full_frame);
    arena_destroy(&bench->frame);
    free(bench->full_ns);
    free(bench->update_ms);
    world_unload(&bench->world);
}

Result bench_refine(const Options *options) {
    Bench bench = {.options = options, .frames = (int)options_integer(options, OPTION_FRAMES), .equal = true};
    if (bench.frames == 0)
        bench.frames = 600;
    Result result = bench_tau(options, &bench.tau_px);
    int64_t begin = clock_now_ns();
    if (result == RESULT_OK)
        result = world_load(options, &bench.world);
    bench.load_ms = (double)(clock_now_ns() - begin) * 1e-6;
    bench.resident_bytes = bench_resident_bytes();
    if (result == RESULT_OK)
        result = prepare(&bench);
    if (result == RESULT_OK)
        result = fly(&bench);
    if (result == RESULT_OK) {
        statistics_sort(bench.full_ns, bench.full_count);
        if (options_flag(options, OPTION_JSON))
            result = print_json(&bench);
        else
            print_text(&bench);
    }
    release(&bench);
    if (result == RESULT_OK && !bench.equal) {
        log_error("bench refine: a kept triangulation differed from a refinement from scratch");
        result = RESULT_RANGE;
    }
    return result;
}
