// Loeffler, Schwanke, Schumann 2010, section 5, table 1: the straightforward recursive scheme of preprocessing against
// the parallel one by diamonds, level by level (sections 3.1, 3.2).
#include "app/reproduce/reproduce.h"
#include "app/reproduce/reproduce_figures.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/statistics.h"
#include "terrain/errors/error_field.h"

#define FULL_ROUNDS 5
#define QUICK_ROUNDS 1

static const int SIDES[] = {1025, 2049, 4097, 8193};

enum {
    COL_SIDE,
    COL_ERROR,
    COL_SINGLE_RECURSIVE,
    COL_SINGLE_PARALLEL,
    COL_QUAD_RECURSIVE,
    COL_QUAD_PARALLEL,
    COL_PAPER_SPEEDUP,
    COL_RECURSIVE,
    COL_PARALLEL_ONE,
    COL_PARALLEL_ALL,
    COL_SPEEDUP_ONE,
    COL_SPEEDUP_ALL,
    COL_NS,
    COL_COUNT
};

static const ReportColumn COLUMNS[COL_COUNT] = {
    [COL_SIDE] = {REPORT_KEY, "size", "side", 0},
    [COL_ERROR] = {REPORT_KEY, "error", "error", 0},
    [COL_SINGLE_RECURSIVE] = {REPORT_PAPER, "single_core_recursive_s", "single core, recursive, s", 2},
    [COL_SINGLE_PARALLEL] = {REPORT_PAPER, "single_core_parallel_s", "single core, parallel scheme, s", 2},
    [COL_QUAD_RECURSIVE] = {REPORT_PAPER, "quad_core_recursive_s", "quad core, recursive, s", 2},
    [COL_QUAD_PARALLEL] = {REPORT_PAPER, "quad_core_parallel_s", "quad core, parallel scheme, s", 2},
    [COL_PAPER_SPEEDUP] = {REPORT_PAPER, "quad_core_speedup", "quad core, ratio", 1},
    [COL_RECURSIVE] = {REPORT_OURS, "recursive_s", "recursive, s", 3},
    [COL_PARALLEL_ONE] = {REPORT_OURS, "parallel_one_thread_s", "parallel scheme, 1 thread, s", 3},
    [COL_PARALLEL_ALL] = {REPORT_OURS, "parallel_all_threads_s", "parallel scheme, all threads, s", 3},
    [COL_SPEEDUP_ONE] = {REPORT_OURS, "speedup_one_thread", "ratio, 1 thread", 1},
    [COL_SPEEDUP_ALL] = {REPORT_OURS, "speedup_all_threads", "ratio, all threads", 1},
    [COL_NS] = {REPORT_OURS, "parallel_all_threads_ns_per_vertex", "all threads, ns a vertex", 2},
};
static const ReportTable TABLE = {.id = "table1",
                                  .name = "Table 1: preprocessing",
                                  .source = "table 1, section 5",
                                  .columns = COLUMNS,
                                  .column_count = COL_COUNT};

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
    ErrorFieldInput input = {.height_m = p->dem->height_m,
                             .grid = p->grid,
                             .forest = &p->forest,
                             .kind = (TerrainErrorKind)error,
                             .scheme = WAYS[way].scheme};
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
    row[COL_SINGLE_RECURSIVE] = report_number(figures->single_recursive_s);
    row[COL_SINGLE_PARALLEL] = report_number(figures->single_parallel_s);
    row[COL_QUAD_RECURSIVE] = report_number(figures->quad_recursive_s);
    row[COL_QUAD_PARALLEL] = report_number(figures->quad_parallel_s);
    row[COL_PAPER_SPEEDUP] = report_number(figures->quad_recursive_s / figures->quad_parallel_s);
}

// The paper's figures are of the midpoint error, Lindstrom and Pascucci's.
static Result add_preprocess_row(Preprocess *p, int side, int error, ReportTable *table) {
    ReportCell *row = report_add_row(table);
    if (!row)
        return RESULT_MEMORY;
    double recursive = median_s(p, error, 0), one = median_s(p, error, 1), all = median_s(p, error, 2);
    row[COL_SIDE] = report_number(side);
    row[COL_ERROR] = report_text(error == TERRAIN_ERROR_MIDPOINT ? "midpoint" : "total");
    set_preprocess_figures(row, error == TERRAIN_ERROR_MIDPOINT ? figures_preprocess(side) : NULL);
    row[COL_RECURSIVE] = report_number(recursive);
    row[COL_PARALLEL_ONE] = report_number(one);
    row[COL_PARALLEL_ALL] = report_number(all);
    row[COL_SPEEDUP_ONE] = report_number(recursive / one);
    row[COL_SPEEDUP_ALL] = report_number(recursive / all);
    row[COL_NS] = report_number(all * 1e9 / ((double)side * side));
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

Result reproduce_preprocess(Reproduce *run) {
    int sides[REPRODUCE_SIDES_MAX];
    int count = reproduce_sides(run, "table 1", SIDES, COUNT_OF(SIDES), 3, sides);
    ReportTable *table = report_add_table(&run->report, &TABLE);
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
