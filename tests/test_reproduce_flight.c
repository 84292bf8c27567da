// The flights of `overfly reproduce`: where they go, and the tolerances that are searched for them.
#include "app/reproduce/reproduce_circuit.h"
#include "app/reproduce/reproduce_race.h"
#include "app/reproduce/reproduce_search.h"
#include "cut_support.h"
#include "terrain/geodesy.h"
#include "terrain/grid.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

#define SIDE 257
#define STEP_M 20.0
#define HEIGHT_M 150.0
#define PX_PER_RAD 700.0

typedef struct Fixture {
    Jobs *jobs;
    Terrain *terrain;
    Circuit circuit;
} Fixture;

static int set_up(void **state) {
    static Fixture fixture;
    DemGeoref georef = {.crs = DEM_CRS_UTM, .utm_zone = 33, .utm_north = true, .x0 = 5e5, .y0 = 5.2e6};
    georef.dx = STEP_M;
    georef.dy = -STEP_M;
    assert_int_equal(jobs_create(1, &fixture.jobs), RESULT_OK);
    Dem *dem = support_rough_dem(SIDE, SIDE, &georef, 400.0, 7);
    fixture.terrain = support_terrain(dem, TERRAIN_ERROR_TOTAL, 12, fixture.jobs);
    circuit_plan(fixture.terrain, HEIGHT_M, &fixture.circuit);
    *state = &fixture;
    return 0;
}

static int tear_down(void **state) {
    Fixture *fixture = *state;
    terrain_destroy(&fixture->terrain);
    jobs_destroy(&fixture->jobs);
    return 0;
}

static void the_circuit_keeps_its_height_above_the_ground(void **state) {
    Fixture *fixture = *state;
    double least = INFINITY;
    for (int i = 0; i < CIRCUIT_STATIONS; i++) {
        Viewpoint at = circuit_at(&fixture->circuit, (double)i / CIRCUIT_STATIONS);
        double ground_m;
        if (!terrain_ground_m(fixture->terrain, at.lat_deg, at.lon_deg, &ground_m))
            fail_msg("station %d is outside the terrain", i);
        least = fmin(least, at.alt_m - ground_m);
    }
    print_message("least height above the ground: %.2f m, wanted %g\n", least, HEIGHT_M);
    assert_true(least >= HEIGHT_M - 1e-6);
}

static Vec3d eye_at(const Circuit *circuit, double part) {
    Viewpoint at = circuit_at(circuit, part);
    return circuit_view(&at, PX_PER_RAD, 1.0).eye_ecef;
}

static void the_circuit_is_a_closed_circle_of_known_length(void **state) {
    Fixture *fixture = *state;
    double apart = vec3d_distance(eye_at(&fixture->circuit, 0.0), eye_at(&fixture->circuit, 1.0));
    double wanted = 2.0 * GEODESY_PI * 0.3 * (SIDE - 1) * STEP_M;
    print_message("start and end %g m apart; length %.1f m, a circle's %.1f\n", apart, fixture->circuit.length_m,
                  wanted);
    assert_true(apart < 1e-3);
    assert_true(fabs(fixture->circuit.length_m / wanted - 1.0) < 2e-3); // UTM's scale, and the polygon's corners
}

static void one_looks_along_the_circuit(void **state) {
    Fixture *fixture = *state;
    for (int i = 0; i < 8; i++) {
        double part = i / 8.0;
        Viewpoint at = circuit_at(&fixture->circuit, part);
        at.pitch_deg = 0.0;
        Vec3d along = vec3d_sub(eye_at(&fixture->circuit, part + 1e-4), eye_at(&fixture->circuit, part - 1e-4));
        Vec3d up = geodesy_up(at.lat_deg * GEODESY_RAD_PER_DEG, at.lon_deg * GEODESY_RAD_PER_DEG);
        along = vec3d_normalize(vec3d_mad(along, up, -vec3d_dot(along, up)));
        double cosine = vec3d_dot(along, viewpoint_forward(&at));
        if (!(cosine > 0.9999))
            fail_msg("at part %g the heading %g is off the way by %g degrees", part, at.heading_deg,
                     acos(cosine) / GEODESY_RAD_PER_DEG);
    }
}

static double mean_triangles(const Fixture *fixture, double tau_px, int probes) {
    LodOptions options = lod_default_options();
    Race race;
    race_begin(fixture->terrain, probes, &race);
    assert_int_equal(race_enter(&race, &options, fixture->jobs), RESULT_OK);
    for (int i = 0; i < probes; i++) {
        Viewpoint at = circuit_at(&fixture->circuit, (i + 0.5) / probes);
        LodView view = circuit_view(&at, PX_PER_RAD, tau_px);
        assert_int_equal(race_step(&race, &view, true), RESULT_OK);
    }
    double mean = race_mean(&race, 0, race.racers[0].triangles);
    race_end(&race);
    return mean;
}

static void a_tolerance_is_found_for_the_triangles_wanted(void **state) {
    Fixture *fixture = *state;
    static const double WANTED[] = {60000.0, 20000.0, 3000.0, 9000.0};
    LodOptions options = lod_default_options();
    Search search;
    assert_int_equal(search_begin(&fixture->circuit, &options, fixture->jobs, PX_PER_RAD, 1.0, 5, &search), RESULT_OK);
    for (size_t i = 0; i < COUNT_OF(WANTED); i++) {
        double tau_px;
        assert_int_equal(search_tau(&search, WANTED[i], &tau_px), RESULT_OK);
        double found = mean_triangles(fixture, tau_px, 5);
        print_message("wanted %g triangles: tau %.4f px gives %.0f\n", WANTED[i], tau_px, found);
        assert_true(fabs(found / WANTED[i] - 1.0) <= 0.02);
    }
    search_end(&search);
}

static void more_triangles_than_there_are_end_at_the_least_tolerance(void **state) {
    Fixture *fixture = *state;
    LodOptions options = lod_default_options();
    Search search;
    double tau_px;
    assert_int_equal(search_begin(&fixture->circuit, &options, fixture->jobs, PX_PER_RAD, 1.0, 2, &search), RESULT_OK);
    assert_int_equal(search_tau(&search, 1e9, &tau_px), RESULT_OK);
    print_message("tau %g px\n", tau_px);
    assert_true(tau_px >= SEARCH_TAU_LEAST_PX && tau_px < 0.02);
    search_end(&search);
}

static void racers_take_turns_and_count_alike(void **state) {
    Fixture *fixture = *state;
    LodOptions hybrid = lod_default_options(), brute = lod_default_options();
    brute.method = LOD_BRUTE;
    Race race;
    race_begin(fixture->terrain, 3, &race);
    assert_int_equal(race_enter(&race, &hybrid, fixture->jobs), RESULT_OK);
    assert_int_equal(race_enter(&race, &brute, fixture->jobs), RESULT_OK);
    for (int i = -1; i < 5; i++) { // one more to warm up, two more than there is room for
        Viewpoint at = circuit_at(&fixture->circuit, 0.1 * i);
        LodView view = circuit_view(&at, PX_PER_RAD, 1.0);
        assert_int_equal(race_step(&race, &view, i >= 0), RESULT_OK);
    }
    assert_int_equal(race_measure(&race, fixture->jobs), RESULT_OK);
    print_message("frames %d and %d; errors %g and %g px\n", race.racers[0].frames, race.racers[1].frames,
                  race.racers[0].max_px, race.racers[1].max_px);
    assert_int_equal(race.racers[0].frames, 3);
    assert_int_equal(race.racers[1].frames, 3);
    assert_true(race_mean(&race, 1, race.racers[1].triangles) == 2.0 * (SIDE - 1) * (SIDE - 1));
    assert_true(race.racers[0].max_px <= 1.0 && race.racers[1].max_px < 0.01);
    RaceTimes times = race_times(&race, 0);
    assert_true(times.p50_ms > 0.0 && times.p99_ms >= times.p50_ms && times.fps > 0.0);
    assert_true(race_ratio(&race, 1, 0) * race_ratio(&race, 0, 1) > 0.0);
    assert_true(isnan(race_drawn_fps(&race, 0)));
    race_end(&race);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_circuit_keeps_its_height_above_the_ground),
        cmocka_unit_test(the_circuit_is_a_closed_circle_of_known_length),
        cmocka_unit_test(one_looks_along_the_circuit),
        cmocka_unit_test(a_tolerance_is_found_for_the_triangles_wanted),
        cmocka_unit_test(more_triangles_than_there_are_end_at_the_least_tolerance),
        cmocka_unit_test(racers_take_turns_and_count_alike),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
