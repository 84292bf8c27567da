// ROAM kept from frame to frame equals ROAM built anew, whatever the flight; the queue that it waits in.
#include "base/arena.h"
#include "base/log.h"
#include "terrain/roam/roam_queue.h"
#include "tests/cut_support.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SEED UINT64_C(2718281)

static const DemGeoref GEOREF = {DEM_CRS_GEOGRAPHIC, 0, false, 12.3, 46.9, 0.0006, -0.0004};

// ---- the queue ----

static void check_queue(RoamQueue *queue, uint32_t *keys, int32_t count, uint32_t now) {
    roam_queue_advance(queue, now);
    int32_t expected = 0, taken = 0;
    for (int32_t i = 0; i < count; i++)
        expected += keys[i] && keys[i] <= now;
    for (int32_t t; (t = roam_queue_take(queue)) >= 0; taken++) {
        if (!keys[t] || keys[t] > now)
            fail_msg("at %u: %d came, whose key is %u", now, t, keys[t]);
        keys[t] = 0;
    }
    if (taken != expected)
        fail_msg("at %u: %d came, %d were due", now, taken, expected);
}

static void test_triangles_come_out_of_the_queue_when_they_are_due(void **state) {
    (void)state;
    enum { COUNT = 500 };
    uint32_t keys[COUNT] = {0}, now = 0; // 0: not waiting
    uint64_t random = SEED;
    RoamQueue queue = {0};
    assert_int_equal(roam_queue_reserve(&queue, COUNT), RESULT_OK);
    roam_queue_clear(&queue);
    print_message("seed %" PRIu64 "\n", random);
    for (int round = 0; round < 5000; round++) {
        for (int k = 0; k < 20; k++) {
            int32_t t = (int32_t)(support_random(&random) % COUNT);
            if (support_random(&random) % 4 == 0) {
                roam_queue_drop(&queue, t);
                keys[t] = 0;
                continue;
            }
            keys[t] = now + 1 + (uint32_t)(support_random(&random) % (UINT64_C(1) << support_random(&random) % 24));
            roam_queue_put(&queue, t, keys[t]);
        }
        now += 1 + (uint32_t)(support_random(&random) % (UINT64_C(1) << support_random(&random) % 14));
        check_queue(&queue, keys, COUNT, now);
    }
    roam_queue_destroy(&queue);
}

// ---- flights ----

typedef struct Pair {
    Jobs *jobs;
    Terrain *terrain;
    Lod *kept, *anew;
    Arena *kept_frame, *anew_frame;
    LodCut cut, fresh;
    uint64_t *revisions; // [items] of the frame before
    int32_t items;
    int64_t changed, reused, evaluated;
} Pair;

static void pair_begin(Pair *p, int width, int height, int patch_level, int64_t max_triangles) {
    *p = (Pair){0};
    assert_int_equal(jobs_create(1, &p->jobs), RESULT_OK);
    p->terrain = support_terrain(support_rough_dem(width, height, &GEOREF, 900.0, SEED), TERRAIN_ERROR_TOTAL,
                                 patch_level, p->jobs);
    LodOptions options = lod_default_options();
    options.method = LOD_ROAM;
    options.max_triangles = max_triangles;
    options.page_bytes_max = 1 << 20; // pages and vertices come and go
    assert_int_equal(lod_create(&options, p->terrain, &p->kept), RESULT_OK);
    options.reuse = false;
    assert_int_equal(lod_create(&options, p->terrain, &p->anew), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &p->kept_frame), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &p->anew_frame), RESULT_OK);
}

static void pair_end(Pair *p) {
    free(p->revisions);
    lod_destroy(&p->kept);
    lod_destroy(&p->anew);
    arena_destroy(&p->kept_frame);
    arena_destroy(&p->anew_frame);
    terrain_destroy(&p->terrain);
    jobs_destroy(&p->jobs);
}

static bool same_triangles(const LodItem *a, const LodItem *b) {
    return a->index_count == b->index_count && a->level == b->level && a->page->vertex_count == b->page->vertex_count &&
           memcmp(a->indices, b->indices, sizeof *a->indices * (size_t)a->index_count) == 0 &&
           memcmp(a->page->vertices, b->page->vertices, sizeof *a->page->vertices * (size_t)a->page->vertex_count) == 0;
}

static void compare(const Pair *p, const char *what) {
    assert_int_equal(p->cut.item_count, p->fresh.item_count);
    for (int32_t i = 0; i < p->cut.item_count; i++)
        if (!same_triangles(&p->cut.items[i], &p->fresh.items[i]))
            fail_msg("%s, frame %" PRIu64 ", square %d: %d triangles kept, %d anew", what, p->cut.frame, i,
                     p->cut.items[i].index_count / 3, p->fresh.items[i].index_count / 3);
    assert_int_equal(p->cut.stats.vertices, p->fresh.stats.vertices);
}

// A list has a new revision exactly where the item says so.
static void note_revisions(Pair *p) {
    if (!p->revisions)
        p->revisions = calloc((size_t)p->cut.item_count, sizeof *p->revisions);
    assert_non_null(p->revisions);
    for (int32_t i = 0; i < p->cut.item_count; i++) {
        bool is_new = p->revisions[i] != p->cut.items[i].revision;
        assert_int_equal(p->cut.items[i].state, is_new ? LOD_ITEM_REBUILT : LOD_ITEM_REUSED);
        p->changed += is_new;
        p->reused += !is_new;
        p->revisions[i] = p->cut.items[i].revision;
    }
    p->evaluated += p->cut.stats.vertices_evaluated;
}

static void pair_fly(Pair *p, const LodView *view, bool check, const char *what) {
    lod_release(p->kept, p->cut.frame);
    arena_reset(p->kept_frame);
    Result result = lod_update(p->kept, view, p->jobs, p->kept_frame, &p->cut);
    assert_true(result == RESULT_OK || result == RESULT_BUDGET);
    note_revisions(p);
    if (!check || result == RESULT_BUDGET)
        return;
    lod_release(p->anew, p->fresh.frame);
    arena_reset(p->anew_frame);
    assert_int_equal(lod_update(p->anew, view, p->jobs, p->anew_frame, &p->fresh), RESULT_OK);
    compare(p, what);
}

// Turns, stops, jumps, zooms and tolerances by turns.
static LodView wild_view(const Terrain *terrain, int frame, uint64_t *random) {
    const Dem *dem = terrain_dem(terrain);
    double angle = 0.013 * frame, jump = frame / 60 * 0.37, reach = 0.3 + 0.2 * sin(0.05 * frame);
    if (frame % 60 < 5)
        angle = 0.013 * (frame / 60 * 60); // it stands still
    LodView view = support_view(support_eye(terrain, (0.5 + reach * cos(angle + jump)) * dem->width,
                                            (0.5 + reach * sin(angle + jump)) * dem->height,
                                            30.0 + 700.0 * (1.0 + sin(0.03 * frame))),
                                frame / 45 % 2 ? 0.7 : 2.0);
    view.px_per_rad *= frame / 100 % 2 ? 1.0 + 0.02 * (frame % 100) : 1.0; // a zoom that never stops
    view.forward_ecef = vec3d_normalize(
        vec3d(support_between(random, -1, 1), support_between(random, -1, 1), support_between(random, -1, 1)));
    return view;
}

static void test_kept_equals_anew_along_wild_flights(void **state) {
    (void)state;
    static const int SIZES[][3] = {{257, 257, 8}, {163, 117, 6}, {301, 99, 12}, {2, 71, 4}};
    uint64_t random = SEED;
    for (size_t i = 0; i < COUNT_OF(SIZES); i++) {
        Pair p;
        char what[64];
        snprintf(what, sizeof what, "%d x %d", SIZES[i][0], SIZES[i][1]);
        pair_begin(&p, SIZES[i][0], SIZES[i][1], SIZES[i][2], 4000000);
        for (int frame = 0; frame < 240; frame++) {
            LodView view = wild_view(p.terrain, frame, &random);
            pair_fly(&p, &view, true, what);
        }
        print_message("%s: %" PRId64 " lists made, %" PRId64 " kept\n", what, p.changed, p.reused);
        assert_true(p.reused > 0);
        pair_end(&p);
    }
}

static void test_kept_equals_anew_after_a_long_steady_flight(void **state) {
    (void)state;
    Pair p;
    pair_begin(&p, 257, 257, 8, 4000000);
    int64_t drawn = 0;
    for (int frame = 0; frame < 6000; frame++) { // 100 m/s at 60 Hz, round and round
        double angle = frame * (100.0 / 60.0) / 3000.0;
        LodView view =
            support_view(support_eye(p.terrain, 128.0 + 65.0 * cos(angle), 128.0 + 65.0 * sin(angle), 400.0), 1.0);
        pair_fly(&p, &view, frame % 97 == 0, "steady flight");
        drawn += p.cut.stats.vertices;
    }
    double share = (double)p.evaluated / (double)drawn;
    print_message("%.3f %% of the vertices decided a frame, %.2f %% of the lists made\n", 100.0 * share,
                  100.0 * (double)p.changed / (double)(p.changed + p.reused));
    assert_true(share < 0.02);
    pair_end(&p);
}

static void test_kept_equals_anew_once_the_budget_is_enough_again(void **state) {
    (void)state;
    Pair p;
    uint64_t random = SEED;
    pair_begin(&p, 257, 257, 8, 9000);
    int over = 0, under = 0;
    for (int frame = 0; frame < 240; frame++) {
        LodView view = wild_view(p.terrain, frame, &random);
        view.tau_px *= frame / 12 % 2 ? 4.0 : 0.3;
        pair_fly(&p, &view, true, "budget");
        bool is_over = p.cut.reached_px > view.tau_px;
        over += is_over;
        under += !is_over;
        if (frame % 20 == 0)
            support_check_cut(p.terrain, &p.cut, p.jobs, "budget");
    }
    print_message("%d frames over the budget, %d under\n", over, under);
    assert_true(over > 40 && under > 40);
    pair_end(&p);
}

static void test_a_still_eye_costs_no_decision(void **state) {
    (void)state;
    Pair p;
    pair_begin(&p, 163, 117, 6, 4000000);
    LodView view = support_view(support_eye(p.terrain, 70.0, 50.0, 300.0), 1.0);
    for (int frame = 0; frame < 3; frame++)
        pair_fly(&p, &view, true, "still");
    assert_int_equal(p.cut.stats.vertices_evaluated, 0);
    assert_int_equal(p.cut.stats.patches_reused, p.cut.stats.patches);
    assert_int_equal(p.cut.stats.splits + p.cut.stats.merges, 0);
    pair_end(&p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_triangles_come_out_of_the_queue_when_they_are_due),
        cmocka_unit_test(test_kept_equals_anew_along_wild_flights),
        cmocka_unit_test(test_kept_equals_anew_after_a_long_steady_flight),
        cmocka_unit_test(test_kept_equals_anew_once_the_budget_is_enough_again),
        cmocka_unit_test(test_a_still_eye_costs_no_decision),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
