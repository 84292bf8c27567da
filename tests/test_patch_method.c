// Static patches of the hybrid method's hierarchy, whole and within the tolerance for DEMs of any size: where the
// remainder of small tiles meets them, both must agree.
#include "base/arena.h"
#include "terrain/lod/lod_patch_near.h"
#include "terrain/patches/patch_select.h"
#include "terrain/terrain_parts.h"
#include "tests/cut_support.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define SEED UINT64_C(2009)

static const DemGeoref GEOREF = {DEM_CRS_GEOGRAPHIC, 0, false, 12.3, 46.9, 0.0006, -0.0004};

typedef struct Bench {
    Jobs *jobs;
    Terrain *terrain;
    Lod *lod;
    Arena *frame;
    LodCut cut;
} Bench;

static void bench_start(Bench *b, LodMethod method, bool reuse) {
    LodOptions options = lod_default_options();
    options.method = method;
    options.reuse = reuse;
    assert_int_equal(lod_create(&options, b->terrain, &b->lod), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &b->frame), RESULT_OK);
}

static Bench bench_of(Dem *dem, int patch_level, int workers) {
    Bench b = {0};
    assert_int_equal(jobs_create(workers, &b.jobs), RESULT_OK);
    b.terrain = support_terrain(dem, TERRAIN_ERROR_TOTAL, patch_level, b.jobs);
    bench_start(&b, LOD_PATCH, true);
    return b;
}

static void bench_stop(Bench *b) {
    lod_destroy(&b->lod);
    arena_destroy(&b->frame);
}

static void bench_end(Bench *b) {
    bench_stop(b);
    terrain_destroy(&b->terrain);
    jobs_destroy(&b->jobs);
}

static void bench_update(Bench *b, const LodView *view) {
    if (b->cut.frame)
        lod_release(b->lod, b->cut.frame);
    arena_reset(b->frame);
    assert_int_equal(lod_update(b->lod, view, b->jobs, b->frame, &b->cut), RESULT_OK);
}

static LodView random_view(const Bench *b, uint64_t *random) {
    const Dem *dem = terrain_dem(b->terrain);
    double col = support_between(random, -0.2, 1.2) * dem->width;
    double row = support_between(random, -0.2, 1.2) * dem->height;
    double above = pow(10.0, support_between(random, -1.0, 4.5));
    if (support_random(random) % 6 == 0)
        above = -above; // inside the ground
    return support_view(support_eye(b->terrain, col, row, above), pow(10.0, support_between(random, -1.0, 2.0)));
}

// ---- sizes and sides ----

// Rough hills, and flat ground beyond a line: coarse patches beside fine ones, wherever the line is.
static Dem *dem_of_size(int width, int height, uint64_t *random) {
    Dem *dem = support_rough_dem(width, height, &GEOREF, 500.0, support_random(random));
    double slope = support_between(random, -2.0, 2.0), shift = support_between(random, -0.5, 0.5) * width;
    for (int row = 0; row < height; row++)
        for (int col = 0; col < width; col++)
            if (col - width / 2 - shift > slope * (row - height / 2))
                dem->height_m[(size_t)row * (size_t)width + (size_t)col] *= 0.001f;
    return dem;
}

static void check_size(int width, int height, int patch_level, int views, uint64_t *random) {
    Bench b = bench_of(dem_of_size(width, height, random), patch_level, 2);
    char what[64];
    snprintf(what, sizeof what, "%d x %d, side %d", width, height, (1 << patch_level / 2) + 1);
    for (int k = 0; k < views; k++) {
        LodView view = random_view(&b, random);
        bench_update(&b, &view);
        support_check_cut(b.terrain, &b.cut, b.jobs, what);
    }
    bench_end(&b);
}

static void test_any_size_is_whole_and_within_tau(void **state) {
    (void)state;
    static const int SIZES[][2] = {{2, 2},    {3, 2},     {2, 3},    {5, 3},     {33, 33},  {65, 65},
                                   {129, 65}, {70, 130},  {130, 70}, {257, 257}, {327, 68}, {118, 97},
                                   {1500, 3}, {601, 113}, {3, 900},  {386, 258}};
    uint64_t random = SEED;
    print_message("seed %" PRIu64 "\n", random);
    for (size_t i = 0; i < COUNT_OF(SIZES); i++)
        for (int patch_level = 2; patch_level <= 14; patch_level += 2)
            check_size(SIZES[i][0], SIZES[i][1], patch_level, 5, &random);
}

// Small sides make many tiles static, of several sizes, with a remainder of several sizes beside.
static void test_random_sizes_are_whole_and_within_tau(void **state) {
    (void)state;
    uint64_t random = SEED + 1;
    print_message("seed %" PRIu64 "\n", random);
    for (int k = 0; k < 60; k++) {
        int width = 2 + (int)(support_random(&random) % 180), height = 2 + (int)(support_random(&random) % 180);
        check_size(width, height, 2 + 2 * (int)(support_random(&random) % 3), 4, &random);
    }
}

static void test_holes_are_left_whole(void **state) {
    (void)state;
    uint64_t random = SEED + 2;
    for (int patch_level = 2; patch_level <= 12; patch_level += 2) {
        enum { WIDTH = 201, HEIGHT = 150 };
        Dem *dem = dem_of_size(WIDTH, HEIGHT, &random);
        dem->void_bits = calloc((WIDTH * HEIGHT + 7) / 8, 1);
        for (int k = 0; k < 12; k++) {
            int i = (int)(support_random(&random) % (WIDTH * HEIGHT));
            dem->void_bits[i >> 3] = (uint8_t)(dem->void_bits[i >> 3] | 1 << (i & 7));
        }
        Bench b = bench_of(dem, patch_level, 2);
        for (int k = 0; k < 6; k++) {
            LodView view = random_view(&b, &random);
            bench_update(&b, &view);
            support_check_cut(b.terrain, &b.cut, b.jobs, "holes");
        }
        bench_end(&b);
    }
}

// ---- what a static patch is ----

// One tile: what patch_select chooses, each patch with every triangle of its page.
static void test_each_patch_of_a_square_dem_shows_its_whole_page(void **state) {
    (void)state;
    uint64_t random = SEED + 3;
    Bench b = bench_of(dem_of_size(257, 257, &random), 6, 2);
    PatchSelection selection = {0};
    for (int k = 0; k < 10; k++) {
        LodView view = random_view(&b, &random);
        RefineView refine = refine_view(&view, view.tau_px);
        bench_update(&b, &view);
        assert_int_equal(patch_select(&b.terrain->patches, &refine, INT32_MAX, &selection), RESULT_OK);
        assert_int_equal(b.cut.item_count, selection.count);
        for (int32_t i = 0; i < selection.count; i++) {
            assert_int_equal(b.cut.items[i].level, selection.choices[i].level);
            assert_int_equal(b.cut.items[i].index_count, 3 << 6);
        }
    }
    patch_selection_destroy(&selection);
    bench_end(&b);
}

// The strips beside the large tile hold 22,386 triangles at full density.
static void test_a_remainder_costs_few_triangles_from_afar(void **state) {
    (void)state;
    uint64_t random = SEED + 4;
    Bench b = bench_of(dem_of_size(278, 278, &random), 12, 2);
    LodView view = support_view(support_eye(b.terrain, 140.0, 140.0, 3e6), 50.0);
    bench_update(&b, &view);
    support_check_cut(b.terrain, &b.cut, b.jobs, "afar");
    print_message("%" PRId64 " triangles\n", b.cut.stats.triangles);
    assert_in_range(b.cut.stats.triangles, 8192, 13000);
    bench_end(&b);
}

// ---- from frame to frame ----

static LodView view_of_frame(const Bench *b, int frame) {
    const Dem *dem = terrain_dem(b->terrain);
    double t = 0.05 + 0.01 * frame;
    return support_view(support_eye(b->terrain, t * dem->width, (0.5 + 0.45 * sin(9.0 * t)) * dem->height,
                                    50.0 + 3000.0 * fabs(sin(20.0 * t))),
                        frame % 20 < 15 ? 1.0 : 4.0);
}

static uint64_t hash_of_flight(int workers, bool reuse) {
    uint64_t random = SEED + 5, hash = 0;
    Bench b = bench_of(dem_of_size(333, 202, &random), 6, workers);
    bench_stop(&b);
    bench_start(&b, LOD_PATCH, reuse);
    for (int frame = 0; frame < 60; frame++) {
        LodView view = view_of_frame(&b, frame);
        bench_update(&b, &view);
        hash = hash * 31 + support_cut_hash(&b.cut);
    }
    bench_end(&b);
    return hash;
}

static void test_workers_and_reuse_change_no_byte(void **state) {
    (void)state;
    uint64_t first = hash_of_flight(1, false);
    for (int workers = 1; workers <= 5; workers++) {
        uint64_t hash = hash_of_flight(workers, true);
        if (hash != first)
            fail_msg("%d workers, with reuse: %016" PRIx64 "; one, from scratch: %016" PRIx64, workers, hash, first);
    }
}

static void test_a_view_seen_again_changes_nothing(void **state) {
    (void)state;
    uint64_t random = SEED + 6;
    Bench b = bench_of(dem_of_size(333, 202, &random), 6, 2);
    LodView view = view_of_frame(&b, 3);
    bench_update(&b, &view);
    bench_update(&b, &view);
    print_message("%" PRId64 " of %" PRId64 " patches reused\n", b.cut.stats.patches_reused, b.cut.stats.patches);
    assert_int_equal(b.cut.stats.patches_reused, b.cut.stats.patches);
    assert_int_equal(b.cut.stats.index_bytes, 0);
    bench_end(&b);
}

// ---- beside hybrid ----

static int64_t triangles_of(Bench *b, LodMethod method, const LodView *view) {
    bench_stop(b);
    b->cut = (LodCut){0};
    bench_start(b, method, true);
    bench_update(b, view);
    return b->cut.stats.triangles;
}

static void test_hybrid_needs_at_most_a_third_of_the_triangles_on_maui(void **state) {
    (void)state;
    Bench b = {0};
    Geoid *geoid = NULL;
    assert_int_equal(jobs_create(2, &b.jobs), RESULT_OK);
    b.terrain = support_shared_terrain("maui_utm4n_40m_2049.tif", &geoid, b.jobs);
    if (!b.terrain) {
        jobs_destroy(&b.jobs);
        skip();
    }
    bench_start(&b, LOD_PATCH, true);
    for (int k = 0; k < 4; k++) {
        LodView view = support_view(support_eye(b.terrain, 1300.0, 1100.0, k & 1 ? 300.0 : 2000.0), k & 2 ? 2.0 : 1.0);
        int64_t hybrid = triangles_of(&b, LOD_HYBRID, &view), patch = triangles_of(&b, LOD_PATCH, &view);
        print_message("tau %.0f: hybrid %" PRId64 ", patch %" PRId64 " triangles: %.3f\n", view.tau_px, hybrid, patch,
                      (double)hybrid / (double)patch);
        assert_true(3 * hybrid <= patch);
    }
    bench_end(&b);
    geoid_close(&geoid);
}

// ---- the distance to the terrain ----

static void test_the_nearest_sample_is_found(void **state) {
    (void)state;
    uint64_t random = SEED + 7;
    Bench b = bench_of(dem_of_size(150, 131, &random), 4, 1);
    const Dem *dem = terrain_dem(b.terrain);
    for (int k = 0; k < 20; k++) {
        LodView view = random_view(&b, &random);
        double expected = INFINITY;
        for (int row = 0; row < dem->height; row++)
            for (int col = 0; col < dem->width; col++) {
                double h = (double)dem->height_m[row * dem->width + col];
                Vec3d p = grid_point_ecef(grid_lattice(terrain_grid(b.terrain), col, row, h));
                expected = fmin(expected, vec3d_distance(p, view.eye_ecef));
            }
        double found = near_distance_m(b.terrain, view.eye_ecef);
        if (found < expected) // corners of tiles may be nearer, and are no matter
            fail_msg("eye %d: %.6f m found, %.6f m expected", k, found, expected);
        assert_true(found <= expected + 1.0 || found < 1.5 * expected + 200.0);
    }
    bench_end(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_any_size_is_whole_and_within_tau),
        cmocka_unit_test(test_random_sizes_are_whole_and_within_tau),
        cmocka_unit_test(test_holes_are_left_whole),
        cmocka_unit_test(test_each_patch_of_a_square_dem_shows_its_whole_page),
        cmocka_unit_test(test_a_remainder_costs_few_triangles_from_afar),
        cmocka_unit_test(test_workers_and_reuse_change_no_byte),
        cmocka_unit_test(test_a_view_seen_again_changes_nothing),
        cmocka_unit_test(test_hybrid_needs_at_most_a_third_of_the_triangles_on_maui),
        cmocka_unit_test(test_the_nearest_sample_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
