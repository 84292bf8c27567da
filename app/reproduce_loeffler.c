// Loeffler, Schwanke, Schumann 2010, section 5: table 1, the schemes of preprocessing (sections 3.1, 3.2), and table 2,
// static patches against the hybrid method (section 4) in flight.
#include "app/reproduce.h"
#include "app/reproduce_figures.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/statistics.h"
#include "terrain/errors/error_field.h"

#include <math.h>

#define WIDTH 1280
#define HEIGHT 800
#define SPEED_M_S 100.0
#define FULL_SECONDS 20.0
#define QUICK_SECONDS 1.0
#define FULL_ROUNDS 5
#define QUICK_ROUNDS 1

static const int SIDES[] = {1025, 2049, 4097, 8193};

// ---- Table 1 ----------------------------------------------------------------------------------------------------

enum {
    T1_SIDE,
    T1_ERROR,
    T1_SINGLE_RECURSIVE,
    T1_SINGLE_PARALLEL,
    T1_QUAD_RECURSIVE,
    T1_QUAD_PARALLEL,
    T1_PAPER_SPEEDUP,
    T1_RECURSIVE,
    T1_PARALLEL_ONE,
    T1_PARALLEL_ALL,
    T1_SPEEDUP_ONE,
    T1_SPEEDUP_ALL,
    T1_NS,
    T1_COLUMNS
};

static const ReportColumn PREPROCESS_COLUMNS[T1_COLUMNS] = {
    [T1_SIDE] = {REPORT_KEY, "size", "side", 0},
    [T1_ERROR] = {REPORT_KEY, "error", "error", 0},
    [T1_SINGLE_RECURSIVE] = {REPORT_PAPER, "single_core_recursive_s", "single core, recursive, s", 2},
    [T1_SINGLE_PARALLEL] = {REPORT_PAPER, "single_core_parallel_s", "single core, parallel scheme, s", 2},
    [T1_QUAD_RECURSIVE] = {REPORT_PAPER, "quad_core_recursive_s", "quad core, recursive, s", 2},
    [T1_QUAD_PARALLEL] = {REPORT_PAPER, "quad_core_parallel_s", "quad core, parallel scheme, s", 2},
    [T1_PAPER_SPEEDUP] = {REPORT_PAPER, "quad_core_speedup", "quad core, ratio", 1},
    [T1_RECURSIVE] = {REPORT_OURS, "recursive_s", "recursive, s", 3},
    [T1_PARALLEL_ONE] = {REPORT_OURS, "parallel_one_thread_s", "parallel scheme, 1 thread, s", 3},
    [T1_PARALLEL_ALL] = {REPORT_OURS, "parallel_all_threads_s", "parallel scheme, all threads, s", 3},
    [T1_SPEEDUP_ONE] = {REPORT_OURS, "speedup_one_thread", "ratio, 1 thread", 1},
    [T1_SPEEDUP_ALL] = {REPORT_OURS, "speedup_all_threads", "ratio, all threads", 1},
    [T1_NS] = {REPORT_OURS, "parallel_all_threads_ns_per_vertex", "all threads, ns a vertex", 2},
};
static const ReportTable PREPROCESS_TABLE = {.id = "table1",
                                             .name = "Table 1: preprocessing",
                                             .source = "table 1, section 5",
                                             .columns = PREPROCESS_COLUMNS,
                                             .column_count = T1_COLUMNS};

// Ways to compute a field, in the order in which each round goes through them.
typedef struct Way {
    ErrorScheme scheme;
    bool all_threads;
} Way;
static const Way WAYS[] = {
    {ERROR_SCHEME_RECURSIVE, false}, {ERROR_SCHEME_PARALLEL, false}, {ERROR_SCHEME_PARALLEL, true}};
#define WAY_COUNT 3

typedef struct Preprocess {
    Reproduce *run;
    const Dem *dem;
    Grid *grid;
    Forest forest;
    int rounds;
    double seconds[2][WAY_COUNT][FULL_ROUNDS]; // [error][way][round]
} Preprocess;

static Result time_field(Preprocess *p, int error, int way, int round) {
    ErrorFieldInput input = {p->dem->height_m, p->grid, &p->forest, (TerrainErrorKind)error, WAYS[way].scheme, NULL};
    ErrorField field;
    int64_t begin = clock_now_ns();
    Result result = error_field_create(&input, WAYS[way].all_threads ? p->run->all : p->run->one, &field);
    p->seconds[error][way][round] = (double)(clock_now_ns() - begin) * 1e-9;
    if (result == RESULT_OK)
        error_field_destroy(&field);
    return result;
}

static Result time_rounds(Preprocess *p) {
    Result result = RESULT_OK;
    for (int round = 0; round < p->rounds; round++)
        for (int error = TERRAIN_ERROR_MIDPOINT; error <= TERRAIN_ERROR_TOTAL; error++)
            for (int way = 0; way < WAY_COUNT && result == RESULT_OK; way++)
                result = time_field(p, error, way, round);
    return result;
}

static double median_s(Preprocess *p, int error, int way) {
    statistics_sort(p->seconds[error][way], p->rounds);
    return statistics_percentile(p->seconds[error][way], p->rounds, 0.5);
}

static void set_preprocess_figures(ReportCell *row, const FiguresPreprocess *figures) {
    if (!figures)
        return;
    row[T1_SINGLE_RECURSIVE] = report_number(figures->single_recursive_s);
    row[T1_SINGLE_PARALLEL] = report_number(figures->single_parallel_s);
    row[T1_QUAD_RECURSIVE] = report_number(figures->quad_recursive_s);
    row[T1_QUAD_PARALLEL] = report_number(figures->quad_parallel_s);
    row[T1_PAPER_SPEEDUP] = report_number(figures->quad_recursive_s / figures->quad_parallel_s);
}

// The paper's figures are of the midpoint error, Lindstrom and Pascucci's.
static Result add_preprocess_row(Preprocess *p, int side, int error, ReportTable *table) {
    ReportCell *row = report_add_row(table);
    if (!row)
        return RESULT_MEMORY;
    double recursive = median_s(p, error, 0), one = median_s(p, error, 1), all = median_s(p, error, 2);
    row[T1_SIDE] = report_number(side);
    row[T1_ERROR] = report_text(error == TERRAIN_ERROR_MIDPOINT ? "midpoint" : "total");
    set_preprocess_figures(row, error == TERRAIN_ERROR_MIDPOINT ? figures_preprocess(side) : NULL);
    row[T1_RECURSIVE] = report_number(recursive);
    row[T1_PARALLEL_ONE] = report_number(one);
    row[T1_PARALLEL_ALL] = report_number(all);
    row[T1_SPEEDUP_ONE] = report_number(recursive / one);
    row[T1_SPEEDUP_ALL] = report_number(recursive / all);
    row[T1_NS] = report_number(all * 1e9 / ((double)side * side));
    return RESULT_OK;
}

static Result preprocess_side(Reproduce *run, int side, ReportTable *table) {
    Preprocess p = {.run = run, .rounds = run->quick ? QUICK_ROUNDS : FULL_ROUNDS};
    Dem *dem = NULL;
    Result result = site_make_dem(&run->site, SITE_ROUGH, side, &dem);
    p.dem = dem;
    if (result == RESULT_OK)
        result = grid_create(&dem->georef, side, side, &p.grid);
    if (result == RESULT_OK)
        result = forest_create(side, side, &p.forest);
    if (result == RESULT_OK)
        result = time_rounds(&p);
    for (int error = TERRAIN_ERROR_MIDPOINT; error <= TERRAIN_ERROR_TOTAL && result == RESULT_OK; error++)
        result = add_preprocess_row(&p, side, error, table);
    forest_destroy(&p.forest);
    if (p.grid)
        grid_destroy(&p.grid);
    dem_destroy(&dem);
    return result;
}

static Result preprocess(Reproduce *run) {
    int sides[REPRODUCE_SIDES_MAX];
    int count = reproduce_sides(run, "table 1", SIDES, COUNT_OF(SIDES), 2, sides);
    ReportTable *table = report_add_table(&run->report, &PREPROCESS_TABLE);
    report_note(&run->report.set_up,
                "Table 1: rough synthetic ground, median of %d rounds, interleaved; the papers' error is 'midpoint', "
                "'total' is ours, which bounds the error at every sample",
                run->quick ? QUICK_ROUNDS : FULL_ROUNDS);
    if (run->quick)
        report_note(&run->report.left_out, "table 1: %d of %d rounds", FULL_ROUNDS - QUICK_ROUNDS, FULL_ROUNDS);
    Progress progress = progress_begin("preprocessing");
    Result result = RESULT_OK;
    for (int i = 0; i < count && result == RESULT_OK; i++) {
        result = preprocess_side(run, sides[i], table);
        progress_update(&progress, (double)(i + 1) / count);
    }
    progress_end(&progress);
    return result;
}

// ---- Table 2 ----------------------------------------------------------------------------------------------------

enum { PATCH, HYBRID, RACERS };

enum {
    T2_GROUND,
    T2_SIDE,
    T2_TAU,
    T2_PAPER_PATCH_TRIANGLES,
    T2_PAPER_HYBRID_TRIANGLES,
    T2_PAPER_RATIO,
    T2_PAPER_PATCH_FPS,
    T2_PAPER_HYBRID_FPS,
    T2_PATCH_TRIANGLES,
    T2_HYBRID_TRIANGLES,
    T2_RATIO,
    T2_PATCH_P50,
    T2_PATCH_P99,
    T2_HYBRID_P50,
    T2_HYBRID_P99,
    T2_PATCH_FPS,
    T2_HYBRID_FPS,
    T2_PATCH_IN_VIEW,
    T2_HYBRID_IN_VIEW,
    T2_PATCH_DRAWN,
    T2_HYBRID_DRAWN,
    T2_COLUMNS
};

static const ReportColumn HYBRID_COLUMNS[T2_COLUMNS] = {
    [T2_GROUND] = {REPORT_KEY, "ground", "ground", 0},
    [T2_SIDE] = {REPORT_KEY, "size", "side", 0},
    [T2_TAU] = {REPORT_KEY, "tau_px", "tau, px", 1},
    [T2_PAPER_PATCH_TRIANGLES] = {REPORT_PAPER, "patch_triangles", "patch triangles", 0},
    [T2_PAPER_HYBRID_TRIANGLES] = {REPORT_PAPER, "hybrid_triangles", "hybrid triangles", 0},
    [T2_PAPER_RATIO] = {REPORT_PAPER, "triangles_ratio", "hybrid / patch", 3},
    [T2_PAPER_PATCH_FPS] = {REPORT_PAPER, "patch_fps", "patch frames/s", 0},
    [T2_PAPER_HYBRID_FPS] = {REPORT_PAPER, "hybrid_fps", "hybrid frames/s", 0},
    [T2_PATCH_TRIANGLES] = {REPORT_OURS, "patch_triangles", "patch triangles", 0},
    [T2_HYBRID_TRIANGLES] = {REPORT_OURS, "hybrid_triangles", "hybrid triangles", 0},
    [T2_RATIO] = {REPORT_OURS, "triangles_ratio", "hybrid / patch", 3},
    [T2_PATCH_P50] = {REPORT_OURS, "patch_update_p50_ms", "patch update p50, ms", 2},
    [T2_PATCH_P99] = {REPORT_OURS, "patch_update_p99_ms", "patch p99, ms", 2},
    [T2_HYBRID_P50] = {REPORT_OURS, "hybrid_update_p50_ms", "hybrid update p50, ms", 2},
    [T2_HYBRID_P99] = {REPORT_OURS, "hybrid_update_p99_ms", "hybrid p99, ms", 2},
    [T2_PATCH_FPS] = {REPORT_OURS, "patch_refined_fps", "patch frames/s, refined", 0},
    [T2_HYBRID_FPS] = {REPORT_OURS, "hybrid_refined_fps", "hybrid frames/s, refined", 0},
    [T2_PATCH_IN_VIEW] = {REPORT_OURS, "patch_triangles_in_view", "patch triangles in view", 0},
    [T2_HYBRID_IN_VIEW] = {REPORT_OURS, "hybrid_triangles_in_view", "hybrid triangles in view", 0},
    [T2_PATCH_DRAWN] = {REPORT_OURS, "patch_drawn_fps", "patch frames/s, drawn", 1},
    [T2_HYBRID_DRAWN] = {REPORT_OURS, "hybrid_drawn_fps", "hybrid frames/s, drawn", 1},
};
static const ReportTable HYBRID_TABLE = {.id = "table2",
                                         .name = "Table 2: static patches and the hybrid method in flight",
                                         .source = "table 2, section 5",
                                         .columns = HYBRID_COLUMNS,
                                         .column_count = T2_COLUMNS};
static const double TAUS_PX[] = {0.5, 1.0, 2.0};

static void set_hybrid_figures(ReportCell *row, const FiguresHybrid *figures) {
    if (!figures)
        return;
    row[T2_PAPER_PATCH_TRIANGLES] = report_number(figures->patch_triangles);
    row[T2_PAPER_HYBRID_TRIANGLES] = report_number(figures->hybrid_triangles);
    row[T2_PAPER_RATIO] = report_number(figures->hybrid_triangles / figures->patch_triangles);
    row[T2_PAPER_PATCH_FPS] = report_number(figures->patch_fps);
    row[T2_PAPER_HYBRID_FPS] = report_number(figures->hybrid_fps);
}

static void set_race(ReportCell *row, const Race *race) {
    RaceTimes patch = race_times(race, PATCH), hybrid = race_times(race, HYBRID);
    double patch_triangles = race_mean(race, PATCH, race->racers[PATCH].triangles);
    double hybrid_triangles = race_mean(race, HYBRID, race->racers[HYBRID].triangles);
    row[T2_PATCH_TRIANGLES] = report_number(patch_triangles);
    row[T2_HYBRID_TRIANGLES] = report_number(hybrid_triangles);
    row[T2_RATIO] = report_number(hybrid_triangles / patch_triangles);
    row[T2_PATCH_P50] = report_number(patch.p50_ms);
    row[T2_PATCH_P99] = report_number(patch.p99_ms);
    row[T2_HYBRID_P50] = report_number(hybrid.p50_ms);
    row[T2_HYBRID_P99] = report_number(hybrid.p99_ms);
    row[T2_PATCH_FPS] = report_number(patch.fps);
    row[T2_HYBRID_FPS] = report_number(hybrid.fps);
    row[T2_PATCH_IN_VIEW] = report_number(race_drawn_triangles(race, PATCH));
    row[T2_HYBRID_IN_VIEW] = report_number(race_drawn_triangles(race, HYBRID));
    row[T2_PATCH_DRAWN] = report_number(race_drawn_fps(race, PATCH));
    row[T2_HYBRID_DRAWN] = report_number(race_drawn_fps(race, HYBRID));
}

typedef struct Flight {
    Reproduce *run;
    Terrain *terrain;
    Circuit circuit;
    SiteGround ground;
    int side, frames;
} Flight;

static Result enter_racers(const Flight *flight, Race *race) {
    LodOptions patch = reproduce_lod_options(LOD_PATCH), hybrid = reproduce_lod_options(LOD_HYBRID);
    Result result = race_enter(race, &patch, flight->run->all);
    if (result == RESULT_OK)
        result = race_enter(race, &hybrid, flight->run->all);
    reproduce_note_absent(flight->run, race);
    return result;
}

static Result fly(Flight *flight, Race *race, double tau_px) {
    double step = SPEED_M_S / REPRODUCE_FRAME_HZ / flight->circuit.length_m, part = 0.0;
    Result result = RESULT_OK;
    for (int frame = 0; frame < flight->frames + REPRODUCE_WARM_UP && result == RESULT_OK; frame++, part += step) {
        Viewpoint at = circuit_at(&flight->circuit, part);
        LodView view = circuit_view(&at, reproduce_px_per_rad(HEIGHT), tau_px);
        result = race_step(race, &view, frame >= REPRODUCE_WARM_UP);
    }
    if (result == RESULT_OK)
        result = reproduce_draw(flight->run, race, &flight->circuit, WIDTH, HEIGHT, tau_px, part, step);
    return result;
}

static Result fly_tau(Flight *flight, double tau_px, ReportTable *table) {
    Race race;
    race_begin(flight->terrain, flight->frames, &race);
    Result result = enter_racers(flight, &race);
    if (result == RESULT_OK)
        result = fly(flight, &race, tau_px);
    ReportCell *row = result == RESULT_OK ? report_add_row(table) : NULL;
    if (row) {
        row[T2_GROUND] = report_text(site_ground_name(flight->ground));
        row[T2_SIDE] = report_number(flight->side);
        row[T2_TAU] = report_number(tau_px);
        set_hybrid_figures(row, figures_hybrid(flight->side, tau_px));
        set_race(row, &race);
    } else if (result == RESULT_OK) {
        result = RESULT_MEMORY;
    }
    race_end(&race);
    return result;
}

static Result fly_terrain(Flight *flight, ReportTable *table) {
    Reproduce *run = flight->run;
    Result result =
        site_make_terrain(&run->site, flight->ground, flight->side, TERRAIN_ERROR_TOTAL, run->all, &flight->terrain);
    if (result != RESULT_OK)
        return result;
    circuit_plan(flight->terrain, REPRODUCE_HEIGHT_M, &flight->circuit);
    for (size_t i = 0; i < COUNT_OF(TAUS_PX) && result == RESULT_OK; i++)
        result = fly_tau(flight, TAUS_PX[i], table);
    terrain_destroy(&flight->terrain);
    return result;
}

static Result fly_all(Reproduce *run) {
    int sides[REPRODUCE_SIDES_MAX];
    int count = reproduce_sides(run, "table 2", SIDES, COUNT_OF(SIDES) - 1, 2, sides);
    double seconds = reproduce_seconds(run, "table 2", FULL_SECONDS, QUICK_SECONDS);
    Flight flight = {.run = run, .frames = (int)fmax(1.0, seconds * REPRODUCE_FRAME_HZ)};
    ReportTable *table = report_add_table(&run->report, &HYBRID_TABLE);
    report_note(&run->report.set_up,
                "Table 2: %dx%d, %g degrees; %d frames of 1/60 s at %g m/s, %g m above the ground, patches of side 65, "
                "error 'total', all threads; triangles are of the whole cut, 'in view' those of the frames drawn",
                WIDTH, HEIGHT, REPRODUCE_FOV_DEG, flight.frames, SPEED_M_S, REPRODUCE_HEIGHT_M);
    Progress progress = progress_begin("flights");
    Result result = RESULT_OK;
    for (int i = 0; i < SITE_GROUND_COUNT * count && result == RESULT_OK; i++) {
        flight.ground = (SiteGround)(i / count);
        flight.side = sides[i % count];
        result = fly_terrain(&flight, table);
        progress_update(&progress, (double)(i + 1) / (SITE_GROUND_COUNT * count));
    }
    progress_end(&progress);
    return result;
}

Result reproduce_loeffler(Reproduce *run) {
    Result result = preprocess(run);
    return result == RESULT_OK ? fly_all(run) : result;
}
