// From pads and keys to controls: who drives, how softly, and what is left when a pad is gone.
#define _GNU_SOURCE
#include "input/mapper.h"

#include <fenv.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#define STEP_S (1.0 / 120.0)

enum { X, Y, TWIST, LEVER, AXES };

typedef struct Desk {
    Mapper mapper;
    Keyboard keyboard;
    PadState pads[MAPPER_SLOTS];
    Controls controls; // of the last sample
} Desk;

static PadInfo stick(void) {
    return (PadInfo){.name = "stick",
                     .axis_count = AXES,
                     .button_count = 12,
                     .hat_count = 1,
                     .axes = {PAD_AXIS_X, PAD_AXIS_Y, PAD_AXIS_RZ, PAD_AXIS_SLIDER}};
}

static PadState told_state(void) {
    PadState state = pad_at_rest();
    state.axes_unknown = ~((1u << AXES) - 1);
    return state;
}

static void sample(Desk *desk) {
    desk->controls = mapper_sample(&desk->mapper, &desk->keyboard, STEP_S);
}

static void wait(Desk *desk, double s) {
    for (int i = 0; i < (int)(s / STEP_S + 0.5); i++)
        sample(desk);
}

static void report(Desk *desk, int slot) {
    mapper_report(&desk->mapper, slot, &desk->pads[slot], &desk->keyboard);
}

static void put(Desk *desk, int slot, int axis, double value) {
    desk->pads[slot].axes[axis] = value;
    report(desk, slot);
}

static void press(Desk *desk, int slot, int button, bool down) {
    uint64_t bit = (uint64_t)1 << ((button - 1) % 64);
    uint64_t *word = &desk->pads[slot].buttons[(button - 1) / 64];
    *word = down ? *word | bit : *word & ~bit;
    report(desk, slot);
}

static void plug(Desk *desk, int slot, const PadProfile *profile) {
    PadInfo info = stick();
    mapper_connect(&desk->mapper, slot, &info, profile, NULL);
    desk->pads[slot] = told_state();
    report(desk, slot);
}

// One stick in slot 0, everything centred, the lever in the middle.
static void begin(Desk *desk, double throttle) {
    memset(desk, 0, sizeof *desk);
    mapper_init(&desk->mapper);
    desk->keyboard = keyboard_create(throttle);
    plug(desk, 0, NULL);
    sample(desk);
}

static void expect_near(const char *what, double found, double expected, double tolerance) {
    if (!(fabs(found - expected) <= tolerance))
        fail_msg("%s: %.12g, expected %.12g within %g", what, found, expected, tolerance);
}

// What the default mapping makes of a stick at `value`.
static double stick_value(double value) {
    AxisMapping mapping = profile_axis(PAD_AXIS_X, 1, PAD_CONTROL_AILERON);
    return profile_axis_value(&mapping, value);
}

// Full at the lever's least.
static double lever_at(double throttle) {
    return (1.0 - 2.0 * throttle) * 0.99; // 0.01 are dead at the ends
}

// ---- Shapes of axes ----

static void a_dead_band_is_continuous_and_reaches_the_ends(void **state) {
    (void)state;
    AxisMapping mapping = profile_axis(PAD_AXIS_X, 1, PAD_CONTROL_AILERON);
    mapping.dead_band = 0.1;
    mapping.power = 1.7;
    double before = profile_axis_value(&mapping, -1.0);
    expect_near("at -1", before, -1.0, 0.0);
    for (int i = -1999; i <= 2000; i++) {
        double value = profile_axis_value(&mapping, i / 2000.0);
        double opposite = profile_axis_value(&mapping, -i / 2000.0);
        expect_near("odd", opposite, -value, 0.0);
        if (!(value >= before && value - before < 1.5e-3 * mapping.power))
            fail_msg("at %g: %g after %g", i / 2000.0, value, before);
        before = value;
    }
    expect_near("at 1", before, 1.0, 0.0);
    expect_near("in the band", profile_axis_value(&mapping, 0.0999), 0.0, 0.0);
}

static void a_lever_is_dead_at_its_ends(void **state) {
    (void)state;
    AxisMapping mapping = profile_axis(PAD_AXIS_SLIDER, 1, PAD_CONTROL_THROTTLE);
    mapping.dead_band = 0.1;
    expect_near("near the least", profile_axis_value(&mapping, -0.91), 0.0, 0.0);
    expect_near("in the middle", profile_axis_value(&mapping, 0.0), 0.5, 0.0);
    expect_near("near the most", profile_axis_value(&mapping, 0.91), 1.0, 0.0);
    mapping.invert = true;
    expect_near("inverted", profile_axis_value(&mapping, -0.91), 1.0, 0.0);
}

// As FlightGear's profiles write a throttle: offset -1, factor -0.5.
static void flightgears_offset_and_factor_mean_the_same(void **state) {
    (void)state;
    AxisMapping mapping = profile_axis(PAD_AXIS_SLIDER, 1, PAD_CONTROL_THROTTLE);
    mapping.dead_band = 0.0;
    mapping.offset = -1.0;
    mapping.factor = -0.5;
    expect_near("pushed away", profile_axis_value(&mapping, -1.0), 1.0, 0.0);
    expect_near("pulled", profile_axis_value(&mapping, 1.0), 0.0, 0.0);
    expect_near("a quarter", profile_axis_value(&mapping, 0.5), 0.25, 1e-15);
}

// ---- Default mapping ----

static void a_pad_without_a_profile_flies(void **state) {
    (void)state;
    Desk desk;
    begin(&desk, 0.5);
    put(&desk, 0, X, 0.8);
    put(&desk, 0, Y, 1.0);
    put(&desk, 0, TWIST, -0.6);
    put(&desk, 0, LEVER, 0.2);
    put(&desk, 0, LEVER, -1.0);
    desk.pads[0].hats[0] = 3;
    report(&desk, 0);
    sample(&desk);
    expect_near("aileron", desk.controls.aileron, stick_value(0.8), 1e-12);
    expect_near("elevator, stick back", desk.controls.elevator, 1.0, 0.0);
    expect_near("rudder", desk.controls.rudder, stick_value(-0.6), 1e-12);
    expect_near("throttle", desk.controls.throttle, 1.0, 0.0);
    double right, up;
    mapper_look(&desk.mapper, &right, &up);
    expect_near("look right", right, 1.0, 0.0);
    expect_near("look up", up, -1.0, 0.0);
    desk.pads[0].hats[0] = PAD_HAT_CENTRED;
    report(&desk, 0);
    mapper_look(&desk.mapper, &right, &up);
    expect_near("look right", right, 0.0, 0.0);
    expect_near("look up", up, 0.0, 0.0);
}

static void the_default_mapping_goes_by_kinds_of_axes(void **state) {
    (void)state;
    static const struct {
        PadAxisKind axes[8];
        int count;
        PadAxisKind of[4]; // aileron, elevator, rudder, throttle
    } cases[] = {
        {{PAD_AXIS_Y, PAD_AXIS_X, PAD_AXIS_Z}, 3, {PAD_AXIS_X, PAD_AXIS_Y, PAD_AXIS_Z, PAD_AXIS_KIND_COUNT}},
        {{PAD_AXIS_X, PAD_AXIS_Y, PAD_AXIS_Z, PAD_AXIS_RZ}, 4, {PAD_AXIS_X, PAD_AXIS_Y, PAD_AXIS_RZ, PAD_AXIS_Z}},
        {{PAD_AXIS_THROTTLE, PAD_AXIS_RUDDER, PAD_AXIS_SLIDER, PAD_AXIS_AILERON, PAD_AXIS_X, PAD_AXIS_ELEVATOR},
         6,
         {PAD_AXIS_AILERON, PAD_AXIS_ELEVATOR, PAD_AXIS_RUDDER, PAD_AXIS_THROTTLE}},
        {{PAD_AXIS_SLIDER, PAD_AXIS_DIAL, PAD_AXIS_WHEEL},
         3,
         {PAD_AXIS_KIND_COUNT, PAD_AXIS_KIND_COUNT, PAD_AXIS_KIND_COUNT, PAD_AXIS_SLIDER}},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        PadInfo info = {.axis_count = cases[i].count};
        memcpy(info.axes, cases[i].axes, sizeof cases[i].axes);
        PadProfile profile = profile_default(&info);
        for (int control = PAD_CONTROL_AILERON; control <= PAD_CONTROL_THROTTLE; control++) {
            PadAxisKind found = PAD_AXIS_KIND_COUNT;
            for (int k = 0; k < profile.axis_count; k++)
                if (profile.axes[k].control == (PadControl)control)
                    found = profile.axes[k].axis;
            if (found != cases[i].of[control])
                fail_msg("case %zu: %s is moved by kind %d, expected %d", i, pad_control_name((PadControl)control),
                         found, cases[i].of[control]);
        }
    }
}

// ---- Who drives ----

static void an_axis_is_unknown_until_it_moves(void **state) {
    (void)state;
    Desk desk;
    memset(&desk, 0, sizeof desk);
    mapper_init(&desk.mapper);
    desk.keyboard = keyboard_create(0.5);
    PadInfo info = stick();
    mapper_connect(&desk.mapper, 0, &info, NULL, NULL);
    desk.pads[0] = pad_at_rest();
    report(&desk, 0); // another report's fields
    desk.pads[0] = told_state();
    put(&desk, 0, X, 0.7); // where the first report finds it
    sample(&desk);
    expect_near("aileron before", desk.controls.aileron, 0.0, 0.0);
    put(&desk, 0, X, 0.7 + 0.9 * MAPPER_MOVED);
    sample(&desk);
    expect_near("aileron after noise", desk.controls.aileron, 0.0, 0.0);
    put(&desk, 0, X, 0.7 + 1.1 * MAPPER_MOVED);
    wait(&desk, MAPPER_FADE_S);
    expect_near("aileron", desk.controls.aileron, stick_value(0.7 + 1.1 * MAPPER_MOVED), 1e-12);
}

// It moves at once as its stick was moved; the rest of the way it goes evenly.
static void a_stick_that_lies_elsewhere_takes_over_without_a_jump(void **state) {
    (void)state;
    Desk desk;
    begin(&desk, 0.5);
    desk.pads[0].axes[X] = 0.8;
    mapper_disconnect(&desk.mapper, 0, &desk.keyboard);
    PadInfo info = stick();
    mapper_connect(&desk.mapper, 0, &info, NULL, NULL);
    report(&desk, 0);
    put(&desk, 0, X, 0.9);
    double moved = stick_value(0.9) - stick_value(0.8), last = 0.0;
    double each = stick_value(0.8) * STEP_S / MAPPER_FADE_S;
    for (int i = 1; i <= 30; i++) {
        sample(&desk);
        expect_near("aileron", desk.controls.aileron, moved + i * each, 1e-12);
        expect_near("step", desk.controls.aileron - last, each + (i == 1 ? moved : 0.0), 1e-12);
        last = desk.controls.aileron;
    }
    sample(&desk);
    expect_near("aileron", desk.controls.aileron, stick_value(0.9), 1e-12);
}

// From its corner, where a device says it is before it knows, to the middle: the aileron is there already.
static void a_stick_never_moves_a_control_away_from_itself(void **state) {
    (void)state;
    Desk desk;
    begin(&desk, 0.5);
    PadInfo info = stick();
    mapper_connect(&desk.mapper, 3, &info, NULL, NULL);
    desk.pads[3] = told_state();
    put(&desk, 3, X, -1.0);
    put(&desk, 3, X, 0.0);
    for (int i = 0; i < 40; i++) {
        sample(&desk);
        expect_near("aileron", desk.controls.aileron, 0.0, 0.0);
    }
    put(&desk, 3, X, 0.4);
    sample(&desk);
    expect_near("aileron", desk.controls.aileron, stick_value(0.4), 1e-12);
}

static void a_report_acts_in_the_next_sample(void **state) {
    (void)state;
    Desk desk;
    begin(&desk, 0.5);
    put(&desk, 0, X, 0.5);
    sample(&desk);
    expect_near("aileron", desk.controls.aileron, stick_value(0.5), 1e-12);
}

static void the_throttle_takes_over_softly(void **state) {
    (void)state;
    Desk desk;
    begin(&desk, 0.3);
    double last = 0.3;
    // From the middle up, away from the present throttle; then down across it.
    for (int i = 0; i <= 100; i++) {
        put(&desk, 0, LEVER, lever_at(0.5 + 0.005 * i));
        sample(&desk);
        expect_near("throttle, lever above", desk.controls.throttle, 0.3, 0.0);
    }
    for (int i = 100; i >= 0; i--) {
        put(&desk, 0, LEVER, lever_at(0.01 * i));
        sample(&desk);
        expect_near("step", desk.controls.throttle, last, MAPPER_PICK_UP + 1e-9);
        last = desk.controls.throttle;
    }
    expect_near("throttle", desk.controls.throttle, 0.0, 1e-12);
}

static void a_lever_within_two_hundredths_has_the_throttle(void **state) {
    (void)state;
    Desk desk;
    begin(&desk, 0.3);
    put(&desk, 0, LEVER, lever_at(0.33));
    sample(&desk);
    expect_near("throttle, lever 0.03 above", desk.controls.throttle, 0.3, 0.0);
    put(&desk, 0, LEVER, lever_at(0.315));
    sample(&desk);
    expect_near("throttle, lever 0.015 above", desk.controls.throttle, 0.315, 1e-12);
}

// Even where it is set to what it was before the lever came to it, unseen.
static void a_throttle_that_is_handed_over_waits_for_the_lever(void **state) {
    (void)state;
    Desk desk;
    begin(&desk, 0.3);
    put(&desk, 0, LEVER, lever_at(0.3));
    put(&desk, 0, LEVER, lever_at(0.8));
    desk.keyboard.controls.throttle = 0.3;
    mapper_keep(&desk.mapper, &desk.keyboard);
    sample(&desk);
    expect_near("throttle, handed over", desk.controls.throttle, 0.3, 0.0);
    put(&desk, 0, LEVER, lever_at(0.7));
    sample(&desk);
    expect_near("throttle, lever above", desk.controls.throttle, 0.3, 0.0);
    put(&desk, 0, LEVER, lever_at(0.2));
    sample(&desk);
    expect_near("throttle, lever crossed it", desk.controls.throttle, 0.2, 1e-12);
}

static void a_lever_that_jumps_across_the_throttle_has_it(void **state) {
    (void)state;
    Desk desk;
    begin(&desk, 0.3);
    put(&desk, 0, LEVER, lever_at(0.1));
    sample(&desk);
    expect_near("throttle", desk.controls.throttle, 0.1, 1e-12);
}

static void keys_that_bring_the_throttle_to_a_resting_lever_keep_it(void **state) {
    (void)state;
    Desk desk;
    begin(&desk, 0.3);
    put(&desk, 0, LEVER, lever_at(0.6));
    put(&desk, 0, LEVER, lever_at(0.7)); // moved, but not across 0.3
    keyboard_on_key(&desk.keyboard, KEY_PAGE_UP, true, false);
    double last = 0.3;
    for (int i = 0; i < 240; i++) {
        report(&desk, 0);
        sample(&desk);
        expect_near("step", desk.controls.throttle - last, STEP_S / KEYBOARD_THROTTLE_S, 1e-9);
        last = desk.controls.throttle;
        if (last > 0.95)
            break;
    }
}

static void an_unplugged_throttle_holds_and_a_plugged_one_waits(void **state) {
    (void)state;
    Desk desk;
    begin(&desk, 0.5);
    put(&desk, 0, LEVER, lever_at(0.4));
    put(&desk, 0, LEVER, lever_at(0.8));
    sample(&desk);
    expect_near("throttle", desk.controls.throttle, 0.8, 1e-12);
    mapper_disconnect(&desk.mapper, 0, &desk.keyboard);
    wait(&desk, 2.0);
    expect_near("throttle without its lever", desk.controls.throttle, 0.8, 1e-12);
    plug(&desk, 0, NULL);
    put(&desk, 0, LEVER, lever_at(0.2));
    put(&desk, 0, LEVER, lever_at(0.3));
    sample(&desk);
    expect_near("throttle, lever plugged in below", desk.controls.throttle, 0.8, 1e-12);
    put(&desk, 0, LEVER, lever_at(0.79));
    sample(&desk);
    expect_near("throttle, picked up", desk.controls.throttle, 0.79, 1e-12);
}

static void an_unplugged_stick_re_centres_in_half_a_second(void **state) {
    (void)state;
    Desk desk;
    begin(&desk, 0.5);
    put(&desk, 0, X, 0.8);
    put(&desk, 0, Y, -1.0);
    sample(&desk);
    double from = desk.controls.aileron;
    mapper_disconnect(&desk.mapper, 0, &desk.keyboard);
    for (int i = 1; i <= 60; i++) {
        sample(&desk);
        expect_near("aileron", desk.controls.aileron, from * (1.0 - i / 60.0), 1e-9);
        expect_near("elevator", desk.controls.elevator, -(1.0 - i / 60.0), 1e-9);
    }
    sample(&desk);
    expect_near("aileron", desk.controls.aileron, 0.0, 0.0);
    expect_near("elevator", desk.controls.elevator, 0.0, 0.0);
}

static void unplugging_with_buttons_down_releases_them(void **state) {
    (void)state;
    PadProfile profile = {
        .button_count = 2,
        .buttons = {{.number = 1, .does = BUTTON_ACTION, .action = ACTION_THROTTLE_UP},
                    {.number = 2, .does = BUTTON_HOLD, .control = PAD_CONTROL_BRAKES, .amount = 1.0}}};
    Desk desk;
    begin(&desk, 0.5);
    plug(&desk, 1, &profile);
    press(&desk, 1, 1, true);
    press(&desk, 1, 2, true);
    wait(&desk, 0.1);
    expect_near("throttle", desk.controls.throttle, 0.54, 1e-9);
    expect_near("left brake", desk.controls.brake_left, 1.0, 0.0);
    expect_near("right brake", desk.controls.brake_right, 1.0, 0.0);
    mapper_disconnect(&desk.mapper, 1, &desk.keyboard);
    mapper_disconnect(&desk.mapper, 1, &desk.keyboard); // it is gone already
    wait(&desk, MAPPER_CENTRE_S + STEP_S);
    expect_near("throttle", desk.controls.throttle, 0.54, 1e-9);
    expect_near("left brake", desk.controls.brake_left, 0.0, 0.0);
    assert_int_equal(desk.keyboard.held[ACTION_THROTTLE_UP], 0);
}

static void of_several_pads_the_last_moved_drives(void **state) {
    (void)state;
    Desk desk;
    begin(&desk, 0.5);
    plug(&desk, 3, NULL);
    put(&desk, 0, X, 0.5);
    sample(&desk);
    expect_near("first stick", desk.controls.aileron, stick_value(0.5), 1e-12);
    put(&desk, 3, X, -0.4);
    wait(&desk, MAPPER_FADE_S);
    expect_near("second stick", desk.controls.aileron, stick_value(-0.4), 1e-12);
    put(&desk, 0, X, 0.5 + 0.5 * MAPPER_MOVED); // noise of the first
    sample(&desk);
    expect_near("still the second", desk.controls.aileron, stick_value(-0.4), 1e-12);
    put(&desk, 0, X, 0.6);
    wait(&desk, MAPPER_FADE_S);
    expect_near("the first again", desk.controls.aileron, stick_value(0.6), 1e-12);
    mapper_disconnect(&desk.mapper, 3, &desk.keyboard);
    wait(&desk, 1.0);
    expect_near("the other unplugged", desk.controls.aileron, stick_value(0.6), 1e-12);
}

static void keys_and_sticks_hand_over_as_they_are_touched(void **state) {
    (void)state;
    Desk desk;
    begin(&desk, 0.5);
    put(&desk, 0, X, 0.5);
    sample(&desk);
    keyboard_on_key(&desk.keyboard, KEY_LEFT, true, false);
    wait(&desk, 1.0);
    expect_near("the key", desk.controls.aileron, -1.0, 0.0);
    put(&desk, 0, X, 0.3); // while the key is still down
    wait(&desk, MAPPER_FADE_S);
    expect_near("the stick", desk.controls.aileron, stick_value(0.3), 1e-12);
    wait(&desk, 0.5);
    expect_near("the stick stays", desk.controls.aileron, stick_value(0.3), 1e-12);
    put(&desk, 0, X, -0.3); // to the same side as the key
    wait(&desk, 0.5);
    expect_near("the stick stays", desk.controls.aileron, stick_value(-0.3), 1e-12);
    put(&desk, 0, X, 0.3);
    keyboard_on_key(&desk.keyboard, KEY_LEFT, false, false);
    wait(&desk, 0.5);
    expect_near("the key let go", desk.controls.aileron, stick_value(0.3), 1e-12);
    expect_near("elevator, never touched", desk.controls.elevator, 0.0, 0.0);
    keyboard_on_key(&desk.keyboard, KEY_UP, true, false);
    wait(&desk, 0.2);
    expect_near("aileron", desk.controls.aileron, stick_value(0.3), 1e-12);
    expect_near("elevator by key", desk.controls.elevator, -0.2 / KEYBOARD_STICK_S, 1e-9);
}

static void keys_go_on_from_where_the_lever_left_the_throttle(void **state) {
    (void)state;
    Desk desk;
    begin(&desk, 0.2);
    put(&desk, 0, LEVER, lever_at(0.1));
    put(&desk, 0, LEVER, lever_at(0.7));
    sample(&desk);
    expect_near("lever", desk.controls.throttle, 0.7, 1e-12);
    keyboard_on_key(&desk.keyboard, KEY_PAGE_DOWN, true, false);
    sample(&desk);
    expect_near("key", desk.controls.throttle, 0.7 - STEP_S / KEYBOARD_THROTTLE_S, 1e-12);
}

// ---- Buttons ----

static void a_button_acts_once_a_press(void **state) {
    (void)state;
    PadProfile profile = {.button_count = 1,
                          .buttons = {{.number = 65, .does = BUTTON_ACTION, .action = ACTION_PAUSE}}};
    Desk desk;
    begin(&desk, 0.5);
    plug(&desk, 1, &profile);
    press(&desk, 1, 65, true);
    for (int i = 0; i < 10; i++) {
        report(&desk, 1);
        sample(&desk);
    }
    press(&desk, 1, 65, false);
    press(&desk, 1, 65, true); // and let go and pressed between two samples
    press(&desk, 1, 65, false);
    sample(&desk);
    assert_int_equal(keyboard_next_action(&desk.keyboard), ACTION_PAUSE);
    assert_int_equal(keyboard_next_action(&desk.keyboard), ACTION_PAUSE);
    assert_int_equal(keyboard_next_action(&desk.keyboard), ACTION_NONE);
}

static void a_switch_that_is_on_when_plugged_in_does_nothing(void **state) {
    (void)state;
    PadProfile profile = {.button_count = 1,
                          .buttons = {{.number = 1, .does = BUTTON_ACTION, .action = ACTION_RUDDER_LEFT}}};
    Desk desk;
    begin(&desk, 0.5);
    PadInfo info = stick();
    mapper_connect(&desk.mapper, 1, &info, &profile, NULL);
    desk.pads[1] = told_state();
    press(&desk, 1, 1, true);
    wait(&desk, 0.2);
    expect_near("rudder", desk.controls.rudder, 0.0, 0.0);
    press(&desk, 1, 1, false);
    assert_int_equal(desk.keyboard.held[ACTION_RUDDER_LEFT], 0);
    press(&desk, 1, 1, true);
    wait(&desk, 0.25);
    expect_near("rudder", desk.controls.rudder, -0.25 / KEYBOARD_RUDDER_S, 1e-9);
}

static void steps_move_a_control_and_keep_it_in_range(void **state) {
    (void)state;
    PadProfile profile = {.button_count = 2,
                          .buttons = {{.number = 1, .does = BUTTON_STEP, .control = PAD_CONTROL_FLAPS, .amount = 0.4},
                                      {.number = 2, .does = BUTTON_STEP, .control = PAD_CONTROL_TRIM, .amount = -0.1}}};
    Desk desk;
    begin(&desk, 0.5);
    plug(&desk, 1, &profile);
    for (int i = 1; i <= 3; i++) {
        press(&desk, 1, 1, true);
        press(&desk, 1, 1, false);
        sample(&desk);
        expect_near("flaps", desk.controls.flaps, fmin(0.4 * i, 1.0), 1e-12);
    }
    press(&desk, 1, 2, true);
    wait(&desk, 0.5);
    expect_near("trim", desk.controls.trim, -0.1, 1e-12);
    mapper_disconnect(&desk.mapper, 1, &desk.keyboard);
    wait(&desk, 1.0);
    expect_near("flaps without their pad", desk.controls.flaps, 1.0, 0.0);
}

// ---- Calibration ----

static void a_calibrated_axis_is_centred_and_reaches_its_ends(void **state) {
    (void)state;
    PadState pad = told_state();
    pad.axes[X] = 0.1;
    PadCalibration calibration = calibration_begin(&pad);
    for (int i = -100; i <= 100; i++) {
        pad.axes[X] = 0.1 + 0.006 * i + (i > 0 ? 0.001 * i : 0.0);
        pad.axes[Y] = 0.0005 * i; // hardly moved
        calibration_learn(&calibration, &pad);
    }
    pad.axes[X] = NAN;
    calibration_learn(&calibration, &pad);
    calibration_finish(&calibration);
    assert_true(calibration.axes[X].known);
    assert_false(calibration.axes[Y].known);
    expect_near("at rest", calibration_apply(&calibration.axes[X], 0.1, true), 0.0, 0.0);
    expect_near("least", calibration_apply(&calibration.axes[X], -0.5, true), -1.0, 0.0);
    expect_near("most", calibration_apply(&calibration.axes[X], 0.8, true), 1.0, 0.0);
    expect_near("half left", calibration_apply(&calibration.axes[X], -0.2, true), -0.5, 1e-12);
    expect_near("beyond", calibration_apply(&calibration.axes[X], 1.0, true), 1.0, 0.0);
    expect_near("a lever's middle", calibration_apply(&calibration.axes[X], 0.15, false), 0.0, 1e-12);
    expect_near("unknown", calibration_apply(&calibration.axes[Y], 0.3, true), 0.3, 0.0);
    Desk desk;
    begin(&desk, 0.5);
    PadInfo info = stick();
    mapper_connect(&desk.mapper, 0, &info, NULL, &calibration);
    desk.pads[0] = told_state();
    report(&desk, 0);
    put(&desk, 0, X, -0.5);
    wait(&desk, MAPPER_FADE_S); // it did not lie where it rests
    expect_near("aileron", desk.controls.aileron, -1.0, 1e-12);
}

// ---- Extremes ----

static void values_that_are_no_numbers_change_nothing(void **state) {
    (void)state;
    static const double wild[] = {NAN, INFINITY, -INFINITY};
    Desk desk;
    begin(&desk, 0.5);
    put(&desk, 0, X, 0.5);
    sample(&desk);
    for (size_t i = 0; i < COUNT_OF(wild); i++) {
        put(&desk, 0, X, wild[i]);
        put(&desk, 0, LEVER, wild[i]);
        sample(&desk);
        expect_near("aileron", desk.controls.aileron, stick_value(0.5), 1e-12);
        expect_near("throttle", desk.controls.throttle, 0.5, 0.0);
    }
    put(&desk, 0, X, 1e300);
    sample(&desk);
    expect_near("aileron", desk.controls.aileron, 1.0, 0.0);
}

static void reports_of_an_empty_slot_are_ignored(void **state) {
    (void)state;
    Desk desk;
    begin(&desk, 0.5);
    desk.pads[5] = told_state();
    put(&desk, 5, X, 0.5);
    put(&desk, 5, X, 0.9);
    sample(&desk);
    expect_near("aileron", desk.controls.aileron, 0.0, 0.0);
}

// Anything that pads and keys may do, made up from a seed: everything stays finite and in range, and the same seed
// gives the same controls.
static double fly_at_random(uint64_t seed) {
    Desk desk;
    begin(&desk, 0.5);
    double sum = 0.0;
    for (int i = 0; i < 20000; i++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        int slot = (int)(seed >> 60 & 3), what = (int)(seed >> 40 & 15);
        double value = (double)(int64_t)(seed << 1) / 9.3e18 * 1.2;
        if (what == 0)
            mapper_disconnect(&desk.mapper, slot, &desk.keyboard);
        else if (what == 1)
            plug(&desk, slot, NULL);
        else if (what < 10)
            put(&desk, slot, what % AXES, value);
        else if (what < 12)
            press(&desk, slot, 1 + (int)(seed >> 50 & 7), value > 0.0);
        else if (what < 14)
            keyboard_on_key(&desk.keyboard, KEY_RIGHT + (int)(seed >> 50 & 7), value > 0.0, false);
        sample(&desk);
        const Controls *c = &desk.controls;
        bool within = fabs(c->aileron) <= 1.0 && fabs(c->elevator) <= 1.0 && fabs(c->rudder) <= 1.0 &&
                      c->throttle >= 0.0 && c->throttle <= 1.0 && fabs(c->trim) <= 1.0;
        if (!within)
            fail_msg("step %d: %g %g %g %g", i, c->aileron, c->elevator, c->rudder, c->throttle);
        sum += c->aileron + 2.0 * c->elevator + 3.0 * c->rudder + 4.0 * c->throttle;
    }
    return sum;
}

static void whatever_is_done_stays_in_range_and_repeats(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 10; seed++) {
        double first = fly_at_random(seed), second = fly_at_random(seed);
        if (first != second)
            fail_msg("seed %llu: %.17g, then %.17g", (unsigned long long)seed, first, second);
    }
}

int main(void) {
    feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_dead_band_is_continuous_and_reaches_the_ends),
        cmocka_unit_test(a_lever_is_dead_at_its_ends),
        cmocka_unit_test(flightgears_offset_and_factor_mean_the_same),
        cmocka_unit_test(a_pad_without_a_profile_flies),
        cmocka_unit_test(the_default_mapping_goes_by_kinds_of_axes),
        cmocka_unit_test(an_axis_is_unknown_until_it_moves),
        cmocka_unit_test(a_stick_that_lies_elsewhere_takes_over_without_a_jump),
        cmocka_unit_test(a_stick_never_moves_a_control_away_from_itself),
        cmocka_unit_test(a_report_acts_in_the_next_sample),
        cmocka_unit_test(the_throttle_takes_over_softly),
        cmocka_unit_test(a_lever_within_two_hundredths_has_the_throttle),
        cmocka_unit_test(a_throttle_that_is_handed_over_waits_for_the_lever),
        cmocka_unit_test(a_lever_that_jumps_across_the_throttle_has_it),
        cmocka_unit_test(keys_that_bring_the_throttle_to_a_resting_lever_keep_it),
        cmocka_unit_test(an_unplugged_throttle_holds_and_a_plugged_one_waits),
        cmocka_unit_test(an_unplugged_stick_re_centres_in_half_a_second),
        cmocka_unit_test(unplugging_with_buttons_down_releases_them),
        cmocka_unit_test(of_several_pads_the_last_moved_drives),
        cmocka_unit_test(keys_and_sticks_hand_over_as_they_are_touched),
        cmocka_unit_test(keys_go_on_from_where_the_lever_left_the_throttle),
        cmocka_unit_test(a_button_acts_once_a_press),
        cmocka_unit_test(a_switch_that_is_on_when_plugged_in_does_nothing),
        cmocka_unit_test(steps_move_a_control_and_keep_it_in_range),
        cmocka_unit_test(a_calibrated_axis_is_centred_and_reaches_its_ends),
        cmocka_unit_test(values_that_are_no_numbers_change_nothing),
        cmocka_unit_test(reports_of_an_empty_slot_are_ignored),
        cmocka_unit_test(whatever_is_done_stays_in_range_and_repeats),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
