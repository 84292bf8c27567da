// Frame time against tolerance, from made-up frames: what a triangle costs is found where the flight tells it, and
// left open where it does not.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "app/live/curve.h"
#include "app/live/history.h"
#include "app/live/pace.h"

#define FRAME_NS 20000000

static double noise(uint64_t *seed) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) / 9007199254740992.0 - 0.5;
}

// 20 ms and 0.2 ms for each thousand triangles, 80,000 / tau of them, with 10 % of noise.
static PipelineFrame frame_at(int64_t number, double tau_px, uint64_t *seed) {
    double triangles = 80000.0 / tau_px * (1.0 + 0.02 * noise(seed));
    double draw_ms = (20.0 + 0.0002 * triangles) * (1.0 + 0.1 * noise(seed));
    return (PipelineFrame){.number = number,
                           .end_ns = number * FRAME_NS,
                           .method = LOD_HYBRID,
                           .tau_px = tau_px,
                           .px_per_rad = 700.0,
                           .select_ms = 0.1f,
                           .refine_ms = 0.4f,
                           .upload_ms = 0.0f,
                           .draw_ms = (float)draw_ms,
                           .frame_ms = (float)draw_ms + 1.0f,
                           .triangles_drawn = (int64_t)triangles};
}

static int64_t fly(Curve *curve, int64_t number, int frames, double tau_px) {
    uint64_t seed = 5;
    for (int i = 0; i < frames; i++) {
        PipelineFrame frame = frame_at(++number, tau_px, &seed);
        curve_add_frame(curve, &frame);
    }
    return number;
}

static void sample_all(Curve *curve, int64_t now_ns) {
    for (int i = 0; i < CURVE_SAMPLES; i++)
        curve->samples[i] = (CurveSample){.tau_px = curve_sample_tau(i),
                                          .triangles = 80000.0 / curve_sample_tau(i),
                                          .refine_ms = 1.0 / curve_sample_tau(i),
                                          .made_ns = now_ns};
}

static void a_flight_of_one_tolerance_leaves_the_slope_open(void **state) {
    (void)state;
    Curve curve = {0};
    int64_t now_ns = fly(&curve, 0, 100, 1.0) * FRAME_NS;
    CurveSlope slope = curve_slope(&curve, now_ns);
    print_message("0.2 is true; found %.4f, %.4f to %.4f us\n", 1e3 * slope.ms, 1e3 * slope.least_ms,
                  1e3 * slope.most_ms);
    assert_true(slope.least_ms <= 0.0002 && slope.most_ms >= 0.0002);
    assert_true(slope.most_ms - slope.least_ms > 0.0001);
    assert_false(slope.known);
    now_ns = fly(&curve, 100, 1500, 1.1) * FRAME_NS; // many frames, but hardly another number of triangles
    assert_false(curve_slope(&curve, now_ns).known);
}

static void two_tolerances_tell_what_a_triangle_costs(void **state) {
    (void)state;
    Curve curve = {0};
    int64_t number = fly(&curve, 0, 100, 4.0);
    int64_t now_ns = fly(&curve, number, 100, 1.0) * FRAME_NS;
    CurveSlope slope = curve_slope(&curve, now_ns);
    print_message("0.2 is true; found %.4f, %.4f to %.4f us\n", 1e3 * slope.ms, 1e3 * slope.least_ms,
                  1e3 * slope.most_ms);
    assert_true(fabs(slope.ms - 0.0002) < 0.00002);
    assert_true(slope.least_ms <= 0.0002 && slope.most_ms >= 0.0002);
    assert_true(slope.most_ms - slope.least_ms < 0.0001);
    assert_true(slope.known);
}

// What was sampled is near what those tolerances take, and passes through the present point.
static void samples_foretell_frames(void **state) {
    (void)state;
    Curve curve = {0};
    RenderAccuracyPoint points[RENDER_ACCURACY_POINTS];
    int64_t number = fly(&curve, 0, 100, 4.0);
    int64_t now_ns = fly(&curve, number, 100, 1.0) * FRAME_NS;
    sample_all(&curve, now_ns);
    int count = curve_points(&curve, now_ns, points), flown = 0;
    assert_int_equal(count, CURVE_SAMPLES + 2);
    for (int i = 0; i < count; i++) {
        double tau = (double)points[i].tau_px, expected = 20.0 + 16.0 / tau + 0.5 / (points[i].flown ? 1.0 : tau);
        print_message("%.2f px: expected %.1f ms, found %.1f\n", tau, expected, (double)points[i].frame_ms);
        assert_true(fabs((double)points[i].frame_ms - expected) < 0.12 * expected);
        assert_true(i == 0 || points[i].tau_px >= points[i - 1].tau_px);
        flown += points[i].flown;
    }
    assert_int_equal(flown, 2);
}

static void old_points_fade_and_go(void **state) {
    (void)state;
    Curve curve = {0};
    RenderAccuracyPoint points[RENDER_ACCURACY_POINTS];
    int64_t now_ns = fly(&curve, 0, 50, 2.0) * FRAME_NS;
    assert_int_equal(curve_points(&curve, now_ns, points), 1);
    assert_true(points[0].freshness == 1.0f);
    int64_t later_ns = now_ns + (int64_t)(0.5 * CURVE_FORGOTTEN_S * 1e9);
    assert_int_equal(curve_points(&curve, later_ns, points), 1);
    assert_true(points[0].freshness > 0.1f && points[0].freshness < 0.9f);
    assert_int_equal(curve_points(&curve, now_ns + (int64_t)(CURVE_FORGOTTEN_S * 1e9), points), 0);
}

static void another_method_or_lens_begins_anew(void **state) {
    (void)state;
    Curve curve = {0};
    uint64_t seed = 1;
    RenderAccuracyPoint points[RENDER_ACCURACY_POINTS];
    int64_t number = fly(&curve, 0, 50, 2.0);
    PipelineFrame frame = frame_at(number + 1, 2.0, &seed);
    frame.px_per_rad *= 2.0;
    curve_add_frame(&curve, &frame);
    assert_int_equal(curve_points(&curve, frame.end_ns, points), 0);
    fly(&curve, number + 1, 50, 2.0);
    frame.method = LOD_ROAM;
    curve_add_frame(&curve, &frame);
    assert_int_equal(curve_points(&curve, frame.end_ns, points), 0);
}

static void frames_without_triangles_or_time_give_numbers(void **state) {
    (void)state;
    Curve curve = {0};
    RenderAccuracyPoint points[RENDER_ACCURACY_POINTS];
    assert_int_equal(curve_points(&curve, 0, points), 0);
    for (int i = 1; i < 20; i++) {
        PipelineFrame frame = {.number = i, .end_ns = i, .tau_px = i % 2 ? 1e-5 : 1e5, .px_per_rad = 700.0};
        curve_add_frame(&curve, &frame);
    }
    sample_all(&curve, 20);
    int count = curve_points(&curve, 20, points);
    for (int i = 0; i < count; i++)
        assert_true(isfinite(points[i].frame_ms) && isfinite(points[i].least_ms) && isfinite(points[i].most_ms));
}

static void percentiles_are_of_the_last_seconds(void **state) {
    (void)state;
    History *history = calloc(1, sizeof *history);
    RenderAccuracy shown;
    memset(&shown, 0, sizeof shown);
    assert_non_null(history);
    history_summarise(history, 0, &shown);
    assert_true(isnan(shown.p50_ms) && isnan(history_present_ms(history)));
    for (int i = 0; i < 1000; i++) {
        PipelineFrame frame = {.number = i + 1,
                               .end_ns = (i + 1) * (int64_t)FRAME_NS,
                               .tau_px = 1.0,
                               .draw_ms = i < 700 ? 90.0f : 10.0f,
                               .frame_ms = i < 700 ? 99.0f : (float)(i % 50 + 1)};
        history_add(history, &frame);
    }
    history_summarise(history, 1000 * (int64_t)FRAME_NS, &shown);
    print_message("of 1 .. 50: p50 %.0f, p99 %.0f\n", shown.p50_ms, shown.p99_ms);
    assert_true(shown.p50_ms == 25.0 && shown.p99_ms == 50.0);
    assert_true(history_present_ms(history) == 10.0);
    assert_true(fabsf(shown.mean.draw_ms - 10.0f) < 0.01f);
    history_fill_frames(history, &shown);
    assert_int_equal(shown.frame_count, RENDER_ACCURACY_FRAMES);
    free(history);
}

static void rest_is_in_proportion_to_work(void **state) {
    (void)state;
    Pace pace = pace_begin(0.01);
    volatile double sink = 0.0;
    while (pace_worked_ns(&pace) < 3000000)
        sink = sink + 1.0;
    double worked_ns = (double)pace_worked_ns(&pace), rest_ns = (double)pace_rest_ns(&pace);
    double share = worked_ns / (worked_ns + rest_ns);
    print_message("share of a processor: expected %.4f, found %.4f\n", pace.share, share);
    assert_true(fabs(share / pace.share - 1.0) < 0.05);
    assert_true(pace_worked_ns(&pace) < 3000000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_flight_of_one_tolerance_leaves_the_slope_open),
        cmocka_unit_test(two_tolerances_tell_what_a_triangle_costs),
        cmocka_unit_test(samples_foretell_frames),
        cmocka_unit_test(old_points_fade_and_go),
        cmocka_unit_test(another_method_or_lens_begins_anew),
        cmocka_unit_test(frames_without_triangles_or_time_give_numbers),
        cmocka_unit_test(percentiles_are_of_the_last_seconds),
        cmocka_unit_test(rest_is_in_proportion_to_work),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
