// Flights with caching: every cut is whole, keeps its promise, and equals the one refined from scratch.
#include "base/arena.h"
#include "terrain/geodesy.h"
#include "tests/cut_support.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define SEED UINT64_C(4711)
#define FRAMES 300

static const DemGeoref ROUGH = {DEM_CRS_GEOGRAPHIC, 0, false, 12.3, 46.9, 0.0006, -0.0004};

typedef struct Flight {
    const Terrain *terrain;
    Jobs *jobs;
    Lod *lod;
    Arena *frame;
    LodCut cut;
} Flight;

static Flight flight_begin(const Terrain *terrain, Jobs *jobs, bool reuse) {
    Flight flight = {.terrain = terrain, .jobs = jobs};
    LodOptions options = lod_default_options();
    options.reuse = reuse;
    assert_int_equal(lod_create(&options, terrain, &flight.lod), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &flight.frame), RESULT_OK);
    return flight;
}

static void flight_end(Flight *flight) {
    lod_destroy(&flight->lod);
    arena_destroy(&flight->frame);
}

// Gives back what the frame before drew first, as a renderer does that is one frame behind.
static void flight_update(Flight *flight, const LodView *view) {
    if (flight->cut.frame)
        lod_release(flight->lod, flight->cut.frame);
    arena_reset(flight->frame);
    assert_int_equal(lod_update(flight->lod, view, flight->jobs, flight->frame, &flight->cut), RESULT_OK);
}

// Across the DEM in a curve, 20 to 420 m above the ground, the head turning; a jump at two thirds, two changes of
// tolerance.
static LodView view_of_frame(const Terrain *terrain, int frame, double step_share) {
    const Dem *dem = terrain_dem(terrain);
    double t = 0.2 + frame * step_share + (frame >= 2 * FRAMES / 3 ? 0.3 : 0.0);
    double col = t * (dem->width - 1), row = (0.5 + 0.3 * sin(7.0 * t)) * (dem->height - 1);
    double tau = frame < FRAMES / 3 ? 1.0 : frame < FRAMES / 2 ? 0.5 : 2.0;
    LodView view = support_view(support_eye(terrain, col, row, 220.0 + 200.0 * sin(40.0 * t)), tau);
    Vec3d up = vec3d_normalize(view.eye_ecef), north = view.forward_ecef, east = vec3d_cross(north, up);
    double heading = 0.05 * frame;
    view.forward_ecef = vec3d_add(vec3d_scale(north, cos(heading)), vec3d_scale(east, sin(heading)));
    return view;
}

static void print_frame(const Flight *flight, const Measure *m) {
    const LodStats *s = &flight->cut.stats;
    print_message("frame %3" PRIu64 ": tau %.1f, max %.4f px, %6" PRId64 " triangles, %4" PRId64 " of %4" PRId64
                  " patches reused\n",
                  flight->cut.frame, flight->cut.view.tau_px, m->max_px, s->triangles, s->patches_reused, s->patches);
}

// Flies with and without reuse side by side.
static void fly(const Terrain *terrain, Jobs *jobs, double step_share, int measure_every, int compare_every) {
    Flight cached = flight_begin(terrain, jobs, true), scratch = flight_begin(terrain, jobs, false);
    int64_t reused = 0, patches = 0;
    for (int frame = 0; frame < FRAMES; frame++) {
        LodView view = view_of_frame(terrain, frame, step_share);
        flight_update(&cached, &view);
        reused += cached.cut.stats.patches_reused;
        patches += cached.cut.stats.patches;
        if (frame % compare_every == 0) {
            flight_update(&scratch, &view);
            if (support_cut_hash(&cached.cut) != support_cut_hash(&scratch.cut))
                fail_msg("frame %d: %" PRId64 " triangles with reuse, %" PRId64 " without, other bytes", frame,
                         cached.cut.stats.triangles, scratch.cut.stats.triangles);
        }
        if (frame % measure_every == 0 || frame == FRAMES - 1) {
            Measure m = support_check_cut(terrain, &cached.cut, jobs, "flight");
            print_frame(&cached, &m);
        }
    }
    print_message("%.1f %% of patches reused over the flight\n", 100.0 * (double)reused / (double)patches);
    assert_true(reused > 0); // or the flight tests nothing
    flight_end(&cached);
    flight_end(&scratch);
}

static void test_a_flight_over_rough_ground_has_no_cracks(void **state) {
    (void)state;
    Jobs *jobs;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    print_message("seed %" PRIu64 "\n", SEED);
    Terrain *terrain = support_terrain(support_rough_dem(613, 411, &ROUGH, 900.0, SEED), TERRAIN_ERROR_TOTAL, 8, jobs);
    fly(terrain, jobs, 0.001, 10, 1);
    terrain_destroy(&terrain);
    jobs_destroy(&jobs);
}

static void fly_shared(const char *name) {
    Jobs *jobs;
    Geoid *geoid = NULL;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    Terrain *terrain = support_shared_terrain(name, &geoid, jobs);
    if (!terrain) {
        jobs_destroy(&jobs);
        skip();
    }
    fly(terrain, jobs, 0.0001, 60, 30);
    terrain_destroy(&terrain);
    geoid_close(&geoid);
    jobs_destroy(&jobs);
}

static void test_a_flight_over_the_tatra_has_no_cracks(void **state) {
    (void)state;
    fly_shared("tatra_srtm3_2401.tif");
}

static void test_a_flight_over_puget_sound_has_no_cracks(void **state) {
    (void)state;
    fly_shared("puget_utm10_160m_1025.tif");
}

// ---- views that change nothing ----

// Level flight, 100 m/s at 60 Hz, 500 m above the ground at its start: what sections 4.3 and 5 of the paper promise.
static void test_most_patches_are_reused_at_100_metres_a_second(void **state) {
    (void)state;
    Jobs *jobs;
    Geoid *geoid = NULL;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    Terrain *terrain = support_shared_terrain("tatra_srtm3_2401.tif", &geoid, jobs);
    if (!terrain) {
        jobs_destroy(&jobs);
        skip();
    }
    Flight flight = flight_begin(terrain, jobs, true);
    Vec3d eye = support_eye(terrain, 1200.0, 1300.0, 500.0);
    Vec3d step = vec3d_scale(vec3d_normalize(vec3d(-eye.y, eye.x, 0.0)), 100.0 / 60.0);
    double reused = 0.0;
    for (int frame = 0; frame < 120; frame++, eye = vec3d_add(eye, step)) {
        LodView view = support_view(eye, 1.0);
        flight_update(&flight, &view);
        const LodStats *s = &flight.cut.stats;
        reused += frame ? (double)s->patches_reused / (double)s->patches / 119.0 : 0.0;
    }
    print_message("%.1f %% of patches reused\n", 100.0 * reused);
    assert_true(reused >= 0.8);
    flight_end(&flight);
    terrain_destroy(&terrain);
    geoid_close(&geoid);
    jobs_destroy(&jobs);
}

static void test_turning_the_head_changes_no_triangle(void **state) {
    (void)state;
    Jobs *jobs;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    Terrain *terrain = support_terrain(support_rough_dem(257, 300, &ROUGH, 900.0, SEED), TERRAIN_ERROR_TOTAL, 6, jobs);
    Flight flight = flight_begin(terrain, jobs, true);
    LodView view = support_view(support_eye(terrain, 100.0, 140.0, 60.0), 1.0);
    Vec3d up = vec3d_normalize(view.eye_ecef), north = view.forward_ecef, east = vec3d_cross(north, up);
    uint64_t first = 0;
    for (int i = 0; i < 24; i++) {
        view.forward_ecef = vec3d_add(vec3d_scale(north, cos(0.26 * i)), vec3d_scale(east, sin(0.26 * i)));
        if (i % 6 == 5) // straight down: no horizontal direction
            view.forward_ecef = vec3d_scale(up, -1.0);
        flight_update(&flight, &view);
        first = i ? first : support_cut_hash(&flight.cut);
        assert_true(support_cut_hash(&flight.cut) == first);
        assert_true(i == 0 || flight.cut.stats.patches_reused == flight.cut.stats.patches);
    }
    flight_end(&flight);
    terrain_destroy(&terrain);
    jobs_destroy(&jobs);
}

// ---- longitudes ----

static uint64_t hash_at_longitude(double west_deg, Jobs *jobs) {
    DemGeoref georef = {DEM_CRS_GEOGRAPHIC, 0, false, west_deg, -16.5, 0.001, -0.001};
    Terrain *terrain = support_terrain(support_rough_dem(300, 300, &georef, 700.0, SEED), TERRAIN_ERROR_TOTAL, 6, jobs);
    Flight flight = flight_begin(terrain, jobs, true);
    double s = sin(179.9 * GEODESY_RAD_PER_DEG), c = cos(179.9 * GEODESY_RAD_PER_DEG);
    Vec3d eye = geodesy_to_ecef((Geodetic){-16.6 * GEODESY_RAD_PER_DEG, 0.0, 1200.0});
    LodView view = support_view(vec3d(eye.x * c, eye.x * s, eye.z), 1.0);
    flight_update(&flight, &view);
    uint64_t hash = support_cut_hash(&flight.cut);
    support_check_cut(terrain, &flight.cut, jobs, "date line");
    print_message("west %.3f: %" PRId64 " triangles, %016" PRIx64 "\n", west_deg, flight.cut.stats.triangles, hash);
    flight_end(&flight);
    terrain_destroy(&terrain);
    return hash;
}

static void test_a_dem_shifted_by_a_turn_gives_the_same_cut(void **state) {
    (void)state;
    Jobs *jobs;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    uint64_t first = hash_at_longitude(179.75, jobs);
    assert_true(hash_at_longitude(-180.25, jobs) == first);
    assert_true(hash_at_longitude(-540.25, jobs) == first);
    jobs_destroy(&jobs);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_flight_over_rough_ground_has_no_cracks),
        cmocka_unit_test(test_a_flight_over_the_tatra_has_no_cracks),
        cmocka_unit_test(test_a_flight_over_puget_sound_has_no_cracks),
        cmocka_unit_test(test_most_patches_are_reused_at_100_metres_a_second),
        cmocka_unit_test(test_turning_the_head_changes_no_triangle),
        cmocka_unit_test(test_a_dem_shifted_by_a_turn_gives_the_same_cut),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
