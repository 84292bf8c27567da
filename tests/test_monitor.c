// The panel of accuracy while a flight goes on: what it measures is the very cut that was drawn, what it holds is let
// go again, and it ends when it is told to.
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "app/bench/bench.h"
#include "app/flight/camera.h"
#include "app/live/monitor.h"
#include "base/clock.h"
#include "terrain/geodesy.h"
#include "terrain/lod/cut_copy.h"
#include "tests/cut_support.h"
#include "tests/gl_support.h"
#include "tests/slow.h"

#define WIDTH 320
#define HEIGHT 200
#define SIDE 129
#define FOV_RAD (60.0 * GEODESY_RAD_PER_DEG)
#define WAIT_NS 120000000000LL // sanitizers and other work are slow
#define FRAME_WAIT_NS 20000000000LL

static const DemGeoref GEOREF = {
    .crs = DEM_CRS_GEOGRAPHIC, .x0 = 20.0, .y0 = 49.5, .dx = 1.0 / 1200, .dy = -1.0 / 1200};

typedef struct World {
    Jobs *jobs;
    Terrain *terrain;
    Context *context;
} World;

static World world; // made once; the tests only read it

static int make_world(void **state) {
    (void)state;
    if (jobs_create(2, &world.jobs) != RESULT_OK)
        return 1;
    world.terrain =
        support_terrain(support_rough_dem(SIDE, SIDE, &GEOREF, 1200.0, 5), TERRAIN_ERROR_TOTAL, 8, world.jobs);
    context_release_current(world.context);
    return 0;
}

static int free_world(void **state) {
    (void)state;
    terrain_destroy(&world.terrain);
    jobs_destroy(&world.jobs);
    return 0;
}

static FrameOrder order_at(double along, LodMethod method) {
    FrameOrder order = {.method = method, .width = WIDTH, .height = HEIGHT};
    Vec3d eye = support_eye(world.terrain, SIDE * (0.3 + 0.3 * along), SIDE * 0.4, 700.0);
    Geodetic at = geodesy_from_ecef(eye);
    Mat3d enu = geodesy_enu_from_ecef(at.lat_rad, at.lon_rad);
    Vec3d east = {enu.m[0][0], enu.m[0][1], enu.m[0][2]}, north = {enu.m[1][0], enu.m[1][1], enu.m[1][2]};
    Vec3d up = {enu.m[2][0], enu.m[2][1], enu.m[2][2]};
    order.look.camera =
        (RenderCamera){eye, {{{east.x, east.y, east.z}, {up.x, up.y, up.z}, {-north.x, -north.y, -north.z}}}, FOV_RAD};
    order.look.sun_ecef = vec3d_normalize(eye);
    order.view = (LodView){.eye_ecef = eye,
                           .forward_ecef = north,
                           .px_per_rad = camera_px_per_rad(FOV_RAD, WIDTH, HEIGHT, false),
                           .tau_px = 2.0};
    return order;
}

static Pipeline *start(bool threaded, LodMethod method) {
    PipelineOptions options = {.threaded = threaded,
                               .lod = lod_default_options(),
                               .render = render_default_options(),
                               .terrain = world.terrain,
                               .jobs = world.jobs,
                               .context = world.context};
    Pipeline *pipeline = NULL;
    options.lod.method = method;
    options.render.width = WIDTH;
    options.render.height = HEIGHT;
    options.render.samples = 1;
    options.render.vram_bytes_max = (size_t)32 << 20;
    assert_int_equal(pipeline_create(&options, &pipeline), RESULT_OK);
    return pipeline;
}

static Monitor *watch(Pipeline *pipeline) {
    const MonitorOptions options = {lod_default_options(), world.terrain, pipeline};
    Monitor *monitor = NULL;
    assert_int_equal(monitor_create(&options, &monitor), RESULT_OK);
    return monitor;
}

static void submit(Pipeline *pipeline, const FrameOrder *order) {
    assert_int_equal(pipeline_submit(pipeline, order, true), RESULT_OK);
}

static void fly(Pipeline *pipeline, LodMethod method, int begin, int end) {
    for (int i = begin; i < end; i++) {
        const FrameOrder order = order_at(0.01 * (i % 100), method);
        submit(pipeline, &order);
    }
}

// ---- holding a drawn cut ----

// On a thread of its own, as the flight goes on meanwhile.
typedef struct Holder {
    Pipeline *pipeline;
    atomic_bool done;
    int held, differing;
    CutCopy copy;
} Holder;

static Measure measured(const LodCut *cut, Jobs *one) {
    Measure measure;
    memset(&measure, 0, sizeof measure);
    assert_int_equal(measure_cut(world.terrain, cut, one, &measure), RESULT_OK);
    return measure;
}

// The held cut, its copy, and the copy after the cut was let go give the same.
static void hold_once(Holder *holder, Jobs *one) {
    PipelineHeld held;
    if (!pipeline_hold(holder->pipeline, clock_now_ns() + FRAME_WAIT_NS / 100, &held))
        return;
    assert_int_equal(cut_copy_take(&holder->copy, &held.cut, SIZE_MAX), RESULT_OK);
    Measure before = measured(&held.cut, one);
    uint64_t hash = support_cut_hash(&held.cut);
    pipeline_let_go(holder->pipeline);
    Measure after = measured(&holder->copy.cut, one);
    holder->differing += memcmp(&before, &after, sizeof before) != 0 || hash != support_cut_hash(&holder->copy.cut);
    holder->held++;
}

static void *hold_often(void *user) {
    Holder *holder = user;
    Jobs *one = NULL;
    assert_int_equal(jobs_create(1, &one), RESULT_OK);
    while (!atomic_load(&holder->done))
        hold_once(holder, one);
    jobs_destroy(&one);
    return NULL;
}

static void check_held(LodMethod method, int frames) {
    Holder holder = {.pipeline = start(true, method)};
    pthread_t thread;
    assert_int_equal(pthread_create(&thread, NULL, hold_often, &holder), 0);
    fly(holder.pipeline, method, 0, frames);
    assert_int_equal(pipeline_drain(holder.pipeline), RESULT_OK);
    atomic_store(&holder.done, true);
    pthread_join(thread, NULL);
    print_message("%s: %d cuts held in %d frames, %d differ\n", lod_method_name(method), holder.held, frames,
                  holder.differing);
    assert_true(holder.held > 0);
    assert_int_equal(holder.differing, 0);
    cut_copy_free(&holder.copy);
    pipeline_destroy(&holder.pipeline);
}

static void a_held_cut_stays_as_it_was_drawn(void **state) {
    (void)state;
    const LodMethod METHODS[] = {LOD_HYBRID, LOD_PATCH, LOD_ROAM, LOD_GEOMIPMAP_YE, LOD_DIAMOND};
    for (size_t i = 0; i < COUNT_OF(METHODS); i++)
        check_held(METHODS[i], 40);
}

// ---- what is measured ----

// With workers of its own: those of the flight are at work.
static Measure expected_of(const FrameOrder *order) {
    LodOptions options = lod_default_options();
    Jobs *one = NULL;
    Lod *lod = NULL;
    Arena *arena = NULL;
    LodCut cut;
    options.method = order->method;
    assert_int_equal(lod_create(&options, world.terrain, &lod), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &arena), RESULT_OK);
    assert_int_equal(jobs_create(1, &one), RESULT_OK);
    assert_int_equal(lod_update(lod, &order->view, one, arena, &cut), RESULT_OK);
    Measure measure = measured(&cut, one);
    jobs_destroy(&one);
    lod_destroy(&lod);
    arena_destroy(&arena);
    return measure;
}

// Flies on the spot until the panel tells a state, with so many samples.
static RenderAccuracy watch_until(Pipeline *pipeline, Monitor *monitor, FrameOrder *order, RenderAccuracyState wanted,
                                  int samples) {
    int64_t end_ns = clock_now_ns() + WAIT_NS;
    int sampled = 0;
    do {
        monitor_follow(monitor, true, order);
        submit(pipeline, order);
        sampled = 0;
        for (int i = 0; i < monitor_shown(monitor)->point_count; i++)
            sampled += !monitor_shown(monitor)->points[i].flown;
    } while ((monitor_shown(monitor)->error.state != wanted || sampled < samples) && clock_now_ns() < end_ns);
    assert_int_equal(monitor_shown(monitor)->error.state, wanted);
    assert_true(sampled >= samples);
    return *monitor_shown(monitor);
}

static void check_measured(bool threaded, LodMethod method) {
    Pipeline *pipeline = start(threaded, method);
    Monitor *monitor = watch(pipeline);
    FrameOrder order = order_at(0.5, method);
    RenderAccuracy shown =
        watch_until(pipeline, monitor, &order, RENDER_ACCURACY_MEASURED, method == LOD_BRUTE ? 0 : 3);
    Measure expected = expected_of(&order);
    print_message("%s: expected at most %.9g px, 99.9 %% within %.9g; found %.9g, %.9g, %.1f s ago\n",
                  lod_method_name(method), expected.max_px, expected.p999_px, shown.error.max_px, shown.error.p999_px,
                  shown.error.age_s);
    assert_true(shown.error.max_px == expected.max_px && shown.error.p999_px == expected.p999_px);
    assert_true(shown.error.above_tau_share == expected.above_tau_share);
    assert_int_equal(shown.error.cracks, expected.holes + expected.overlaps + expected.t_junctions);
    assert_true(shown.error.age_s >= 0.0 && shown.error.tau_px == 2.0 && shown.tau_px == 2.0);
    monitor_destroy(&monitor);
    pipeline_destroy(&pipeline);
}

static void the_error_is_that_of_the_drawn_cut(void **state) {
    (void)state;
    SKIP_WHERE_THREADS_ARE_WATCHED();
    check_measured(true, LOD_HYBRID);
    check_measured(true, LOD_GEOMIPMAP);
    check_measured(true, LOD_BRUTE);
    check_measured(false, LOD_HYBRID);
}

static void points_ascend_and_lie_within_their_bounds(void **state) {
    (void)state;
    SKIP_WHERE_THREADS_ARE_WATCHED();
    Pipeline *pipeline = start(true, LOD_HYBRID);
    Monitor *monitor = watch(pipeline);
    FrameOrder order = order_at(0.5, LOD_HYBRID);
    RenderAccuracy shown = watch_until(pipeline, monitor, &order, RENDER_ACCURACY_MEASURED, 6);
    double before_px = 0.0;
    for (int i = 0; i < shown.point_count; i++) {
        const RenderAccuracyPoint *point = &shown.points[i];
        print_message("%.3f px: %.2f ms, %.2f to %.2f, %s\n", (double)point->tau_px, (double)point->frame_ms,
                      (double)point->least_ms, (double)point->most_ms, point->flown ? "flown" : "sampled");
        assert_true((double)point->tau_px >= before_px && point->least_ms <= point->most_ms);
        assert_true(isfinite(point->frame_ms) && point->freshness >= 0.0f && point->freshness <= 1.0f);
        before_px = (double)point->tau_px;
    }
    assert_true(shown.axis_ms > 0.0 && isfinite(shown.axis_ms));
    monitor_destroy(&monitor);
    pipeline_destroy(&pipeline);
}

static void a_change_of_tolerance_moves_the_point_at_once(void **state) {
    (void)state;
    SKIP_WHERE_THREADS_ARE_WATCHED();
    Pipeline *pipeline = start(true, LOD_HYBRID);
    Monitor *monitor = watch(pipeline);
    FrameOrder order = order_at(0.5, LOD_HYBRID);
    watch_until(pipeline, monitor, &order, RENDER_ACCURACY_MEASURED, 0);
    uint64_t revision = monitor_shown(monitor)->revision;
    order.view.tau_px = 4.0;
    submit(pipeline, &order);
    assert_int_equal(pipeline_drain(pipeline), RESULT_OK);
    monitor_follow(monitor, true, &order);
    assert_true(monitor_shown(monitor)->tau_px == 4.0);
    assert_true(monitor_shown(monitor)->revision > revision);
    assert_true(order.look.hud.accuracy.show && order.look.hud.accuracy.tau_px == 4.0);
    monitor_destroy(&monitor);
    pipeline_destroy(&pipeline);
}

// Samples and errors of a lens or a size are not shown for another one.
static void a_change_of_lens_or_size_begins_anew(void **state) {
    (void)state;
    SKIP_WHERE_THREADS_ARE_WATCHED();
    Pipeline *pipeline = start(true, LOD_HYBRID);
    Monitor *monitor = watch(pipeline);
    FrameOrder order = order_at(0.5, LOD_HYBRID);
    for (int change = 0; change < 2; change++) {
        watch_until(pipeline, monitor, &order, RENDER_ACCURACY_MEASURED, 3);
        if (change == 0)
            order.look.camera.fov_y_rad *= 0.5;
        else
            order.width = WIDTH / 2;
        order.view.px_per_rad = camera_px_per_rad(order.look.camera.fov_y_rad, order.width, order.height, false);
        int64_t begin_ns = clock_now_ns();
        submit(pipeline, &order);
        assert_int_equal(pipeline_drain(pipeline), RESULT_OK);
        clock_sleep_until_ns(clock_now_ns() + 300000000); // what is shown is refreshed four times a second
        uint64_t revision = monitor_shown(monitor)->revision;
        monitor_follow(monitor, true, &order);
        assert_true(monitor_shown(monitor)->revision > revision);
        if (clock_now_ns() - begin_ns > 500000000) // on a busy machine it may have come far already
            continue;
        assert_true(monitor_shown(monitor)->point_count <= 1);
        assert_true(change == 1 || monitor_shown(monitor)->error.state == RENDER_ACCURACY_NOTHING);
    }
    monitor_destroy(&monitor);
    pipeline_destroy(&pipeline);
}

// ---- beginning and end ----

static void a_closed_panel_works_no_more_and_forgets(void **state) {
    (void)state;
    Pipeline *pipeline = start(true, LOD_HYBRID);
    Monitor *monitor = watch(pipeline);
    FrameOrder order = order_at(0.5, LOD_HYBRID);
    watch_until(pipeline, monitor, &order, RENDER_ACCURACY_MEASURED, 0);
    order.look.hud.accuracy.show = false;
    monitor_follow(monitor, false, &order);
    assert_false(order.look.hud.accuracy.show);
    clock_sleep_until_ns(clock_now_ns() + 1000000000);
    double spent_ms = monitor_spent_ms(monitor);
    clock_sleep_until_ns(clock_now_ns() + 500000000);
    assert_true(monitor_spent_ms(monitor) == spent_ms);
    monitor_follow(monitor, true, &order);
    assert_int_equal(monitor_shown(monitor)->error.state, RENDER_ACCURACY_NOTHING);
    int64_t begin_ns = clock_now_ns();
    monitor_destroy(&monitor);
    double took_ms = (double)(clock_now_ns() - begin_ns) * 1e-6;
    print_message("ended in %.1f ms\n", took_ms);
    pipeline_destroy(&pipeline);
}

// Neither the frames that do not show it count nor the time: no refresh is due that would not have been.
static void a_panel_at_rest_works_not_and_forgets_nothing(void **state) {
    (void)state;
    SKIP_WHERE_THREADS_ARE_WATCHED();
    Pipeline *pipeline = start(true, LOD_HYBRID);
    Monitor *monitor = watch(pipeline);
    FrameOrder order = order_at(0.5, LOD_HYBRID);
    watch_until(pipeline, monitor, &order, RENDER_ACCURACY_MEASURED, 0);
    assert_int_equal(pipeline_drain(pipeline), RESULT_OK);
    monitor_rest(monitor, true);
    uint64_t revision = monitor_shown(monitor)->revision;
    double spent_ms = -1.0, before_ms = 0.0;
    // The piece of work in hand is done to its end.
    for (int i = 0; i < 4 && spent_ms != before_ms; i++) {
        before_ms = monitor_spent_ms(monitor);
        fly(pipeline, LOD_HYBRID, 50, 75);
        assert_int_equal(pipeline_drain(pipeline), RESULT_OK);
        clock_sleep_until_ns(clock_now_ns() + 250000000);
        spent_ms = monitor_spent_ms(monitor);
    }
    print_message("%.1f ms worked, and %.1f at rest\n", before_ms, spent_ms - before_ms);
    assert_true(spent_ms == before_ms);
    monitor_rest(monitor, false);
    monitor_follow(monitor, true, &order);
    assert_int_equal(monitor_shown(monitor)->error.state, RENDER_ACCURACY_MEASURED);
    print_message("revision %d before, %d after\n", (int)revision, (int)monitor_shown(monitor)->revision);
    assert_true(monitor_shown(monitor)->revision == revision);
    // Frames that show it count, however few there are between two rests.
    for (int i = 0; i < 14; i++) {
        monitor_follow(monitor, true, &order);
        fly(pipeline, LOD_HYBRID, 50, 51);
        assert_int_equal(pipeline_drain(pipeline), RESULT_OK);
        clock_sleep_until_ns(clock_now_ns() + 22000000);
        monitor_rest(monitor, true);
        monitor_rest(monitor, false);
    }
    monitor_follow(monitor, true, &order);
    assert_true(monitor_shown(monitor)->revision > revision);
    int64_t end_ns = clock_now_ns() + WAIT_NS;
    while ((spent_ms = monitor_spent_ms(monitor)) == before_ms && clock_now_ns() < end_ns)
        submit(pipeline, &order);
    assert_true(spent_ms > before_ms);
    monitor_destroy(&monitor);
    pipeline_destroy(&pipeline);
}

static void it_goes_along_with_changes_of_method_and_ends_in_the_middle(void **state) {
    (void)state;
    for (int round = 0; round < 3; round++) {
        Pipeline *pipeline = start(true, LOD_HYBRID);
        Monitor *monitor = watch(pipeline);
        for (int i = 0; i < 24; i++) {
            FrameOrder order = order_at(0.01 * i, (LodMethod)(i / 3 % LOD_METHOD_COUNT));
            order.compare = round == 1;
            order.right = LOD_ROAM;
            monitor_follow(monitor, i % 10 != 9, &order);
            submit(pipeline, &order);
        }
        monitor_destroy(&monitor);
        pipeline_destroy(&pipeline);
    }
}

// Lists and pages that the hold keeps from being used again are used again afterwards.
static void memory_does_not_grow_with_the_flight(void **state) {
    (void)state;
    SKIP_WHERE_THREADS_ARE_WATCHED();
    Holder holder = {.pipeline = start(true, LOD_HYBRID)};
    pthread_t thread;
    fly(holder.pipeline, LOD_HYBRID, 0, 100);
    assert_int_equal(pthread_create(&thread, NULL, hold_often, &holder), 0);
    fly(holder.pipeline, LOD_HYBRID, 0, 200);
    int64_t before = bench_resident_bytes();
    fly(holder.pipeline, LOD_HYBRID, 0, 400);
    int64_t after = bench_resident_bytes();
    atomic_store(&holder.done, true);
    pthread_join(thread, NULL);
    print_message("%d cuts held; %lld bytes, then %lld\n", holder.held, (long long)before, (long long)after);
    assert_true(after - before < 24 << 20);
    cut_copy_free(&holder.copy);
    pipeline_destroy(&holder.pipeline);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_held_cut_stays_as_it_was_drawn),
        cmocka_unit_test(the_error_is_that_of_the_drawn_cut),
        cmocka_unit_test(points_ascend_and_lie_within_their_bounds),
        cmocka_unit_test(a_change_of_lens_or_size_begins_anew),
        cmocka_unit_test(a_change_of_tolerance_moves_the_point_at_once),
        cmocka_unit_test(a_closed_panel_works_no_more_and_forgets),
        cmocka_unit_test(a_panel_at_rest_works_not_and_forgets_nothing),
        cmocka_unit_test(it_goes_along_with_changes_of_method_and_ends_in_the_middle),
        cmocka_unit_test(memory_does_not_grow_with_the_flight),
    };
    if (!gl_support_begin(WIDTH, HEIGHT, &world.context))
        return GL_SKIP_STATUS;
    int failed = cmocka_run_group_tests(tests, make_world, free_world);
    context_destroy(&world.context);
    return failed;
}
