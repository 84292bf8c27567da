// The parts of the geomipmap methods: errors of levels against a naive count, level rules as printed, borders between
// any levels, and the morph: continuous, and the same on both sides of a border.
#include "base/arena.h"
#include "terrain/geomipmap/geomip_page.h"
#include "terrain/squares/square_page.h"
#include "tests/cut_support.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SEED UINT64_C(20001031)

static const DemGeoref GEOREF = {DEM_CRS_GEOGRAPHIC, 0, false, 12.3, 46.9, 0.0006, -0.0004};

typedef struct Ground {
    Jobs *jobs;
    Terrain *terrain;
    GeomipTiles tiles;
} Ground;

static Ground ground_begin(int width, int height, int side, GeomipBorder border, bool bounds) {
    Ground g = {0};
    assert_int_equal(jobs_create(2, &g.jobs), RESULT_OK);
    g.terrain = support_terrain(support_rough_dem(width, height, &GEOREF, 900.0, SEED), TERRAIN_ERROR_TOTAL, 4, g.jobs);
    GeomipInput input = {g.terrain, side, border, bounds};
    assert_int_equal(geomip_tiles_create(&input, g.jobs, &g.tiles), RESULT_OK);
    return g;
}

static void ground_end(Ground *g) {
    geomip_tiles_destroy(&g->tiles);
    terrain_destroy(&g->terrain);
    jobs_destroy(&g->jobs);
}

// ---- errors ----

typedef struct Point {
    double col, row, h;
} Point;

static Point point_at(const Dem *dem, int col, int row) {
    return (Point){col, row, (double)dem->height_m[(size_t)row * (size_t)dem->width + (size_t)col]};
}

static double area(Point a, Point b, Point c) {
    return (b.col - a.col) * (c.row - a.row) - (b.row - a.row) * (c.col - a.col);
}

// The height of the triangle's plane at p; NAN outside.
static double height_in(Point a, Point b, Point c, Point p) {
    double all = area(a, b, c), u = area(p, b, c) / all, v = area(a, p, c) / all, w = area(a, b, p) / all;
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
                Point p = point_at(dem, square->col + x, square->row + y);
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
    Ground g = ground_begin(107, 74, 16, GEOMIP_OMITTED, false);
    for (int32_t i = 0; i < g.tiles.squares.count; i++) {
        for (int level = 0; level <= g.tiles.tiles[i].log_side; level++) {
            double naive = naive_error(terrain_dem(g.terrain), &g.tiles.squares.squares[i], 1 << level);
            double found = (double)geomip_delta(&g.tiles, i, level);
            if (!(found >= naive * (1.0 - 1e-9) && found <= naive * (1.0 + 1e-6) + 1e-6))
                fail_msg("tile %d, level %d: %.9g m, one by one %.9g m", i, level, found, naive);
        }
    }
    ground_end(&g);
}

static void test_bounds_grow_with_the_level_and_with_the_border(void **state) {
    (void)state;
    for (int border = GEOMIP_OMITTED; border <= (int)GEOMIP_FANNED; border++) {
        Ground g = ground_begin(107, 74, 16, (GeomipBorder)border, true);
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
        ground_end(&g);
    }
}

// ---- level rules ----

static void test_de_boer_s_level_is_the_coarsest_whose_distance_is_reached(void **state) {
    (void)state;
    Ground g = ground_begin(300, 210, 32, GEOMIP_OMITTED, false);
    GeomipLevels levels;
    assert_int_equal(geomip_levels_create(g.tiles.squares.count, &levels), RESULT_OK);
    Vec3d eye = support_eye(g.terrain, 90.0, 120.0, 400.0);
    // n = 1, t = tan 30 degrees, v = 800 lines, tau = 1.5
    double t = tan(30.0 * acos(-1.0) / 180.0), constant = 800.0 / (2.0 * t * 1.5);
    geomip_levels_choose(&g.tiles, (GeomipRule){false, false}, eye, 800.0 / (2.0 * t), 1.5, g.jobs, &levels);
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
    ground_end(&g);
}

static void test_ye_s_level_and_morph_follow_the_square_of_the_ground_distance(void **state) {
    (void)state;
    Ground g = ground_begin(300, 210, 32, GEOMIP_FANNED, false);
    GeomipLevels levels;
    assert_int_equal(geomip_levels_create(g.tiles.squares.count, &levels), RESULT_OK);
    Vec3d eye = support_eye(g.terrain, 90.0, 120.0, 3000.0), ground = support_eye(g.terrain, 90.0, 120.0, 0.0);
    Vec3d up = vec3d_normalize(vec3d_sub(eye, ground));
    double share = 2.0 / 692.8; // tau / px_per_rad
    geomip_levels_choose(&g.tiles, (GeomipRule){true, false}, eye, 692.8, 2.0, g.jobs, &levels);
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
    ground_end(&g);
}

// ---- a cut of given levels ----

typedef struct Drawn {
    LodCut cut;
    LodItem *items;
    GeomipPageStore pages;
    SquarePageStore squares;
} Drawn;

static LodItem draw_tile(Drawn *d, const Ground *g, const int16_t *levels, int32_t tile, GeomipBorder border) {
    GeomipOutline outline;
    GeomipSize size = geomip_mesh_size(&g->tiles, levels, tile, border);
    geomip_mesh_outline(&g->tiles, levels, tile, border, &outline);
    uint16_t *indices = malloc(sizeof *indices * 3 * (size_t)size.triangles);
    assert_non_null(indices);
    int32_t count = geomip_mesh_indices(&outline, &g->tiles.squares.squares[tile], border, indices);
    assert_int_equal(count, 3 * size.triangles);
    LodItem item = {.indices = indices, .index_count = count};
    if (border == GEOMIP_FANNED) {
        GeomipPage *page = geomip_page_take(&d->pages, size.vertices);
        assert_non_null(page);
        assert_int_equal(outline.vertex_count, size.vertices);
        geomip_page_fill(page, &g->tiles, levels, tile, &outline);
        item.page = &page->shown;
    } else {
        SquarePage *page = square_page_take(&d->squares, tile, outline.stride, 1);
        assert_non_null(page);
        square_page_fill(page, &g->tiles.squares, g->terrain);
        item.page = &page->shown;
    }
    return item;
}

static Drawn draw(const Ground *g, const int16_t *levels, GeomipBorder border) {
    int32_t count = g->tiles.squares.count;
    Drawn d = {.items = malloc(sizeof(LodItem) * (size_t)count)};
    assert_non_null(d.items);
    assert_int_equal(square_page_store_create(&g->tiles.squares, 0, &d.squares), RESULT_OK);
    for (int32_t i = 0; i < count; i++)
        d.items[i] = draw_tile(&d, g, levels, i, border);
    d.cut = (LodCut){.item_count = count, .items = d.items};
    d.cut.view = support_view(support_eye(g->terrain, 10.0, 10.0, 5000.0), 1.0);
    return d;
}

static void draw_end(Drawn *d) {
    for (int32_t i = 0; i < d->cut.item_count; i++) {
        free((void *)(uintptr_t)d->items[i].indices);
        if (!d->squares.oldest)
            geomip_page_retire(&d->pages, (GeomipPage *)(uintptr_t)d->items[i].page, 0); // its first member
    }
    geomip_page_store_destroy(&d->pages);
    square_page_store_destroy(&d->squares);
    free(d->items);
}

// ---- borders ----

static void check_random_levels(int width, int height, int side, GeomipBorder border, uint64_t *random) {
    Ground g = ground_begin(width, height, side, border, false);
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
        Drawn d = draw(&g, levels, border);
        support_check_cut(g.terrain, &d.cut, g.jobs, what);
        draw_end(&d);
    }
    free(levels);
    ground_end(&g);
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
    Ground g = ground_begin(65, 65, 16, GEOMIP_FANNED, false);
    int16_t levels[16];
    for (int level = 0; level <= 4; level++) {
        for (int border = GEOMIP_OMITTED; border <= (int)GEOMIP_FANNED; border++) {
            for (int i = 0; i < 16; i++)
                levels[i] = (int16_t)(level * GEOMIP_LEVEL);
            Drawn d = draw(&g, levels, (GeomipBorder)border);
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
            draw_end(&d);
        }
    }
    ground_end(&g);
}

// ---- the morph ----

// Where the surface is at every sample.
static void rasterise(const LodCut *cut, int width, Vec3d *surface) {
    for (int32_t i = 0; i < cut->item_count; i++) {
        const LodItem *item = &cut->items[i];
        for (int32_t k = 0; k < item->index_count; k += 3) {
            Point p[3];
            Vec3d at[3];
            for (int c = 0; c < 3; c++) {
                const LodVertex *v = &item->page->vertices[item->indices[k + c]];
                const GridPoint *o = &item->page->origin;
                p[c] = (Point){item->page->col0 + v->col, item->page->row0 + v->row, 0.0};
                at[c] = grid_point_ecef((GridPoint){o->x + v->x, o->y + v->y, o->z + v->z});
            }
            double all = area(p[0], p[1], p[2]);
            int left = (int)fmin(fmin(p[0].col, p[1].col), p[2].col),
                right = (int)fmax(fmax(p[0].col, p[1].col), p[2].col);
            int top = (int)fmin(fmin(p[0].row, p[1].row), p[2].row),
                low = (int)fmax(fmax(p[0].row, p[1].row), p[2].row);
            for (int row = top; row <= low; row++) {
                for (int col = left; col <= right; col++) {
                    Point s = {col, row, 0.0};
                    double u = area(s, p[1], p[2]) / all, v = area(p[0], s, p[2]) / all, w = 1.0 - u - v;
                    if (u >= -1e-12 && v >= -1e-12 && w >= -1e-12)
                        surface[row * width + col] = vec3d_mad(vec3d_mad(vec3d_scale(at[0], u), at[1], v), at[2], w);
                }
            }
        }
    }
}

// By how much a tile's surface may move: its own and its neighbours' steps between levels, each of which moves it by
// the two levels' errors at most, and what the Earth's curvature adds to both.
static double allowed_movement(const Ground *g, int32_t tile, const int16_t *now, const int16_t *then) {
    double sum = 0.003;
    for (int32_t k = g->tiles.tiles[tile].first_link - 1; k < g->tiles.tiles[tile + 1].first_link; k++) {
        int32_t j = k < g->tiles.tiles[tile].first_link ? tile : g->tiles.links[k].tile;
        if (j == GEOMIP_OUTSIDE)
            continue;
        int high = now[j] > then[j] ? now[j] : then[j], cap = g->tiles.tiles[j].cap;
        int level = (high + GEOMIP_LEVEL - 1) / GEOMIP_LEVEL < cap ? (high + GEOMIP_LEVEL - 1) / GEOMIP_LEVEL : cap;
        sum += abs(now[j] - then[j]) / (double)GEOMIP_LEVEL * (2.0 * (double)geomip_delta(&g->tiles, j, level) + 0.5);
    }
    return sum;
}

static void check_movement(const Ground *g, const Vec3d *a, const Vec3d *b, const int16_t *now, const int16_t *then,
                           double *most) {
    int width = terrain_dem(g->terrain)->width;
    for (int32_t i = 0; i < g->tiles.squares.count; i++) {
        const ForestTile *q = &g->tiles.squares.squares[i];
        double allowed = allowed_movement(g, i, now, then);
        for (int row = q->row + 1; row < q->row + q->side; row++) {
            for (int col = q->col + 1; col < q->col + q->side; col++) {
                double moved = vec3d_distance(a[row * width + col], b[row * width + col]);
                *most = fmax(*most, moved);
                if (moved > allowed)
                    fail_msg("sample (%d, %d) moved %.4f m, tile %d went from %.3f to %.3f: at most %.4f m", col, row,
                             moved, i, then[i] / 256.0, now[i] / 256.0, allowed);
            }
        }
    }
}

static void test_nothing_pops_while_the_eye_moves(void **state) {
    (void)state;
    enum { WIDTH = 149, HEIGHT = 133, STEPS = 500 };
    Ground g = ground_begin(WIDTH, HEIGHT, 32, GEOMIP_FANNED, false);
    GeomipLevels levels;
    Vec3d *surfaces[2] = {calloc(WIDTH * HEIGHT, sizeof(Vec3d)), calloc(WIDTH * HEIGHT, sizeof(Vec3d))};
    assert_non_null(surfaces[0]);
    assert_non_null(surfaces[1]);
    int16_t *then = calloc((size_t)g.tiles.squares.count, sizeof *then);
    assert_non_null(then);
    assert_int_equal(geomip_levels_create(g.tiles.squares.count, &levels), RESULT_OK);
    int changes = 0, fastest = 0;
    double most = 0.0;
    for (int step = 0; step < STEPS; step++) {
        Vec3d eye = support_eye(g.terrain, 30.0 + 0.15 * step, 60.0, 500.0);
        geomip_levels_choose(&g.tiles, (GeomipRule){true, false}, eye, 692.8, 3.0, g.jobs, &levels);
        Drawn d = draw(&g, levels.drawn, GEOMIP_FANNED);
        rasterise(&d.cut, WIDTH, surfaces[step % 2]);
        draw_end(&d);
        if (step)
            check_movement(&g, surfaces[step % 2], surfaces[1 - step % 2], levels.drawn, then, &most);
        for (int32_t i = 0; i < g.tiles.squares.count; i++) {
            changes += step && levels.drawn[i] / GEOMIP_LEVEL != then[i] / GEOMIP_LEVEL;
            int by = step ? abs(levels.drawn[i] - then[i]) : 0;
            fastest = by > fastest ? by : fastest;
            then[i] = levels.drawn[i];
        }
    }
    print_message("%d changes of level; a tile moves by %d/256 of a level a step at most, a sample by %.3f m\n",
                  changes, fastest, most);
    assert_true(changes > 20 && fastest < GEOMIP_LEVEL / 2);
    free(then);
    free(surfaces[0]);
    free(surfaces[1]);
    geomip_levels_destroy(&levels);
    ground_end(&g);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_error_of_a_level_is_its_largest_deviation),
        cmocka_unit_test(test_bounds_grow_with_the_level_and_with_the_border),
        cmocka_unit_test(test_de_boer_s_level_is_the_coarsest_whose_distance_is_reached),
        cmocka_unit_test(test_ye_s_level_and_morph_follow_the_square_of_the_ground_distance),
        cmocka_unit_test(test_any_levels_beside_each_other_are_whole),
        cmocka_unit_test(test_one_level_everywhere_is_the_bisection_s_grid),
        cmocka_unit_test(test_nothing_pops_while_the_eye_moves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
