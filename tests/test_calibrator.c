// The way through a calibration, without devices and files: resting, moving, coming late, leaving.
#include "app/devices/calibrator.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#define TICK_S 0.02

enum { X, Y, LEVER, AXES };

static void plug(Calibrator *calibrator, int slot) {
    DeviceEvent event = {.kind = DEVICE_ARRIVED, .slot = slot, .info = {.name = "stick", .axis_count = AXES}};
    calibrator_take(calibrator, &event);
}

static void tell(Calibrator *calibrator, int slot, double x, double y, double lever) {
    DeviceEvent event = {.kind = DEVICE_REPORT, .slot = slot, .state = pad_at_rest()};
    event.state.axes_unknown = ~((1u << AXES) - 1);
    event.state.axes[X] = x;
    event.state.axes[Y] = y;
    event.state.axes[LEVER] = lever;
    calibrator_take(calibrator, &event);
}

static void wait(Calibrator *calibrator, double seconds) {
    for (int i = 0; i < (int)(seconds / TICK_S + 0.5); i++)
        calibrator_advance(calibrator, TICK_S);
}

static void expect_axis(const CalibratorPad *pad, int axis, AxisCalibration expected) {
    const AxisCalibration *found = &pad->calibration.axes[axis];
    print_message("axis %d: %d %g %g %g, expected %d %g %g %g\n", axis, found->known, found->min, found->centre,
                  found->max, expected.known, expected.min, expected.centre, expected.max);
    assert_int_equal(found->known, expected.known);
    if (expected.known)
        assert_true(found->min == expected.min && found->centre == expected.centre && found->max == expected.max);
}

static void centres_are_where_it_lies_when_it_has_come_to_rest(void **state) {
    (void)state;
    static Calibrator calibrator;
    calibrator_init(&calibrator);
    plug(&calibrator, 2);
    tell(&calibrator, 2, 0.9, 0.0, -1.0); // a hand still moves it
    for (int i = 0; i < 10; i++) {
        wait(&calibrator, 0.9 * CALIBRATOR_STILL_S);
        tell(&calibrator, 2, 0.82 - 0.08 * i, 0.0, -1.0);
        assert_int_equal(calibrator.phase, CALIBRATOR_RESTING);
    }
    for (int i = 0; i < 200; i++) { // it trembles
        tell(&calibrator, 2, 0.06 + 0.01 * (i % 3), -0.03, -1.0);
        wait(&calibrator, TICK_S);
    }
    assert_int_equal(calibrator.phase, CALIBRATOR_MOVING);
    tell(&calibrator, 2, -0.75, 0.02, 1.0);
    tell(&calibrator, 2, 0.5, 0.02, 0.0);
    assert_int_equal(calibrator_learned(&calibrator.pads[2]), 2);
    calibrator_next(&calibrator);
    assert_int_equal(calibrator.phase, CALIBRATOR_DONE);
    expect_axis(&calibrator.pads[2], X,
                (AxisCalibration){true, calibrator.pads[2].calibration.axes[X].centre, -0.75, 0.5});
    assert_true(fabs(calibrator.pads[2].calibration.axes[X].centre - 0.07) < 0.011);
    expect_axis(&calibrator.pads[2], Y, (AxisCalibration){.known = false});
    expect_axis(&calibrator.pads[2], LEVER, (AxisCalibration){true, -1.0, -1.0, 1.0});
}

// Nothing is told before something moves: the first that is told is where it rested.
static void a_stick_that_says_nothing_at_rest_is_calibrated_too(void **state) {
    (void)state;
    static Calibrator calibrator;
    calibrator_init(&calibrator);
    plug(&calibrator, 0);
    wait(&calibrator, CALIBRATOR_STILL_S + TICK_S);
    assert_int_equal(calibrator.phase, CALIBRATOR_MOVING);
    tell(&calibrator, 0, 0.05, -0.1, 0.25);
    tell(&calibrator, 0, 1.0, -0.1, 0.25);
    tell(&calibrator, 0, -1.0, 0.8, 0.25);
    plug(&calibrator, 1); // comes late, and leaves
    tell(&calibrator, 1, 0.0, 0.0, 0.0);
    tell(&calibrator, 1, 1.0, 0.0, 0.0);
    assert_int_equal(calibrator_pads(&calibrator), 2);
    calibrator_take(&calibrator, &(DeviceEvent){.kind = DEVICE_LEFT, .slot = 1});
    tell(&calibrator, 1, -1.0, 0.0, 0.0);
    calibrator_next(&calibrator);
    assert_int_equal(calibrator_pads(&calibrator), 1);
    expect_axis(&calibrator.pads[0], X, (AxisCalibration){true, 0.05, -1.0, 1.0});
    expect_axis(&calibrator.pads[0], Y, (AxisCalibration){true, -0.1, -0.1, 0.8});
    expect_axis(&calibrator.pads[0], LEVER, (AxisCalibration){.known = false});
}

static void axes_that_were_not_moved_keep_what_was_kept(void **state) {
    (void)state;
    static Calibrator calibrator;
    calibrator_init(&calibrator);
    plug(&calibrator, 0);
    calibrator_next(&calibrator);
    tell(&calibrator, 0, 0.0, 0.0, 0.0);
    tell(&calibrator, 0, 0.5, 0.0, 0.0);
    calibrator_next(&calibrator);
    calibrator_next(&calibrator); // done is done
    PadCalibration kept = {.axes = {[X] = {true, 0.3, -0.3, 0.6}, [LEVER] = {true, 0.1, -0.9, 0.9}}};
    PadCalibration merged = calibrator_merge(&calibrator.pads[0], &kept);
    print_message("x to %g, expected 0.5; the lever from %g, expected -0.9\n", merged.axes[X].max,
                  merged.axes[LEVER].min);
    assert_true(merged.axes[X].max == 0.5 && merged.axes[X].centre == 0.0);
    assert_true(merged.axes[LEVER].known && merged.axes[LEVER].min == -0.9 && !merged.axes[Y].known);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(centres_are_where_it_lies_when_it_has_come_to_rest),
        cmocka_unit_test(a_stick_that_says_nothing_at_rest_is_calibrated_too),
        cmocka_unit_test(axes_that_were_not_moved_keep_what_was_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
