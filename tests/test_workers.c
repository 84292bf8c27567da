// A flight with caching gives the same bytes for any number of workers and partitions, error field and measure
// included.
#include "base/arena.h"
#include "tests/cut_support.h"

#include <inttypes.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define SEED UINT64_C(271828)
#define FRAMES 24

typedef struct Outcome {
    uint64_t cuts; // a hash over all cuts of the flight
    Measure last;  // of the last cut
} Outcome;

static LodView view_of_frame(const Terrain *terrain, int frame) {
    double col = 40.0 + 7.0 * frame, row = 60.0 + 4.0 * frame;
    LodView view = support_view(support_eye(terrain, col, row, 150.0), frame < FRAMES / 2 ? 1.0 : 0.7);
    Vec3d up = vec3d_normalize(view.eye_ecef), east = vec3d_cross(view.forward_ecef, up);
    view.forward_ecef =
        vec3d_add(vec3d_scale(view.forward_ecef, cos(0.4 * frame)), vec3d_scale(east, sin(0.4 * frame)));
    return view;
}

static uint64_t fly(const Terrain *terrain, Lod *lod, Jobs *jobs, LodCut *cut, Arena *frame) {
    uint64_t hash = 0;
    for (int i = 0; i < FRAMES; i++) {
        LodView view = view_of_frame(terrain, i);
        arena_reset(frame);
        assert_int_equal(lod_update(lod, &view, jobs, frame, cut), RESULT_OK);
        hash = hash * 31 + support_cut_hash(cut);
        lod_release(lod, cut->frame - 1);
    }
    return hash;
}

static Outcome outcome_of(int workers, int partitions) {
    const DemGeoref georef = {DEM_CRS_GEOGRAPHIC, 0, false, 12.3, 46.9, 0.0006, -0.0004};
    Jobs *jobs;
    Lod *lod;
    Arena *frame;
    LodCut cut;
    Outcome outcome;
    LodOptions options = lod_default_options();
    options.partitions = partitions;
    assert_int_equal(jobs_create(workers, &jobs), RESULT_OK);
    Terrain *terrain = support_terrain(support_rough_dem(301, 233, &georef, 900.0, SEED), TERRAIN_ERROR_TOTAL, 6, jobs);
    assert_int_equal(lod_create(&options, terrain, &lod), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &frame), RESULT_OK);
    outcome.cuts = fly(terrain, lod, jobs, &cut, frame);
    outcome.last = support_check_cut(terrain, &cut, jobs, "last frame");
    lod_destroy(&lod);
    arena_destroy(&frame);
    terrain_destroy(&terrain);
    jobs_destroy(&jobs);
    return outcome;
}

static void test_any_number_of_workers_and_partitions_gives_the_same_bytes(void **state) {
    (void)state;
    static const struct {
        int workers, partitions;
    } CASES[] = {{1, 0}, {2, 0}, {3, 0}, {8, 0}, {1, 1}, {2, 5}, {3, 2}, {8, 16}, {16, 3}};
    Outcome first = outcome_of(CASES[0].workers, CASES[0].partitions);
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        Outcome outcome = outcome_of(CASES[i].workers, CASES[i].partitions);
        print_message("%2d workers, %2d partitions: cuts %016" PRIx64 ", max %.17g px, rms %.17g\n", CASES[i].workers,
                      CASES[i].partitions, outcome.cuts, outcome.last.max_px, outcome.last.rms_px);
        assert_true(outcome.cuts == first.cuts);
        assert_memory_equal(&outcome.last, &first.last, sizeof first.last);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_any_number_of_workers_and_partitions_gives_the_same_bytes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
