// What a wired Xbox 360 pad says, bit by bit, and what its motors are told.
#include "input/devices/xbox_report.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SEED 20260707u

// As a pad sends it that nobody touches.
static void rest(uint8_t out[XBOX_REPORT_BYTES]) {
    memset(out, 0, XBOX_REPORT_BYTES);
    out[1] = XBOX_REPORT_BYTES;
}

static PadState decode(const uint8_t report[XBOX_REPORT_BYTES]) {
    PadState state = pad_at_rest();
    assert_int_equal(xbox_report_decode(report, XBOX_REPORT_BYTES, &state), XBOX_INPUT);
    return state;
}

static void test_a_pad_at_rest_is_centred_and_its_triggers_are_let_go(void **state) {
    (void)state;
    uint8_t report[XBOX_REPORT_BYTES];
    rest(report);
    PadState pad = decode(report);
    for (int i = 0; i < 4; i++)
        assert_true(fabs(pad.axes[i]) < 2e-5); // half a step of 65535
    assert_true(pad.axes[XBOX_LEFT_TRIGGER] == -1.0 && pad.axes[XBOX_RIGHT_TRIGGER] == -1.0);
    assert_int_equal(pad.hats[0], PAD_HAT_CENTRED);
    assert_true(pad.buttons[0] == 0 && pad.buttons[1] == 0);
    assert_true((pad.axes_unknown & 0x3fu) == 0);
}

static void test_axes_reach_their_ends_with_the_signs_of_a_hid_gamepad(void **state) {
    (void)state;
    static const struct {
        int byte, axis;
        double low, high; // of -32768 and 32767
    } CASES[] = {{6, XBOX_LEFT_X, -1.0, 1.0},
                 {8, XBOX_LEFT_Y, 1.0, -1.0},
                 {10, XBOX_RIGHT_X, -1.0, 1.0},
                 {12, XBOX_RIGHT_Y, 1.0, -1.0}};
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        uint8_t report[XBOX_REPORT_BYTES];
        rest(report);
        report[CASES[i].byte + 1] = 0x80;
        double low = decode(report).axes[CASES[i].axis];
        report[CASES[i].byte] = 0xff;
        report[CASES[i].byte + 1] = 0x7f;
        double high = decode(report).axes[CASES[i].axis];
        print_message("axis %d: %.9f .. %.9f, expected %g .. %g\n", CASES[i].axis, low, high, CASES[i].low,
                      CASES[i].high);
        assert_true(fabs(low - CASES[i].low) < 1e-12 && fabs(high - CASES[i].high) < 1e-12);
    }
    uint8_t report[XBOX_REPORT_BYTES];
    rest(report);
    report[4] = report[5] = 0xff;
    PadState pad = decode(report);
    assert_true(fabs(pad.axes[XBOX_LEFT_TRIGGER] - 1.0) < 1e-12 && fabs(pad.axes[XBOX_RIGHT_TRIGGER] - 1.0) < 1e-12);
}

static void test_raw_values_are_those_of_the_report(void **state) {
    (void)state;
    uint8_t report[XBOX_REPORT_BYTES];
    PadInfo info = {.bus = PAD_BUS_USB};
    xbox_describe(&info);
    rest(report);
    report[4] = 200;
    report[8] = 0x18; // -1000
    report[9] = 0xfc;
    PadState pad = decode(report);
    assert_int_equal(pad_raw(&info, &pad, XBOX_LEFT_Y), -1000);
    assert_int_equal(pad_raw(&info, &pad, XBOX_LEFT_X), 0);
    assert_int_equal(pad_raw(&info, &pad, XBOX_LEFT_TRIGGER), 200);
    assert_int_equal(info.ranges[XBOX_LEFT_Y].least, -32768);
    assert_int_equal(info.ranges[XBOX_LEFT_Y].most, 32767);
    assert_int_equal(info.ranges[XBOX_RIGHT_TRIGGER].least, 0);
    assert_int_equal(info.ranges[XBOX_RIGHT_TRIGGER].most, 255);
}

static void test_each_button_has_a_bit_of_its_own(void **state) {
    (void)state;
    static const struct {
        int byte, bit, button; // -1: none
    } CASES[] = {{2, 4, XBOX_START}, {2, 5, XBOX_BACK}, {2, 6, XBOX_LEFT_STICK}, {2, 7, XBOX_RIGHT_STICK},
                 {3, 0, XBOX_LB},    {3, 1, XBOX_RB},   {3, 2, XBOX_GUIDE},      {3, 3, -1},
                 {3, 4, XBOX_A},     {3, 5, XBOX_B},    {3, 6, XBOX_X},          {3, 7, XBOX_Y}};
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        uint8_t report[XBOX_REPORT_BYTES];
        rest(report);
        report[CASES[i].byte] = (uint8_t)(1u << CASES[i].bit);
        PadState pad = decode(report);
        uint64_t expected = CASES[i].button < 0 ? 0 : UINT64_C(1) << CASES[i].button;
        print_message("byte %d bit %d: buttons %llx, expected %llx\n", CASES[i].byte, CASES[i].bit,
                      (unsigned long long)pad.buttons[0], (unsigned long long)expected);
        assert_true(pad.buttons[0] == expected && pad.hats[0] == PAD_HAT_CENTRED);
    }
}

static void test_the_cross_is_a_hat(void **state) {
    (void)state;
    enum { UP = 1, DOWN = 2, LEFT = 4, RIGHT = 8 };
    static const struct {
        int cross, eighth;
    } CASES[] = {{UP, 0},
                 {UP | RIGHT, 1},
                 {RIGHT, 2},
                 {DOWN | RIGHT, 3},
                 {DOWN, 4},
                 {DOWN | LEFT, 5},
                 {LEFT, 6},
                 {UP | LEFT, 7},
                 {0, PAD_HAT_CENTRED},
                 {UP | DOWN, PAD_HAT_CENTRED},
                 {LEFT | RIGHT | UP, 0},
                 {15, PAD_HAT_CENTRED}};
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        uint8_t report[XBOX_REPORT_BYTES];
        rest(report);
        report[2] = (uint8_t)CASES[i].cross;
        PadState pad = decode(report);
        print_message("cross %x: %d, expected %d\n", CASES[i].cross, pad.hats[0], CASES[i].eighth);
        assert_true(pad.hats[0] == CASES[i].eighth && pad.buttons[0] == 0);
    }
}

static void test_what_is_no_input_changes_nothing(void **state) {
    (void)state;
    uint8_t bytes[64];
    PadState untouched = pad_at_rest(), pad = untouched;
    srand(SEED);
    print_message("seed %u\n", SEED);
    for (int round = 0; round < 100000; round++) {
        size_t count = (size_t)(rand() % (int)(sizeof bytes + 1));
        for (size_t i = 0; i < count; i++)
            bytes[i] = (uint8_t)rand();
        if (count > 0 && rand() % 2)
            bytes[0] = 0;
        if (count == XBOX_REPORT_BYTES && bytes[0] == 0)
            bytes[1] = (uint8_t)(bytes[1] == XBOX_REPORT_BYTES ? 3 : bytes[1]);
        XboxMessage found = xbox_report_decode(bytes, count, &pad);
        XboxMessage expected = count > 0 && bytes[0] != 0 ? XBOX_OTHER : XBOX_DAMAGED;
        if (found != expected || memcmp(&pad, &untouched, sizeof pad) != 0)
            fail_msg("%zu bytes, first %d: found %d, expected %d", count, count ? bytes[0] : -1, found, expected);
    }
}

static void test_motors_are_told_their_strength_within_bounds(void **state) {
    (void)state;
    static const struct {
        double low, high;
        uint8_t bytes[XBOX_RUMBLE_BYTES];
    } CASES[] = {{0.0, 0.0, {0, 8, 0, 0, 0, 0, 0, 0}},
                 {1.0, 0.5, {0, 8, 0, 255, 128, 0, 0, 0}},
                 {-3.0, 7.0, {0, 8, 0, 0, 255, 0, 0, 0}},
                 {NAN, INFINITY, {0, 8, 0, 0, 255, 0, 0, 0}}};
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        uint8_t bytes[XBOX_RUMBLE_BYTES];
        xbox_rumble_encode(CASES[i].low, CASES[i].high, bytes);
        assert_memory_equal(bytes, CASES[i].bytes, sizeof bytes);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_pad_at_rest_is_centred_and_its_triggers_are_let_go),
        cmocka_unit_test(test_axes_reach_their_ends_with_the_signs_of_a_hid_gamepad),
        cmocka_unit_test(test_raw_values_are_those_of_the_report),
        cmocka_unit_test(test_each_button_has_a_bit_of_its_own),
        cmocka_unit_test(test_the_cross_is_a_hat),
        cmocka_unit_test(test_what_is_no_input_changes_nothing),
        cmocka_unit_test(test_motors_are_told_their_strength_within_bounds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
