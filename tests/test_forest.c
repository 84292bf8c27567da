// The forest covers every cell once, and patches, templates and index lists are what their headers say.
#include "terrain/forest.h"
#include "terrain/lod/partition.h"
#include "terrain/patches/index_pool.h"
#include "terrain/patches/patch_forest.h"
#include "terrain/patches/refine.h"
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

#define SEED UINT64_C(4096)

static void check_cover(int width, int height) {
    Forest forest;
    assert_int_equal(forest_create(width, height, &forest), RESULT_OK);
    size_t cells = (size_t)(width - 1) * (size_t)(height - 1);
    uint8_t *covered = calloc(cells, 1);
    for (int32_t i = 0; i < forest.tile_count; i++) {
        ForestTile t = forest.tiles[i];
        assert_true(t.side > 0 && t.side <= FOREST_SIDE_MAX && (t.side & (t.side - 1)) == 0);
        assert_int_equal(t.col % t.side, 0);
        assert_int_equal(t.row % t.side, 0);
        for (int row = t.row; row < t.row + t.side; row++)
            for (int col = t.col; col < t.col + t.side; col++)
                covered[(size_t)row * (size_t)(width - 1) + (size_t)col]++;
    }
    for (size_t i = 0; i < cells; i++)
        if (covered[i] != 1)
            fail_msg("%d x %d: cell %zu is covered %d times", width, height, i, covered[i]);
    free(covered);
    forest_destroy(&forest);
}

static void test_tiles_cover_every_cell_once(void **state) {
    (void)state;
    static const int SIZES[][2] = {{2, 2},       {3, 2},       {2, 3},     {5000, 3}, {344, 403},
                                   {2401, 2401}, {2049, 2049}, {4801, 17}, {1, 1}};
    for (size_t i = 0; i + 1 < COUNT_OF(SIZES); i++)
        check_cover(SIZES[i][0], SIZES[i][1]);
    Forest none;
    assert_int_equal(forest_create(1, 5, &none), RESULT_RANGE);
}

// Twice the area in units of one leaf; positive where counter-clockwise seen from above (rows grow southwards).
static int template_area(const PatchTemplate *p, const uint16_t *t) {
    int ai = p->position[t[0]][0], aj = p->position[t[0]][1];
    int bi = p->position[t[1]][0] - ai, bj = p->position[t[1]][1] - aj;
    int ci = p->position[t[2]][0] - ai, cj = p->position[t[2]][1] - aj;
    return ci * bj - cj * bi;
}

static void test_a_full_patch_covers_its_triangle_once(void **state) {
    (void)state;
    for (int depth = 0; depth <= PATCH_TEMPLATE_DEPTH_MAX; depth += 2) {
        PatchTemplate p;
        assert_int_equal(patch_template_create(depth, &p), RESULT_OK);
        assert_int_equal(p.level_begin[depth], p.vertex_count);
        uint16_t *indices = malloc(sizeof *indices * refine_indices_max(&p));
        int32_t count = refine_all(&p, indices);
        assert_int_equal(count, 3 * p.triangle_count);
        int64_t area = 0;
        for (int32_t i = 0; i < count; i += 3) {
            assert_true(template_area(&p, indices + i) > 0);
            area += template_area(&p, indices + i);
        }
        assert_int_equal(area, p.side * p.side);
        free(indices);
        patch_template_destroy(&p);
    }
    PatchTemplate odd;
    assert_int_equal(patch_template_create(3, &odd), RESULT_RANGE);
}

// A patch that does not split can show every active vertex in it: its error is that of its first missing level or more.
static void test_patch_errors_cover_what_their_pages_lack(void **state) {
    (void)state;
    const DemGeoref georef = {DEM_CRS_GEOGRAPHIC, 0, false, 7.0, 46.0, 0.001, -0.0008};
    Jobs *jobs;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    Terrain *terrain = support_terrain(support_rough_dem(260, 193, &georef, 800.0, SEED), TERRAIN_ERROR_TOTAL, 6, jobs);
    const PatchForest *forest = &terrain->patches;
    int64_t checked = 0;
    for (int k = 0; k < forest->plane_count; k++) {
        const PatchPlane *plane = &forest->planes[k];
        int fine = plane->step / forest->side;
        for (int row = 0; row < 193; row += fine) {
            for (int col = 0; col < 260; col += fine) {
                if ((col | row) % (2 * fine) == 0)
                    continue;
                bool centre = col / fine % 2 && row / fine % 2;
                float delta = error_field_decode(error_field_at(&terrain->errors, col, row).delta);
                for (int j = 0; j < plane->height; j++) {
                    for (int i = 0; i < plane->width; i++) {
                        if (!((i | j) & 1) || (i & j & 1) != centre)
                            continue;
                        int dc = abs(col - i * plane->step), dr = abs(row - j * plane->step);
                        if (centre ? dc > plane->step || dr > plane->step : dc + dr > plane->step)
                            continue;
                        const PatchVertex *v = &plane->vertices[j * plane->width + i];
                        checked++;
                        if (v->delta < delta)
                            fail_msg("patch vertex (%d, %d) has %g m, its vertex (%d, %d) %g m", i * plane->step,
                                     j * plane->step, (double)v->delta, col, row, (double)delta);
                    }
                }
            }
        }
    }
    print_message("%" PRId64 " pairs\n", checked);
    assert_true(checked > 1000);
    terrain_destroy(&terrain);
    jobs_destroy(&jobs);
}

static void test_a_sample_takes_less_than_twelve_bytes(void **state) {
    (void)state;
    const DemGeoref georef = {DEM_CRS_GEOGRAPHIC, 0, false, 7.0, 46.0, 0.001, -0.0008};
    Jobs *jobs;
    assert_int_equal(jobs_create(1, &jobs), RESULT_OK);
    Terrain *terrain =
        support_terrain(support_rough_dem(1025, 900, &georef, 800.0, SEED), TERRAIN_ERROR_TOTAL, 12, jobs);
    double bytes = (double)terrain_sample_bytes(terrain) / (1025.0 * 900.0);
    print_message("%.2f bytes a sample\n", bytes);
    assert_true(bytes < 12.0);
    terrain_destroy(&terrain);
    jobs_destroy(&jobs);
}

static void test_index_lists_do_not_overlap_and_are_reused(void **state) {
    (void)state;
    IndexPool pool = {0};
    uint16_t *lists[500];
    int classes[500];
    uint64_t random = SEED;
    for (int round = 0; round < 20; round++) {
        for (int i = 0; i < 500; i++) {
            int32_t count = (int32_t)support_between(&random, 3, 12288);
            classes[i] = index_pool_class(count);
            lists[i] = index_pool_take(&pool, classes[i]);
            assert_non_null(lists[i]);
            assert_int_equal((uintptr_t)lists[i] % 8, 0);
            for (int32_t k = 0; k < count; k++)
                lists[i][k] = (uint16_t)i;
            lists[i][0] = (uint16_t)count;
        }
        for (int i = 0; i < 500; i++) {
            for (int32_t k = 1; k < lists[i][0]; k++)
                assert_int_equal(lists[i][k], i);
            index_pool_give_back(&pool, lists[i], classes[i]);
        }
    }
    size_t before = pool.system_allocations;
    index_pool_give_back(&pool, index_pool_take(&pool, 3), 3);
    assert_int_equal(pool.system_allocations, before);
    index_pool_destroy(&pool);
}

static void test_two_partitions_are_the_sides_of_the_plane_of_sight(void **state) {
    (void)state;
    Vec3d eye = {6378137.0 + 1000.0, 0.0, 0.0}; // over the equator, up is x, north z, east y
    ObserverLine line = partition_observer_line(eye, vec3d(-0.2, 0.0, 1.0));
    double borders[2];
    partition_borders(2, NULL, NULL, 0, NULL, borders);
    Vec3d east = vec3d_add(eye, vec3d(-300.0, 50.0, 1000.0)), west = vec3d_add(eye, vec3d(-300.0, -50.0, -1000.0));
    assert_int_equal(partition_of(borders, 2, partition_turn(&line, east)), 0);
    assert_int_equal(partition_of(borders, 2, partition_turn(&line, west)), 1);
    ObserverLine down = partition_observer_line(eye, vec3d(-1.0, 0.0, 0.0));
    assert_true(fabs(vec3d_length(down.right) - 1.0) < 1e-12 && fabs(vec3d_dot(down.right, eye)) < 1e-3);
}

static void test_sectors_share_the_predicted_work(void **state) {
    (void)state;
    enum { ITEMS = 2000, SECTORS = 5 };
    static double turns[ITEMS], work[ITEMS];
    static int32_t order[ITEMS];
    double borders[SECTORS], sums[SECTORS] = {0}, total = 0.0;
    uint64_t random = SEED;
    for (int i = 0; i < ITEMS; i++) {
        turns[i] = pow(support_between(&random, 0.0, 1.0), 3.0);
        work[i] = support_between(&random, 1.0, 40.0);
        total += work[i];
    }
    partition_borders(SECTORS, turns, work, ITEMS, order, borders);
    for (int i = 0; i < ITEMS; i++)
        sums[partition_of(borders, SECTORS, turns[i])] += work[i];
    for (int k = 0; k < SECTORS; k++) {
        print_message("sector %d: %.1f %% of the work\n", k, 100.0 * sums[k] / total);
        assert_true(fabs(sums[k] / total - 1.0 / SECTORS) < 0.01);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tiles_cover_every_cell_once),
        cmocka_unit_test(test_a_full_patch_covers_its_triangle_once),
        cmocka_unit_test(test_patch_errors_cover_what_their_pages_lack),
        cmocka_unit_test(test_a_sample_takes_less_than_twelve_bytes),
        cmocka_unit_test(test_index_lists_do_not_overlap_and_are_reused),
        cmocka_unit_test(test_two_partitions_are_the_sides_of_the_plane_of_sight),
        cmocka_unit_test(test_sectors_share_the_predicted_work),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
