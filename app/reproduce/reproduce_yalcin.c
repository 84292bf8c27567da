// Yalcin, Weiss, De Floriani 2011, section 9, table 1: the phases over a hierarchy of diamonds: generation of errors
// (section 5), evaluation of a view-dependent criterion (6), transitive closure (7), indices (8), and rendering.
#include "app/reproduce/reproduce.h"
#include "app/reproduce/reproduce_diamonds.h"
#include "app/reproduce/reproduce_figures.h"
#include "base/log.h"
#include "terrain/geodesy.h"

#include <math.h>

#define WIDTH 1280
#define HEIGHT 800
#define TAU_PX 1.0
#define CRITERION "tolerance && inview" // section 9.2: view-dependent error, frustum culling included
#define FULL_VIEWS 24
#define QUICK_VIEWS 5
#define SOFTWARE_SIDE_MAX 1025 // a static mesh of more takes a software renderer minutes

enum {
    COL_GROUND,
    COL_SIDE,
    COL_WHERE,
    COL_PAPER_GENERATION,
    COL_PAPER_ROOT,
    COL_PAPER_DEEPEST,
    COL_PAPER_EVALUATION,
    COL_PAPER_CLOSURE_MAX,
    COL_PAPER_CLOSURE,
    COL_PAPER_INDICES,
    COL_PAPER_DYNAMIC,
    COL_PAPER_DYNAMIC_FPS,
    COL_PAPER_STATIC_FPS,
    COL_GENERATION,
    COL_ROOT,
    COL_DEEPEST,
    COL_EVALUATION,
    COL_CLOSURE_MAX,
    COL_CLOSURE,
    COL_INDICES,
    COL_DYNAMIC,
    COL_DYNAMIC_P99,
    COL_DYNAMIC_FPS,
    COL_STATIC_FPS,
    COL_TRIANGLES,
    COL_COUNT
};

static const ReportColumn COLUMNS[COL_COUNT] = {
    [COL_GROUND] = {REPORT_KEY, "ground", "ground", 0},
    [COL_SIDE] = {REPORT_KEY, "size", "side", 0},
    [COL_WHERE] = {REPORT_KEY, "where", "where", 0},
    [COL_PAPER_GENERATION] = {REPORT_PAPER, "generation_ms", "generation, ms", 0},
    [COL_PAPER_ROOT] = {REPORT_PAPER, "generation_root_ms", "root depth, ms", 1},
    [COL_PAPER_DEEPEST] = {REPORT_PAPER, "generation_deepest_ms", "deepest, ms", 2},
    [COL_PAPER_EVALUATION] = {REPORT_PAPER, "evaluation_ms", "evaluation, ms", 2},
    [COL_PAPER_CLOSURE_MAX] = {REPORT_PAPER, "closure_max_ms", "closure, all split, ms", 2},
    [COL_PAPER_CLOSURE] = {REPORT_PAPER, "closure_ms", "closure, ms", 2},
    [COL_PAPER_INDICES] = {REPORT_PAPER, "indices_ms", "indices, ms", 2},
    [COL_PAPER_DYNAMIC] = {REPORT_PAPER, "dynamic_ms", "dynamic phases, ms", 2},
    [COL_PAPER_DYNAMIC_FPS] = {REPORT_PAPER, "dynamic_fps", "dynamic frames/s", 0},
    [COL_PAPER_STATIC_FPS] = {REPORT_PAPER, "static_fps", "static frames/s", 0},
    [COL_GENERATION] = {REPORT_OURS, "generation_ms", "generation, ms", 1},
    [COL_ROOT] = {REPORT_OURS, "generation_root_ms", "root depth, ms", 2},
    [COL_DEEPEST] = {REPORT_OURS, "generation_deepest_ms", "deepest, ms", 2},
    [COL_EVALUATION] = {REPORT_OURS, "evaluation_ms", "evaluation, ms", 2},
    [COL_CLOSURE_MAX] = {REPORT_OURS, "closure_max_ms", "closure, all split, ms", 2},
    [COL_CLOSURE] = {REPORT_OURS, "closure_ms", "closure, ms", 2},
    [COL_INDICES] = {REPORT_OURS, "indices_ms", "indices, ms", 2},
    [COL_DYNAMIC] = {REPORT_OURS, "dynamic_ms", "dynamic phases p50, ms", 2},
    [COL_DYNAMIC_P99] = {REPORT_OURS, "dynamic_p99_ms", "p99, ms", 2},
    [COL_DYNAMIC_FPS] = {REPORT_OURS, "dynamic_drawn_fps", "dynamic frames/s, drawn", 1},
    [COL_STATIC_FPS] = {REPORT_OURS, "static_drawn_fps", "static frames/s, drawn", 1},
    [COL_TRIANGLES] = {REPORT_OURS, "triangles", "triangles, mean", 0},
};
static const ReportTable TABLE = {.id = "table1",
                                  .name = "Table 1: the phases of diamonds",
                                  .source = "table 1, section 9",
                                  .columns = COLUMNS,
                                  .column_count = COL_COUNT};
static const int SIDES[] = {513, 1025, 2049, 4097};

// One terrain, its views, and the times of its phases.
typedef struct Flight {
    Reproduce *run;
    SiteGround ground;
    int side, views;
    Terrain *terrain;
    Circuit circuit;
    bool has_shaders; // the phases ran as compute shaders too: the row before the last is theirs
    Race race;        // of what is drawn
} Flight;
enum { WORKERS, STATIC, SHADERS };

static void set_figures(ReportCell *row, const FiguresDiamond *figures) {
    if (!figures)
        return;
    row[COL_PAPER_GENERATION] = report_number(figures->generation_ms);
    row[COL_PAPER_ROOT] = report_number(figures->generation_root_ms);
    row[COL_PAPER_DEEPEST] = report_number(figures->generation_deepest_ms);
    row[COL_PAPER_EVALUATION] = report_number(figures->evaluation_ms);
    row[COL_PAPER_CLOSURE_MAX] = report_number(figures->closure_max_ms);
    row[COL_PAPER_CLOSURE] = report_number(figures->closure_ms);
    row[COL_PAPER_INDICES] = report_number(figures->indices_ms);
    row[COL_PAPER_DYNAMIC] = report_number(figures->dynamic_ms);
    row[COL_PAPER_DYNAMIC_FPS] = report_number(figures->dynamic_fps);
    row[COL_PAPER_STATIC_FPS] = report_number(figures->static_fps);
}

static void set_times(ReportCell *row, const DiamondsTimes *times) {
    row[COL_GENERATION] = report_number(times->generation_ms);
    row[COL_ROOT] = report_number(times->root_ms);
    row[COL_DEEPEST] = report_number(times->deepest_ms);
    row[COL_EVALUATION] = report_number(times->p50_ms[DIAMONDS_EVALUATION]);
    row[COL_CLOSURE_MAX] = report_number(times->closure_max_ms);
    row[COL_CLOSURE] = report_number(times->p50_ms[DIAMONDS_CLOSURE]);
    row[COL_INDICES] = report_number(times->p50_ms[DIAMONDS_INDICES]);
    row[COL_DYNAMIC] = report_number(times->p50_ms[DIAMONDS_DYNAMIC]);
    row[COL_DYNAMIC_P99] = report_number(times->p99_ms[DIAMONDS_DYNAMIC]);
    row[COL_TRIANGLES] = report_number(times->triangles);
}

static Result add_row(const Flight *flight, const char *where, const DiamondsTimes *times, ReportTable *table) {
    ReportCell *row = report_add_row(table);
    if (!row)
        return RESULT_MEMORY;
    row[COL_GROUND] = report_text(site_ground_name(flight->ground));
    row[COL_SIDE] = report_number(flight->side);
    row[COL_WHERE] = report_text(where);
    set_figures(row, figures_diamond(flight->side));
    set_times(row, times);
    return RESULT_OK;
}

static Result make_diamonds(const Flight *flight, DiamondModel *model, Diamonds *out) {
    *out = (Diamonds){.jobs = flight->run->all,
                      .circuit = &flight->circuit,
                      .model = model,
                      .px_per_rad = reproduce_px_per_rad(HEIGHT),
                      .tau_px = TAU_PX,
                      .views = flight->views};
    out->lens.tan_up = tan(0.5 * REPRODUCE_FOV_DEG * GEODESY_RAD_PER_DEG);
    out->lens.tan_right = out->lens.tan_up * WIDTH / HEIGHT;
    DiamondSelect *select = NULL;
    Result result = diamond_select_create(CRITERION, &out->lens, &select);
    if (result != RESULT_OK)
        return result;
    diamond_select_bind(select, model, &out->program);
    diamond_select_destroy(&select);
    return RESULT_OK;
}

// What the GPU has no room for is left out, not a failure.
static Result time_on_gpu(Flight *flight, Diamonds *diamonds, ReportTable *table) {
    Reproduce *run = flight->run;
    DiamondsTimes times;
    const char *why;
    flight->has_shaders = false;
    if (!run->context)
        return RESULT_OK;
    Result result = diamonds_time_gpu(diamonds, run->context, &times, &why);
    if (result == RESULT_UNSUPPORTED && why) {
        report_note(&run->report.left_out, "%d x %d in compute shaders: %s", flight->side, flight->side, why);
        return RESULT_OK;
    }
    if (result != RESULT_OK)
        return result;
    flight->has_shaders = true;
    return add_row(flight, context_is_software(run->context) ? "shaders (CPU)" : "shaders (GPU)", &times, table);
}

static Result time_model(Flight *flight, DiamondModel *model, ReportTable *table) {
    Diamonds diamonds;
    DiamondsTimes times;
    Result result = make_diamonds(flight, model, &diamonds);
    if (result == RESULT_OK)
        result = time_on_gpu(flight, &diamonds, table);
    if (result == RESULT_OK)
        result = diamonds_time_workers(&diamonds, &times);
    return result == RESULT_OK ? add_row(flight, "workers", &times, table) : result;
}

static bool is_drawn(Flight *flight) {
    Reproduce *run = flight->run;
    if (!run->context || !context_is_software(run->context) || flight->side <= SOFTWARE_SIDE_MAX)
        return run->context != NULL;
    report_note(&run->report.left_out, "drawing %s of %d x %d samples: a software renderer takes too long",
                site_ground_name(flight->ground), flight->side, flight->side);
    return false;
}

static Result enter_racers(Flight *flight) {
    LodOptions dynamic = reproduce_lod_options(LOD_DIAMOND), all = reproduce_lod_options(LOD_BRUTE);
    race_begin(flight->terrain, 1, &flight->race);
    Result result = race_enter(&flight->race, &dynamic, flight->run->all);
    if (result == RESULT_OK)
        result = race_enter(&flight->race, &all, flight->run->all);
    dynamic.resident = true;
    return result == RESULT_OK && flight->has_shaders ? race_enter(&flight->race, &dynamic, flight->run->all) : result;
}

static void set_drawn(ReportCell *row, const Race *race, int dynamic) {
    row[COL_DYNAMIC_FPS] = report_number(race_drawn_fps(race, dynamic));
    row[COL_STATIC_FPS] = report_number(race_drawn_fps(race, STATIC));
}

// The whole path of a frame, as `fly` has it; static is every sample.
static Result draw(Flight *flight, ReportTable *table) {
    if (!is_drawn(flight))
        return RESULT_OK;
    Result result = enter_racers(flight);
    if (result == RESULT_OK)
        result = reproduce_draw(flight->run, &flight->race, &flight->circuit, WIDTH, HEIGHT, TAU_PX, 0.0,
                                1.0 / flight->views);
    ReportCell *row = table->cells + (size_t)table->column_count * (size_t)(table->row_count - 1);
    set_drawn(row, &flight->race, WORKERS);
    if (flight->has_shaders)
        set_drawn(row - table->column_count, &flight->race, SHADERS);
    race_end(&flight->race);
    return result;
}

static Result fly_terrain(Flight *flight, ReportTable *table) {
    Reproduce *run = flight->run;
    DiamondModel model = {0};
    Result result = reproduce_terrain(run, flight->ground, flight->side, &flight->circuit, &flight->terrain);
    if (result != RESULT_OK)
        return result;
    result = diamond_model_create(flight->terrain, 0, 1, run->all, &model);
    if (result == RESULT_OK)
        result = time_model(flight, &model, table);
    diamond_model_destroy(&model);
    if (result == RESULT_OK)
        result = draw(flight, table);
    terrain_destroy(&flight->terrain);
    return result;
}

static void note_set_up(Reproduce *run, const Flight *flight) {
    report_note(&run->report.set_up,
                "Criterion '%s' at tau %g px, %dx%d, %g degrees, %g m above the ground; medians over %d views round "
                "the circuit, all threads",
                CRITERION, TAU_PX, WIDTH, HEIGHT, REPRODUCE_FOV_DEG, REPRODUCE_HEIGHT_M, flight->views);
    report_note(&run->report.set_up,
                "'workers': the phases on the processor; 'shaders': the same phases as compute shaders, timed one by "
                "one; generation is of the total error, once; drawn: a whole frame, tau %g px, against every sample",
                TAU_PX);
    if (run->quick)
        report_note(&run->report.left_out, "table 1: %d of %d views; the phases as compute shaders",
                    FULL_VIEWS - flight->views, FULL_VIEWS);
}

Result reproduce_yalcin(Reproduce *run) {
    int sides[REPRODUCE_SIDES_MAX];
    int count = reproduce_sides(run, "table 1", SIDES, COUNT_OF(SIDES), 3, sides);
    Flight flight = {.run = run, .views = run->quick ? QUICK_VIEWS : FULL_VIEWS};
    ReportTable *table = report_add_table(&run->report, &TABLE);
    note_set_up(run, &flight);
    Progress progress = progress_begin("diamonds");
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
