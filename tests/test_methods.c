// What every method of terrain/lod/lod.h owes its users, whatever it is: whole cuts, the error it promises, its budget,
// the same bytes for any number of workers, from scratch or kept, and numbers that are never used again for something
// else.
#include "base/arena.h"
#include "base/log.h"
#include "tests/cut_support.h"
#include "tests/slow.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SEED UINT64_C(1597463007)
#define FRAMES 40
#define STILL_FRAMES 30 // after which a still view has come to rest

static const DemGeoref GEOREF = {DEM_CRS_GEOGRAPHIC, 0, false, 12.3, 46.9, 0.0006, -0.0004};

typedef struct Flight {
    Jobs *jobs;
    Terrain *terrain;
    Lod *lod;
    Arena *frame;
    LodCut cut;
} Flight;

static LodMethod method_of(void **state) {
    return (LodMethod)(uintptr_t)*state;
}

static Flight flight_begin_at(const LodOptions *options, int workers, int width, int height, int patch_level,
                              const DemGeoref *georef) {
    Flight f = {0};
    assert_int_equal(jobs_create(workers, &f.jobs), RESULT_OK);
    Dem *dem = support_rough_dem(width, height, georef, 900.0, SEED);
    f.terrain = support_terrain(dem, TERRAIN_ERROR_TOTAL, patch_level, f.jobs);
    assert_int_equal(lod_create(options, f.terrain, &f.lod), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &f.frame), RESULT_OK);
    return f;
}

static Flight flight_begin(const LodOptions *options, int workers, int width, int height, int patch_level) {
    return flight_begin_at(options, workers, width, height, patch_level, &GEOREF);
}

static void flight_end(Flight *f) {
    lod_destroy(&f->lod);
    arena_destroy(&f->frame);
    terrain_destroy(&f->terrain);
    jobs_destroy(&f->jobs);
}

static Result flight_update(Flight *f, const LodView *view) {
    if (f->cut.frame)
        lod_release(f->lod, f->cut.frame);
    arena_reset(f->frame);
    return lod_update(f->lod, view, f->jobs, f->frame, &f->cut);
}

static LodOptions options_of(LodMethod method) {
    LodOptions options = lod_default_options();
    options.method = method;
    return options;
}

// A curve low over the ground, the head turning; a jump, and two changes of tolerance.
static LodView view_of_frame(const Terrain *terrain, int frame) {
    const Dem *dem = terrain_dem(terrain);
    double t = 0.1 + 0.004 * frame + (frame > 25 ? 0.4 : 0.0);
    double tau = frame < 15 ? 1.0 : frame < 22 ? 0.4 : 2.5;
    LodView view = support_view(
        support_eye(terrain, t * dem->width, (0.5 + 0.4 * sin(9.0 * t)) * dem->height, 60.0 + 2500.0 * t * t), tau);
    Vec3d up = vec3d_normalize(view.eye_ecef), east = vec3d_cross(view.forward_ecef, up);
    view.forward_ecef =
        vec3d_add(vec3d_scale(view.forward_ecef, cos(0.4 * frame)), vec3d_scale(east, sin(0.4 * frame)));
    return view;
}

static LodView random_view(const Terrain *terrain, uint64_t *random) {
    const Dem *dem = terrain_dem(terrain);
    double col = support_between(random, -0.3, 1.3) * dem->width;
    double row = support_between(random, -0.3, 1.3) * dem->height;
    double above = pow(10.0, support_between(random, -1.0, 4.5));
    if (support_random(random) % 8 == 0)
        above = -above; // under the ground
    return support_view(support_eye(terrain, col, row, above), pow(10.0, support_between(random, -1.0, 1.5)));
}

static const struct {
    int width, height, patch_level;
} SIZES[] = {{2, 2, 12},    {3, 2, 12},    {2, 71, 4},     {65, 65, 6},
             {129, 129, 6}, {130, 101, 6}, {163, 117, 12}, {3, 300, 2}};

static void check_sizes(LodMethod method, LodBound bound) {
    uint64_t random = SEED;
    for (size_t i = 0; i < COUNT_OF(SIZES); i++) {
        LodOptions options = options_of(method);
        options.bound = bound;
        options.tile_side = i % 2 ? 17 : 33;
        Flight f = flight_begin(&options, 2, SIZES[i].width, SIZES[i].height, SIZES[i].patch_level);
        char what[64];
        snprintf(what, sizeof what, "%s, %d x %d", lod_method_name(method), SIZES[i].width, SIZES[i].height);
        for (int k = 0; k < 8; k++) {
            LodView view = random_view(f.terrain, &random);
            assert_int_equal(flight_update(&f, &view), RESULT_OK);
            support_check_cut(f.terrain, &f.cut, f.jobs, what);
            assert_true(bound == LOD_BOUND_PUBLISHED || f.cut.promises);
        }
        flight_end(&f);
    }
}

static void test_cuts_are_whole_and_keep_what_they_promise(void **state) {
    SKIP_WHERE_THREADS_ARE_WATCHED();
    check_sizes(method_of(state), LOD_BOUND_PUBLISHED);
}

static void test_every_sample_is_within_tau_where_the_bound_is_asked_for(void **state) {
    SKIP_WHERE_THREADS_ARE_WATCHED();
    check_sizes(method_of(state), LOD_BOUND_CENTRE);
}

// Offsets within a page reach 524 km in 32 bits.
static void test_coarse_grids_are_whole(void **state) {
    static const struct {
        double cell;
        int width, height, tile_side;
    } CASES[] = {{0.3, 129, 129, 129}, {0.3, 65, 129, 65}, {1.0, 129, 65, 129}, {1.0, 65, 65, 65}};
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        LodOptions options = options_of(method_of(state));
        options.bound = LOD_BOUND_CENTRE;
        options.tile_side = CASES[i].tile_side;
        DemGeoref georef = {DEM_CRS_GEOGRAPHIC, 0, false, 12.3, 40.0, CASES[i].cell, -CASES[i].cell};
        Flight f = flight_begin_at(&options, 2, CASES[i].width, CASES[i].height, 12, &georef);
        for (int k = 0; k < 2; k++) {
            Vec3d eye = support_eye(f.terrain, 0.4 * CASES[i].width, 0.6 * CASES[i].height, k ? 2e6 : 5e4);
            LodView view = support_view(eye, k ? 30.0 : 3.0);
            assert_int_equal(flight_update(&f, &view), RESULT_OK);
            support_check_cut(f.terrain, &f.cut, f.jobs, lod_method_name(method_of(state)));
        }
        flight_end(&f);
    }
}

// Sanitizers take minutes over a million samples, and find nothing there that they do not find in smaller ones.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SANITIZED true
#else
#define SANITIZED false
#endif

static void check_real(LodMethod method, const char *name) {
    if (SANITIZED) {
        print_message("%s: skipped under sanitizers\n", name);
        skip();
    }
    Flight f = {0};
    Geoid *geoid = NULL;
    LodOptions options = options_of(method);
    options.bound = LOD_BOUND_CENTRE;
    assert_int_equal(jobs_create(2, &f.jobs), RESULT_OK);
    f.terrain = support_shared_terrain(name, &geoid, f.jobs);
    if (!f.terrain) {
        jobs_destroy(&f.jobs);
        skip();
    }
    assert_int_equal(lod_create(&options, f.terrain, &f.lod), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &f.frame), RESULT_OK);
    const Dem *dem = terrain_dem(f.terrain);
    for (int k = 0; k < 3; k++) {
        Vec3d eye =
            support_eye(f.terrain, (0.3 + 0.2 * k) * dem->width, (0.6 - 0.1 * k) * dem->height, 40.0 * pow(10.0, k));
        LodView view = support_view(eye, k == 0 ? 2.0 : k == 1 ? 1.0 : 0.7);
        assert_int_equal(flight_update(&f, &view), RESULT_OK);
        Measure m = support_check_cut(f.terrain, &f.cut, f.jobs, name);
        print_message("%s, %s, tau %.1f: max %.3f px, %" PRId64 " triangles\n", lod_method_name(method), name,
                      view.tau_px, m.max_px, f.cut.stats.triangles);
    }
    flight_end(&f);
    geoid_close(&geoid);
}

static void test_puget_sound_keeps_the_bound(void **state) {
    check_real(method_of(state), "puget_utm10_160m_1025.tif");
}

static void test_mount_washington_keeps_the_bound(void **state) {
    check_real(method_of(state), "N44W072.hgt");
}

static void test_statistics_are_those_of_the_cut(void **state) {
    LodOptions options = options_of(method_of(state));
    Flight f = flight_begin(&options, 2, 163, 117, 6);
    for (int frame = 0; frame < 5; frame++) {
        LodView view = view_of_frame(f.terrain, frame);
        assert_int_equal(flight_update(&f, &view), RESULT_OK);
        int64_t triangles = 0, reused = 0;
        for (int32_t i = 0; i < f.cut.item_count; i++) {
            triangles += f.cut.items[i].index_count / 3;
            reused += f.cut.items[i].state == LOD_ITEM_REUSED;
            assert_in_range(f.cut.items[i].partition, 0, LOD_PARTITIONS_MAX - 1);
        }
        assert_int_equal(f.cut.stats.triangles, triangles);
        assert_int_equal(f.cut.stats.patches, f.cut.item_count);
        assert_int_equal(f.cut.stats.patches_reused, reused);
        assert_true(f.cut.stats.triangles_rebuilt <= triangles);
    }
    flight_end(&f);
}

static void test_nothing_is_drawn_outside_an_item_s_sphere(void **state) {
    LodOptions options = options_of(method_of(state));
    Flight f = flight_begin(&options, 2, 163, 117, 6);
    LodView view = view_of_frame(f.terrain, 3);
    assert_int_equal(flight_update(&f, &view), RESULT_OK);
    for (int32_t i = 0; i < f.cut.item_count; i++) {
        const LodItem *item = &f.cut.items[i];
        for (int32_t k = 0; k < item->index_count; k++) {
            assert_true(item->indices[k] < item->page->vertex_count);
            const LodVertex *v = &item->page->vertices[item->indices[k]];
            GridPoint p = {item->page->origin.x + v->x, item->page->origin.y + v->y, item->page->origin.z + v->z};
            double d = vec3d_distance(grid_point_ecef(p), item->centre_ecef);
            if (d > item->radius_m * (1.0 + 1e-9))
                fail_msg("item %d: a vertex %.6f m from the centre, radius %.6f m", i, d, item->radius_m);
        }
    }
    flight_end(&f);
}

static uint64_t hash_of_flight(LodMethod method, int workers, int partitions, bool reuse) {
    LodOptions options = options_of(method);
    options.partitions = partitions;
    options.reuse = reuse;
    Flight f = flight_begin(&options, workers, 301, 233, 6);
    uint64_t hash = 0;
    for (int frame = 0; frame < FRAMES; frame++) {
        LodView view = view_of_frame(f.terrain, frame);
        assert_int_equal(flight_update(&f, &view), RESULT_OK);
        hash = hash * 31 + support_cut_hash(&f.cut);
    }
    flight_end(&f);
    return hash;
}

static void test_any_number_of_workers_gives_the_same_bytes(void **state) {
    static const struct { int workers, partitions; } CASES[] = {{2, 0}, {5, 0}, {1, 1}, {2, 2}, {3, 7}};
    uint64_t first = hash_of_flight(method_of(state), 1, 0, true);
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        uint64_t hash = hash_of_flight(method_of(state), CASES[i].workers, CASES[i].partitions, true);
        if (hash != first)
            fail_msg("%d workers, %d partitions: %016" PRIx64 ", one worker %016" PRIx64, CASES[i].workers,
                     CASES[i].partitions, hash, first);
    }
}

static void test_what_is_kept_equals_what_is_made_from_scratch(void **state) {
    SKIP_WHERE_THREADS_ARE_WATCHED();
    uint64_t kept = hash_of_flight(method_of(state), 2, 0, true), fresh = hash_of_flight(method_of(state), 2, 0, false);
    if (kept != fresh)
        fail_msg("kept %016" PRIx64 ", from scratch %016" PRIx64, kept, fresh);
}

// ---- numbers: the renderer keeps pages by id and index lists by revision ----

typedef struct Seen {
    uint64_t number, contents;
} Seen;

typedef struct Ledger {
    Seen *seen;
    size_t count, capacity;
} Ledger;

static void ledger_note(Ledger *ledger, uint64_t number, uint64_t contents, const char *what) {
    for (size_t i = ledger->count; i-- > 0;) {
        if (ledger->seen[i].number != number)
            continue;
        if (ledger->seen[i].contents != contents)
            fail_msg("%s %" PRIu64 " is used again for other contents", what, number);
        return;
    }
    if (ledger->count == ledger->capacity) {
        ledger->capacity = 2 * ledger->capacity + 256;
        ledger->seen = realloc(ledger->seen, ledger->capacity * sizeof *ledger->seen);
        assert_non_null(ledger->seen);
    }
    ledger->seen[ledger->count++] = (Seen){number, contents};
}

static uint64_t hash_bytes(const void *bytes, size_t count) {
    const unsigned char *b = bytes;
    uint64_t hash = UINT64_C(0xcbf29ce484222325); // FNV-1a
    for (size_t i = 0; i < count; i++)
        hash = (hash ^ b[i]) * UINT64_C(0x100000001b3);
    return hash;
}

// A revision is that of a list drawn from a page: both together.
static void note_items(const LodCut *cut, Ledger *pages, Ledger *lists) {
    for (int32_t i = 0; i < cut->item_count; i++) {
        const LodItem *item = &cut->items[i];
        const LodPage *page = item->page;
        uint64_t vertices = hash_bytes(page->vertices, sizeof *page->vertices * (size_t)page->vertex_count);
        uint64_t indices = hash_bytes(item->indices, sizeof *item->indices * (size_t)item->index_count);
        ledger_note(pages, page->id, vertices ^ hash_bytes(&page->origin, sizeof page->origin), "page id");
        ledger_note(lists, page->id * UINT64_C(0x9e3779b97f4a7c15) ^ item->revision, indices, "page and revision");
    }
}

static void test_numbers_of_pages_and_lists_are_never_used_again(void **state) {
    LodOptions options = options_of(method_of(state));
    options.page_bytes_max = 100000; // pages come and go
    options.serial = 3;
    Flight f = flight_begin(&options, 2, 163, 117, 6);
    Ledger pages = {0}, lists = {0};
    for (int frame = 0; frame < FRAMES; frame++) {
        LodView view = view_of_frame(f.terrain, frame);
        assert_int_equal(flight_update(&f, &view), RESULT_OK);
        note_items(&f.cut, &pages, &lists);
        for (int32_t i = 0; i < f.cut.item_count; i++)
            assert_int_equal(f.cut.items[i].page->id >> 40, options.serial);
    }
    free(pages.seen);
    free(lists.seen);
    flight_end(&f);
}

static void test_a_frame_that_is_still_read_keeps_its_bytes(void **state) {
    LodOptions options = options_of(method_of(state));
    Flight f = flight_begin(&options, 2, 163, 117, 6);
    Arena *other;
    assert_int_equal(arena_create(1 << 20, &other), RESULT_OK);
    LodView view = view_of_frame(f.terrain, 0);
    assert_int_equal(flight_update(&f, &view), RESULT_OK);
    LodCut held = f.cut;
    uint64_t before = support_cut_hash(&held);
    for (int frame = 10; frame < 30; frame += 6) { // none released
        LodCut cut;
        view = view_of_frame(f.terrain, frame);
        assert_int_equal(lod_update(f.lod, &view, f.jobs, other, &cut), RESULT_OK);
    }
    assert_true(support_cut_hash(&held) == before);
    arena_destroy(&other);
    flight_end(&f);
}

// ---- the budget ----

static void test_the_budget_holds_and_the_cut_says_which_error_it_reached(void **state) {
    SKIP_WHERE_THREADS_ARE_WATCHED();
    if (method_of(state) == LOD_BRUTE) { // it has none
        skip();
    }
    for (int64_t budget = 700; budget <= 20000; budget = budget * 5 / 2) {
        LodOptions options = options_of(method_of(state));
        options.max_triangles = budget;
        Flight f = flight_begin(&options, 2, 257, 129, 6);
        bool reached = false;
        for (int frame = 0; frame < FRAMES; frame += 2) {
            LodView view = view_of_frame(f.terrain, frame);
            view.tau_px *= 0.3;
            Result result = flight_update(&f, &view);
            assert_true(result == RESULT_OK || result == RESULT_BUDGET);
            reached = reached || result == RESULT_BUDGET;
            if (result == RESULT_BUDGET)
                assert_true(f.cut.reached_px > view.tau_px);
            else
                assert_true(f.cut.reached_px == view.tau_px);
            if (f.cut.stats.triangles > budget)
                fail_msg("%" PRId64 " triangles, budget %" PRId64, f.cut.stats.triangles, budget);
            support_check_cut(f.terrain, &f.cut, f.jobs, "budget");
        }
        assert_true(reached || budget > 10000);
        flight_end(&f);
    }
}

// Three frames low over the rough ground, and then one view whose cut at the tolerance asked for fits.
static void test_a_still_view_that_fits_ends_at_its_tolerance(void **state) {
    if (method_of(state) == LOD_BRUTE) { // it has no budget
        skip();
    }
    LodOptions options = options_of(method_of(state));
    for (int share = 105; share <= 165; share += 30) { // % of what the still view takes
        Flight f = flight_begin(&options, 2, 257, 129, 6);
        LodView near = view_of_frame(f.terrain, 0);
        LodView still = support_view(support_eye(f.terrain, 200.0, 64.0, 9000.0), 1.0);
        near.tau_px = 0.05;
        assert_int_equal(flight_update(&f, &still), RESULT_OK);
        LodOptions tight = options;
        tight.max_triangles = f.cut.stats.triangles * share / 100;
        lod_destroy(&f.lod);
        f.cut.frame = 0;
        assert_int_equal(lod_create(&tight, f.terrain, &f.lod), RESULT_OK);
        for (int frame = 0; frame < 3; frame++)
            assert_int_equal(flight_update(&f, &near), RESULT_BUDGET);
        Result result = RESULT_BUDGET;
        int frames = 0;
        for (; result == RESULT_BUDGET && frames < STILL_FRAMES; frames++)
            result = flight_update(&f, &still);
        if (result != RESULT_OK)
            fail_msg("%.3f px after %d frames, asked for 1", f.cut.reached_px, frames);
        for (int frame = 0; frame < 5; frame++)
            assert_int_equal(flight_update(&f, &still), RESULT_OK);
        flight_end(&f);
    }
}

// And one that does not fit stays at one tolerance.
static void test_a_still_view_above_the_budget_comes_to_rest(void **state) {
    if (method_of(state) == LOD_BRUTE) { // it has no budget
        skip();
    }
    LodOptions options = options_of(method_of(state));
    options.max_triangles = 5000;
    Flight f = flight_begin(&options, 2, 257, 129, 6);
    LodView view = view_of_frame(f.terrain, 0);
    view.tau_px = 0.05;
    for (int frame = 0; frame < STILL_FRAMES; frame++)
        assert_int_equal(flight_update(&f, &view), RESULT_BUDGET);
    double rest = f.cut.reached_px;
    for (int frame = 0; frame < 40; frame++) {
        assert_int_equal(flight_update(&f, &view), RESULT_BUDGET);
        if (f.cut.reached_px != rest || f.cut.stats.triangles_rebuilt != 0)
            fail_msg("%.6f px, %" PRId64 " triangles rebuilt; before %.6f px", f.cut.reached_px,
                     f.cut.stats.triangles_rebuilt, rest);
    }
    flight_end(&f);
}

static uint64_t hash_of_budget_flight(LodMethod method, int workers, int partitions) {
    LodOptions options = options_of(method);
    options.partitions = partitions;
    options.max_triangles = 4000;
    Flight f = flight_begin(&options, workers, 257, 129, 6);
    uint64_t hash = 0;
    int over = 0;
    for (int frame = 0; frame < FRAMES; frame++) {
        LodView view = view_of_frame(f.terrain, frame);
        view.tau_px *= 0.3;
        over += flight_update(&f, &view) == RESULT_BUDGET;
        hash = hash * 31 + support_cut_hash(&f.cut);
    }
    assert_true(over > 0 || method == LOD_BRUTE);
    flight_end(&f);
    return hash;
}

static void test_above_the_budget_any_number_of_workers_gives_the_same_bytes(void **state) {
    static const struct { int workers, partitions; } CASES[] = {{2, 0}, {4, 0}, {3, 7}};
    uint64_t first = hash_of_budget_flight(method_of(state), 1, 0);
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        uint64_t hash = hash_of_budget_flight(method_of(state), CASES[i].workers, CASES[i].partitions);
        if (hash != first)
            fail_msg("%d workers, %d partitions: %016" PRIx64 ", one worker %016" PRIx64, CASES[i].workers,
                     CASES[i].partitions, hash, first);
    }
}

// ---- bad input ----

static void keep_quiet(void *user, LogLevel level, const char *text) {
    (void)user, (void)level, (void)text;
}

static void test_views_that_are_no_views_are_refused(void **state) {
    LodOptions options = options_of(method_of(state));
    Flight f = flight_begin(&options, 1, 65, 65, 6);
    LodView good = view_of_frame(f.terrain, 0);
    LodView bad[] = {good, good, good, good, good};
    bad[0].tau_px = NAN;
    bad[1].tau_px = 0.0;
    bad[2].px_per_rad = INFINITY;
    bad[3].eye_ecef.y = NAN;
    bad[4].px_per_rad = -1.0;
    log_set_sink(keep_quiet, NULL);
    for (size_t i = 0; i < COUNT_OF(bad); i++)
        assert_int_equal(flight_update(&f, &bad[i]), RESULT_RANGE);
    log_set_sink(NULL, NULL);
    assert_int_equal(flight_update(&f, &good), RESULT_OK);
    support_check_cut(f.terrain, &f.cut, f.jobs, "after bad views");
    flight_end(&f);
}

static void test_options_out_of_range_are_refused(void **state) {
    LodOptions good = options_of(method_of(state)), bad[] = {good, good, good, good, good, good};
    bad[0].partitions = -1;
    bad[1].partitions = LOD_PARTITIONS_MAX + 1;
    bad[2].max_triangles = 0;
    bad[3].tile_side = 34;
    bad[4].tile_side = 257;
    bad[5].method = LOD_METHOD_COUNT;
    Flight f = flight_begin(&good, 1, 33, 33, 6);
    log_set_sink(keep_quiet, NULL);
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        Lod *lod = NULL;
        assert_int_equal(lod_create(&bad[i], f.terrain, &lod), RESULT_RANGE);
        assert_null(lod);
    }
    log_set_sink(NULL, NULL);
    flight_end(&f);
}

static void test_extreme_tolerances_give_whole_cuts(void **state) {
    LodOptions options = options_of(method_of(state));
    Flight f = flight_begin(&options, 2, 97, 97, 6);
    static const double TAUS[] = {1e-9, 1e-3, 1e6, 1e12};
    for (size_t i = 0; i < COUNT_OF(TAUS); i++) {
        LodView view = view_of_frame(f.terrain, 5);
        view.tau_px = TAUS[i];
        Result result = flight_update(&f, &view);
        assert_true(result == RESULT_OK || result == RESULT_BUDGET);
        LodCut cut = f.cut;
        cut.promises = cut.promises && TAUS[i] > 0.01; // below, the lattice of positions shows
        support_check_cut(f.terrain, &cut, f.jobs, "extreme tolerance");
    }
    flight_end(&f);
}

#define PROPERTIES(X)                                                                                                  \
    X(test_cuts_are_whole_and_keep_what_they_promise)                                                                  \
    X(test_every_sample_is_within_tau_where_the_bound_is_asked_for)                                                    \
    X(test_coarse_grids_are_whole)                                                                                     \
    X(test_puget_sound_keeps_the_bound)                                                                                \
    X(test_mount_washington_keeps_the_bound)                                                                           \
    X(test_statistics_are_those_of_the_cut)                                                                            \
    X(test_nothing_is_drawn_outside_an_item_s_sphere)                                                                  \
    X(test_any_number_of_workers_gives_the_same_bytes)                                                                 \
    X(test_what_is_kept_equals_what_is_made_from_scratch)                                                              \
    X(test_numbers_of_pages_and_lists_are_never_used_again)                                                            \
    X(test_a_frame_that_is_still_read_keeps_its_bytes)                                                                 \
    X(test_the_budget_holds_and_the_cut_says_which_error_it_reached)                                                   \
    X(test_a_still_view_that_fits_ends_at_its_tolerance)                                                               \
    X(test_a_still_view_above_the_budget_comes_to_rest)                                                                \
    X(test_above_the_budget_any_number_of_workers_gives_the_same_bytes)                                                \
    X(test_options_out_of_range_are_refused)                                                                           \
    X(test_views_that_are_no_views_are_refused)                                                                        \
    X(test_extreme_tolerances_give_whole_cuts)

static const struct {
    const char *name;
    CMUnitTestFunction function;
} PROPERTY[] = {
#define PROPERTY_ROW(function) {#function, function},
    PROPERTIES(PROPERTY_ROW)
#undef PROPERTY_ROW
};

// Usage: test_methods [METHOD]; all without one.
int main(int argc, char **argv) {
    struct CMUnitTest tests[COUNT_OF(PROPERTY) * LOD_METHOD_COUNT];
    char names[COUNT_OF(PROPERTY) * LOD_METHOD_COUNT][120];
    size_t count = 0;
    for (int method = 0; method < LOD_METHOD_COUNT; method++) {
        if (argc > 1 && strcmp(argv[1], lod_method_name((LodMethod)method)) != 0)
            continue;
        for (size_t i = 0; i < COUNT_OF(PROPERTY); i++, count++) {
            snprintf(names[count], sizeof names[count], "%s: %s", lod_method_name((LodMethod)method), PROPERTY[i].name);
            tests[count] = (struct CMUnitTest){
                .name = names[count], .test_func = PROPERTY[i].function, .initial_state = (void *)(uintptr_t)method};
        }
    }
    return _cmocka_run_group_tests("methods", tests, count, NULL, NULL);
}
