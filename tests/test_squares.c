// terrain/squares: every cell of a DEM of any size lies in exactly one square, and pages hold their square's samples.
#include "terrain/squares/square_page.h"
#include "terrain/terrain_parts.h"
#include "tests/cut_support.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

static const int SIZES[][2] = {{2, 2},     {3, 2},     {65, 65},  {66, 65},   {130, 101},
                               {327, 468}, {2401, 97}, {2, 5000}, {2049, 65}, {100, 4097}};

static void check_grid(const Forest *forest, int side_max) {
    SquareGrid grid;
    assert_int_equal(square_grid_create(forest, side_max, &grid), RESULT_OK);
    int64_t area = 0;
    for (int32_t i = 0; i < grid.count; i++) {
        const ForestTile *s = &grid.squares[i];
        area += (int64_t)s->side * s->side;
        assert_true(s->side <= side_max && s->col % s->side == 0 && s->row % s->side == 0);
        for (int row = s->row; row < s->row + s->side; row++)
            for (int col = s->col; col < s->col + s->side; col++)
                if (square_grid_at(&grid, col, row) != i)
                    fail_msg("%d x %d in squares of %d: cell (%d, %d) is in square %d, expected %d", forest->width,
                             forest->height, side_max, col, row, square_grid_at(&grid, col, row), i);
    }
    assert_int_equal(area, (int64_t)(forest->width - 1) * (forest->height - 1));
    assert_int_equal(square_grid_at(&grid, -1, 0), -1);
    assert_int_equal(square_grid_at(&grid, 0, -1), -1);
    assert_int_equal(square_grid_at(&grid, forest->width - 1, 0), -1);
    assert_int_equal(square_grid_at(&grid, 0, forest->height - 1), -1);
    square_grid_destroy(&grid);
}

static void test_each_cell_lies_in_one_square(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT_OF(SIZES); i++) {
        Forest forest;
        assert_int_equal(forest_create(SIZES[i][0], SIZES[i][1], &forest), RESULT_OK);
        for (int side = 2; side <= 128; side *= 4)
            check_grid(&forest, side);
        check_grid(&forest, 64);
        forest_destroy(&forest);
    }
}

static Terrain *make_terrain(Jobs **jobs) {
    const DemGeoref georef = {DEM_CRS_GEOGRAPHIC, 0, false, 7.0, 46.0, 0.001, -0.0008};
    assert_int_equal(jobs_create(1, jobs), RESULT_OK);
    return support_terrain(support_rough_dem(101, 77, &georef, 500.0, 5), TERRAIN_ERROR_TOTAL, 6, *jobs);
}

static void check_page(const Terrain *terrain, const ForestTile *square, const SquarePage *page) {
    for (int row = square->row; row <= square->row + square->side; row += page->stride) {
        for (int col = square->col; col <= square->col + square->side; col += page->stride) {
            const LodPage *shown = &page->shown;
            uint16_t number = square_page_vertex(page, col, row);
            assert_true(number < shown->vertex_count);
            const LodVertex *v = &shown->vertices[number];
            float h = terrain->dem->height_m[row * terrain->dem->width + col];
            GridPoint p = grid_lattice(terrain->grid, col, row, (double)h);
            assert_int_equal(shown->col0 + v->col, col);
            assert_int_equal(shown->row0 + v->row, row);
            assert_true(shown->origin.x + v->x == p.x && shown->origin.y + v->y == p.y &&
                        shown->origin.z + v->z == p.z);
            assert_true(vec3d_distance(grid_point_ecef(p), page->centre_ecef) <= page->radius_m);
        }
    }
}

static void test_pages_hold_the_samples_of_their_square(void **state) {
    (void)state;
    Jobs *jobs;
    Terrain *terrain = make_terrain(&jobs);
    SquareGrid grid;
    SquarePageStore store;
    assert_int_equal(square_grid_create(&terrain->forest, 16, &grid), RESULT_OK);
    assert_int_equal(square_page_store_create(&grid, 100, &store), RESULT_OK);
    for (int32_t i = 0; i < grid.count; i++) {
        for (int stride = 1; stride <= grid.squares[i].side; stride *= 2) {
            SquarePage *page = square_page_take(&store, i, stride, 1);
            assert_non_null(page);
            assert_false(page->filled);
            square_page_fill(page, &grid, terrain);
            check_page(terrain, &grid.squares[i], page);
            assert_ptr_equal(square_page_take(&store, i, stride, 1), page);
        }
    }
    square_page_store_destroy(&store);
    square_grid_destroy(&grid);
    terrain_destroy(&terrain);
    jobs_destroy(&jobs);
}

static void test_what_is_still_drawn_is_not_evicted(void **state) {
    (void)state;
    Jobs *jobs;
    Terrain *terrain = make_terrain(&jobs);
    SquareGrid grid;
    SquarePageStore store;
    assert_int_equal(square_grid_create(&terrain->forest, 16, &grid), RESULT_OK);
    assert_int_equal(square_page_store_create(&grid, 0, &store), RESULT_OK);
    SquarePage *old = square_page_take(&store, 0, 1, 1), *kept = square_page_take(&store, 1, 1, 2);
    uint64_t old_id = old->shown.id, kept_id = kept->shown.id;
    square_page_evict(&store, 1, 0);
    assert_ptr_equal(square_page_take(&store, 1, 1, 3), kept);
    assert_int_equal(kept->shown.id, kept_id);
    SquarePage *again = square_page_take(&store, 0, 1, 3);
    assert_true(again->shown.id > kept_id && again->shown.id > old_id && !again->filled);
    size_t bytes = store.bytes;
    square_page_evict(&store, 3, bytes / 2);
    assert_true(store.bytes <= bytes / 2);
    square_page_store_destroy(&store);
    square_grid_destroy(&grid);
    terrain_destroy(&terrain);
    jobs_destroy(&jobs);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_each_cell_lies_in_one_square),
        cmocka_unit_test(test_pages_hold_the_samples_of_their_square),
        cmocka_unit_test(test_what_is_still_drawn_is_not_evicted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
