// ROAM in uncoupled parts: any observer line, any number of parts and workers gives the serial triangles; no cracks,
// over the budget neither; what is counted along the cut.
#include "base/arena.h"
#include "base/log.h"
#include "terrain/lod/partition.h"
#include "tests/cut_support.h"
#include "tests/slow.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SEED UINT64_C(1414213)
#define FRAMES 16

static const DemGeoref GEOREF = {DEM_CRS_GEOGRAPHIC, 0, false, 12.3, 46.9, 0.0006, -0.0004};

typedef struct Flight {
    Jobs *jobs;
    Terrain *terrain;
    Lod *lod;
    Arena *frame;
    LodCut cut;
} Flight;

static void flight_begin(Flight *f, Dem *dem, int patch_level, const LodOptions *options, int workers) {
    *f = (Flight){0};
    assert_int_equal(jobs_create(workers, &f->jobs), RESULT_OK);
    f->terrain = support_terrain(dem, TERRAIN_ERROR_TOTAL, patch_level, f->jobs);
    assert_int_equal(lod_create(options, f->terrain, &f->lod), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &f->frame), RESULT_OK);
}

static void flight_end(Flight *f) {
    lod_destroy(&f->lod);
    arena_destroy(&f->frame);
    terrain_destroy(&f->terrain);
    jobs_destroy(&f->jobs);
}

static Result flight_update(Flight *f, const LodView *view) {
    lod_release(f->lod, f->cut.frame);
    arena_reset(f->frame);
    return lod_update(f->lod, view, f->jobs, f->frame, &f->cut);
}

static LodOptions options_of(LodMethod method, int partitions) {
    LodOptions options = lod_default_options();
    options.method = method;
    options.partitions = partitions;
    return options;
}

static Dem *rough(void) {
    return support_rough_dem(301, 233, &GEOREF, 900.0, SEED);
}

// The eye goes on; the line of sight turns by `turn` a frame.
static LodView view_of_frame(const Terrain *terrain, int frame, double turn) {
    LodView view = support_view(support_eye(terrain, 60.0 + 9.0 * frame, 80.0 + 5.0 * frame, 250.0),
                                frame < FRAMES / 2 ? 1.0 : 0.6);
    Vec3d up = vec3d_normalize(view.eye_ecef), east = vec3d_cross(view.forward_ecef, up);
    view.forward_ecef =
        vec3d_add(vec3d_scale(view.forward_ecef, cos(turn * frame)), vec3d_scale(east, sin(turn * frame)));
    return view;
}

static uint64_t hash_of_flight(const LodOptions *options, int workers, double turn, double tau_scale) {
    Flight f;
    uint64_t hash = 0;
    flight_begin(&f, rough(), 8, options, workers);
    for (int frame = 0; frame < FRAMES; frame++) {
        LodView view = view_of_frame(f.terrain, frame, turn);
        view.tau_px *= tau_scale;
        Result result = flight_update(&f, &view);
        assert_true(result == RESULT_OK || result == RESULT_BUDGET);
        hash = hash * 31 + support_cut_hash(&f.cut);
    }
    flight_end(&f);
    return hash;
}

static void test_any_parts_workers_and_line_give_the_triangles_of_the_serial_method(void **state) {
    (void)state;
    static const struct {
        int workers, partitions;
        double turn;
    } CASES[] = {{1, 0, 0.0}, {2, 0, 0.0},  {3, 0, 0.7}, {4, 0, -0.4}, {5, 0, 2.1},
                 {1, 2, 0.3}, {2, 2, -1.1}, {2, 3, 0.9}, {3, 7, 0.2},  {2, 64, 1.3}};
    LodOptions serial = options_of(LOD_ROAM, 0);
    uint64_t expected = hash_of_flight(&serial, 1, 0.0, 1.0);
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        LodOptions options = options_of(LOD_ROAM_PARALLEL, CASES[i].partitions);
        options.reuse = i % 2;
        uint64_t hash = hash_of_flight(&options, CASES[i].workers, CASES[i].turn, 1.0);
        if (hash != expected)
            fail_msg("%d workers, %d partitions, line turning by %g: %016" PRIx64 ", roam %016" PRIx64,
                     CASES[i].workers, CASES[i].partitions, CASES[i].turn, hash, expected);
    }
}

static void test_over_the_budget_too_all_parts_and_workers_give_the_same(void **state) {
    (void)state;
    static const struct { int workers, partitions; } CASES[] = {{1, 1}, {2, 0}, {5, 0}, {1, 2}, {3, 9}};
    uint64_t expected = 0;
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        LodOptions options = options_of(LOD_ROAM_PARALLEL, CASES[i].partitions);
        options.max_triangles = 6000;
        uint64_t hash = hash_of_flight(&options, CASES[i].workers, 0.5 * (double)i, 0.3);
        expected = i ? expected : hash;
        if (hash != expected)
            fail_msg("%d workers, %d partitions: %016" PRIx64 ", the first %016" PRIx64, CASES[i].workers,
                     CASES[i].partitions, hash, expected);
    }
}

// ---- cracks ----

static void check_parts(Dem *dem, int patch_level, int64_t max_triangles, const char *what, int *over) {
    LodOptions options = options_of(LOD_ROAM_PARALLEL, 5);
    options.max_triangles = max_triangles;
    Flight f;
    uint64_t random = SEED;
    flight_begin(&f, dem, patch_level, &options, 2);
    const Dem *at = terrain_dem(f.terrain);
    for (int k = 0; k < 10; k++) {
        Vec3d eye = support_eye(f.terrain, support_between(&random, -0.1, 1.1) * at->width,
                                support_between(&random, -0.1, 1.1) * at->height,
                                pow(10.0, support_between(&random, 1.0, 3.5)));
        LodView view = support_view(eye, 0.5);
        Result result = flight_update(&f, &view);
        assert_true(result == RESULT_OK || result == RESULT_BUDGET);
        assert_true(f.cut.stats.triangles <= max_triangles);
        assert_true((result == RESULT_BUDGET) == (f.cut.reached_px > view.tau_px));
        *over += result == RESULT_BUDGET;
        support_check_cut(f.terrain, &f.cut, f.jobs, what);
    }
    flight_end(&f);
}

static Dem *with_holes(Dem *dem) {
    dem->void_bits = calloc((size_t)(dem->width * dem->height + 7) / 8, 1);
    assert_non_null(dem->void_bits);
    for (int i = 0; i < dem->width * dem->height; i++) {
        int col = i % dem->width, row = i / dem->width;
        bool is_open = (col >= 62 && col < 67 && row >= 30 && row < 36) || (col == 64 && row == 64);
        dem->void_bits[i >> 3] = (uint8_t)(dem->void_bits[i >> 3] | is_open << (i & 7));
    }
    return dem;
}

static void test_no_cracks_on_awkward_sizes_and_around_holes(void **state) {
    SKIP_WHERE_THREADS_ARE_WATCHED();
    (void)state;
    static const int SIZES[][3] = {{2, 2, 12}, {3, 5, 4}, {327, 468, 12}, {131, 67, 8}, {257, 2, 6}};
    int over = 0;
    for (size_t i = 0; i < COUNT_OF(SIZES); i++) {
        char what[64];
        snprintf(what, sizeof what, "%d x %d", SIZES[i][0], SIZES[i][1]);
        check_parts(support_rough_dem(SIZES[i][0], SIZES[i][1], &GEOREF, 500.0, SEED), SIZES[i][2], 4000000, what,
                    &over);
    }
    assert_int_equal(over, 0);
    check_parts(with_holes(support_rough_dem(131, 101, &GEOREF, 500.0, SEED)), 6, 4000000, "holes", &over);
}

static void test_no_cracks_where_the_budget_ends_on_one_side(void **state) {
    SKIP_WHERE_THREADS_ARE_WATCHED();
    (void)state;
    int over = 0;
    for (int64_t budget = 2000; budget < 40000; budget = budget * 3 / 2)
        check_parts(support_rough_dem(257, 193, &GEOREF, 900.0, SEED), 8, budget, "budget", &over);
    print_message("%d cuts over the budget\n", over);
    assert_true(over > 20);
}

// ---- along the cut ----

static int by_value(const void *a, const void *b) {
    const int64_t *x = a, *y = b;
    return *x < *y ? -1 : *x > *y;
}

// Places drawn by more than one partition.
static int64_t count_shared(const LodCut *cut) {
    size_t count = 0, most = 0;
    for (int32_t i = 0; i < cut->item_count; i++)
        most += (size_t)cut->items[i].index_count;
    int64_t *all = malloc(sizeof *all * most), shared = 0; // place and partition
    assert_non_null(all);
    for (int32_t i = 0; i < cut->item_count; i++)
        for (int32_t k = 0; k < cut->items[i].index_count; k++) {
            const LodPage *page = cut->items[i].page;
            const LodVertex *v = &page->vertices[cut->items[i].indices[k]];
            all[count++] =
                ((int64_t)(page->row0 + v->row) << 32 | (page->col0 + v->col)) << 8 | cut->items[i].partition;
        }
    qsort(all, count, sizeof *all, by_value);
    for (size_t i = 0; i < count;) {
        size_t end = i;
        bool differs = false;
        for (; end < count && all[end] >> 8 == all[i] >> 8; end++)
            differs = differs || all[end] != all[i];
        shared += differs;
        i = end;
    }
    free(all);
    return shared;
}

static void test_vertices_on_the_cut_are_counted(void **state) {
    SKIP_WHERE_THREADS_ARE_WATCHED();
    (void)state;
    for (int partitions = 1; partitions <= 7; partitions += 2) {
        LodOptions options = options_of(LOD_ROAM_PARALLEL, partitions);
        Flight f;
        flight_begin(&f, support_rough_dem(327, 213, &GEOREF, 900.0, SEED), 8, &options, 2);
        for (int frame = 0; frame < 6; frame++) {
            LodView view = view_of_frame(f.terrain, frame, 0.8);
            assert_int_equal(flight_update(&f, &view), RESULT_OK);
            assert_int_equal(f.cut.stats.cut_vertices, count_shared(&f.cut));
            assert_int_equal(f.cut.stats.partitions, partitions);
            assert_true((f.cut.stats.cut_vertices > 0) == (partitions > 1));
        }
        flight_end(&f);
    }
}

// Vertices at one place have one position, whichever part draws them: the whole lattice position, not the offset.
static void test_vertices_on_the_cut_are_equal_bit_for_bit(void **state) {
    (void)state;
    LodOptions options = options_of(LOD_ROAM_PARALLEL, 4);
    Flight f;
    flight_begin(&f, rough(), 8, &options, 2);
    LodView view = view_of_frame(f.terrain, 3, 0.8);
    assert_int_equal(flight_update(&f, &view), RESULT_OK);
    const Dem *dem = terrain_dem(f.terrain);
    GridPoint *seen = calloc((size_t)dem->width * (size_t)dem->height, sizeof *seen);
    assert_non_null(seen);
    for (int32_t i = 0; i < f.cut.item_count; i++)
        for (int32_t k = 0; k < f.cut.items[i].index_count; k++) {
            const LodPage *page = f.cut.items[i].page;
            const LodVertex *v = &page->vertices[f.cut.items[i].indices[k]];
            GridPoint p = {page->origin.x + v->x, page->origin.y + v->y, page->origin.z + v->z};
            GridPoint *first = &seen[(page->row0 + v->row) * dem->width + page->col0 + v->col];
            if (!first->x && !first->y && !first->z)
                *first = p;
            assert_memory_equal(first, &p, sizeof p);
        }
    free(seen);
    flight_end(&f);
}

// Two parts: one on each side of the vertical plane of sight, but for squares that the plane passes through.
static void test_two_parts_are_the_sides_of_the_plane_of_sight(void **state) {
    (void)state;
    LodOptions options = options_of(LOD_ROAM_PARALLEL, 2);
    Flight f;
    flight_begin(&f, rough(), 8, &options, 2);
    for (int frame = 0; frame < FRAMES; frame++) {
        LodView view = view_of_frame(f.terrain, frame, 0.5);
        Vec3d right = vec3d_normalize(vec3d_cross(view.forward_ecef, vec3d_normalize(view.eye_ecef)));
        assert_int_equal(flight_update(&f, &view), RESULT_OK);
        int sides[2] = {0, 0};
        for (int32_t i = 0; i < f.cut.item_count; i++) {
            const LodItem *item = &f.cut.items[i];
            double x = vec3d_dot(vec3d_sub(item->centre_ecef, view.eye_ecef), right);
            if (fabs(x) > item->radius_m)
                assert_int_equal(item->partition, x > 0.0 ? 0 : 1);
            sides[item->partition]++;
        }
        assert_true(sides[0] + sides[1] == f.cut.item_count);
    }
    flight_end(&f);
}

// ---- the work ----

static void test_parts_have_equal_predicted_work(void **state) {
    (void)state;
    LodOptions options = options_of(LOD_ROAM_PARALLEL, 4);
    Flight f;
    double mean = 0.0;
    flight_begin(&f, support_rough_dem(513, 513, &GEOREF, 900.0, SEED), 8, &options, 2);
    for (int frame = 0; frame < FRAMES; frame++) {
        LodView view = support_view(support_eye(f.terrain, 256.0 + 2.0 * frame, 250.0, 1500.0), 1.0);
        assert_int_equal(flight_update(&f, &view), RESULT_OK);
        int64_t triangles[4] = {0}, most = 0;
        for (int32_t i = 0; i < f.cut.item_count; i++)
            triangles[f.cut.items[i].partition] += f.cut.items[i].index_count / 3;
        for (int p = 0; p < 4; p++)
            most = triangles[p] > most ? triangles[p] : most;
        double balance = 4.0 * (double)most / (double)f.cut.stats.triangles;
        if (frame == 0)
            print_message("first frame, estimated: %.3f\n", balance);
        else if (balance > 1.15)
            fail_msg("frame %d: the largest part has %.3f times the mean of the triangles", frame, balance);
        mean += frame ? balance / (FRAMES - 1) : 0.0;
    }
    print_message("then %.3f in the mean\n", mean);
    flight_end(&f);
}

static void test_borders_lie_where_they_halve_the_work_best(void **state) {
    (void)state;
    double turns[5] = {0.1, 0.3, 0.5, 0.7, 0.9}, work[5] = {1.0, 1.0, 10.0, 1.0, 1.0}, borders[3];
    int32_t order[5];
    partition_borders(3, turns, work, 5, order, borders);
    int count[3] = {0};
    for (int i = 0; i < 5; i++)
        count[partition_of(borders, 3, turns[i])]++;
    assert_int_equal(count[0], 2);
    assert_int_equal(count[1], 1);
    assert_int_equal(count[2], 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_any_parts_workers_and_line_give_the_triangles_of_the_serial_method),
        cmocka_unit_test(test_over_the_budget_too_all_parts_and_workers_give_the_same),
        cmocka_unit_test(test_no_cracks_on_awkward_sizes_and_around_holes),
        cmocka_unit_test(test_no_cracks_where_the_budget_ends_on_one_side),
        cmocka_unit_test(test_vertices_on_the_cut_are_counted),
        cmocka_unit_test(test_vertices_on_the_cut_are_equal_bit_for_bit),
        cmocka_unit_test(test_two_parts_are_the_sides_of_the_plane_of_sight),
        cmocka_unit_test(test_parts_have_equal_predicted_work),
        cmocka_unit_test(test_borders_lie_where_they_halve_the_work_best),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
