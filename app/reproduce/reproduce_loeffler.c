// Loeffler, Schwanke, Schumann 2010, section 5, table 2: static patches (Boesch et al. 2009) against the hybrid method
// (section 4) in flight; table 1 is in reproduce_preprocess.c.
#include "app/reproduce/reproduce.h"
#include "app/reproduce/reproduce_figures.h"
#include "base/log.h"

#include <math.h>

#define WIDTH 1280
#define HEIGHT 800
#define SPEED_M_S 100.0
#define FULL_SECONDS 20.0
#define QUICK_SECONDS 1.0

static const int SIDES[] = {1025, 2049, 4097};

enum { PATCH, HYBRID, RACERS };

enum {
    COL_GROUND,
    COL_SIDE,
    COL_TAU,
    COL_PAPER_PATCH_TRIANGLES,
    COL_PAPER_HYBRID_TRIANGLES,
    COL_PAPER_RATIO,
    COL_PAPER_PATCH_FPS,
    COL_PAPER_HYBRID_FPS,
    COL_PATCH_TRIANGLES,
    COL_HYBRID_TRIANGLES,
    COL_RATIO,
    COL_PATCH_P50,
    COL_PATCH_P99,
    COL_HYBRID_P50,
    COL_HYBRID_P99,
    COL_PATCH_FPS,
    COL_HYBRID_FPS,
    COL_PATCH_IN_VIEW,
    COL_HYBRID_IN_VIEW,
    COL_PATCH_DRAWN,
    COL_HYBRID_DRAWN,
    COL_COUNT
};

static const ReportColumn COLUMNS[COL_COUNT] = {
    [COL_GROUND] = {REPORT_KEY, "ground", "ground", 0},
    [COL_SIDE] = {REPORT_KEY, "size", "side", 0},
    [COL_TAU] = {REPORT_KEY, "tau_px", "tau, px", 1},
    [COL_PAPER_PATCH_TRIANGLES] = {REPORT_PAPER, "patch_triangles", "patch triangles", 0},
    [COL_PAPER_HYBRID_TRIANGLES] = {REPORT_PAPER, "hybrid_triangles", "hybrid triangles", 0},
    [COL_PAPER_RATIO] = {REPORT_PAPER, "triangles_ratio", "hybrid / patch", 3},
    [COL_PAPER_PATCH_FPS] = {REPORT_PAPER, "patch_fps", "patch frames/s", 0},
    [COL_PAPER_HYBRID_FPS] = {REPORT_PAPER, "hybrid_fps", "hybrid frames/s", 0},
    [COL_PATCH_TRIANGLES] = {REPORT_OURS, "patch_triangles", "patch triangles", 0},
    [COL_HYBRID_TRIANGLES] = {REPORT_OURS, "hybrid_triangles", "hybrid triangles", 0},
    [COL_RATIO] = {REPORT_OURS, "triangles_ratio", "hybrid / patch", 3},
    [COL_PATCH_P50] = {REPORT_OURS, "patch_update_p50_ms", "patch update p50, ms", 2},
    [COL_PATCH_P99] = {REPORT_OURS, "patch_update_p99_ms", "patch p99, ms", 2},
    [COL_HYBRID_P50] = {REPORT_OURS, "hybrid_update_p50_ms", "hybrid update p50, ms", 2},
    [COL_HYBRID_P99] = {REPORT_OURS, "hybrid_update_p99_ms", "hybrid p99, ms", 2},
    [COL_PATCH_FPS] = {REPORT_OURS, "patch_refined_fps", "patch frames/s, refined", 0},
    [COL_HYBRID_FPS] = {REPORT_OURS, "hybrid_refined_fps", "hybrid frames/s, refined", 0},
    [COL_PATCH_IN_VIEW] = {REPORT_OURS, "patch_triangles_in_view", "patch triangles in view", 0},
    [COL_HYBRID_IN_VIEW] = {REPORT_OURS, "hybrid_triangles_in_view", "hybrid triangles in view", 0},
    [COL_PATCH_DRAWN] = {REPORT_OURS, "patch_drawn_fps", "patch frames/s, drawn", 1},
    [COL_HYBRID_DRAWN] = {REPORT_OURS, "hybrid_drawn_fps", "hybrid frames/s, drawn", 1},
};
static const ReportTable TABLE = {.id = "table2",
                                  .name = "Table 2: static patches and the hybrid method in flight",
                                  .source = "table 2, section 5",
                                  .columns = COLUMNS,
                                  .column_count = COL_COUNT};
static const double TAUS_PX[] = {0.5, 1.0, 2.0};

static void set_hybrid_figures(ReportCell *row, const FiguresHybrid *figures) {
    if (!figures)
        return;
    row[COL_PAPER_PATCH_TRIANGLES] = report_number(figures->patch_triangles);
    row[COL_PAPER_HYBRID_TRIANGLES] = report_number(figures->hybrid_triangles);
    row[COL_PAPER_RATIO] = report_number(figures->hybrid_triangles / figures->patch_triangles);
    row[COL_PAPER_PATCH_FPS] = report_number(figures->patch_fps);
    row[COL_PAPER_HYBRID_FPS] = report_number(figures->hybrid_fps);
}

static void set_race(ReportCell *row, const Race *race) {
    RaceTimes patch = race_times(race, PATCH), hybrid = race_times(race, HYBRID);
    double patch_triangles = race_mean(race, PATCH, race->racers[PATCH].triangles);
    double hybrid_triangles = race_mean(race, HYBRID, race->racers[HYBRID].triangles);
    row[COL_PATCH_TRIANGLES] = report_number(patch_triangles);
    row[COL_HYBRID_TRIANGLES] = report_number(hybrid_triangles);
    row[COL_RATIO] = report_number(hybrid_triangles / patch_triangles);
    row[COL_PATCH_P50] = report_number(patch.p50_ms);
    row[COL_PATCH_P99] = report_number(patch.p99_ms);
    row[COL_HYBRID_P50] = report_number(hybrid.p50_ms);
    row[COL_HYBRID_P99] = report_number(hybrid.p99_ms);
    row[COL_PATCH_FPS] = report_number(patch.fps);
    row[COL_HYBRID_FPS] = report_number(hybrid.fps);
    row[COL_PATCH_IN_VIEW] = report_number(race_drawn_triangles(race, PATCH));
    row[COL_HYBRID_IN_VIEW] = report_number(race_drawn_triangles(race, HYBRID));
    row[COL_PATCH_DRAWN] = report_number(race_drawn_fps(race, PATCH));
    row[COL_HYBRID_DRAWN] = report_number(race_drawn_fps(race, HYBRID));
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
        row[COL_GROUND] = report_text(site_ground_name(flight->ground));
        row[COL_SIDE] = report_number(flight->side);
        row[COL_TAU] = report_number(tau_px);
        set_hybrid_figures(row, figures_hybrid(flight->side, tau_px));
        set_race(row, &race);
    } else if (result == RESULT_OK) {
        result = RESULT_MEMORY;
    }
    race_end(&race);
    return result;
}

static Result fly_terrain(Flight *flight, ReportTable *table) {
    Result result = reproduce_terrain(flight->run, flight->ground, flight->side, &flight->circuit, &flight->terrain);
    if (result != RESULT_OK)
        return result;
    for (size_t i = 0; i < COUNT_OF(TAUS_PX) && result == RESULT_OK; i++)
        result = fly_tau(flight, TAUS_PX[i], table);
    terrain_destroy(&flight->terrain);
    return result;
}

static Result fly_all(Reproduce *run) {
    int sides[REPRODUCE_SIDES_MAX];
    int count = reproduce_sides(run, "table 2", SIDES, COUNT_OF(SIDES), 3, sides);
    double seconds = reproduce_seconds(run, "table 2", FULL_SECONDS, QUICK_SECONDS);
    Flight flight = {.run = run, .frames = (int)fmax(1.0, seconds * REPRODUCE_FRAME_HZ)};
    ReportTable *table = report_add_table(&run->report, &TABLE);
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
    Result result = reproduce_preprocess(run);
    return result == RESULT_OK ? fly_all(run) : result;
}
