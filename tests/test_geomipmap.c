// The parts of the geomipmap methods: errors of levels against a naive count, level rules as printed, borders between
// any levels.
#include "tests/geomip_support.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SEED UINT64_C(1001)

// ---- errors ----

static GeomipPoint point_at(const Dem *dem, int col, int row) {
    return (GeomipPoint){col, row, (double)dem->height_m[(size_t)row * (size_t)dem->width + (size_t)col]};
}

// The height of the triangle's plane at p; NAN outside.
static double height_in(GeomipPoint a, GeomipPoint b, GeomipPoint c, GeomipPoint p) {
    double all = geomip_support_area(a, b, c), u = geomip_support_area(p, b, c) / all,
           v = geomip_support_area(a, p, c) / all, w = geomip_support_area(a, b, p) / all;
    return u < -1e-12 || v < -1e-12 || w < -1e-12 ? NAN : u * a.h + v * b.h + w * c.h;
}

// Sample by sample, in whichever of the level's triangles it lies. The diagonals are those of the bisection.
static double naive_error(const Dem *dem, const ForestTile *square, int stride) {
    double most = 0.0;
    for (int y = 0; y <= square->side; y++) {
        for (int x = 0; x <= square->side; x++) {
            int col = square->col + (x == square->side ? x - 1 : x) / stride * stride;
            int row = square->row + (y == square->side ? y - 1 : y) / stride * stride;
            PatchTriangle halves[2];
            ForestTile cell = {col, row, stride};
            for (int half = 0; half < 2; half++) {
                halves[half] = square_root_triangle(&cell, half);
                const PatchTriangle *t = &halves[half];
                GeomipPoint p = point_at(dem, square->col + x, square->row + y);
                double h = height_in(point_at(dem, t->left.col, t->left.row), point_at(dem, t->right.col, t->right.row),
                                     point_at(dem, t->apex.col, t->apex.row), p);
                most = isnan(h) ? most : fmax(most, fabs(h - p.h));
            }
        }
    }
    return most;
}

static void test_the_error_of_a_level_is_its_largest_deviation(void **state) {
    (void)state;
    GeomipGround g = geomip_support_ground(107, 74, 16, GEOMIP_OMITTED, false);
    for (int32_t i = 0; i < g.tiles.squares.count; i++) {
        for (int level = 0; level <= g.tiles.tiles[i].log_side; level++) {
            double naive = naive_error(terrain_dem(g.terrain), &g.tiles.squares.squares[i], 1 << level);
            double found = (double)geomip_delta(&g.tiles, i, level);
            if (!(found >= naive * (1.0 - 1e-9) && found <= naive * (1.0 + 1e-6) + 1e-6))
                fail_msg("tile %d, level %d: %.9g m, one by one %.9g m", i, level, found, naive);
        }
    }
    geomip_support_ground_end(&g);
}

static void test_bounds_grow_with_the_level_and_with_the_border(void **state) {
    (void)state;
    for (int border = GEOMIP_OMITTED; border <= (int)GEOMIP_FANNED; border++) {
        GeomipGround g = geomip_support_ground(107, 74, 16, (GeomipBorder)border, true);
        for (int32_t i = 0; i < g.tiles.squares.count; i++) {
            int last = g.tiles.tiles[i].log_side;
            for (int k = 0; k < GEOMIP_SIDES * (last + 1) * (last + 1); k++) {
                int side = k % GEOMIP_SIDES, level = k / GEOMIP_SIDES % (last + 1), rim = k / GEOMIP_SIDES / (last + 1);
                if (rim < level)
                    continue;
                float own = geomip_strip(&g.tiles, i, side, level, rim);
                assert_true(rim > level || own == geomip_delta(&g.tiles, i, level));
                assert_true(rim == last || geomip_strip(&g.tiles, i, side, level, rim + 1) >= own);
                assert_true(rim == level || geomip_strip(&g.tiles, i, side, level + 1, rim) >= own);
            }
        }
        geomip_support_ground_end(&g);
    }
}

// ---- level rules ----

static void test_de_boer_s_level_is_the_coarsest_whose_distance_is_reached(void **state) {
    (void)state;
    GeomipGround g = geomip_support_ground(300, 210, 32, GEOMIP_OMITTED, false);
    GeomipLevels levels;
    assert_int_equal(geomip_levels_create(g.tiles.squares.count, &levels), RESULT_OK);
    Vec3d eye = support_eye(g.terrain, 90.0, 120.0, 400.0);
    // n = 1, t = tan 30 degrees, v = 800 lines, tau = 1.5
    double t = tan(30.0 * acos(-1.0) / 180.0), constant = 800.0 / (2.0 * t * 1.5);
    geomip_levels_choose(&g.tiles, (GeomipRule){false, false, 1.0}, eye, 800.0 / (2.0 * t), 1.5, g.jobs, &levels);
    int seen[GEOMIP_LEVELS_MAX] = {0};
    for (int32_t i = 0; i < g.tiles.squares.count; i++) {
        const GeomipTile *tile = &g.tiles.tiles[i];
        double d = vec3d_distance(tile->centre_ecef, eye);
        int expected = 0;
        for (int m = 0; m <= tile->cap; m++)
            if ((double)geomip_delta(&g.tiles, i, m) * constant <= d)
                expected = m;
        assert_int_equal(levels.drawn[i], expected * GEOMIP_LEVEL);
        seen[expected]++;
    }
    print_message("tiles at levels 0..5: %d %d %d %d %d %d\n", seen[0], seen[1], seen[2], seen[3], seen[4], seen[5]);
    assert_true(seen[0] && seen[1] && seen[2]);
    geomip_levels_destroy(&levels);
    geomip_support_ground_end(&g);
}

static void test_ye_s_level_and_morph_follow_the_square_of_the_ground_distance(void **state) {
    (void)state;
    GeomipGround g = geomip_support_ground(300, 210, 32, GEOMIP_FANNED, false);
    GeomipLevels levels;
    assert_int_equal(geomip_levels_create(g.tiles.squares.count, &levels), RESULT_OK);
    Vec3d eye = support_eye(g.terrain, 90.0, 120.0, 3000.0), ground = support_eye(g.terrain, 90.0, 120.0, 0.0);
    Vec3d up = vec3d_normalize(vec3d_sub(eye, ground));
    double share = 2.0 / 692.8; // tau / px_per_rad
    geomip_levels_choose(&g.tiles, (GeomipRule){true, false, 1.0}, eye, 692.8, 2.0, g.jobs, &levels);
    int between = 0;
    for (int32_t i = 0; i < g.tiles.squares.count; i++) {
        Vec3d to = vec3d_sub(g.tiles.tiles[i].centre_ecef, eye);
        to = vec3d_mad(to, up, -vec3d_dot(to, up));
        double delta = share * share * vec3d_dot(to, to), expected = 0.0;
        int n = 0, cap = g.tiles.tiles[i].cap;
        while (n < cap && (double)geomip_delta(&g.tiles, i, n + 1) <= delta)
            n++;
        double low = (double)geomip_delta(&g.tiles, i, n);
        if (n < cap)
            expected = (delta - low) / ((double)geomip_delta(&g.tiles, i, n + 1) - low);
        double found = levels.drawn[i] / (double)GEOMIP_LEVEL - n;
        if (!(found <= expected + 1e-6 && found > expected - 1.0 / GEOMIP_LEVEL - 1e-6))
            fail_msg("tile %d: level %d and %.6f, expected %.6f rounded down to 1/256", i, n, found, expected);
        between += levels.drawn[i] % GEOMIP_LEVEL != 0;
    }
    assert_true(between > 5);
    geomip_levels_destroy(&levels);
    geomip_support_ground_end(&g);
}

// ---- borders ----

static void check_random_levels(int width, int height, int side, GeomipBorder border, uint64_t *random) {
    GeomipGround g = geomip_support_ground(width, height, side, border, false);
    int16_t *levels = malloc(sizeof *levels * (size_t)g.tiles.squares.count);
    assert_non_null(levels);
    for (int round = 0; round < 3; round++) {
        for (int32_t i = 0; i < g.tiles.squares.count; i++) {
            int cap = g.tiles.tiles[i].cap, level = (int)(support_random(random) % (uint64_t)(cap + 1));
            bool whole = border == GEOMIP_OMITTED || level == cap || support_random(random) % 4 == 0;
            levels[i] = (int16_t)(level * GEOMIP_LEVEL + (whole ? 0 : (int)(support_random(random) % GEOMIP_LEVEL)));
        }
        char what[80];
        snprintf(what, sizeof what, "%d x %d in squares of %d, %s", width, height, side,
                 border == GEOMIP_FANNED ? "fans" : "omitted");
        GeomipDrawn d = geomip_support_draw(&g, levels, border);
        support_check_cut(g.terrain, &d.cut, g.jobs, what);
        geomip_support_draw_end(&d);
    }
    free(levels);
    geomip_support_ground_end(&g);
}

static void test_any_levels_beside_each_other_are_whole(void **state) {
    (void)state;
    static const int SIZES[][2] = {{2, 2}, {3, 2}, {2, 71}, {9, 9}, {65, 66}, {129, 97}, {130, 101}, {163, 117}};
    uint64_t random = SEED;
    print_message("seed %" PRIu64 "\n", random);
    for (size_t i = 0; i < COUNT_OF(SIZES); i++)
        for (int side = 2; side <= 128; side *= 2)
            for (int border = GEOMIP_OMITTED; border <= (int)GEOMIP_FANNED; border++)
                check_random_levels(SIZES[i][0], SIZES[i][1], side, (GeomipBorder)border, &random);
}

static void test_one_level_everywhere_is_the_bisection_s_grid(void **state) {
    (void)state;
    GeomipGround g = geomip_support_ground(65, 65, 16, GEOMIP_FANNED, false);
    int16_t levels[16];
    for (int level = 0; level <= 4; level++) {
        for (int border = GEOMIP_OMITTED; border <= (int)GEOMIP_FANNED; border++) {
            for (int i = 0; i < 16; i++)
                levels[i] = (int16_t)(level * GEOMIP_LEVEL);
            GeomipDrawn d = geomip_support_draw(&g, levels, (GeomipBorder)border);
            for (int i = 0; i < 16; i++)
                assert_int_equal(d.items[i].index_count, 3 * 2 * (16 >> level) * (16 >> level));
            for (int k = 0; k < d.items[5].index_count;
                 k += 3) { // each triangle is half a cell, with the cell's diagonal
                int diagonals = 0;
                for (int e = 0; e < 3; e++) {
                    const LodVertex *a = &d.items[5].page->vertices[d.items[5].indices[k + e]];
                    const LodVertex *b = &d.items[5].page->vertices[d.items[5].indices[k + (e + 1) % 3]];
                    int dc = b->col - a->col, dr = b->row - a->row;
                    assert_true(abs(dc) <= 1 << level && abs(dr) <= 1 << level);
                    int col = 16 + (a->col < b->col ? a->col : b->col), row = 16 + (a->row < b->row ? a->row : b->row);
                    if (dc && dr)
                        assert_int_equal(((col >> level) + (row >> level)) & 1, (dc > 0) != (dr > 0));
                    diagonals += dc && dr;
                }
                assert_int_equal(diagonals, 1);
            }
            geomip_support_draw_end(&d);
        }
    }
    geomip_support_ground_end(&g);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_error_of_a_level_is_its_largest_deviation),
        cmocka_unit_test(test_bounds_grow_with_the_level_and_with_the_border),
        cmocka_unit_test(test_de_boer_s_level_is_the_coarsest_whose_distance_is_reached),
        cmocka_unit_test(test_ye_s_level_and_morph_follow_the_square_of_the_ground_distance),
        cmocka_unit_test(test_any_levels_beside_each_other_are_whole),
        cmocka_unit_test(test_one_level_everywhere_is_the_bisection_s_grid),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
