// Biedermann, Rivara, section 5, table 1: a flight of 230 seconds round a circuit at ten levels of detail, the serial
// tessellation (section 3) against the uncoupled parallel one (section 4) on two processors.
#include "app/reproduce/reproduce.h"
#include "app/reproduce/reproduce_figures.h"
#include "app/reproduce/reproduce_search.h"
#include "base/log.h"

#include <math.h>

#define WIDTH 1280
#define HEIGHT 800
#define FLIGHT_SECONDS 230.0
#define FULL_HZ 1.0
#define QUICK_POSITIONS 12
#define WORKERS 2
#define SECTORS_A_WORKER 2 // of equal predicted work: the part that the paper left open
#define FULL_PROBES 24
#define QUICK_PROBES 6
#define TRIANGLES_PER_VERTEX 2.0 // Euler: T = 2 V less the rim

enum { SERIAL, PARALLEL, SECTORS };

enum {
    COL_GROUND,
    COL_SIDE,
    COL_VERTICES,
    COL_PAPER_SERIAL,
    COL_PAPER_PARALLEL,
    COL_PAPER_INCREASE,
    COL_TAU,
    COL_FOUND,
    COL_OFF,
    COL_SERIAL_P50,
    COL_SERIAL_P99,
    COL_PARALLEL_P50,
    COL_PARALLEL_P99,
    COL_SERIAL_FPS,
    COL_PARALLEL_FPS,
    COL_INCREASE,
    COL_NS,
    COL_BALANCE,
    COL_SURPLUS,
    COL_SERIAL_DRAWN,
    COL_PARALLEL_DRAWN,
    COL_SECTORS_P50,
    COL_SECTORS_P99,
    COL_SECTORS_INCREASE,
    COL_SECTORS_BALANCE,
    COL_SECTORS_SURPLUS,
    COL_COUNT
};

static const ReportColumn COLUMNS[COL_COUNT] = {
    [COL_GROUND] = {REPORT_KEY, "ground", "ground", 0},
    [COL_SIDE] = {REPORT_KEY, "size", "side", 0},
    [COL_VERTICES] = {REPORT_KEY, "vertices", "vertices a frame", 0},
    [COL_PAPER_SERIAL] = {REPORT_PAPER, "serial_fps", "serial frames/s", 2},
    [COL_PAPER_PARALLEL] = {REPORT_PAPER, "parallel_fps", "parallel frames/s", 2},
    [COL_PAPER_INCREASE] = {REPORT_PAPER, "increase_percent", "increase, %", 2},
    [COL_TAU] = {REPORT_OURS, "tau_px", "tau, px", 3},
    [COL_FOUND] = {REPORT_OURS, "vertices", "vertices, mean", 0},
    [COL_OFF] = {REPORT_OURS, "vertices_off_percent", "off the aim, %", 1},
    [COL_SERIAL_P50] = {REPORT_OURS, "serial_update_p50_ms", "serial update p50, ms", 2},
    [COL_SERIAL_P99] = {REPORT_OURS, "serial_update_p99_ms", "serial p99, ms", 2},
    [COL_PARALLEL_P50] = {REPORT_OURS, "parallel_update_p50_ms", "parallel update p50, ms", 2},
    [COL_PARALLEL_P99] = {REPORT_OURS, "parallel_update_p99_ms", "parallel p99, ms", 2},
    [COL_SERIAL_FPS] = {REPORT_OURS, "serial_refined_fps", "serial frames/s, refined", 1},
    [COL_PARALLEL_FPS] = {REPORT_OURS, "parallel_refined_fps", "parallel frames/s, refined", 1},
    [COL_INCREASE] = {REPORT_OURS, "increase_percent", "increase, %", 1},
    [COL_NS] = {REPORT_OURS, "serial_ns_per_triangle", "serial, ns a triangle", 0},
    [COL_BALANCE] = {REPORT_OURS, "balance", "longest partition / mean", 3},
    [COL_SURPLUS] = {REPORT_OURS, "surplus_percent", "surplus triangles, %", 3},
    [COL_SERIAL_DRAWN] = {REPORT_OURS, "serial_drawn_fps", "serial frames/s, drawn", 2},
    [COL_PARALLEL_DRAWN] = {REPORT_OURS, "parallel_drawn_fps", "parallel frames/s, drawn", 2},
    [COL_SECTORS_P50] = {REPORT_OURS, "sectors_update_p50_ms", "sectors update p50, ms", 2},
    [COL_SECTORS_P99] = {REPORT_OURS, "sectors_update_p99_ms", "sectors p99, ms", 2},
    [COL_SECTORS_INCREASE] = {REPORT_OURS, "sectors_increase_percent", "sectors increase, %", 1},
    [COL_SECTORS_BALANCE] = {REPORT_OURS, "sectors_balance", "longest sector / mean", 3},
    [COL_SECTORS_SURPLUS] = {REPORT_OURS, "sectors_surplus_percent", "sectors' surplus triangles, %", 3},
};
static const ReportTable TABLE = {.id = "table1",
                                  .name = "Table 1: serial and uncoupled parallel tessellation",
                                  .source = "table 1, section 5",
                                  .columns = COLUMNS,
                                  .column_count = COL_COUNT};
static const int SIDES[] = {2049};

typedef struct Flight {
    Reproduce *run;
    Jobs *two;
    Circuit circuit;
    Search search;
    SiteGround ground;
    int side, positions;
    double tau_px; // of the present level of detail
} Flight;

// Built anew in each frame, as the paper's: positions may lie far apart.
static LodOptions roam_options(LodMethod method, int partitions) {
    LodOptions options = reproduce_lod_options(method);
    options.reuse = false;
    options.partitions = partitions;
    return options;
}

static void set_figures(ReportCell *row, const FiguresUncoupled *figures) {
    row[COL_VERTICES] = report_number(figures->vertices);
    row[COL_PAPER_SERIAL] = report_number(figures->serial_fps);
    row[COL_PAPER_PARALLEL] = report_number(figures->parallel_fps);
    row[COL_PAPER_INCREASE] = report_number(figures->increase_percent);
}

static double surplus_percent(const Race *race, int racer) {
    double serial = race_mean(race, SERIAL, race->racers[SERIAL].triangles);
    return 100.0 * (race_mean(race, racer, race->racers[racer].triangles) / serial - 1.0);
}

static void set_sectors(ReportCell *row, const Race *race) {
    RaceTimes times = race_times(race, SECTORS);
    row[COL_SECTORS_P50] = report_number(times.p50_ms);
    row[COL_SECTORS_P99] = report_number(times.p99_ms);
    row[COL_SECTORS_INCREASE] = report_number(100.0 * (race_ratio(race, SERIAL, SECTORS) - 1.0));
    row[COL_SECTORS_BALANCE] = report_number(race_mean(race, SECTORS, race->racers[SECTORS].balance));
    row[COL_SECTORS_SURPLUS] = report_number(surplus_percent(race, SECTORS));
}

static void set_race(ReportCell *row, const Flight *flight, const Race *race, int aim) {
    RaceTimes serial = race_times(race, SERIAL), parallel = race_times(race, PARALLEL);
    const Racer *one = &race->racers[SERIAL], *two = &race->racers[PARALLEL];
    double triangles = race_mean(race, SERIAL, one->triangles), vertices = triangles / TRIANGLES_PER_VERTEX;
    row[COL_TAU] = report_number(flight->tau_px);
    row[COL_FOUND] = report_number(vertices);
    row[COL_OFF] = report_number(100.0 * (vertices / aim - 1.0));
    row[COL_SERIAL_P50] = report_number(serial.p50_ms);
    row[COL_SERIAL_P99] = report_number(serial.p99_ms);
    row[COL_PARALLEL_P50] = report_number(parallel.p50_ms);
    row[COL_PARALLEL_P99] = report_number(parallel.p99_ms);
    row[COL_SERIAL_FPS] = report_number(serial.fps);
    row[COL_PARALLEL_FPS] = report_number(parallel.fps);
    row[COL_INCREASE] = report_number(100.0 * (race_ratio(race, SERIAL, PARALLEL) - 1.0));
    row[COL_NS] = report_number(1e9 / serial.fps / triangles);
    row[COL_BALANCE] = report_number(race_mean(race, PARALLEL, two->balance));
    row[COL_SURPLUS] = report_number(surplus_percent(race, PARALLEL));
    row[COL_SERIAL_DRAWN] = report_number(race_drawn_fps(race, SERIAL));
    row[COL_PARALLEL_DRAWN] = report_number(race_drawn_fps(race, PARALLEL));
    set_sectors(row, race);
}

static Result enter_racers(const Flight *flight, Race *race) {
    LodOptions serial = roam_options(LOD_ROAM, 1), parallel = roam_options(LOD_ROAM_PARALLEL, WORKERS);
    LodOptions sectors = roam_options(LOD_ROAM_PARALLEL, SECTORS_A_WORKER * WORKERS);
    Result result = race_enter(race, &serial, flight->run->one);
    if (result == RESULT_OK)
        result = race_enter(race, &parallel, flight->two);
    if (result == RESULT_OK)
        result = race_enter(race, &sectors, flight->two);
    return result;
}

static Result fly(const Flight *flight, Race *race) {
    double step = 1.0 / flight->positions;
    Result result = RESULT_OK;
    for (int i = -1; i < flight->positions && result == RESULT_OK; i++) { // the first one makes the pools
        Viewpoint at = circuit_at(&flight->circuit, i * step);
        LodView view = circuit_view(&at, reproduce_px_per_rad(HEIGHT), flight->tau_px);
        result = race_step(race, &view, i >= 0);
    }
    if (result == RESULT_OK)
        result = reproduce_draw(flight->run, race, &flight->circuit, WIDTH, HEIGHT, flight->tau_px, 0.0, step);
    return result;
}

static Result fly_level(Flight *flight, const FiguresUncoupled *figures, ReportTable *table) {
    Race race;
    race_begin(flight->circuit.terrain, flight->positions, &race);
    Result result = search_tau(&flight->search, TRIANGLES_PER_VERTEX * figures->vertices, &flight->tau_px);
    if (result == RESULT_OK)
        result = enter_racers(flight, &race);
    if (result == RESULT_OK)
        result = fly(flight, &race);
    ReportCell *row = result == RESULT_OK ? report_add_row(table) : NULL;
    if (row) {
        row[COL_GROUND] = report_text(site_ground_name(flight->ground));
        row[COL_SIDE] = report_number(flight->side);
        set_figures(row, figures);
        set_race(row, flight, &race, figures->vertices);
    } else if (result == RESULT_OK) {
        result = RESULT_MEMORY;
    }
    race_end(&race);
    return result;
}

static Result fly_levels(Flight *flight, ReportTable *table) {
    LodOptions serial = roam_options(LOD_ROAM, 1);
    int probes = flight->run->quick ? QUICK_PROBES : FULL_PROBES;
    Result result = search_begin(&flight->circuit, &serial, flight->run->one, reproduce_px_per_rad(HEIGHT), 1.0, probes,
                                 &flight->search);
    Progress progress = progress_begin(site_ground_name(flight->ground));
    for (int i = 0; i < FIGURES_UNCOUPLED_COUNT && result == RESULT_OK; i++) {
        result = fly_level(flight, &figures_uncoupled[i], table);
        progress_update(&progress, (i + 1.0) / FIGURES_UNCOUPLED_COUNT);
    }
    progress_end(&progress);
    search_end(&flight->search);
    return result;
}

static Result fly_terrain(Flight *flight, ReportTable *table) {
    Terrain *terrain = NULL;
    Result result = reproduce_terrain(flight->run, flight->ground, flight->side, &flight->circuit, &terrain);
    if (result != RESULT_OK)
        return result;
    result = fly_levels(flight, table);
    terrain_destroy(&terrain);
    return result;
}

static void note_set_up(Reproduce *run, const Flight *flight) {
    report_note(&run->report.set_up,
                "Once round the circuit in %g s, of which %d positions, %.3g s apart, are refined; %dx%d, %g degrees, "
                "%g m above the ground; the mesh is built anew at each",
                FLIGHT_SECONDS, flight->positions, FLIGHT_SECONDS / flight->positions, WIDTH, HEIGHT, REPRODUCE_FOV_DEG,
                REPRODUCE_HEIGHT_M);
    report_note(
        &run->report.set_up,
        "The tolerance of each row is searched for its vertices; vertices are triangles / 2; serial: 1 thread; "
        "parallel: the 2 sides of the plane of sight, %d threads; sectors: %d of equal predicted work, as many "
        "threads; each refines each position in turn, increase is the median of the positions' ratios to serial",
        WORKERS, SECTORS_A_WORKER * WORKERS);
    if (run->quick)
        report_note(&run->report.left_out, "the rough synthetic ground");
}

static int count_positions(Reproduce *run) {
    int full = (int)(FLIGHT_SECONDS * FULL_HZ);
    if (run->seconds > 0.0)
        return (int)fmax(1.0, run->seconds * FULL_HZ);
    if (run->quick)
        report_note(&run->report.left_out, "all but %d of %d positions of the flight", QUICK_POSITIONS, full);
    return run->quick ? QUICK_POSITIONS : full;
}

Result reproduce_biedermann(Reproduce *run) {
    int sides[REPRODUCE_SIDES_MAX];
    int count = reproduce_sides(run, "table 1", SIDES, COUNT_OF(SIDES), 1, sides);
    Flight flight = {.run = run, .positions = count_positions(run)};
    ReportTable *table = report_add_table(&run->report, &TABLE);
    int grounds = run->quick ? 1 : SITE_GROUND_COUNT;
    note_set_up(run, &flight);
    Result result = jobs_create(WORKERS, &flight.two);
    for (int i = 0; i < grounds * count && result == RESULT_OK; i++) {
        flight.ground = (SiteGround)(i / count);
        flight.side = sides[i % count];
        result = fly_terrain(&flight, table);
    }
    if (flight.two)
        jobs_destroy(&flight.two);
    return result;
}
