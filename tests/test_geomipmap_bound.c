// The geomipmap methods with their bound kept, over real ground; without, they promise nothing; holes keep their shape
// with either.
#include "base/arena.h"
#include "base/log.h"
#include "terrain/mesh/mesh.h"
#include "tests/cut_support.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define SEED UINT64_C(451)

static const LodMethod METHODS[] = {LOD_GEOMIPMAP, LOD_GEOMIPMAP_YE};

typedef struct Bench {
    Lod *lod;
    Arena *frame;
    LodCut cut;
} Bench;

static Bench bench_begin(const Terrain *terrain, LodMethod method, LodBound bound, int tile_side) {
    Bench b = {0};
    LodOptions options = lod_default_options();
    options.method = method;
    options.bound = bound;
    options.tile_side = tile_side;
    options.max_triangles = INT64_C(1) << 40;
    assert_int_equal(lod_create(&options, terrain, &b.lod), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &b.frame), RESULT_OK);
    return b;
}

static void bench_end(Bench *b) {
    lod_destroy(&b->lod);
    arena_destroy(&b->frame);
}

static Measure bench_check(Bench *b, const Terrain *terrain, const LodView *view, Jobs *jobs, const char *what) {
    if (b->cut.frame)
        lod_release(b->lod, b->cut.frame);
    arena_reset(b->frame);
    assert_int_equal(lod_update(b->lod, view, jobs, b->frame, &b->cut), RESULT_OK);
    return support_check_cut(terrain, &b->cut, jobs, what);
}

// ---- real ground ----

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LARGE_GROUND false // takes minutes; the same code runs over Puget Sound
#else
#define LARGE_GROUND true
#endif

// Large ground takes one method at every other tolerance, and the other method at the rest.
static void check_flight(const Terrain *terrain, LodMethod method, const char *name, Jobs *jobs) {
    static const double TAUS[] = {0.5, 1.0, 2.0, 4.0};
    Bench b = bench_begin(terrain, method, LOD_BOUND_CENTRE, method == LOD_GEOMIPMAP ? 33 : 17);
    const Dem *dem = terrain_dem(terrain);
    size_t step = dem->width > 2000 ? 2 : 1;
    for (size_t i = step == 2 && method == LOD_GEOMIPMAP; i < COUNT_OF(TAUS); i += step) {
        double t = 0.2 + 0.2 * (double)i;
        Vec3d eye = support_eye(terrain, t * dem->width, (0.3 + 0.5 * t * t) * dem->height, 30.0 * pow(6.0, (double)i));
        LodView view = support_view(eye, TAUS[i]);
        Measure m = bench_check(&b, terrain, &view, jobs, name);
        assert_true(b.cut.promises);
        print_message("%s, %s, tau %.1f: max %.3f px, %" PRId64 " triangles\n", lod_method_name(method), name, TAUS[i],
                      m.max_px, b.cut.stats.triangles);
    }
    bench_end(&b);
}

static void check_ground(const char *name, bool large) {
    if (large && !LARGE_GROUND) {
        print_message("%s: skipped in a checked build\n", name);
        skip();
    }
    Jobs *jobs;
    Geoid *geoid = NULL;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    Terrain *terrain = support_shared_terrain(name, &geoid, jobs);
    if (!terrain) {
        jobs_destroy(&jobs);
        skip();
    }
    for (size_t i = 0; i < COUNT_OF(METHODS); i++)
        check_flight(terrain, METHODS[i], name, jobs);
    terrain_destroy(&terrain);
    geoid_close(&geoid);
    jobs_destroy(&jobs);
}

static void test_puget_sound_is_within_the_tolerance(void **state) {
    (void)state;
    check_ground("puget_utm10_160m_1025.tif", false);
}
static void test_maui_is_within_the_tolerance(void **state) {
    (void)state;
    check_ground("maui_utm4n_40m_2049.tif", true);
}
static void test_the_tatra_are_within_the_tolerance(void **state) {
    (void)state;
    check_ground("tatra_srtm3_2401.tif", true);
}

// ---- hard shapes and views ----

static float shape_height(int shape, int col, int row) {
    switch (shape) {
    case 0:
        return 123.0f;
    case 1:
        return col == 37 && row == 51 ? 10000.0f : 0.0f;
    case 2:
        return 2 * col + row > 190 ? 3000.0f : -50.0f;
    case 3:
        return (col + row) % 2 ? 900.0f : 100.0f;
    default:
        return 0.3f * (float)((col - 60) * (col - 60) + (row - 50) * (row - 50));
    }
}

static Terrain *terrain_of_shape(int shape, double north_deg, Jobs *jobs) {
    const DemGeoref georef = {DEM_CRS_GEOGRAPHIC, 0, false, 7.0, north_deg, 0.004, -0.003};
    Dem *dem = NULL;
    assert_int_equal(dem_create(130, 101, &georef, DEM_DATUM_ELLIPSOID, &dem), RESULT_OK);
    for (int row = 0; row < dem->height; row++)
        for (int col = 0; col < dem->width; col++)
            dem->height_m[row * dem->width + col] = shape_height(shape, col, row);
    return support_terrain(dem, TERRAIN_ERROR_TOTAL, 6, jobs);
}

static LodView random_view(const Terrain *terrain, uint64_t *random) {
    const Dem *dem = terrain_dem(terrain);
    double col = support_between(random, -0.3, 1.3) * dem->width;
    double row = support_between(random, -0.3, 1.3) * dem->height;
    double above = pow(10.0, support_between(random, 0.0, 6.0));
    return support_view(support_eye(terrain, col, row, above), pow(10.0, support_between(random, -1.0, 1.5)));
}

static void test_hard_shapes_are_within_the_tolerance_from_anywhere(void **state) {
    (void)state;
    uint64_t random = SEED;
    Jobs *jobs;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    print_message("seed %" PRIu64 "\n", random);
    for (int i = 0; i < 20; i++) {
        Terrain *terrain = terrain_of_shape(i % 5, i < 10 ? 46.0 : 88.0, jobs);
        Bench b = bench_begin(terrain, METHODS[i / 5 % 2], LOD_BOUND_CENTRE, i % 2 ? 9 : 65);
        char what[64];
        snprintf(what, sizeof what, "%s, shape %d", lod_method_name(METHODS[i / 5 % 2]), i % 5);
        double worst = 0.0;
        for (int k = 0; k < 9; k++) {
            LodView view = random_view(terrain, &random);
            worst = fmax(worst, bench_check(&b, terrain, &view, jobs, what).max_px / view.tau_px);
        }
        print_message("%-24s at most %.4f of the tolerance\n", what, worst);
        bench_end(&b);
        terrain_destroy(&terrain);
    }
    jobs_destroy(&jobs);
}

static void test_without_the_bound_nothing_is_promised(void **state) {
    (void)state;
    Jobs *jobs;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    Terrain *terrain = terrain_of_shape(4, 46.0, jobs);
    for (size_t i = 0; i < COUNT_OF(METHODS); i++) {
        Bench b = bench_begin(terrain, METHODS[i], LOD_BOUND_PUBLISHED, 33);
        LodView view = support_view(support_eye(terrain, 60.0, 50.0, 800.0), 2.0);
        Measure m = bench_check(&b, terrain, &view, jobs, "published");
        assert_false(b.cut.promises);
        print_message("%s: max %.2f px at tau 2\n", lod_method_name(METHODS[i]), m.max_px);
        bench_end(&b);
    }
    terrain_destroy(&terrain);
    jobs_destroy(&jobs);
}

// The tile around the eye stays fine, whatever the tolerance; the rest becomes coarse, and the search ends.
static void test_a_budget_that_can_not_be_kept_gives_the_coarsest_cut(void **state) {
    (void)state;
    Jobs *jobs;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    Terrain *terrain = terrain_of_shape(4, 46.0, jobs);
    for (int i = 0; i < 4; i++) {
        LodOptions options = lod_default_options();
        options.method = METHODS[i % 2];
        options.bound = i < 2 ? LOD_BOUND_PUBLISHED : LOD_BOUND_CENTRE;
        options.max_triangles = 10;
        Bench b = {0};
        assert_int_equal(lod_create(&options, terrain, &b.lod), RESULT_OK);
        assert_int_equal(arena_create(1 << 20, &b.frame), RESULT_OK);
        LodView view = support_view(support_eye(terrain, 48.0, 48.0, 1.0), 1.0); // a tile's middle
        assert_int_equal(lod_update(b.lod, &view, jobs, b.frame, &b.cut), RESULT_BUDGET);
        support_check_cut(terrain, &b.cut, jobs, "no budget");
        print_message("%s: %" PRId64 " triangles, reached %.3g px\n", lod_method_name(METHODS[i % 2]),
                      b.cut.stats.triangles, b.cut.reached_px);
        assert_true(b.cut.stats.triangles < 20000 && b.cut.reached_px > 1.0);
        bench_end(&b);
    }
    terrain_destroy(&terrain);
    jobs_destroy(&jobs);
}

static void count_message(void *user, LogLevel level, const char *message) {
    (void)level, (void)message;
    ++*(int *)user;
}

static void test_tiles_of_other_sides_are_refused(void **state) {
    (void)state;
    static const int SIDES[] = {-1, 0, 1, 2, 34, 257, INT32_MAX};
    Jobs *jobs;
    assert_int_equal(jobs_create(1, &jobs), RESULT_OK);
    Terrain *terrain = terrain_of_shape(0, 46.0, jobs);
    for (size_t i = 0; i < COUNT_OF(SIDES); i++) {
        LodOptions options = lod_default_options();
        options.method = METHODS[i % 2];
        options.tile_side = SIDES[i];
        int messages = 0;
        Lod *lod = NULL;
        log_set_sink(count_message, &messages);
        Result result = lod_create(&options, terrain, &lod);
        log_set_sink(NULL, NULL);
        print_message("side %d: %s, %d messages\n", SIDES[i], result_name(result), messages);
        assert_int_equal(result, RESULT_RANGE);
        assert_int_equal(messages, 1);
    }
    terrain_destroy(&terrain);
    jobs_destroy(&jobs);
}

// ---- holes ----

static bool is_open(int col, int row) {
    return (col >= 40 && col < 46 && row >= 30 && row < 33) || (col == 64 && row == 64) || (col == 0 && row == 99) ||
           (col == 33 && row == 65);
}

// Doubled area of the half cells that no open sample touches, from the samples alone: diagonals as in the bisection.
static int64_t closed_area(int width, int height) {
    int64_t doubled = 0;
    for (int row = 0; row < height - 1; row++) {
        for (int col = 0; col < width - 1; col++) {
            bool rising = (col + row) & 1;
            bool nw = is_open(col, row), ne = is_open(col + 1, row), sw = is_open(col, row + 1);
            bool se = is_open(col + 1, row + 1);
            doubled += rising ? !(nw || ne || sw) + !(se || ne || sw) : !(nw || se || sw) + !(nw || se || ne);
        }
    }
    return doubled;
}

static Terrain *terrain_with_holes(Jobs *jobs) {
    const DemGeoref georef = {DEM_CRS_GEOGRAPHIC, 0, false, 7.0, 46.0, 0.0005, -0.0003};
    Dem *dem = support_rough_dem(130, 101, &georef, 500.0, SEED);
    dem->void_bits = calloc((130 * 101 + 7) / 8, 1);
    assert_non_null(dem->void_bits);
    for (int i = 0; i < 130 * 101; i++)
        dem->void_bits[i >> 3] = (uint8_t)(dem->void_bits[i >> 3] | is_open(i % 130, i / 130) << (i & 7));
    return support_terrain(dem, TERRAIN_ERROR_TOTAL, 6, jobs);
}

static int64_t mesh_area(const Mesh *mesh) {
    int64_t doubled = 0;
    for (int64_t i = 0; i < mesh->triangle_count; i++) {
        const MeshVertex *v[3];
        for (int k = 0; k < 3; k++)
            v[k] = &mesh->vertices[mesh->indices[3 * i + k]];
        doubled += (int64_t)((v[2]->col - v[0]->col) * (v[1]->row - v[0]->row) -
                             (v[1]->col - v[0]->col) * (v[2]->row - v[0]->row));
    }
    return doubled;
}

static void test_holes_keep_their_shape_at_any_tolerance(void **state) {
    (void)state;
    Jobs *jobs;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    Terrain *terrain = terrain_with_holes(jobs);
    for (int i = 0; i < 8; i++) {
        Bench b = bench_begin(terrain, METHODS[i % 2], i & 2 ? LOD_BOUND_CENTRE : LOD_BOUND_PUBLISHED, i & 4 ? 9 : 33);
        for (double tau = 0.5; tau < 1e6; tau *= 16.0) {
            LodView view = support_view(support_eye(terrain, 64.0, 50.0, 800.0), tau);
            bench_check(&b, terrain, &view, jobs, "holes");
            Mesh mesh;
            assert_int_equal(mesh_from_cut(terrain, &b.cut, &mesh), RESULT_OK);
            assert_int_equal(mesh_area(&mesh), closed_area(130, 101));
            mesh_clear(&mesh);
        }
        bench_end(&b);
    }
    terrain_destroy(&terrain);
    jobs_destroy(&jobs);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_puget_sound_is_within_the_tolerance),
        cmocka_unit_test(test_maui_is_within_the_tolerance),
        cmocka_unit_test(test_the_tatra_are_within_the_tolerance),
        cmocka_unit_test(test_hard_shapes_are_within_the_tolerance_from_anywhere),
        cmocka_unit_test(test_without_the_bound_nothing_is_promised),
        cmocka_unit_test(test_a_budget_that_can_not_be_kept_gives_the_coarsest_cut),
        cmocka_unit_test(test_tiles_of_other_sides_are_refused),
        cmocka_unit_test(test_holes_keep_their_shape_at_any_tolerance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
