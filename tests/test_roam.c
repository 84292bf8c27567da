// ROAM: its triangles against a recursion that knows no neighbours, and against hybrid's; its budget.
#include "base/arena.h"
#include "base/log.h"
#include "terrain/patches/refine.h"
#include "terrain/squares/square_grid.h"
#include "terrain/terrain_parts.h"
#include "tests/cut_support.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SEED UINT64_C(1618033)

static const DemGeoref GEOREF = {DEM_CRS_GEOGRAPHIC, 0, false, 12.3, 46.9, 0.0006, -0.0004};

typedef struct Bench {
    Jobs *jobs;
    Terrain *terrain;
    Lod *lod;
    Arena *frame;
    LodCut cut;
} Bench;

static Bench bench_begin(Dem *dem, int patch_level, const LodOptions *options) {
    Bench b = {0};
    assert_int_equal(jobs_create(1, &b.jobs), RESULT_OK);
    b.terrain = support_terrain(dem, TERRAIN_ERROR_TOTAL, patch_level, b.jobs);
    assert_int_equal(lod_create(options, b.terrain, &b.lod), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &b.frame), RESULT_OK);
    return b;
}

static void bench_end(Bench *b) {
    lod_destroy(&b->lod);
    arena_destroy(&b->frame);
    terrain_destroy(&b->terrain);
    jobs_destroy(&b->jobs);
}

static LodOptions roam_options(bool reuse) {
    LodOptions options = lod_default_options();
    options.method = LOD_ROAM;
    options.reuse = reuse;
    return options;
}

static Result bench_update(Bench *b, const LodView *view) {
    if (b->cut.frame)
        lod_release(b->lod, b->cut.frame);
    arena_reset(b->frame);
    return lod_update(b->lod, view, b->jobs, b->frame, &b->cut);
}

static LodView random_view(const Terrain *terrain, uint64_t *random) {
    const Dem *dem = terrain_dem(terrain);
    double col = support_between(random, -0.2, 1.2) * dem->width,
           row = support_between(random, -0.2, 1.2) * dem->height;
    double above = pow(10.0, support_between(random, 0.0, 4.0));
    return support_view(support_eye(terrain, col, row, above), pow(10.0, support_between(random, -1.0, 1.0)));
}

// ---- the oracle: bisect each square's roots where the vertex is active, asking nobody ----

typedef struct Oracle {
    const Terrain *terrain;
    RefineView view;
    int32_t *triangles; // [count][6] columns and rows of apex, right, left
    int32_t count, capacity;
    double worst_px, tau_px; // the largest priority of a vertex that does not split
} Oracle;

static bool oracle_splits(Oracle *o, PatchCorner m) {
    const Dem *dem = terrain_dem(o->terrain);
    ErrorCodes codes = error_field_at(&o->terrain->errors, m.col, m.row);
    float h = dem->height_m[(size_t)m.row * (size_t)dem->width + (size_t)m.col];
    Vec3d p = grid_point_ecef(grid_lattice(o->terrain->grid, m.col, m.row, (double)h));
    return refine_is_active(&o->view, p, error_field_decode(codes.delta), error_field_decode(codes.radius));
}

static void oracle_draw(Oracle *o, const PatchTriangle *t) {
    if (o->count == o->capacity) {
        o->capacity = 2 * o->capacity + 1024;
        o->triangles = realloc(o->triangles, sizeof *o->triangles * 6 * (size_t)o->capacity);
        assert_non_null(o->triangles);
    }
    int32_t six[6] = {t->apex.col, t->apex.row, t->right.col, t->right.row, t->left.col, t->left.row};
    memcpy(o->triangles + 6 * (size_t)o->count++, six, sizeof six);
}

static void oracle_bisect(Oracle *o, const PatchTriangle *t) {
    PatchCorner m = patch_triangle_middle(t);
    bool is_whole = (t->left.col + t->right.col) % 2 == 0 && (t->left.row + t->right.row) % 2 == 0;
    if (!is_whole || !oracle_splits(o, m))
        return oracle_draw(o, t);
    for (int half = 0; half < 2; half++) {
        PatchTriangle child = patch_triangle_half(t, m, half);
        oracle_bisect(o, &child);
    }
}

static void oracle_square(Oracle *o, const ForestTile *square) {
    o->count = 0;
    for (int root = 0; root < 2; root++) {
        PatchTriangle t = square_root_triangle(square, root);
        oracle_bisect(o, &t);
    }
}

static void compare_item(const Oracle *o, const LodItem *item, int32_t number) {
    if (item->index_count != 3 * o->count)
        fail_msg("square %d: %d triangles, the oracle has %d", number, item->index_count / 3, o->count);
    for (int32_t k = 0; k < item->index_count; k++) {
        const LodVertex *v = &item->page->vertices[item->indices[k]];
        int col = item->page->col0 + v->col, row = item->page->row0 + v->row;
        if (col != o->triangles[2 * k] || row != o->triangles[2 * k + 1])
            fail_msg("square %d, index %d: vertex (%d, %d), the oracle has (%d, %d)", number, k, col, row,
                     o->triangles[2 * k], o->triangles[2 * k + 1]);
    }
}

static void compare_with_oracle(Bench *b, const LodView *view) {
    Oracle oracle = {.terrain = b->terrain, .view = refine_view(view, view->tau_px)};
    SquareGrid grid;
    assert_int_equal(square_grid_create(&b->terrain->forest, b->terrain->patches.side, &grid), RESULT_OK);
    assert_int_equal(grid.count, b->cut.item_count);
    for (int32_t i = 0; i < grid.count; i++) {
        oracle_square(&oracle, &grid.squares[i]);
        compare_item(&oracle, &b->cut.items[i], i);
    }
    free(oracle.triangles);
    square_grid_destroy(&grid);
}

static void test_triangles_are_those_of_a_recursion_without_neighbours(void **state) {
    (void)state;
    static const int SIZES[][3] = {{2, 2, 12},    {3, 2, 12},     {130, 101, 6},
                                   {257, 193, 8}, {163, 117, 12}, {327, 468, 12}};
    uint64_t random = SEED;
    print_message("seed %" PRIu64 "\n", random);
    for (size_t i = 0; i < COUNT_OF(SIZES); i++) {
        LodOptions options = roam_options(i % 2);
        Dem *dem = support_rough_dem(SIZES[i][0], SIZES[i][1], &GEOREF, 700.0, SEED);
        Bench b = bench_begin(dem, SIZES[i][2], &options);
        for (int k = 0; k < 8; k++) {
            LodView view = random_view(b.terrain, &random);
            assert_int_equal(bench_update(&b, &view), RESULT_OK);
            compare_with_oracle(&b, &view);
        }
        bench_end(&b);
    }
}

// ---- against hybrid, where its tolerance alone asks for all squares ----

static int by_corners(const void *a, const void *b) {
    return memcmp(a, b, 6 * sizeof(int32_t));
}

static int32_t *sorted_triangles(const LodCut *cut) {
    int32_t *all = malloc(sizeof *all * 6 * (size_t)cut->stats.triangles), *out = all;
    assert_non_null(all);
    for (int32_t i = 0; i < cut->item_count; i++)
        for (int32_t k = 0; k < cut->items[i].index_count; k++) {
            const LodPage *page = cut->items[i].page;
            const LodVertex *v = &page->vertices[cut->items[i].indices[k]];
            *out++ = page->col0 + v->col;
            *out++ = page->row0 + v->row;
        }
    qsort(all, (size_t)cut->stats.triangles, 6 * sizeof *all, by_corners);
    return all;
}

static void test_triangles_are_those_of_hybrid_where_it_needs_all_squares(void **state) {
    (void)state;
    LodOptions options = roam_options(true), other = lod_default_options();
    Bench b = bench_begin(support_rough_dem(257, 161, &GEOREF, 1500.0, SEED), 4, &options);
    Bench h = bench_begin(support_rough_dem(257, 161, &GEOREF, 1500.0, SEED), 4, &other);
    LodView view = support_view(support_eye(b.terrain, 120.0, 70.0, 900.0), 0.5);
    assert_int_equal(bench_update(&b, &view), RESULT_OK);
    assert_int_equal(bench_update(&h, &view), RESULT_OK);
    print_message("%" PRId64 " triangles, hybrid %" PRId64 "\n", b.cut.stats.triangles, h.cut.stats.triangles);
    assert_int_equal(b.cut.stats.triangles, h.cut.stats.triangles);
    int32_t *ours = sorted_triangles(&b.cut), *theirs = sorted_triangles(&h.cut);
    assert_memory_equal(ours, theirs, sizeof *ours * 6 * (size_t)b.cut.stats.triangles);
    assert_true(b.cut.stats.triangles < 2 * 256 * 160);
    free(ours);
    free(theirs);
    bench_end(&b);
    bench_end(&h);
}

// ---- the budget ----

// What a tolerance of `reached` alone would draw fits the budget, and hardly less does: the triangles went where the
// error is.
static void check_best(Bench *b, const LodView *view, int64_t budget) {
    LodOptions options = roam_options(false);
    Bench free_of_budget = {.jobs = b->jobs, .terrain = b->terrain, .frame = b->frame};
    LodView same = *view;
    int64_t drawn = b->cut.stats.triangles;
    same.tau_px = b->cut.reached_px * (1.0 + 1e-9);
    assert_int_equal(lod_create(&options, b->terrain, &free_of_budget.lod), RESULT_OK);
    lod_release(b->lod, b->cut.frame);
    assert_int_equal(bench_update(&free_of_budget, &same), RESULT_OK);
    int64_t needed = free_of_budget.cut.stats.triangles;
    if (needed > drawn || drawn > budget || needed < drawn - 64)
        fail_msg("%" PRId64 " triangles, %" PRId64 " for %.6g px, budget %" PRId64, drawn, needed, same.tau_px, budget);
    lod_destroy(&free_of_budget.lod);
}

static void check_budget(bool reuse, int64_t budget) {
    LodOptions options = roam_options(reuse);
    options.max_triangles = budget;
    Bench b = bench_begin(support_rough_dem(327, 257, &GEOREF, 900.0, SEED), 8, &options);
    int reached = 0;
    for (int frame = 0; frame < 30; frame++) {
        LodView view = support_view(support_eye(b.terrain, 40.0 + 8.0 * frame, 60.0 + 5.0 * frame, 500.0),
                                    frame % 10 < 7 ? 0.4 : 30.0);
        Result result = bench_update(&b, &view);
        assert_true(result == RESULT_OK || result == RESULT_BUDGET);
        assert_true((result == RESULT_BUDGET) == (b.cut.reached_px > view.tau_px));
        assert_true(b.cut.stats.triangles <= budget);
        if (frame % 5 == 0)
            support_check_cut(b.terrain, &b.cut, b.jobs, "budget"); // measured <= reached_px
        reached += result == RESULT_BUDGET;
        if (result == RESULT_BUDGET)
            check_best(&b, &view, budget);
        else
            compare_with_oracle(&b, &view);
    }
    print_message("%s, %" PRId64 " triangles: reached in %d frames of 30, %.3g px at last\n", reuse ? "kept" : "anew",
                  budget, reached, b.cut.reached_px);
    assert_true(reached >= 20 && reached < 30);
    bench_end(&b);
}

static void test_the_budget_goes_where_the_error_is(void **state) {
    (void)state;
    check_budget(false, 3000);
    check_budget(true, 3000);
    check_budget(false, 17000);
    check_budget(true, 17000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_triangles_are_those_of_a_recursion_without_neighbours),
        cmocka_unit_test(test_triangles_are_those_of_hybrid_where_it_needs_all_squares),
        cmocka_unit_test(test_the_budget_goes_where_the_error_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
