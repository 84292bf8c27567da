// ROAM: its mesh against a recursion that knows no neighbours, its links after random splits and merges, its bounds.
#include "base/arena.h"
#include "base/log.h"
#include "terrain/patches/refine.h"
#include "terrain/roam/roam_base.h"
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

// ---- the mesh: links ----

typedef struct Corner {
    int col, row;
} Corner;

static Corner corner_of(const SquareGrid *grid, const RoamTriangle *t, int which) { // 0 left, 1 right, 2 apex
    const ForestTile *s = &grid->squares[t->square];
    int col = which == 0 ? t->left_col : which == 1 ? t->right_col : t->apex_col;
    int row = which == 0 ? t->left_row : which == 1 ? t->right_row : t->apex_row;
    return (Corner){s->col + col, s->row + row};
}

static bool same_corner(Corner a, Corner b) {
    return a.col == b.col && a.row == b.row;
}

static bool is_outer_edge(const SquareGrid *grid, Corner a, Corner b) {
    return (a.col == b.col && (a.col == 0 || a.col == grid->width - 1)) ||
           (a.row == b.row && (a.row == 0 || a.row == grid->height - 1));
}

// The edge from corner `from` to corner `to` of t is that of its neighbour, the other way round.
static void check_link(const SquareGrid *grid, const RoamMesh *mesh, int32_t t, int32_t neighbour, int from, int to) {
    const RoamTriangle *a = &mesh->triangles[t];
    Corner begin = corner_of(grid, a, from), end = corner_of(grid, a, to);
    if (neighbour < 0) {
        assert_true(is_outer_edge(grid, begin, end));
        return;
    }
    const RoamTriangle *b = &mesh->triangles[neighbour];
    assert_true(!roam_is_gone(b) && roam_is_leaf(b));
    int32_t back = ROAM_NONE;
    static const int EDGES[3][2] = {{0, 1}, {2, 0}, {1, 2}}; // base, left, right: from, to
    for (int e = 0; e < 3; e++)
        if (same_corner(corner_of(grid, b, EDGES[e][0]), end) && same_corner(corner_of(grid, b, EDGES[e][1]), begin))
            back = e == 0 ? b->base : e == 1 ? b->left : b->right;
    if (back != t)
        fail_msg("triangle %d names %d across (%d, %d)-(%d, %d), which names %d", t, neighbour, begin.col, begin.row,
                 end.col, end.row, back);
}

static void check_mesh(const SquareGrid *grid, const RoamMesh *mesh) {
    int64_t leaves = 0, doubled_area = 0;
    for (int32_t t = 0; t < mesh->used; t++) {
        const RoamTriangle *at = &mesh->triangles[t];
        if (roam_is_gone(at) || !roam_is_leaf(at))
            continue;
        Corner l = corner_of(grid, at, 0), r = corner_of(grid, at, 1), a = corner_of(grid, at, 2);
        check_link(grid, mesh, t, at->base, 0, 1);
        check_link(grid, mesh, t, at->left, 2, 0);
        check_link(grid, mesh, t, at->right, 1, 2);
        doubled_area += llabs((int64_t)(l.col - a.col) * (r.row - a.row) - (int64_t)(l.row - a.row) * (r.col - a.col));
        leaves++;
    }
    assert_int_equal(mesh->leaf_count, leaves);
    assert_int_equal(doubled_area, 2 * (int64_t)(grid->width - 1) * (grid->height - 1));
}

typedef struct Toy {
    Jobs *jobs;
    Terrain *terrain;
    SquareGrid grid;
    RoamBase base;
    RoamMesh mesh;
    int32_t *roots;
} Toy;

static void toy_begin(Toy *toy, int width, int height, int side, int32_t triangles_max) {
    *toy = (Toy){0};
    assert_int_equal(jobs_create(1, &toy->jobs), RESULT_OK);
    toy->terrain =
        support_terrain(support_rough_dem(width, height, &GEOREF, 300.0, SEED), TERRAIN_ERROR_TOTAL, 6, toy->jobs);
    assert_int_equal(square_grid_create(&toy->terrain->forest, side, &toy->grid), RESULT_OK);
    assert_int_equal(roam_base_create(&toy->grid, &toy->terrain->errors, &toy->base), RESULT_OK);
    toy->roots = calloc((size_t)toy->grid.count, sizeof *toy->roots);
    assert_non_null(toy->roots);
    assert_int_equal(roam_base_copy(&toy->base, &toy->mesh, toy->roots), RESULT_OK);
    toy->mesh.triangles_max = triangles_max;
}

static void toy_end(Toy *toy) {
    free(toy->roots);
    roam_mesh_destroy(&toy->mesh);
    roam_base_destroy(&toy->base);
    square_grid_destroy(&toy->grid);
    terrain_destroy(&toy->terrain);
    jobs_destroy(&toy->jobs);
}

static bool can_split(const Toy *toy, int32_t t) {
    const RoamTriangle *at = &toy->mesh.triangles[t];
    return !roam_is_gone(at) && roam_is_leaf(at) && at->level < 2 * __builtin_ctz((unsigned)toy->grid.side_max);
}

static void step_at_random(Toy *toy, uint64_t *random) {
    int32_t t = (int32_t)(support_random(random) % (uint64_t)toy->mesh.used), partner;
    if (can_split(toy, t) && roam_mesh_has_room(&toy->mesh, t)) {
        int cost = roam_mesh_cost(&toy->mesh, t), before = toy->mesh.leaf_count;
        assert_true(roam_mesh_split(&toy->mesh, t));
        assert_int_equal(toy->mesh.leaf_count, before + cost);
    } else if (!roam_is_gone(&toy->mesh.triangles[t]) && roam_mesh_can_merge(&toy->mesh, t, &partner)) {
        roam_mesh_merge(&toy->mesh, t, partner);
    }
}

static void test_links_hold_after_random_splits_and_merges(void **state) {
    (void)state;
    static const int SIZES[][3] = {{2, 2, 2}, {65, 65, 16}, {83, 71, 8}, {131, 67, 64}};
    uint64_t random = SEED;
    print_message("seed %" PRIu64 "\n", random);
    for (size_t i = 0; i < COUNT_OF(SIZES); i++) {
        Toy toy;
        toy_begin(&toy, SIZES[i][0], SIZES[i][1], SIZES[i][2], 1 << 20);
        check_mesh(&toy.grid, &toy.mesh);
        for (int round = 0; round < 40; round++) {
            for (int k = 0; k < 200; k++)
                step_at_random(&toy, &random);
            check_mesh(&toy.grid, &toy.mesh);
        }
        print_message("%d x %d: %d triangles, %" PRId64 " splits, %" PRId64 " forced, %" PRId64 " merges\n",
                      SIZES[i][0], SIZES[i][1], toy.mesh.leaf_count, toy.mesh.splits, toy.mesh.forced_splits,
                      toy.mesh.merges);
        assert_true(i == 0 || (toy.mesh.forced_splits > 0 && toy.mesh.merges > 100));
        toy_end(&toy);
    }
}

static void test_merging_all_gives_the_mesh_to_begin_with(void **state) {
    (void)state;
    Toy toy;
    uint64_t random = SEED;
    toy_begin(&toy, 83, 71, 16, 1 << 20);
    for (int k = 0; k < 5000; k++)
        step_at_random(&toy, &random);
    int32_t before = toy.mesh.leaf_count, partner;
    for (bool merged = true; merged;) {
        merged = false;
        for (int32_t t = toy.base.mesh.used; t-- > 0;) // those that are always there keep their halves
            assert_true(!roam_is_gone(&toy.mesh.triangles[t]));
        for (int32_t t = 0; t < toy.mesh.used; t++) {
            const RoamTriangle *at = &toy.mesh.triangles[t];
            bool is_fixed = t < toy.base.mesh.used && !roam_is_leaf(&toy.base.mesh.triangles[t]);
            if (is_fixed || roam_is_gone(at) || !roam_mesh_can_merge(&toy.mesh, t, &partner))
                continue;
            roam_mesh_merge(&toy.mesh, t, partner);
            merged = true;
        }
    }
    print_message("from %d triangles to %d, of %d\n", before, toy.mesh.leaf_count, toy.base.mesh.leaf_count);
    assert_int_equal(toy.mesh.leaf_count, toy.base.mesh.leaf_count);
    check_mesh(&toy.grid, &toy.mesh);
    toy_end(&toy);
}

static void test_a_deep_split_forces_its_neighbours_along_the_longest_edges(void **state) {
    (void)state;
    Toy toy;
    toy_begin(&toy, 65, 65, 16, 1 << 20);
    int32_t t = toy.roots[5];
    while (can_split(&toy, t)) { // always the left half: towards a corner of the square
        assert_true(roam_mesh_split(&toy.mesh, t));
        check_mesh(&toy.grid, &toy.mesh);
        t = toy.mesh.triangles[t].child;
    }
    print_message("%" PRId64 " splits, %" PRId64 " of them forced\n", toy.mesh.splits, toy.mesh.forced_splits);
    assert_true(toy.mesh.forced_splits >= 4);
    toy_end(&toy);
}

static void test_the_pool_never_grows_beyond_its_bound(void **state) {
    (void)state;
    Toy toy;
    uint64_t random = SEED;
    toy_begin(&toy, 131, 131, 16, 1777);
    for (int k = 0; k < 20000; k++) {
        step_at_random(&toy, &random);
        assert_true(toy.mesh.leaf_count <= 1777 && toy.mesh.used <= 2 * 1777);
    }
    bool is_full = true;
    for (int32_t t = 0; t < toy.mesh.used; t++)
        if (can_split(&toy, t) && !roam_mesh_has_room(&toy.mesh, t))
            is_full = is_full && !roam_mesh_split(&toy.mesh, t);
    assert_true(is_full && toy.mesh.leaf_count > 1700);
    check_mesh(&toy.grid, &toy.mesh);
    toy_end(&toy);
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
        cmocka_unit_test(test_links_hold_after_random_splits_and_merges),
        cmocka_unit_test(test_merging_all_gives_the_mesh_to_begin_with),
        cmocka_unit_test(test_a_deep_split_forces_its_neighbours_along_the_longest_edges),
        cmocka_unit_test(test_the_pool_never_grows_beyond_its_bound),
        cmocka_unit_test(test_the_budget_goes_where_the_error_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
