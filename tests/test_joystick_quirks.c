// Hard case 21: what odd devices say, and when they leave, makes no control of the flight jump: in no step more than
// the stick's own way, and what a return to rest takes.
#include "tests/cockpit_support.h"
#include "tests/flight_support.h"

#include <string.h>

// Written for this test. Report 1: X and Y of 16 bits, -32767..32767; a hat with a null state; 8 buttons. Report 2: a
// slider of 8 bits.
static const uint8_t descriptor[] = {0x05, 0x01, 0x09, 0x04, 0xa1, 0x01, 0x85, 0x01, 0x09, 0x30, 0x09, 0x31, 0x16, 0x01,
                                     0x80, 0x26, 0xff, 0x7f, 0x75, 0x10, 0x95, 0x02, 0x81, 0x02, 0x09, 0x39, 0x15, 0x00,
                                     0x25, 0x07, 0x35, 0x00, 0x46, 0x3b, 0x01, 0x75, 0x04, 0x95, 0x01, 0x81, 0x42, 0x75,
                                     0x04, 0x95, 0x01, 0x81, 0x03, 0x05, 0x09, 0x19, 0x01, 0x29, 0x08, 0x15, 0x00, 0x25,
                                     0x01, 0x75, 0x01, 0x95, 0x08, 0x81, 0x02, 0x85, 0x02, 0x05, 0x01, 0x09, 0x36, 0x15,
                                     0x00, 0x26, 0xff, 0x00, 0x75, 0x08, 0x95, 0x01, 0x81, 0x02, 0xc0};
static const FakeStickModel ODD_STICK = {0x1234, 0xabcd, "Odd Stick", descriptor, sizeof descriptor};

#define MAIN_BYTES 7
#define LEVER_BYTES 2
#define DEAD_BAND 0.03 // of the default mapping
#define SLOPE (1.0 / (1.0 - DEAD_BAND))

typedef struct Odd {
    Cockpit *cockpit;
    FakeStick *stick;
    int from; // the first step that is looked at
    double before[4];
} Odd;

static void put_16(double share, uint8_t out[2]) {
    uint16_t value = (uint16_t)(int16_t)lround(share * 32767.0);
    out[0] = (uint8_t)(value & 0xff);
    out[1] = (uint8_t)(value >> 8);
}

static void main_report(double x, double y, uint8_t hat, uint8_t out[MAIN_BYTES]) {
    out[0] = 1;
    put_16(x, out + 1);
    put_16(y, out + 3);
    out[5] = hat;
    out[6] = 0;
}

// What is told is waited for.
static void tell(Odd *odd, const uint8_t *bytes, size_t count) {
    int reports = odd->cockpit->heard[DEVICE_REPORT];
    fake_stick_send(odd->stick, bytes, count);
    cockpit_wait(odd->cockpit, DEVICE_REPORT, reports + 1);
}

static void move(Odd *odd, double x, double y, uint8_t hat) {
    uint8_t report[MAIN_BYTES];
    main_report(x, y, hat, report);
    tell(odd, report, sizeof report);
}

static void babble(Odd *odd, const uint8_t *bytes, size_t count) {
    cockpit_send_whole(odd->stick, bytes, count);
    pilot_poll(odd->cockpit->session->pilot);
}

static void plug(Odd *odd, int number, double x, double y) {
    int arrived = odd->cockpit->heard[DEVICE_ARRIVED];
    odd->stick = fake_stick_plug(odd->cockpit->bed, &ODD_STICK, number);
    cockpit_wait(odd->cockpit, DEVICE_ARRIVED, arrived + 1);
    move(odd, x, y, 0x0f);
    tell(odd, (const uint8_t[]){2, 200}, LEVER_BYTES);
}

static void controls_of(const CockpitStep *step, double out[4]) {
    out[0] = step->controls.aileron;
    out[1] = step->controls.elevator;
    out[2] = step->controls.rudder;
    out[3] = step->controls.throttle;
}

static void mark(Odd *odd) {
    odd->from = odd->cockpit->step_count;
    controls_of(cockpit_last(odd->cockpit), odd->before);
}

// Flies on; no control has changed by more than that in a step since the mark. Its largest change.
static double expect_steps_within(Odd *odd, const char *what, int steps, double most) {
    double largest = 0.0, last[4], now[4];
    cockpit_fly(odd->cockpit, steps);
    memcpy(last, odd->before, sizeof last);
    for (int i = odd->from; i < odd->cockpit->step_count; i++) {
        controls_of(&odd->cockpit->steps[i], now);
        for (int k = 0; k < 4; k++)
            largest = fmax(largest, fabs(now[k] - last[k]));
        memcpy(last, now, sizeof last);
    }
    if (*what)
        print_message("%-44s largest change of a control in a step %.6f, at most %.6f\n", what, largest, most);
    assert_true(largest <= most + 1e-9);
    mark(odd);
    return largest;
}

static int set_up(void **state) {
    static Odd odd;
    odd = (Odd){.cockpit = cockpit_create("c172", false)};
    *state = &odd;
    plug(&odd, 0, 0.0, 0.0);
    cockpit_fly(odd.cockpit, 2);
    return 0;
}

static int tear_down(void **state) {
    Odd *odd = *state;
    cockpit_destroy(&odd->cockpit);
    return 0;
}

// To the right and a bit back, as a hand moves.
static void hold_right(Odd *odd) {
    mark(odd);
    for (int i = 1; i <= 10; i++) {
        move(odd, 0.05 * i, 0.02 * i, 0x0f);
        expect_steps_within(odd, i == 10 ? "a hand to the right, 0.05 a report" : "", 2, 0.05 * SLOPE + 1e-4);
    }
}

static void test_reports_of_odd_sizes_and_ids_hold_everything(void **state) {
    Odd *odd = *state;
    uint8_t report[64];
    hold_right(odd);
    double held = cockpit_last(odd->cockpit)->controls.aileron;
    int reports = odd->cockpit->heard[DEVICE_REPORT];
    for (size_t count = 1; count < MAIN_BYTES; count++) {
        memset(report, 0xff, sizeof report);
        report[0] = 1;
        babble(odd, report, count);
        expect_steps_within(odd, "a report cut off", 4, 0.0);
    }
    static const uint8_t ids[] = {0, 3, 255};
    for (size_t i = 0; i < COUNT_OF(ids); i++) {
        memset(report, 0x80, sizeof report);
        report[0] = ids[i];
        babble(odd, report, MAIN_BYTES);
        expect_steps_within(odd, "an id that is not declared", 4, 0.0);
    }
    babble(odd, (const uint8_t[]){2}, 1);
    expect_steps_within(odd, "only an id", 4, 0.0);
    memset(report, 0xff, sizeof report);
    babble(odd, report, sizeof report);
    expect_steps_within(odd, "64 bytes of ones", 4, 0.0);
    assert_int_equal(odd->cockpit->heard[DEVICE_REPORT], reports);
    tell(odd, (const uint8_t[]){2, 190}, LEVER_BYTES);
    expect_steps_within(odd, "the other report, of the lever alone", 4, 0.0);
    assert_true(held > 0.4 && cockpit_last(odd->cockpit)->controls.aileron == held);
}

static void test_a_hat_beyond_its_range_is_centred(void **state) {
    Odd *odd = *state;
    hold_right(odd);
    move(odd, 0.5, 0.2, 2);
    cockpit_fly(odd->cockpit, 1);
    double right = odd->cockpit->session->rig.look_right;
    for (int hat = 8; hat < 16; hat++) {
        move(odd, 0.5, 0.2, (uint8_t)hat);
        expect_steps_within(odd, "a null hat", 2, 0.0);
        const CameraRig *rig = &odd->cockpit->session->rig;
        assert_true(rig->look_right == 0.0 && rig->look_up == 0.0);
    }
    assert_true(right == 1.0);
}

static void test_extreme_values_go_to_the_ends_and_no_farther(void **state) {
    Odd *odd = *state;
    static const uint8_t wild[][MAIN_BYTES] = {{1, 0x00, 0x80, 0x00, 0x80, 0x0f, 0}, // -32768, below the least
                                               {1, 0xff, 0x7f, 0xff, 0x7f, 0x0f, 0},
                                               {1, 0x00, 0x80, 0xff, 0x7f, 0xff, 0xff},
                                               {1, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff}};
    static const double way[] = {1.5, 2.0, 2.0, 1.0 + 1e-4}; // the longer of X and Y
    hold_right(odd);
    for (size_t i = 0; i < COUNT_OF(wild); i++) {
        tell(odd, wild[i], MAIN_BYTES);
        double most = expect_steps_within(odd, "from end to end", 4, fmin(way[i] * SLOPE, 2.0));
        const Controls *now = &cockpit_last(odd->cockpit)->controls;
        print_message("aileron %+.4f, elevator %+.4f\n", now->aileron, now->elevator);
        assert_true(fabs(now->aileron) <= 1.0 && fabs(now->elevator) <= 1.0 && most > 0.5);
    }
    for (int i = 0; i < 100; i++) { // from end to end in each step
        tell(odd, wild[i % 2], MAIN_BYTES);
        cockpit_fly(odd->cockpit, 1);
    }
    expect_steps_within(odd, "from end to end, 100 times", 1, 2.0);
}

static void test_a_stick_pulled_out_in_mid_report_re_centres_evenly(void **state) {
    Odd *odd = *state;
    hold_right(odd);
    double aileron = cockpit_last(odd->cockpit)->controls.aileron;
    double throttle = cockpit_last(odd->cockpit)->controls.throttle;
    fake_stick_send(odd->stick, (const uint8_t[]){1, 0xff, 0x7f}, 3);
    fake_stick_unplug(odd->stick);
    cockpit_wait(odd->cockpit, DEVICE_LEFT, 1);
    double each = aileron * FLIGHT_STEP_S / MAPPER_CENTRE_S;
    double most = expect_steps_within(odd, "unplugged in mid-report", 70, each);
    const Controls *now = &cockpit_last(odd->cockpit)->controls;
    assert_true(most > 0.999 * each && now->aileron == 0.0 && now->elevator == 0.0 && now->throttle == throttle);
}

static void test_a_stick_plugged_in_bent_takes_over_without_a_jump(void **state) {
    Odd *odd = *state;
    hold_right(odd);
    fake_stick_unplug(odd->stick);
    cockpit_wait(odd->cockpit, DEVICE_LEFT, 1);
    cockpit_fly(odd->cockpit, 30); // and in again while it re-centres
    mark(odd);
    plug(odd, 1, 0.9, -0.5);
    double rest = 0.5 * SLOPE * FLIGHT_STEP_S / MAPPER_CENTRE_S;
    expect_steps_within(odd, "plugged in bent, not touched", 40, rest);
    assert_true(cockpit_last(odd->cockpit)->controls.aileron == 0.0);
    move(odd, 0.96, -0.56, 0x0f);
    double fade = SLOPE * 0.9 * FLIGHT_STEP_S / MAPPER_FADE_S;
    double most = expect_steps_within(odd, "and moved by 0.06", 40, 0.06 * SLOPE + fade);
    double found = cockpit_last(odd->cockpit)->controls.aileron, expected = (0.96 - DEAD_BAND) * SLOPE;
    print_message("aileron %.4f, expected %.4f\n", found, expected);
    assert_true(most > 0.05 && fabs(found - expected) < 1e-4);
}

// As some devices begin: all zeros, which is a stick in its corner, and then the truth.
static void test_a_first_report_that_is_a_lie_moves_nothing(void **state) {
    Odd *odd = *state;
    mark(odd);
    fake_stick_unplug(odd->stick);
    cockpit_wait(odd->cockpit, DEVICE_LEFT, 1);
    plug(odd, 1, -1.0, -1.0);
    expect_steps_within(odd, "a first report in the corner", 2, 0.0);
    move(odd, 0.01, -0.02, 0x0f); // within the dead band
    expect_steps_within(odd, "and then the truth", 40, 0.0);
    move(odd, 0.2, -0.02, 0x0f);
    expect_steps_within(odd, "and a hand", 40, (0.2 - DEAD_BAND) * SLOPE + 1e-4);
    assert_true(cockpit_last(odd->cockpit)->controls.aileron > 0.17);
}

#define QUIRK_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void) {
    const struct CMUnitTest tests[] = {
        QUIRK_TEST(test_reports_of_odd_sizes_and_ids_hold_everything),
        QUIRK_TEST(test_a_hat_beyond_its_range_is_centred),
        QUIRK_TEST(test_extreme_values_go_to_the_ends_and_no_farther),
        QUIRK_TEST(test_a_stick_pulled_out_in_mid_report_re_centres_evenly),
        QUIRK_TEST(test_a_stick_plugged_in_bent_takes_over_without_a_jump),
        QUIRK_TEST(test_a_first_report_that_is_a_lie_moves_nothing),
    };
    if (!fake_bed_works())
        return 77;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
