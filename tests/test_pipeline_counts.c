// What a drawn frame is said to have cost, from made-up stages.
#include "app/pipeline/pipeline_counts.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

#define MS INT64_C(1000000)

typedef struct Stages {
    PipelineCounts *counts;
    RenderPacket packet;
    RenderStats drawn;
    PipelineWork work;
    LodMethod methods[METHODS_HALVES];
    int64_t now_ns;
} Stages;

// One frame is drawn, of which the next ones differ by what a test changes.
static Stages begin(void) {
    Stages s = {.counts = calloc(1, sizeof *s.counts), .work = {.width = 640, .height = 400}, .now_ns = 5 * MS};
    assert_non_null(s.counts);
    s.packet.cut.view = (LodView){.eye_ecef = vec3d(7e6, 0.0, 0.0), .px_per_rad = 1000.0, .tau_px = 2.0};
    s.packet.camera.eye_ecef = s.packet.cut.view.eye_ecef;
    s.packet.cut.reached_px = 2.0;
    s.packet.cut.stats.triangles = 1000;
    pipeline_counts_add(s.counts, &s.packet, s.methods, &s.drawn, &s.work, s.now_ns);
    return s;
}

static PipelineFrame add(Stages *s, int64_t ms) {
    s->now_ns += ms * MS;
    pipeline_counts_add(s->counts, &s->packet, s->methods, &s->drawn, &s->work, s->now_ns);
    return s->counts->stats.latest[(s->counts->stats.frames - 1) % PIPELINE_FRAMES_KEPT];
}

static void end(Stages *s) {
    free(s->counts);
}

static void check_cost(const PipelineFrame *frame, double ms, const char *what) {
    if (fabs(frame->cost_ms - ms) > 1e-9)
        fail_msg("%s: %.3f ms, expected %.3f", what, frame->cost_ms, ms);
}

static void test_the_cost_is_the_time_between_frames_where_nothing_waits(void **state) {
    (void)state;
    Stages s = begin();
    s.work.refine_ns = 12 * MS;
    s.work.draw_ns = 19 * MS;
    PipelineFrame frame = add(&s, 20);
    check_cost(&frame, 20.0, "overlapped");
    assert_true(frame.frame_ms == 20.0 && frame.tau_px == 2.0 && frame.reached_px == 2.0 && frame.triangles == 1000);
    end(&s);
}

static void test_waiting_for_an_order_or_the_screen_costs_nothing(void **state) {
    (void)state;
    Stages s = begin();
    s.work.refine_ns = 3 * MS;
    s.work.draw_ns = 5 * MS;
    s.work.waited_ns = 14 * MS; // also while it was drawn
    PipelineFrame frame = add(&s, 17);
    check_cost(&frame, 5.0, "the drawing is the longest stage");
    s.work.refine_ns = 7 * MS;
    frame = add(&s, 17);
    check_cost(&frame, 7.0, "the refining is the longest stage");
    s.drawn.draw_ms = 8.0; // on a GPU, which works on when the orders are given
    s.drawn.upload_ms = 1.0;
    frame = add(&s, 17);
    check_cost(&frame, 9.0, "the GPU's own time");
    end(&s);
}

static void test_a_frame_knows_whether_its_view_is_that_of_the_one_before(void **state) {
    (void)state;
    Stages s = begin();
    PipelineFrame first = s.counts->stats.latest[0], frame = add(&s, 10);
    assert_true(first.another && first.moved && first.disturbed);
    assert_false(frame.moved || frame.disturbed);
    s.packet.camera.eye_ecef.x += 1e-3;
    frame = add(&s, 10);
    assert_true(frame.moved && !frame.disturbed);
    s.packet.camera.camera_from_ecef.m[1][2] += 1e-6;
    frame = add(&s, 10);
    assert_true(frame.moved && !frame.disturbed);
    s.packet.camera.fov_y_rad += 0.1;
    frame = add(&s, 10);
    assert_true(frame.moved && !frame.disturbed);
    s.packet.hud.accuracy.show = true; // costs time too
    frame = add(&s, 10);
    assert_true(frame.moved && !frame.another && !frame.disturbed);
    s.packet.hud.message = "it goes by itself";
    frame = add(&s, 10);
    assert_false(frame.another || frame.moved || frame.disturbed);
    end(&s);
}

static void test_frames_that_tell_nothing_of_the_next_ones_say_so(void **state) {
    (void)state;
    Stages s = begin();
    s.methods[0] = LOD_ROAM;
    PipelineFrame frame = add(&s, 10);
    assert_true(frame.another && frame.moved && frame.disturbed);
    s.work.width = 800;
    frame = add(&s, 10);
    assert_true(frame.another && frame.moved && frame.disturbed && frame.width == 800);
    s.packet.wireframe = true;
    frame = add(&s, 10);
    assert_true(frame.another && frame.moved && frame.disturbed);
    s.packet.colouring++;
    frame = add(&s, 10);
    assert_true(frame.another && frame.moved && frame.disturbed);
    s.work.wrote = true;
    frame = add(&s, 10);
    assert_true(!frame.moved && frame.disturbed);
    s.work.wrote = false;
    s.drawn.resident.create_ms = 300.0;
    frame = add(&s, 10);
    assert_true(!frame.moved && frame.disturbed);
    frame = add(&s, 10);
    assert_false(frame.moved || frame.disturbed);
    end(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_cost_is_the_time_between_frames_where_nothing_waits),
        cmocka_unit_test(test_waiting_for_an_order_or_the_screen_costs_nothing),
        cmocka_unit_test(test_a_frame_knows_whether_its_view_is_that_of_the_one_before),
        cmocka_unit_test(test_frames_that_tell_nothing_of_the_next_ones_say_so),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
