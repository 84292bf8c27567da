// Two methods side by side, and changes of method: each half is the picture of its method alone, and a pipeline goes
// through all methods, with and without threads, without losing a frame.
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "app/flight/camera.h"
#include "app/pipeline/pipeline.h"
#include "base/clock.h"
#include "render/gl.h"
#include "terrain/geodesy.h"
#include "tests/cut_support.h"
#include "tests/gl_support.h"
#include "tests/heard.h"
#include "tests/slow.h"

#define WIDTH 640
#define HEIGHT 240
#define SIDE 321
#define BRUTE_TRIANGLES (2 * (SIDE - 1) * (SIDE - 1))
#define FOV_RAD (60.0 * GEODESY_RAD_PER_DEG)
#define WAIT_NS 20000000000LL // for a method that is being created

static const DemGeoref GEOREF = {
    .crs = DEM_CRS_GEOGRAPHIC, .x0 = 20.0, .y0 = 49.5, .dx = 1.0 / 1200, .dy = -1.0 / 1200};

typedef struct World {
    Jobs *jobs;
    Terrain *terrain;
    Context *context;
    bool possible[LOD_METHOD_COUNT]; // whether the method can be created
} World;

static World world; // made once; the tests only read it

static bool can_create(LodMethod method) {
    LodOptions options = lod_default_options();
    options.method = method;
    Lod *lod = NULL;
    Result result = lod_create(&options, world.terrain, &lod);
    lod_destroy(&lod);
    return result == RESULT_OK;
}

static int make_world(void **state) {
    (void)state;
    if (jobs_create(2, &world.jobs) != RESULT_OK)
        return 1;
    world.terrain =
        support_terrain(support_rough_dem(SIDE, SIDE, &GEOREF, 1200.0, 5), TERRAIN_ERROR_TOTAL, 8, world.jobs);
    Heard heard;
    heard_begin(&heard);
    for (int i = 0; i < LOD_METHOD_COUNT; i++)
        world.possible[i] = can_create((LodMethod)i);
    heard_end();
    return 0;
}

static int free_world(void **state) {
    (void)state;
    terrain_destroy(&world.terrain);
    jobs_destroy(&world.jobs);
    return 0;
}

static RenderCamera camera_at(double col, double row, double above_m) {
    Vec3d eye = support_eye(world.terrain, col, row, above_m);
    Geodetic at = geodesy_from_ecef(eye);
    Mat3d enu = geodesy_enu_from_ecef(at.lat_rad, at.lon_rad);
    Vec3d east = {enu.m[0][0], enu.m[0][1], enu.m[0][2]}, north = {enu.m[1][0], enu.m[1][1], enu.m[1][2]};
    Vec3d up = {enu.m[2][0], enu.m[2][1], enu.m[2][2]};
    Vec3d ahead = vec3d_normalize(vec3d_mad(north, up, -0.35)), top = vec3d_cross(east, ahead);
    return (RenderCamera){
        eye, {{{east.x, east.y, east.z}, {top.x, top.y, top.z}, {-ahead.x, -ahead.y, -ahead.z}}}, FOV_RAD};
}

static LodView view_of(const RenderCamera *camera, double tau_px) {
    const double *back = camera->camera_from_ecef.m[2];
    return (LodView){.eye_ecef = camera->eye_ecef,
                     .forward_ecef = {-back[0], -back[1], -back[2]},
                     .px_per_rad = camera_px_per_rad(FOV_RAD, WIDTH, HEIGHT, false),
                     .tau_px = tau_px};
}

static FrameOrder order_at(double along, LodMethod method) {
    FrameOrder order = {.method = method, .width = WIDTH, .height = HEIGHT};
    order.look.camera = camera_at(SIDE * (0.3 + 0.3 * along), SIDE * (0.3 + 0.1 * along), 700.0);
    order.look.sun_ecef = vec3d_normalize(order.look.camera.eye_ecef);
    order.look.colouring = RENDER_COLOUR_LEVEL;
    order.view = view_of(&order.look.camera, 2.0);
    return order;
}

static PipelineOptions options_with(bool threaded, LodMethod method) {
    PipelineOptions options = {.threaded = threaded,
                               .lod = lod_default_options(),
                               .render = render_default_options(),
                               .terrain = world.terrain,
                               .jobs = world.jobs,
                               .context = world.context};
    options.lod.method = method;
    options.render.width = WIDTH;
    options.render.height = HEIGHT;
    options.render.samples = 1;
    options.render.vram_bytes_max = (size_t)32 << 20;
    return options;
}

static Pipeline *start_with(const PipelineOptions *options) {
    Pipeline *pipeline = NULL;
    context_release_current(world.context);
    assert_int_equal(pipeline_create(options, &pipeline), RESULT_OK);
    return pipeline;
}

// ---- each half is the picture of its method ----

typedef struct Stage {
    Renderer *renderer;
    Lod *lods[2];
    Arena *arena;
} Stage;

static Lod *create_lod(LodMethod method, uint32_t serial) {
    LodOptions options = lod_default_options();
    options.method = method;
    options.serial = serial;
    Lod *lod = NULL;
    assert_int_equal(lod_create(&options, world.terrain, &lod), RESULT_OK);
    return lod;
}

static Stage stage_begin(int width, size_t vram_bytes, LodMethod left, LodMethod right) {
    Stage stage = {.lods = {create_lod(left, 1), create_lod(right, 2)}};
    RenderOptions options = render_default_options();
    options.width = width;
    options.height = HEIGHT;
    options.samples = 1;
    options.vram_bytes_max = vram_bytes;
    assert_int_equal(context_make_current(world.context), RESULT_OK);
    assert_int_equal(render_create(&options, world.terrain, &stage.renderer), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &stage.arena), RESULT_OK);
    return stage;
}

static void stage_end(Stage *stage) {
    render_destroy(&stage->renderer);
    for (int i = 0; i < 2; i++)
        lod_destroy(&stage->lods[i]);
    arena_destroy(&stage->arena);
}

// The renderer's picture of one view by both methods, or by the first.
static void draw(Stage *stage, double along, bool split, RenderStats *stats, uint8_t *rgb) {
    FrameOrder order = order_at(along, LOD_HYBRID);
    RenderPacket packet = order.look;
    packet.magenta_background = true; // no noise that depends on where in the picture a pixel is
    packet.split = split;
    arena_reset(stage->arena);
    assert_int_equal(lod_update(stage->lods[0], &order.view, world.jobs, stage->arena, &packet.cut), RESULT_OK);
    if (split)
        assert_int_equal(lod_update(stage->lods[1], &order.view, world.jobs, stage->arena, &packet.right), RESULT_OK);
    assert_int_equal(render_frame(stage->renderer, &packet, stats), RESULT_OK);
    assert_int_equal(render_read_pixels(stage->renderer, rgb), RESULT_OK);
    assert_int_equal(gl_take_error(), GL_NO_ERROR);
    lod_release(stage->lods[0], packet.cut.frame);
    lod_release(stage->lods[1], packet.right.frame);
}

// Pixels of a half that differ from the picture of half the width; not counting the divider, two pixels and its halo.
static int count_different(const uint8_t *both, const uint8_t *one, int half) {
    int different = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = half ? 5 : 0; x < WIDTH / 2 - (half ? 0 : 5); x++)
            different += memcmp(both + ((size_t)y * WIDTH + (size_t)(half * WIDTH / 2 + x)) * 3,
                                one + ((size_t)y * (WIDTH / 2) + (size_t)x) * 3, 3) != 0;
    return different;
}

// Draws a flight in halves and each method alone. `vram_bytes` is that of the renderer with both. Returns its
// evictions.
static int64_t check_halves(size_t vram_bytes, int frames) {
    Stage both = stage_begin(WIDTH, vram_bytes, LOD_HYBRID, LOD_BRUTE);
    Stage alone[2] = {stage_begin(WIDTH / 2, (size_t)64 << 20, LOD_HYBRID, LOD_HYBRID),
                      stage_begin(WIDTH / 2, (size_t)64 << 20, LOD_BRUTE, LOD_BRUTE)};
    uint8_t *two = malloc((size_t)WIDTH * HEIGHT * 3), *one = malloc((size_t)WIDTH * HEIGHT * 3);
    assert_true(two && one);
    RenderStats stats, single;
    int64_t evictions = 0;
    for (int frame = 0; frame < frames; frame++) {
        draw(&both, (double)frame / frames, true, &stats, two);
        evictions += stats.evictions + stats.right.evictions;
        for (int half = 0; half < 2; half++) {
            draw(&alone[half], (double)frame / frames, false, &single, one);
            int64_t triangles = half ? stats.right.triangles_drawn : stats.triangles_drawn;
            int different = count_different(two, one, half);
            if (different > HEIGHT / 20 || triangles != single.triangles_drawn)
                fail_msg("frame %d, half %d: %d pixels differ; %lld triangles, alone %lld", frame, half, different,
                         (long long)triangles, (long long)single.triangles_drawn);
        }
    }
    free(two);
    free(one);
    stage_end(&both);
    stage_end(&alone[0]);
    stage_end(&alone[1]);
    return evictions;
}

static void each_half_is_the_picture_of_its_method(void **state) {
    SKIP_WHERE_THREADS_ARE_WATCHED();
    (void)state;
    assert_int_equal(check_halves((size_t)64 << 20, 8), 0);
}

// The least memory a cache takes holds either cut, and not both with what was drawn before.
static void two_cuts_need_not_fit_into_the_memory_together(void **state) {
    SKIP_WHERE_THREADS_ARE_WATCHED();
    (void)state;
    int64_t evictions = check_halves((size_t)4 << 20, 8);
    print_message("%lld evictions\n", (long long)evictions);
    assert_true(evictions > 0);
}

// ---- the pipeline goes through all methods ----

static Pipeline *start(bool threaded, LodMethod method) {
    const PipelineOptions options = options_with(threaded, method);
    return start_with(&options);
}

typedef struct Expected {
    LodMethod method; // what is to be shown
    int64_t changes, refusals;
} Expected;

static void check_shown(const PipelineStats *stats, const Expected *expected, const char *what) {
    if (stats->cut.method != expected->method || stats->changes.changes != expected->changes ||
        stats->changes.refusals != expected->refusals)
        fail_msg("%s: expected %s, %lld changes, %lld refusals; found %s, %lld, %lld", what,
                 lod_method_name(expected->method), (long long)expected->changes, (long long)expected->refusals,
                 lod_method_name(stats->cut.method), (long long)stats->changes.changes,
                 (long long)stats->changes.refusals);
}

static void in_lockstep_the_next_frame_has_the_method(void **state) {
    (void)state;
    Pipeline *pipeline = start(false, LOD_HYBRID);
    Expected expected = {.method = LOD_HYBRID};
    int64_t frames = 0;
    Heard heard;
    heard_begin(&heard);
    for (int i = 0; i < 2 * LOD_METHOD_COUNT; i++) {
        LodMethod wanted = (LodMethod)((i + 1) % LOD_METHOD_COUNT);
        bool possible = world.possible[wanted];
        expected.changes += possible && wanted != expected.method;
        expected.refusals += !possible;
        expected.method = possible ? wanted : expected.method;
        for (int again = 0; again < 2; again++, frames++) {
            FrameOrder order = order_at(i / 16.0, wanted);
            assert_int_equal(pipeline_submit(pipeline, &order, true), RESULT_OK);
            PipelineStats stats = pipeline_stats(pipeline);
            check_shown(&stats, &expected, lod_method_name(wanted));
            assert_int_equal(stats.frames, frames + 1);
            assert_true(stats.cut.lod.triangles > 0);
        }
    }
    heard_end();
    print_message("%lld changes, %lld refusals\n", (long long)expected.changes, (long long)expected.refusals);
    pipeline_destroy(&pipeline);
}

static void in_lockstep_all_methods_are_compared(void **state) {
    (void)state;
    Pipeline *pipeline = start(false, LOD_BRUTE);
    int64_t split = 0;
    Heard heard;
    heard_begin(&heard);
    for (int i = 0; i < LOD_METHOD_COUNT; i++) {
        bool possible = world.possible[i];
        FrameOrder order = order_at(i / 8.0, LOD_BRUTE);
        order.compare = true;
        order.right = (LodMethod)i;
        assert_int_equal(pipeline_submit(pipeline, &order, true), RESULT_OK);
        PipelineStats stats = pipeline_stats(pipeline);
        assert_int_equal(stats.cut.method, LOD_BRUTE);
        assert_int_equal(stats.split, possible);
        if (possible)
            assert_int_equal(stats.right.method, i);
        split += possible;
        order.compare = false;
        assert_int_equal(pipeline_submit(pipeline, &order, true), RESULT_OK);
        assert_false(pipeline_stats(pipeline).split);
    }
    heard_end();
    assert_int_equal(pipeline_stats(pipeline).frames_split, split);
    pipeline_destroy(&pipeline);
}

// Submits frames until the left half, and the right one if wanted, show what is wanted; or one was refused.
static void fly_until_shown(Pipeline *pipeline, const FrameOrder *order, int64_t refusals) {
    int64_t end_ns = clock_now_ns() + WAIT_NS;
    PipelineStats stats;
    do {
        assert_int_equal(pipeline_submit(pipeline, order, true), RESULT_OK);
        stats = pipeline_stats(pipeline);
        bool left = stats.cut.method == order->method, right = stats.split && stats.right.method == order->right;
        if (left && stats.split == order->compare && (right || !order->compare))
            return;
        if (stats.changes.refusals > refusals)
            return;
    } while (clock_now_ns() < end_ns);
    fail_msg("expected %s%s%s, found %s%s%s", lod_method_name(order->method), order->compare ? " and " : "",
             order->compare ? lod_method_name(order->right) : "", lod_method_name(stats.cut.method),
             stats.split ? " and " : "", stats.split ? lod_method_name(stats.right.method) : "");
}

// The former method is shown for as long as the next one takes; frames go on coming.
static void with_threads_methods_change_while_frames_go_on(void **state) {
    (void)state;
    Pipeline *pipeline = start(true, LOD_HYBRID);
    Heard heard;
    heard_begin(&heard);
    for (int i = 0; i < 3 * LOD_METHOD_COUNT; i++) {
        FrameOrder order = order_at(i / 24.0, (LodMethod)((i + 1) % LOD_METHOD_COUNT));
        order.compare = i >= LOD_METHOD_COUNT && i % 3 != 0;
        order.right = (LodMethod)((5 * i + 1) % LOD_METHOD_COUNT);
        fly_until_shown(pipeline, &order, pipeline_stats(pipeline).changes.refusals);
        // And sometimes another one is wanted before that one has come.
        order.method = (LodMethod)((i + 3) % LOD_METHOD_COUNT);
        assert_int_equal(pipeline_submit(pipeline, &order, false), RESULT_OK);
    }
    assert_int_equal(pipeline_drain(pipeline), RESULT_OK);
    heard_end();
    PipelineStats stats = pipeline_stats(pipeline);
    print_message("%lld frames, %lld split; %lld changes, %lld refusals; longest frame %.1f ms, creation %.1f ms, "
                  "first refinement %.1f ms\n",
                  (long long)stats.frames, (long long)stats.frames_split, (long long)stats.changes.changes,
                  (long long)stats.changes.refusals, stats.longest_frame_ms, stats.changes.longest_create_ms,
                  stats.changes.longest_first_refine_ms);
    for (int i = 0; i < LOD_METHOD_COUNT; i++)
        assert_int_equal(stats.frames_by_method[i] > 0, world.possible[i]);
    pipeline_destroy(&pipeline);
}

// Every sample is more than the budget: the flight goes on with what it has, and with the next method that can come.
static void a_method_that_cannot_be_created_leaves_the_present_one(void **state) {
    (void)state;
    for (int threaded = 0; threaded < 2; threaded++) {
        PipelineOptions options = options_with(threaded, LOD_HYBRID);
        options.bound_brute = true;
        options.lod.max_triangles = BRUTE_TRIANGLES - 1;
        Pipeline *pipeline = start_with(&options);
        FrameOrder order = order_at(0.5, LOD_BRUTE);
        order.compare = true;
        order.right = LOD_BRUTE;
        Heard heard;
        heard_begin(&heard);
        int64_t end_ns = clock_now_ns() + WAIT_NS;
        PipelineStats stats;
        do {
            assert_int_equal(pipeline_submit(pipeline, &order, true), RESULT_OK);
            stats = pipeline_stats(pipeline);
            assert_true(stats.cut.method == LOD_HYBRID && !stats.split);
        } while (stats.changes.refusals < 2 && clock_now_ns() < end_ns);
        for (int i = 0; i < 5; i++) // it is not tried again and again
            assert_int_equal(pipeline_submit(pipeline, &order, true), RESULT_OK);
        heard_end();
        stats = pipeline_stats(pipeline);
        assert_int_equal(stats.changes.refusals, 2);
        assert_int_equal(stats.changes.refusal, RESULT_RANGE);
        assert_int_equal(heard.errors, 2);
        assert_string_equal(stats.changes.why, "204800 triangles, more than --max-triangles 204799");
        assert_non_null(strstr(heard.text, stats.changes.why));
        order.method = order.right = LOD_PATCH;
        fly_until_shown(pipeline, &order, 2);
        pipeline_destroy(&pipeline);
    }
}

static void brute_within_the_budget_or_where_none_is_kept_comes(void **state) {
    (void)state;
    for (int bound = 0; bound < 2; bound++) {
        PipelineOptions options = options_with(false, LOD_HYBRID);
        options.bound_brute = bound;
        options.lod.max_triangles = bound ? BRUTE_TRIANGLES : 1000;
        Pipeline *pipeline = start_with(&options);
        FrameOrder order = order_at(0.5, LOD_BRUTE);
        assert_int_equal(pipeline_submit(pipeline, &order, true), RESULT_OK);
        PipelineStats stats = pipeline_stats(pipeline);
        assert_int_equal(stats.cut.method, LOD_BRUTE);
        assert_int_equal(stats.cut.lod.triangles, BRUTE_TRIANGLES);
        pipeline_destroy(&pipeline);
    }
}

// ---- errors ----

static void an_error_comes_back_from_every_later_frame(void **state) {
    (void)state;
    for (int threaded = 0; threaded < 2; threaded++) {
        Pipeline *pipeline = start(threaded, LOD_HYBRID);
        FrameOrder order = order_at(0.5, LOD_HYBRID), bad = order;
        bad.view.tau_px = NAN;
        Heard heard;
        heard_begin(&heard);
        assert_int_equal(pipeline_submit(pipeline, &order, true), RESULT_OK);
        assert_int_equal(pipeline_drain(pipeline), RESULT_OK);
        (void)!pipeline_submit(pipeline, &bad, true); // with threads it is not known yet
        assert_int_equal(pipeline_drain(pipeline), RESULT_RANGE);
        assert_int_equal(pipeline_submit(pipeline, &order, true), RESULT_RANGE);
        assert_int_equal(pipeline_drain(pipeline), RESULT_RANGE);
        heard_end();
        assert_int_equal(heard.errors, 1);
        assert_int_equal(pipeline_stats(pipeline).frames, 1);
        pipeline_destroy(&pipeline);
    }
}

static void a_frame_that_cannot_be_drawn_does_not_count(void **state) {
    (void)state;
    Pipeline *pipeline = start(false, LOD_HYBRID);
    FrameOrder order = order_at(0.5, LOD_HYBRID);
    order.width = 1 << 24; // no texture is as wide
    Heard heard;
    heard_begin(&heard);
    Result result = pipeline_submit(pipeline, &order, true);
    heard_end();
    assert_true(result != RESULT_OK);
    assert_int_equal(pipeline_drain(pipeline), result);
    assert_int_equal(pipeline_stats(pipeline).frames, 0);
    pipeline_destroy(&pipeline);
}

// ---- a GPU that has no room for the diamonds ----

#define LARGE_BYTES (256 << 10) // less than any array of the model

static PFNGLNAMEDBUFFERSTORAGEPROC given_storage; // while the driver refuses

static void APIENTRY refuse_large(GLuint buffer, GLsizeiptr bytes, const void *data, GLbitfield flags) {
    given_storage(buffer, bytes > LARGE_BYTES ? -1 : bytes, data, flags);
}

static void let_driver_refuse(bool refuse) {
    if (refuse)
        given_storage = glNamedBufferStorage;
    glNamedBufferStorage = refuse ? refuse_large : given_storage;
}

static int64_t submit_and_wait(Pipeline *pipeline, const FrameOrder *order) {
    assert_int_equal(pipeline_submit(pipeline, order, true), RESULT_OK);
    assert_int_equal(pipeline_drain(pipeline), RESULT_OK);
    return 1;
}

// The diamonds come all the same, made by the processor, and no frame is lost. Returns what was shown meanwhile.
static int64_t check_fallback(bool threaded, LodMethod first) {
    PipelineOptions options = options_with(threaded, first);
    options.lod.resident = true;
    Pipeline *pipeline = start_with(&options);
    FrameOrder order = order_at(0.5, first);
    int64_t end_ns = clock_now_ns() + WAIT_NS, frames = 0;
    if (first != LOD_DIAMOND)
        frames += submit_and_wait(pipeline, &order);
    Heard heard;
    heard_begin(&heard);
    let_driver_refuse(true);
    order.method = LOD_DIAMOND;
    PipelineStats stats;
    do {
        frames += submit_and_wait(pipeline, &order);
        stats = pipeline_stats(pipeline);
        assert_true(stats.cut.lod.triangles > 0);
        assert_false(stats.render.resident.made);
    } while ((stats.cut.method != LOD_DIAMOND || stats.changes.fallbacks < 1) && clock_now_ns() < end_ns);
    let_driver_refuse(false);
    heard_end();
    assert_int_equal(stats.cut.method, LOD_DIAMOND);
    assert_int_equal(stats.changes.fallbacks, 1);
    assert_int_equal(stats.changes.refusals, 0);
    assert_int_equal(stats.frames, frames);
    const char *said = strstr(heard.text, "the processor computes it");
    if (!said || strstr(said + 1, "the processor computes it"))
        fail_msg("expected one warning of it, heard: %s", heard.text);
    pipeline_destroy(&pipeline);
    return stats.frames_by_method[first];
}

static void without_room_on_the_gpu_the_processor_makes_diamonds(void **state) {
    SKIP_WHERE_THREADS_ARE_WATCHED();
    (void)state;
    assert_int_equal(check_fallback(false, LOD_HYBRID), 1);
    assert_int_equal(check_fallback(false, LOD_DIAMOND), 1);
    int64_t meanwhile = check_fallback(true, LOD_HYBRID);
    print_message("%lld frames of hybrid before the processor's diamonds\n", (long long)meanwhile);
    assert_true(meanwhile > 1);
    assert_int_equal(check_fallback(true, LOD_DIAMOND), 1);
}

static void with_room_on_the_gpu_its_share_of_a_change_is_told(void **state) {
    (void)state;
    PipelineOptions options = options_with(true, LOD_HYBRID);
    options.lod.resident = true;
    Pipeline *pipeline = start_with(&options);
    FrameOrder order = order_at(0.5, LOD_DIAMOND);
    fly_until_shown(pipeline, &order, 0);
    order.compare = true;
    order.right = LOD_DIAMOND;
    fly_until_shown(pipeline, &order, 0);
    order.method = LOD_HYBRID;
    fly_until_shown(pipeline, &order, 0);
    assert_int_equal(pipeline_drain(pipeline), RESULT_OK);
    PipelineStats stats = pipeline_stats(pipeline);
    assert_true(stats.render.right.resident.made);
    assert_int_equal(stats.changes.fallbacks, 0);
    assert_true(stats.longest_gpu_create_ms > 0.0);
    pipeline_destroy(&pipeline);
}

// The flight ends while a method is being created.
static void leaving_in_the_middle_of_a_change_is_clean(void **state) {
    (void)state;
    for (int i = 0; i < 6; i++) {
        Pipeline *pipeline = start(true, LOD_HYBRID);
        FrameOrder order = order_at(0.5, i % 2 ? LOD_BRUTE : LOD_HYBRID);
        order.compare = i >= 2;
        order.right = LOD_BRUTE;
        assert_int_equal(pipeline_submit(pipeline, &order, true), RESULT_OK);
        if (i >= 4)
            assert_int_equal(pipeline_drain(pipeline), RESULT_OK);
        pipeline_destroy(&pipeline);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_half_is_the_picture_of_its_method),
        cmocka_unit_test(two_cuts_need_not_fit_into_the_memory_together),
        cmocka_unit_test(in_lockstep_the_next_frame_has_the_method),
        cmocka_unit_test(in_lockstep_all_methods_are_compared),
        cmocka_unit_test(with_threads_methods_change_while_frames_go_on),
        cmocka_unit_test(a_method_that_cannot_be_created_leaves_the_present_one),
        cmocka_unit_test(brute_within_the_budget_or_where_none_is_kept_comes),
        cmocka_unit_test(an_error_comes_back_from_every_later_frame),
        cmocka_unit_test(a_frame_that_cannot_be_drawn_does_not_count),
        cmocka_unit_test(without_room_on_the_gpu_the_processor_makes_diamonds),
        cmocka_unit_test(with_room_on_the_gpu_its_share_of_a_change_is_told),
        cmocka_unit_test(leaving_in_the_middle_of_a_change_is_clean),
    };
    if (!gl_support_begin(WIDTH, HEIGHT, &world.context))
        return GL_SKIP_STATUS;
    int failed = cmocka_run_group_tests(tests, make_world, free_world);
    context_destroy(&world.context);
    return failed;
}
