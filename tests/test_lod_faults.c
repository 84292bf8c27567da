// Memory that runs out once: every method of terrain/lod/lod.h says so, and goes on as if nothing had been.
#include "base/arena.h"
#include "base/log.h"
#include "tests/cut_support.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define SEED UINT64_C(433494437)
#define WIDTH 137
#define HEIGHT 101
#define FRAMES 6
#define TRIALS 20 // of each flight, the failing allocations evenly apart

static const DemGeoref GEOREF = {DEM_CRS_GEOGRAPHIC, 0, false, 12.3, 46.9, 0.0006, -0.0004};

// ---- allocations, counted while a Lod is at work; the linker leads them here ----

static atomic_bool counts;
static atomic_llong allocations, failing; // the number of the one that fails, from 1; 0: none

// NOLINTBEGIN(bugprone-reserved-identifier): the linker's names
void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *memory, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *memory, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);

static bool fails_now(void) {
    return atomic_load(&counts) && atomic_fetch_add(&allocations, 1) + 1 == atomic_load(&failing);
}

void *__wrap_malloc(size_t size) {
    return fails_now() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size) {
    return fails_now() ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *memory, size_t size) {
    return fails_now() ? NULL : __real_realloc(memory, size);
}

void *__wrap_aligned_alloc(size_t alignment, size_t size) {
    return fails_now() ? NULL : __real_aligned_alloc(alignment, size);
}
// NOLINTEND(bugprone-reserved-identifier)

static void fail_at(long long number) {
    atomic_store(&allocations, 0);
    atomic_store(&failing, number);
}

static bool has_failed(void) {
    return atomic_load(&failing) && atomic_load(&allocations) >= atomic_load(&failing);
}

// ---- a flight ----

typedef struct Scene {
    Jobs *jobs;
    Terrain *terrain;
    Arena *frame;
    LodOptions options;
    uint64_t hashes[FRAMES]; // without a failure; not compared under a budget, which remembers the frames before
} Scene;

static void hear_nothing(void *user, LogLevel level, const char *text) {
    (void)user, (void)level, (void)text;
}

static Scene scene_begin(LodMethod method) {
    Scene s = {.options = lod_default_options()};
    log_set_sink(hear_nothing, NULL); // many errors are asked for
    assert_int_equal(jobs_create(2, &s.jobs), RESULT_OK);
    s.terrain = support_terrain(support_rough_dem(WIDTH, HEIGHT, &GEOREF, 900.0, SEED), TERRAIN_ERROR_TOTAL, 6, s.jobs);
    s.options.method = method;
    s.options.bound = LOD_BOUND_CENTRE;
    s.options.partitions = 3;
    s.options.page_bytes_max = 50000;
    return s;
}

static void scene_end(Scene *s) {
    terrain_destroy(&s->terrain);
    jobs_destroy(&s->jobs);
    log_set_sink(NULL, NULL);
}

// Ever farther and with a jump; the tolerance changes once.
static LodView view_of(const Scene *s, int frame) {
    double jump = frame > 3 ? 40.0 : 0.0;
    Vec3d eye = support_eye(s->terrain, 20 + 8 * frame + jump, 60 - 5 * frame, 200.0 + 150.0 * frame);
    return support_view(eye, frame == 2 ? 0.5 : 1.0);
}

static Result create(const Scene *s, Lod **lod) {
    atomic_store(&counts, true);
    Result result = lod_create(&s->options, s->terrain, lod);
    atomic_store(&counts, false);
    return result;
}

static Result update(const Scene *s, Lod *lod, int frame, LodCut *cut) {
    LodView view = view_of(s, frame);
    arena_reset(s->frame);
    atomic_store(&counts, true);
    Result result = lod_update(lod, &view, s->jobs, s->frame, cut);
    atomic_store(&counts, false);
    return result;
}

static bool is_cut(Result result) {
    return result == RESULT_OK || result == RESULT_BUDGET;
}

static void check_frame(Scene *s, const LodCut *cut, int frame) {
    char what[128];
    snprintf(what, sizeof what, "%s, allocation %lld fails, view %d", lod_method_name(s->options.method),
             (long long)atomic_load(&failing), frame);
    uint64_t hash = support_cut_hash(cut);
    bool has_budget = s->options.max_triangles != lod_default_options().max_triangles;
    if (has_budget || !atomic_load(&failing))
        support_check_cut(s->terrain, cut, s->jobs, what);
    if (!atomic_load(&failing))
        s->hashes[frame] = hash;
    else if (hash != s->hashes[frame] && !has_budget)
        fail_msg("%s: cut %016" PRIx64 ", expected %016" PRIx64, what, hash, s->hashes[frame]);
}

// A frame that fails is asked for once more: there is memory again.
static void fly_frame(Scene *s, Lod *lod, int frame) {
    LodCut cut;
    bool failed_before = has_failed();
    Result result = update(s, lod, frame, &cut);
    if (!is_cut(result)) {
        if (result != RESULT_MEMORY || failed_before || !has_failed())
            fail_msg("%s, view %d: result %d; expected MEMORY (%d), and that only where allocation %lld fails",
                     lod_method_name(s->options.method), frame, (int)result, (int)RESULT_MEMORY,
                     (long long)atomic_load(&failing));
        result = update(s, lod, frame, &cut);
    }
    assert_true(is_cut(result));
    check_frame(s, &cut, frame);
    if (frame % 2)
        lod_release(lod, cut.frame);
}

static void fly(Scene *s) {
    Lod *lod = NULL;
    Result result = create(s, &lod);
    if (result != RESULT_OK) {
        assert_int_equal(result, RESULT_MEMORY);
        assert_true(has_failed());
        assert_int_equal(create(s, &lod), RESULT_OK);
    }
    assert_int_equal(arena_create(1 << 12, &s->frame), RESULT_OK);
    for (int frame = 0; frame < FRAMES; frame++)
        fly_frame(s, lod, frame);
    lod_destroy(&lod);
    arena_destroy(&s->frame);
}

static void fly_with_failures(LodMethod method, int64_t max_triangles) {
    Scene s = scene_begin(method);
    s.options.max_triangles = max_triangles;
    fail_at(0);
    fly(&s);
    long long all = atomic_load(&allocations);
    assert_true(all > 0);
    for (int trial = 0; trial < TRIALS && trial < all; trial++) {
        fail_at(1 + (all <= TRIALS ? trial : trial * (all - 1) / (TRIALS - 1)));
        fly(&s);
    }
    scene_end(&s);
}

static void a_flight_goes_on_after_a_failed_allocation(void **state) {
    fly_with_failures((LodMethod)(uintptr_t)*state, lod_default_options().max_triangles);
}

static void a_flight_with_a_budget_goes_on_after_a_failed_allocation(void **state) {
    fly_with_failures((LodMethod)(uintptr_t)*state, 6000);
}

int main(void) {
#define TESTS_OF(id, name, source)                                                                                     \
    {"a flight goes on after a failed allocation: " name, a_flight_goes_on_after_a_failed_allocation, NULL, NULL,      \
     (void *)(uintptr_t)LOD_##id},                                                                                     \
        {"a flight with a budget goes on after a failed allocation: " name,                                            \
         a_flight_with_a_budget_goes_on_after_a_failed_allocation, NULL, NULL, (void *)(uintptr_t)LOD_##id},
    const struct CMUnitTest tests[] = {LOD_METHOD_TABLE(TESTS_OF)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
