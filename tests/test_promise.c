// The promise over shapes, sizes, places and views that are hard: every sample within the tolerance, every cut whole.
#include "base/arena.h"
#include "base/log.h"
#include "terrain/geodesy.h"
#include "terrain/mesh/mesh.h"
#include "tests/cut_support.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define SEED UINT64_C(90125)

typedef struct Bench {
    Jobs *jobs;
    Terrain *terrain;
    Lod *lod;
    Arena *frame;
    LodCut cut;
} Bench;

static Bench bench_of(Dem *dem, TerrainErrorKind error, int patch_level, int64_t max_triangles) {
    Bench b = {0};
    LodOptions options = lod_default_options();
    if (max_triangles)
        options.max_triangles = max_triangles;
    assert_int_equal(jobs_create(2, &b.jobs), RESULT_OK);
    b.terrain = support_terrain(dem, error, patch_level, b.jobs);
    assert_int_equal(lod_create(&options, b.terrain, &b.lod), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &b.frame), RESULT_OK);
    return b;
}

static void bench_end(Bench *b) {
    lod_destroy(&b->lod);
    arena_destroy(&b->frame);
    terrain_destroy(&b->terrain);
    jobs_destroy(&b->jobs);
}

static Result bench_update(Bench *b, const LodView *view) {
    if (b->cut.frame)
        lod_release(b->lod, b->cut.frame);
    arena_reset(b->frame);
    return lod_update(b->lod, view, b->jobs, b->frame, &b->cut);
}

static Measure bench_check(Bench *b, const LodView *view, const char *what) {
    Result result = bench_update(b, view);
    if (result != RESULT_OK)
        fail_msg("%s: %s at tau %g, expected OK", what, result_name(result), view->tau_px);
    return support_check_cut(b->terrain, &b->cut, b->jobs, what);
}

// ---- shapes ----

typedef float Shape(int col, int row);

static float shape_flat(int col, int row) {
    (void)col, (void)row;
    return 123.0f;
}
static float shape_tilted(int col, int row) {
    return (float)(3 * col - 2 * row);
}
static float shape_spike(int col, int row) {
    return col == 37 && row == 51 ? 10000.0f : 0.0f;
}
static float shape_cliff(int col, int row) {
    return 2 * col + row > 190 ? 3000.0f : -50.0f;
}
static float shape_checkers(int col, int row) {
    return (col + row) % 2 ? 900.0f : 100.0f;
}
static float shape_teeth(int col, int row) {
    (void)row;
    return (float)(col % 3) * 150.0f;
}
static float shape_bowl(int col, int row) {
    return 0.3f * (float)((col - 60) * (col - 60) + (row - 50) * (row - 50));
}

static const struct {
    const char *name;
    Shape *shape;
} SHAPES[] = {{"flat", shape_flat},         {"tilted", shape_tilted}, {"spike", shape_spike}, {"cliff", shape_cliff},
              {"checkers", shape_checkers}, {"teeth", shape_teeth},   {"bowl", shape_bowl}};

static Dem *dem_of_shape(Shape *shape, int width, int height, const DemGeoref *georef) {
    Dem *dem = NULL;
    assert_int_equal(dem_create(width, height, georef, DEM_DATUM_ELLIPSOID, &dem), RESULT_OK);
    for (int row = 0; row < height; row++)
        for (int col = 0; col < width; col++)
            dem->height_m[row * width + col] = shape(col, row);
    return dem;
}

static LodView random_view(const Bench *b, uint64_t *random) {
    const Dem *dem = terrain_dem(b->terrain);
    double col = support_between(random, -0.3, 1.3) * dem->width,
           row = support_between(random, -0.3, 1.3) * dem->height;
    double above = pow(10.0, support_between(random, -1.0, 4.5));
    if (support_random(random) % 8 == 0)
        above = -above; // under the ground
    return support_view(support_eye(b->terrain, col, row, above), pow(10.0, support_between(random, -1.0, 1.5)));
}

static void check_shape(int i, uint64_t *random) {
    const DemGeoref georef = {DEM_CRS_GEOGRAPHIC, 0, false, 7.0, 46.0, 0.001, -0.0008};
    Bench b = bench_of(dem_of_shape(SHAPES[i].shape, 130, 101, &georef), TERRAIN_ERROR_TOTAL, 6, 0);
    double worst = 0.0;
    int64_t most = 0;
    for (int k = 0; k < 25; k++) {
        LodView view = random_view(&b, random);
        Measure m = bench_check(&b, &view, SHAPES[i].name);
        worst = fmax(worst, m.max_px / view.tau_px);
        most = b.cut.stats.triangles > most ? b.cut.stats.triangles : most;
    }
    print_message("%-9s at most %.4f of the tolerance, %" PRId64 " triangles\n", SHAPES[i].name, worst, most);
    bench_end(&b);
}

static void test_hard_shapes_are_drawn_within_the_tolerance(void **state) {
    (void)state;
    uint64_t random = SEED;
    print_message("seed %" PRIu64 "\n", random);
    for (int i = 0; i < (int)COUNT_OF(SHAPES); i++)
        check_shape(i, &random);
}

static void test_a_plane_takes_few_triangles(void **state) {
    (void)state;
    const DemGeoref georef = {DEM_CRS_GEOGRAPHIC, 0, false, 7.0, 0.05, 0.0001, -0.0001};
    Bench b = bench_of(dem_of_shape(shape_flat, 257, 257, &georef), TERRAIN_ERROR_TOTAL, 4, 0);
    LodView view = support_view(support_eye(b.terrain, 128.0, 128.0, 5000.0), 4.0);
    bench_check(&b, &view, "plane");
    print_message("%" PRId64 " triangles for a plane of one base tile\n", b.cut.stats.triangles);
    assert_int_equal(b.cut.stats.triangles, 2);
    bench_end(&b);
}

// ---- sizes ----

static void check_size(int width, int height, int patch_level, uint64_t *random) {
    const DemGeoref georef = {DEM_CRS_GEOGRAPHIC, 0, false, 7.0, 46.0, 0.0005, -0.0003};
    Dem *dem = support_rough_dem(width, height, &georef, 500.0, SEED);
    Bench b = bench_of(dem, TERRAIN_ERROR_TOTAL, patch_level, 0);
    char what[64];
    snprintf(what, sizeof what, "%d x %d, patch level %d", width, height, patch_level);
    for (int k = 0; k < 8; k++) {
        LodView view = random_view(&b, random);
        bench_check(&b, &view, what);
    }
    bench_end(&b);
}

static void test_any_size_is_covered(void **state) {
    (void)state;
    static const int SIZES[][2] = {{2, 2},  {3, 2},   {2, 3},   {2, 700},  {513, 2},   {4, 4},     {5, 3},
                                   {17, 9}, {33, 33}, {65, 66}, {127, 64}, {333, 257}, {1030, 130}};
    uint64_t random = SEED + 1;
    print_message("seed %" PRIu64 "\n", random);
    for (size_t i = 0; i < COUNT_OF(SIZES); i++)
        for (int patch_level = 2; patch_level <= 12; patch_level += 2)
            check_size(SIZES[i][0], SIZES[i][1], patch_level, &random);
}

// ---- holes ----

static bool is_open(int col, int row) {
    return (col >= 40 && col < 46 && row >= 30 && row < 33) || (col == 64 && row == 64) || (col == 0 && row == 99);
}

// Cells that no open sample touches are covered, triangles at open samples are gone, at any tolerance.
static void test_holes_keep_their_shape(void **state) {
    (void)state;
    enum { WIDTH = 130, HEIGHT = 101 };
    const DemGeoref georef = {DEM_CRS_GEOGRAPHIC, 0, false, 7.0, 46.0, 0.0005, -0.0003};
    Dem *dem = support_rough_dem(WIDTH, HEIGHT, &georef, 500.0, SEED);
    dem->void_bits = calloc((WIDTH * HEIGHT + 7) / 8, 1);
    int touched = 0;
    for (int row = 0; row < HEIGHT; row++) {
        for (int col = 0; col < WIDTH; col++) {
            int i = row * WIDTH + col;
            dem->void_bits[i >> 3] = (uint8_t)(dem->void_bits[i >> 3] | is_open(col, row) << (i & 7));
            touched +=
                col + 1 < WIDTH && row + 1 < HEIGHT &&
                (is_open(col, row) || is_open(col + 1, row) || is_open(col, row + 1) || is_open(col + 1, row + 1));
        }
    }
    Bench b = bench_of(dem, TERRAIN_ERROR_TOTAL, 6, 0);
    for (double tau = 0.5; tau < 1e6; tau *= 16.0) {
        LodView view = support_view(support_eye(b.terrain, 64.0, 50.0, 800.0), tau);
        bench_check(&b, &view, "holes");
        Mesh mesh;
        assert_int_equal(mesh_from_cut(b.terrain, &b.cut, &mesh), RESULT_OK);
        int64_t doubled_area = 0;
        for (int64_t i = 0; i < mesh.triangle_count; i++) {
            const MeshVertex *v[3];
            for (int k = 0; k < 3; k++) {
                v[k] = &mesh.vertices[mesh.indices[3 * i + k]];
                assert_false(is_open((int)v[k]->col, (int)v[k]->row));
            }
            doubled_area += llabs((int64_t)((v[1]->col - v[0]->col) * (v[2]->row - v[0]->row)) -
                                  (int64_t)((v[1]->row - v[0]->row) * (v[2]->col - v[0]->col)));
        }
        int64_t missing = 2 * (WIDTH - 1) * (HEIGHT - 1) - doubled_area;
        print_message("tau %g: %" PRId64 " triangles, %g cells open of %d touched\n", tau, mesh.triangle_count,
                      0.5 * (double)missing, touched);
        assert_true(missing <= 2 * touched && missing > touched);
        mesh_clear(&mesh);
    }
    bench_end(&b);
}

// ---- places ----

static void test_any_place_on_earth_keeps_the_promise(void **state) {
    (void)state;
    static const struct {
        const char *name;
        DemGeoref georef;
    } PLACES[] = {
        {"equator", {DEM_CRS_GEOGRAPHIC, 0, false, -0.05, 0.03, 0.0005, -0.0005}},
        {"near the north pole", {DEM_CRS_GEOGRAPHIC, 0, false, 20.0, 90.0, 0.2, -0.0005}},
        {"south pole", {DEM_CRS_GEOGRAPHIC, 0, false, -90.0, -89.9, 0.1, -0.0005}},
        {"date line", {DEM_CRS_GEOGRAPHIC, 0, false, 179.9, 52.0, 0.001, -0.001}},
        {"a third of the Earth", {DEM_CRS_GEOGRAPHIC, 0, false, -60.0, 60.0, 0.5, -0.5}},
        {"UTM, far off its meridian", {DEM_CRS_UTM, 31, true, 940000.0, 4000000.0, 30.0, -30.0}},
        {"UTM, oblong cells", {DEM_CRS_UTM, 12, false, 400000.0, 7000000.0, 500.0, -90.0}},
    };
    uint64_t random = SEED + 2;
    print_message("seed %" PRIu64 "\n", random);
    for (size_t i = 0; i < COUNT_OF(PLACES); i++) {
        Dem *dem = support_rough_dem(190, 140, &PLACES[i].georef, 600.0, SEED);
        Bench b = bench_of(dem, TERRAIN_ERROR_TOTAL, 6, 0);
        double worst = 0.0;
        for (int k = 0; k < 20; k++) {
            LodView view = random_view(&b, &random);
            Measure m = bench_check(&b, &view, PLACES[i].name);
            worst = fmax(worst, m.max_px / view.tau_px);
        }
        print_message("%-26s at most %.4f of the tolerance\n", PLACES[i].name, worst);
        bench_end(&b);
    }
}

// ---- real terrain ----

static void check_real(Bench *b, const char *name) {
    static const double TAUS[] = {0.5, 1.0, 2.0, 4.0}, EYES[][3] = {{0.41, 0.37, 40.0}, {0.7, 0.55, 15000.0}};
    const Dem *dem = terrain_dem(b->terrain);
    for (size_t e = 0; e < COUNT_OF(EYES); e++)
        for (size_t t = 0; t < COUNT_OF(TAUS); t++) {
            Vec3d eye = support_eye(b->terrain, EYES[e][0] * dem->width, EYES[e][1] * dem->height, EYES[e][2]);
            LodView view = support_view(eye, TAUS[t]);
            Measure m = bench_check(b, &view, name);
            print_message("%s, %5.0f m up, tau %.1f: max %.4f px, p99.9 %.4f, rms %.4f, %" PRId64 " triangles\n", name,
                          EYES[e][2], TAUS[t], m.max_px, m.p999_px, m.rms_px, b->cut.stats.triangles);
        }
}

static void check_shared(const char *name) {
    Geoid *geoid = NULL;
    Bench b = {0};
    LodOptions options = lod_default_options();
    assert_int_equal(jobs_create(2, &b.jobs), RESULT_OK);
    b.terrain = support_shared_terrain(name, &geoid, b.jobs);
    if (!b.terrain) {
        jobs_destroy(&b.jobs);
        skip();
    }
    assert_int_equal(lod_create(&options, b.terrain, &b.lod), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &b.frame), RESULT_OK);
    check_real(&b, name);
    bench_end(&b);
    geoid_close(&geoid);
}

static void test_puget_sound_keeps_the_promise(void **state) {
    (void)state;
    check_shared("puget_utm10_160m_1025.tif");
}

static void test_maui_keeps_the_promise(void **state) {
    (void)state;
    check_shared("maui_utm4n_40m_2049.tif");
}

static void test_the_tatra_keep_the_promise(void **state) {
    (void)state;
    check_shared("tatra_srtm3_2401.tif");
}

// ---- eyes and tolerances ----

static Bench rough_bench(TerrainErrorKind error, int64_t max_triangles) {
    const DemGeoref georef = {DEM_CRS_GEOGRAPHIC, 0, false, 12.3, 46.9, 0.0006, -0.0004};
    return bench_of(support_rough_dem(301, 260, &georef, 900.0, SEED), error, 6, max_triangles);
}

static void test_an_eye_on_or_in_the_ground_gets_a_whole_cut(void **state) {
    (void)state;
    Bench b = rough_bench(TERRAIN_ERROR_TOTAL, 0);
    const Dem *dem = terrain_dem(b.terrain);
    static const double ABOVE_M[] = {0.0, 1e-6, -1e-6, 0.3, -0.3, -40.0, -5000.0};
    for (size_t i = 0; i < COUNT_OF(ABOVE_M); i++) {
        LodView view = support_view(support_eye(b.terrain, 128.0, 64.0, ABOVE_M[i]), 1.0);
        if (i == 0) // where a vertex is drawn, to the bit
            view.eye_ecef = grid_point_ecef(
                grid_lattice(terrain_grid(b.terrain), 128, 64, (double)dem->height_m[64 * dem->width + 128]));
        assert_int_equal(bench_update(&b, &view), RESULT_OK);
        Measure m;
        assert_int_equal(measure_cut(b.terrain, &b.cut, b.jobs, &m), RESULT_OK);
        print_message("%10.6f m above: max %.4g px at (%d, %d), %.3g of the samples above tau\n", ABOVE_M[i], m.max_px,
                      m.worst_col, m.worst_row, m.above_tau_share);
        assert_int_equal(m.t_junctions + m.holes + m.overlaps, 0);
        // The lattice's own step, seen from nearer than half a metre, is more than a pixel, and cannot be drawn finer.
        assert_true(m.max_px <= 1.0 || (fabs(ABOVE_M[i]) < 0.5 && m.worst_col == 128 && m.worst_row == 64));
    }
    bench_end(&b);
}

static void test_extreme_tolerances_end(void **state) {
    (void)state;
    Bench b = rough_bench(TERRAIN_ERROR_TOTAL, 0);
    static const double TAUS[] = {1e-6, 1e-3, 1e3, 1e9, 1e30};
    for (size_t i = 0; i < COUNT_OF(TAUS); i++) {
        LodView view = support_view(support_eye(b.terrain, 128.0, 64.0, 800.0), TAUS[i]);
        Result result = bench_update(&b, &view);
        assert_true(result == RESULT_OK || result == RESULT_BUDGET);
        Measure m;
        assert_int_equal(measure_cut(b.terrain, &b.cut, b.jobs, &m), RESULT_OK);
        print_message("tau %.0e: %s, %" PRId64 " triangles, max %.4g px, reached %.4g\n", TAUS[i], result_name(result),
                      b.cut.stats.triangles, m.max_px, b.cut.reached_px);
        assert_int_equal(m.t_junctions + m.holes + m.overlaps, 0);
        assert_true(m.max_px <= b.cut.reached_px || b.cut.stats.triangles == 2 * 300 * 259);
    }
    bench_end(&b);
}

static void count_message(void *user, LogLevel level, const char *message) {
    (void)level;
    (void)message;
    ++*(int *)user;
}

static void test_views_that_are_no_numbers_are_refused(void **state) {
    (void)state;
    Bench b = rough_bench(TERRAIN_ERROR_TOTAL, 0);
    const LodView good = support_view(support_eye(b.terrain, 128.0, 64.0, 800.0), 1.0);
    LodView bad[6] = {good, good, good, good, good, good};
    bad[0].tau_px = NAN;
    bad[1].tau_px = 0.0;
    bad[2].tau_px = -1.0;
    bad[3].eye_ecef.y = NAN;
    bad[4].eye_ecef.x = INFINITY;
    bad[5].px_per_rad = 0.0;
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        int messages = 0;
        log_set_sink(count_message, &messages);
        Result result = bench_update(&b, &bad[i]);
        log_set_sink(NULL, NULL);
        print_message("view %zu: %s, %d messages\n", i, result_name(result), messages);
        assert_int_equal(result, RESULT_RANGE);
        assert_int_equal(messages, 1);
    }
    bench_check(&b, &good, "after refusals");
    bench_end(&b);
}

static void test_a_reached_budget_says_which_error_holds(void **state) {
    (void)state;
    Bench b = rough_bench(TERRAIN_ERROR_TOTAL, 8000);
    for (int k = 0; k < 12; k++) {
        LodView view = support_view(support_eye(b.terrain, 60.0 + 12.0 * k, 120.0, 300.0), k < 9 ? 0.05 : 30.0);
        Result result = bench_update(&b, &view);
        Measure m = support_check_cut(b.terrain, &b.cut, b.jobs, "budget");
        print_message("tau %.2f: %s, %" PRId64 " triangles, max %.4f px, reached %.4f\n", view.tau_px,
                      result_name(result), b.cut.stats.triangles, m.max_px, b.cut.reached_px);
        assert_true(result == (b.cut.reached_px > view.tau_px ? RESULT_BUDGET : RESULT_OK));
        assert_true(b.cut.stats.triangles <= 8000);
    }
    bench_end(&b);
}

static void test_the_midpoint_metric_is_whole_but_promises_nothing(void **state) {
    (void)state;
    Bench b = rough_bench(TERRAIN_ERROR_MIDPOINT, 0);
    double worst = 0.0;
    for (int k = 0; k < 20; k++) {
        LodView view = support_view(support_eye(b.terrain, 10.0 * k, 120.0, 300.0), 1.0);
        worst = fmax(worst, bench_check(&b, &view, "midpoint").max_px);
        assert_false(b.cut.promises);
    }
    print_message("midpoint: max %.3f px at tau 1\n", worst);
    bench_end(&b);
}

// Exact up to a stride, bounded above it: the same promise, for more triangles.
static void test_bounded_errors_keep_the_promise_with_more_triangles(void **state) {
    (void)state;
    const DemGeoref georef = {DEM_CRS_GEOGRAPHIC, 0, false, 12.3, 46.9, 0.0006, -0.0004};
    static const int STRIDES[] = {0, 2, 1};
    int64_t before = 0;
    for (size_t i = 0; i < COUNT_OF(STRIDES); i++) {
        Bench b = rough_bench(TERRAIN_ERROR_TOTAL, 0);
        lod_destroy(&b.lod);
        terrain_destroy(&b.terrain);
        const TerrainOptions options = {.error = TERRAIN_ERROR_TOTAL, .error_stride = STRIDES[i], .patch_level = 6};
        const LodOptions lod = lod_default_options();
        Dem *dem = support_rough_dem(301, 260, &georef, 900.0, SEED);
        assert_int_equal(terrain_create(&options, dem, NULL, b.jobs, &b.terrain), RESULT_OK);
        assert_int_equal(lod_create(&lod, b.terrain, &b.lod), RESULT_OK);
        int64_t triangles = 0;
        for (int k = 0; k < 8; k++) {
            LodView view = support_view(support_eye(b.terrain, 25.0 * k, 120.0, 300.0), 1.0 + k);
            bench_check(&b, &view, "bounded");
            assert_true(b.cut.promises);
            triangles += b.cut.stats.triangles;
        }
        print_message("stride %d: %" PRId64 " triangles\n", STRIDES[i], triangles);
        assert_true(triangles > before);
        before = triangles;
        bench_end(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hard_shapes_are_drawn_within_the_tolerance),
        cmocka_unit_test(test_bounded_errors_keep_the_promise_with_more_triangles),
        cmocka_unit_test(test_a_plane_takes_few_triangles),
        cmocka_unit_test(test_any_size_is_covered),
        cmocka_unit_test(test_holes_keep_their_shape),
        cmocka_unit_test(test_any_place_on_earth_keeps_the_promise),
        cmocka_unit_test(test_puget_sound_keeps_the_promise),
        cmocka_unit_test(test_maui_keeps_the_promise),
        cmocka_unit_test(test_the_tatra_keep_the_promise),
        cmocka_unit_test(test_an_eye_on_or_in_the_ground_gets_a_whole_cut),
        cmocka_unit_test(test_extreme_tolerances_end),
        cmocka_unit_test(test_views_that_are_no_numbers_are_refused),
        cmocka_unit_test(test_a_reached_budget_says_which_error_holds),
        cmocka_unit_test(test_the_midpoint_metric_is_whole_but_promises_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
