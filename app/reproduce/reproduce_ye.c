// Ye, Wang, section 4: de Boer's GeoMipMap, its improvement and ROAM over 1025 x 1025 samples in tiles of 33, at one
// tolerance. What the paper does not measure: the true error of each, and of the variants that keep a bound.
#include "app/reproduce/reproduce.h"
#include "app/reproduce/reproduce_figures.h"
#include "app/reproduce/reproduce_search.h"
#include "base/log.h"

#include <math.h>
#include <string.h>

#define WIDTH 1024
#define HEIGHT 768
#define TILE_SIDE 33
#define SPEED_M_S 100.0
#define FULL_SECONDS 20.0
#define QUICK_SECONDS 2.0
#define MEASURES 8 // of the true error, spread over the flight
#define QUICK_MEASURES 2
#define PROBES 12
#define GEOMIPMAP_TRIANGLES 30000.0 // section 4: "30000-odd"
#define ROAM_TRIANGLES 10000        // section 4: "constantly 10000"

enum {
    COL_GROUND,
    COL_SIDE,
    COL_METHOD,
    COL_BOUND,
    COL_UNIT,
    COL_PAPER_TRIANGLES,
    COL_PAPER_FPS,
    COL_TAU,
    COL_TRIANGLES,
    COL_P50,
    COL_P99,
    COL_FPS,
    COL_DRAWN,
    COL_MAX,
    COL_P999,
    COL_RMS,
    COL_REACHED,
    COL_COUNT
};

static const ReportColumn COLUMNS[COL_COUNT] = {
    [COL_GROUND] = {REPORT_KEY, "ground", "ground", 0},
    [COL_SIDE] = {REPORT_KEY, "size", "side", 0},
    [COL_METHOD] = {REPORT_KEY, "method", "method", 0},
    [COL_BOUND] = {REPORT_KEY, "bound", "bound", 0},
    [COL_UNIT] = {REPORT_KEY, "unit_m", "unit, m", 1},
    [COL_PAPER_TRIANGLES] = {REPORT_PAPER, "triangles", "triangles", 0},
    [COL_PAPER_FPS] = {REPORT_PAPER, "fps", "frames/s", 0},
    [COL_TAU] = {REPORT_OURS, "tau_px", "tau, px", 3},
    [COL_TRIANGLES] = {REPORT_OURS, "triangles", "triangles, mean", 0},
    [COL_P50] = {REPORT_OURS, "update_p50_ms", "update p50, ms", 3},
    [COL_P99] = {REPORT_OURS, "update_p99_ms", "p99, ms", 3},
    [COL_FPS] = {REPORT_OURS, "refined_fps", "frames/s, refined", 0},
    [COL_DRAWN] = {REPORT_OURS, "drawn_fps", "frames/s, drawn", 1},
    [COL_MAX] = {REPORT_OURS, "error_max_px", "true error max, px", 2},
    [COL_P999] = {REPORT_OURS, "error_p999_px", "p99.9, px", 2},
    [COL_RMS] = {REPORT_OURS, "error_rms_px", "rms, px", 3},
    [COL_REACHED] = {REPORT_OURS, "reached_px", "said to hold, px", 3},
};
static const ReportTable TABLE = {.id = "results",
                                  .name = "Results: static level of detail and ROAM",
                                  .source = "section 4 (text)",
                                  .columns = COLUMNS,
                                  .column_count = COL_COUNT};
static const int SIDES[] = {1025};

typedef struct Entry {
    LodMethod method;
    LodBound bound;
    int64_t max_triangles; // 0: without limit
    bool unit_is_spacing;  // Ye's rule in units of the samples' spacing, not in metres
} Entry;
static const Entry ENTRIES[] = {
    {LOD_GEOMIPMAP, LOD_BOUND_PUBLISHED, 0, false},   {LOD_GEOMIPMAP_YE, LOD_BOUND_PUBLISHED, 0, false},
    {LOD_GEOMIPMAP_YE, LOD_BOUND_PUBLISHED, 0, true}, {LOD_ROAM, LOD_BOUND_PUBLISHED, ROAM_TRIANGLES, false},
    {LOD_GEOMIPMAP, LOD_BOUND_CENTRE, 0, false},      {LOD_GEOMIPMAP_YE, LOD_BOUND_CENTRE, 0, false},
    {LOD_HYBRID, LOD_BOUND_PUBLISHED, 0, false},
};
#define ENTRY_COUNT ((int)COUNT_OF(ENTRIES))

typedef struct Flight {
    Reproduce *run;
    Circuit circuit;
    SiteGround ground;
    int side, frames, measures;
    double tau_px;
} Flight;

// Between neighbours in the middle of the grid, the mean of both directions.
static double spacing_m(const Terrain *terrain) {
    const Grid *grid = terrain_grid(terrain);
    int middle = terrain_dem(terrain)->width / 2;
    Vec3d at = grid_ecef(grid, middle, middle, 0.0);
    double across = vec3d_distance(at, grid_ecef(grid, middle + 1, middle, 0.0));
    return 0.5 * (across + vec3d_distance(at, grid_ecef(grid, middle, middle + 1, 0.0)));
}

static LodOptions entry_options(const Flight *flight, const Entry *entry) {
    LodOptions options = reproduce_lod_options(entry->method);
    if (entry->unit_is_spacing)
        options.unit_m = spacing_m(flight->circuit.terrain);
    options.bound = entry->bound;
    options.tile_side = TILE_SIDE;
    if (entry->max_triangles)
        options.max_triangles = entry->max_triangles;
    return options;
}

static Result find_tau(Flight *flight) {
    Search search;
    LodOptions options = entry_options(flight, &ENTRIES[0]);
    double span = flight->frames * SPEED_M_S / REPRODUCE_FRAME_HZ / flight->circuit.length_m;
    Result result =
        search_begin(&flight->circuit, &options, flight->run->all, reproduce_px_per_rad(HEIGHT), span, PROBES, &search);
    if (result == RESULT_OK)
        result = search_tau(&search, GEOMIPMAP_TRIANGLES, &flight->tau_px);
    search_end(&search);
    return result;
}

static void set_racer(ReportCell *row, const Flight *flight, const Race *race, int index) {
    const Racer *racer = &race->racers[index];
    RaceTimes times = race_times(race, index);
    row[COL_TAU] = report_number(flight->tau_px);
    row[COL_TRIANGLES] = report_number(race_mean(race, index, racer->triangles));
    row[COL_P50] = report_number(times.p50_ms);
    row[COL_P99] = report_number(times.p99_ms);
    row[COL_FPS] = report_number(times.fps);
    row[COL_DRAWN] = report_number(race_drawn_fps(race, index));
    if (!racer->measures)
        return;
    row[COL_MAX] = report_number(racer->max_px);
    row[COL_P999] = report_number(racer->p999_px);
    row[COL_RMS] = report_number(sqrt(racer->squares_px / racer->measures));
    if (racer->cut.promises)
        row[COL_REACHED] = report_number(racer->reached_px);
}

static Result add_rows(const Flight *flight, const Race *race, ReportTable *table) {
    for (int i = 0; i < ENTRY_COUNT; i++) {
        ReportCell *row = report_add_row(table);
        if (!row)
            return RESULT_MEMORY;
        const char *method = lod_method_name(ENTRIES[i].method);
        bool measured = ENTRIES[i].bound == LOD_BOUND_PUBLISHED && flight->side == SIDES[0];
        const FiguresStatic *figures = measured ? figures_static(method) : NULL;
        row[COL_GROUND] = report_text(site_ground_name(flight->ground));
        row[COL_SIDE] = report_number(flight->side);
        row[COL_METHOD] = report_text(method);
        row[COL_BOUND] = report_text(ENTRIES[i].bound == LOD_BOUND_PUBLISHED ? "published" : "centre");
        if (ENTRIES[i].method == LOD_GEOMIPMAP_YE && ENTRIES[i].bound == LOD_BOUND_PUBLISHED)
            row[COL_UNIT] = report_number(race->racers[i].options.unit_m);
        if (figures) {
            row[COL_PAPER_TRIANGLES] = report_number(figures->triangles);
            row[COL_PAPER_FPS] = report_number(figures->fps);
        }
        set_racer(row, flight, race, i);
    }
    return RESULT_OK;
}

static Result enter_racers(const Flight *flight, Race *race) {
    Result result = RESULT_OK;
    for (int i = 0; i < ENTRY_COUNT && result == RESULT_OK; i++) {
        LodOptions options = entry_options(flight, &ENTRIES[i]);
        result = race_enter(race, &options, flight->run->all);
    }
    return result;
}

static Result fly(const Flight *flight, Race *race) {
    double step = SPEED_M_S / REPRODUCE_FRAME_HZ / flight->circuit.length_m, part = 0.0;
    int every = (flight->frames + flight->measures - 1) / flight->measures;
    Result result = RESULT_OK;
    for (int frame = 0; frame < flight->frames + REPRODUCE_WARM_UP && result == RESULT_OK; frame++, part += step) {
        Viewpoint at = circuit_at(&flight->circuit, part);
        LodView view = circuit_view(&at, reproduce_px_per_rad(HEIGHT), flight->tau_px);
        bool counted = frame >= REPRODUCE_WARM_UP;
        result = race_step(race, &view, counted);
        if (result == RESULT_OK && counted && (frame - REPRODUCE_WARM_UP) % every == every - 1)
            result = race_measure(race, flight->run->all);
    }
    if (result == RESULT_OK)
        result = reproduce_draw(flight->run, race, &flight->circuit, WIDTH, HEIGHT, flight->tau_px, part, step);
    return result;
}

static Result race_methods(Flight *flight, ReportTable *table) {
    Race race;
    race_begin(flight->circuit.terrain, flight->frames, &race);
    Result result = find_tau(flight);
    if (result == RESULT_OK)
        result = enter_racers(flight, &race);
    if (result == RESULT_OK)
        result = fly(flight, &race);
    if (result == RESULT_OK)
        result = add_rows(flight, &race, table);
    race_end(&race);
    return result;
}

static Result fly_terrain(Flight *flight, ReportTable *table) {
    Terrain *terrain = NULL;
    Result result = reproduce_terrain(flight->run, flight->ground, flight->side, &flight->circuit, &terrain);
    if (result != RESULT_OK)
        return result;
    result = race_methods(flight, table);
    terrain_destroy(&terrain);
    return result;
}

Result reproduce_ye(Reproduce *run) {
    int sides[REPRODUCE_SIDES_MAX];
    int count = reproduce_sides(run, "results", SIDES, COUNT_OF(SIDES), 1, sides);
    double seconds = reproduce_seconds(run, "results", FULL_SECONDS, QUICK_SECONDS);
    Flight flight = {.run = run, .frames = (int)fmax(1.0, seconds * REPRODUCE_FRAME_HZ)};
    flight.measures = run->quick ? QUICK_MEASURES : MEASURES;
    ReportTable *table = report_add_table(&run->report, &TABLE);
    report_note(
        &run->report.set_up,
        "%dx%d, %g degrees, tiles of %d; %d frames of 1/60 s at %g m/s, %g m above the ground, all threads; the "
        "tolerance is the one at which geomipmap draws about %.0f triangles; roam has a budget of %d",
        WIDTH, HEIGHT, REPRODUCE_FOV_DEG, TILE_SIDE, flight.frames, SPEED_M_S, REPRODUCE_HEIGHT_M, GEOMIPMAP_TRIANGLES,
        ROAM_TRIANGLES);
    report_note(&run->report.set_up,
                "True errors over all samples of %d frames: the greatest, the greatest p99.9, the root of the mean "
                "square; with the bound 'centre' the tolerance holds at every sample",
                flight.measures);
    report_note(
        &run->report.set_up,
        "The rule of Ye and Wang compares a length with a length's square, so that it depends on the unit, which "
        "they do not name: in metres, and in units of the samples' spacing");
    if (run->quick)
        report_note(&run->report.left_out, "%d of %d measurements of the true error", MEASURES - QUICK_MEASURES,
                    MEASURES);
    Result result = RESULT_OK;
    for (int i = 0; i < SITE_GROUND_COUNT * count && result == RESULT_OK; i++) {
        flight.ground = (SiteGround)(i / count);
        flight.side = sides[i % count];
        result = fly_terrain(&flight, table);
    }
    return result;
}
