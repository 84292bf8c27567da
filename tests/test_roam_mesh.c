// ROAM's mesh: its links after random splits and merges, what splits force, the bound of its pool.
#include "terrain/roam/roam_base.h"
#include "terrain/terrain_parts.h"
#include "tests/cut_support.h"

#include <inttypes.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define SEED UINT64_C(1618033)

static const DemGeoref GEOREF = {DEM_CRS_GEOGRAPHIC, 0, false, 12.3, 46.9, 0.0006, -0.0004};

// ---- links ----

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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_links_hold_after_random_splits_and_merges),
        cmocka_unit_test(test_merging_all_gives_the_mesh_to_begin_with),
        cmocka_unit_test(test_a_deep_split_forces_its_neighbours_along_the_longest_edges),
        cmocka_unit_test(test_the_pool_never_grows_beyond_its_bound),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
