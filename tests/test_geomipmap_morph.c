// The morph of Ye and Wang: no sample's surface jumps while the eye moves, whatever the levels around it do.
#include "tests/geomip_support.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

// Where the surface is at every sample.
static void rasterise(const LodCut *cut, int width, Vec3d *surface) {
    for (int32_t i = 0; i < cut->item_count; i++) {
        const LodItem *item = &cut->items[i];
        for (int32_t k = 0; k < item->index_count; k += 3) {
            GeomipPoint p[3];
            Vec3d at[3];
            for (int c = 0; c < 3; c++) {
                const LodVertex *v = &item->page->vertices[item->indices[k + c]];
                const GridPoint *o = &item->page->origin;
                p[c] = (GeomipPoint){item->page->col0 + v->col, item->page->row0 + v->row, 0.0};
                at[c] = grid_point_ecef((GridPoint){o->x + v->x, o->y + v->y, o->z + v->z});
            }
            double all = geomip_support_area(p[0], p[1], p[2]);
            int left = (int)fmin(fmin(p[0].col, p[1].col), p[2].col),
                right = (int)fmax(fmax(p[0].col, p[1].col), p[2].col);
            int top = (int)fmin(fmin(p[0].row, p[1].row), p[2].row),
                low = (int)fmax(fmax(p[0].row, p[1].row), p[2].row);
            for (int row = top; row <= low; row++) {
                for (int col = left; col <= right; col++) {
                    GeomipPoint s = {col, row, 0.0};
                    double u = geomip_support_area(s, p[1], p[2]) / all, v = geomip_support_area(p[0], s, p[2]) / all,
                           w = 1.0 - u - v;
                    if (u >= -1e-12 && v >= -1e-12 && w >= -1e-12)
                        surface[row * width + col] = vec3d_mad(vec3d_mad(vec3d_scale(at[0], u), at[1], v), at[2], w);
                }
            }
        }
    }
}

// By how much a tile's surface may move: a step between levels, its own or a neighbour's, moves it by the errors of the
// levels and borders around at most, and by what the Earth's curvature adds to them.
static double allowed_movement(const GeomipGround *g, int32_t tile, const int16_t *now, const int16_t *then) {
    double errors = 0.5, steps = 0.0;
    for (int32_t k = g->tiles.tiles[tile].first_link - 1; k < g->tiles.tiles[tile + 1].first_link; k++) {
        int32_t j = k < g->tiles.tiles[tile].first_link ? tile : g->tiles.links[k].tile;
        if (j == GEOMIP_OUTSIDE)
            continue;
        int high = now[j] > then[j] ? now[j] : then[j], cap = g->tiles.tiles[j].cap;
        int level = (high + GEOMIP_LEVEL - 1) / GEOMIP_LEVEL;
        errors += 2.0 * (double)geomip_delta(&g->tiles, j, level < cap ? level : cap);
        steps += abs(now[j] - then[j]) / (double)GEOMIP_LEVEL;
    }
    return 0.003 + steps * errors;
}

static void check_movement(const GeomipGround *g, const Vec3d *a, const Vec3d *b, const int16_t *now,
                           const int16_t *then, double *most) {
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

enum { WIDTH = 149, HEIGHT = 133, STEPS = 500 };

typedef struct Walk {
    GeomipGround ground;
    GeomipLevels levels;
    Vec3d *surfaces[2]; // of this step and the one before, [HEIGHT][WIDTH]
    int16_t *then;      // [tile] levels of the step before
    int changes, fastest;
    double most;
} Walk;

static Walk walk_begin(bool bounds) {
    Walk w = {.ground = geomip_support_ground(WIDTH, HEIGHT, 32, GEOMIP_FANNED, bounds)};
    int32_t count = w.ground.tiles.squares.count;
    for (int i = 0; i < 2; i++) {
        w.surfaces[i] = calloc(WIDTH * HEIGHT, sizeof(Vec3d));
        assert_non_null(w.surfaces[i]);
    }
    w.then = calloc((size_t)count, sizeof *w.then);
    assert_non_null(w.then);
    assert_int_equal(geomip_levels_create(count, &w.levels), RESULT_OK);
    return w;
}

static void walk_end(Walk *w) {
    free(w->then);
    free(w->surfaces[0]);
    free(w->surfaces[1]);
    geomip_levels_destroy(&w->levels);
    geomip_support_ground_end(&w->ground);
}

static void compare_levels(Walk *w) {
    for (int32_t i = 0; i < w->ground.tiles.squares.count; i++) {
        int by = abs(w->levels.drawn[i] - w->then[i]);
        w->changes += w->levels.drawn[i] / GEOMIP_LEVEL != w->then[i] / GEOMIP_LEVEL;
        w->fastest = by > w->fastest ? by : w->fastest;
    }
}

// Along a straight line, 11 m a step.
static void walk(bool bounds, double above_m, double tau_px) {
    Walk w = walk_begin(bounds);
    GeomipGround *g = &w.ground;
    Vec3d begin = support_eye(g->terrain, 20.0, 55.0, above_m), end = support_eye(g->terrain, 120.0, 80.0, above_m);
    for (int step = 0; step < STEPS; step++) {
        Vec3d eye = vec3d_mad(begin, vec3d_sub(end, begin), (double)step / STEPS);
        geomip_levels_choose(&g->tiles, (GeomipRule){true, bounds, 1.0}, eye, 692.8, tau_px, g->jobs, &w.levels);
        GeomipDrawn d = geomip_support_draw(g, w.levels.drawn, GEOMIP_FANNED);
        rasterise(&d.cut, WIDTH, w.surfaces[step % 2]);
        geomip_support_draw_end(&d);
        if (step) {
            check_movement(g, w.surfaces[step % 2], w.surfaces[1 - step % 2], w.levels.drawn, w.then, &w.most);
            compare_levels(&w);
        }
        memcpy(w.then, w.levels.drawn, sizeof *w.then * (size_t)g->tiles.squares.count);
    }
    print_message("%d changes of level; a tile moves by %d/256 of a level a step at most, a sample by %.3f m\n",
                  w.changes, w.fastest, w.most);
    assert_true(w.changes > 20);
    assert_true(w.fastest < GEOMIP_LEVEL / 2);
    walk_end(&w);
}

static void test_nothing_pops_while_the_eye_moves(void **state) {
    (void)state;
    walk(false, 500.0, 3.0);
}

static void test_nothing_pops_with_the_bound_kept(void **state) {
    (void)state;
    walk(true, 1500.0, 12.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nothing_pops_while_the_eye_moves),
        cmocka_unit_test(test_nothing_pops_with_the_bound_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
