// From a stick's bytes to a rolling aircraft, and from its stall to a pad's motors: all between is the program's own.
#define _GNU_SOURCE // RUSAGE_THREAD
#include "tests/cockpit_support.h"
#include "tests/device_timing.h"
#include "tests/flight_support.h"

#include "app/aircraft/airframe.h"
#include "app/aircraft/isa.h"
#include "app/joystick/joystick_files.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#define FLY(state) (*(Cockpit **)(state))
#define DEG (180.0 / GEODESY_PI)
#define FULL 1.0
#define IDLE 1.0          // of the slider, which is full at its least
#define SIXTEEN_BITS 1e-4 // a pad's full left is -32767 of 32768

static int set_up(void **state) {
    *state = cockpit_create("c172", false);
    return 0;
}

static int set_up_helped(void **state) {
    *state = cockpit_create("c172", true);
    return 0;
}

static int set_up_jet(void **state) {
    *state = cockpit_create("t37", false);
    return 0;
}

static int tear_down(void **state) {
    cockpit_destroy((Cockpit **)state);
    return 0;
}

static double bank_deg(const Cockpit *cockpit) {
    return flight_instruments(&cockpit->session->flight).bank_rad * DEG;
}

static double rate_deg_s(const Cockpit *cockpit) {
    return cockpit->session->flight.state.rate_body.x * DEG;
}

// The report was polled already: what does the flight make of it, to this side?
static void expect_a_roll(Cockpit *cockpit, double side) {
    double bank = bank_deg(cockpit);
    cockpit_fly(cockpit, 1);
    print_message("first step: aileron %+.3f, expected %+g; roll rate %+.2f degrees a second\n",
                  cockpit_last(cockpit)->controls.aileron, side, rate_deg_s(cockpit));
    assert_true(fabs(cockpit->session->flight.state.aileron - side) < SIXTEEN_BITS);
    assert_true(side * rate_deg_s(cockpit) > 0.0);
    for (int i = 0; i < 60; i++) {
        double before = bank_deg(cockpit);
        cockpit_fly(cockpit, 1);
        assert_true(side * (bank_deg(cockpit) - before) > 0.0);
    }
    print_message("half a second later: roll rate %+.1f degrees a second, bank %+.1f degrees\n", rate_deg_s(cockpit),
                  bank_deg(cockpit));
    assert_true(side * rate_deg_s(cockpit) > 20.0 && side * (bank_deg(cockpit) - bank) > 10.0);
}

static void test_a_stick_to_the_right_rolls_the_aircraft_to_the_right(void **state) {
    Cockpit *cockpit = FLY(state);
    FakeStick *stick = cockpit_plug_stick(cockpit, 0, IDLE);
    cockpit_fly(cockpit, 10);
    assert_true(fabs(rate_deg_s(cockpit)) < 0.01 && cockpit_last(cockpit)->controls.aileron == 0.0);
    cockpit_move_stick(cockpit, stick, FULL, 0.0, IDLE, -1, 0);
    expect_a_roll(cockpit, 1.0);
    cockpit_move_stick(cockpit, stick, -FULL, 0.0, IDLE, -1, 0);
    cockpit_fly(cockpit, 60);
    expect_a_roll(cockpit, -1.0);
}

static void test_a_pad_to_the_right_rolls_the_aircraft_to_the_right(void **state) {
    Cockpit *cockpit = FLY(state);
    FakePad *pad = cockpit_plug_pad(cockpit, 3);
    cockpit_fly(cockpit, 10);
    cockpit_move_pad(cockpit, pad, (FakePadHands){.left_x = FULL});
    expect_a_roll(cockpit, 1.0);
    cockpit_move_pad(cockpit, pad, (FakePadHands){.left_x = -FULL});
    cockpit_fly(cockpit, 60);
    expect_a_roll(cockpit, -1.0);
}

static void test_a_stick_pulled_back_raises_the_nose(void **state) {
    Cockpit *cockpit = FLY(state);
    FakeStick *stick = cockpit_plug_stick(cockpit, 0, IDLE);
    cockpit_fly(cockpit, 10);
    double pitch = flight_instruments(&cockpit->session->flight).pitch_rad;
    cockpit_move_stick(cockpit, stick, 0.0, 0.5, IDLE, -1, 0);
    cockpit_fly(cockpit, 60);
    double raised = flight_instruments(&cockpit->session->flight).pitch_rad - pitch;
    print_message("elevator %+.3f; nose up by %.1f degrees after half a second\n",
                  cockpit_last(cockpit)->controls.elevator, raised * DEG);
    assert_true(cockpit_last(cockpit)->controls.elevator > 0.2 && raised * DEG > 2.0);
}

// ---- Throttle ----

static double slider_at(double throttle) {
    return 1.0 - 2.0 * throttle;
}

static double throttle_after(Cockpit *cockpit, FakeStick *stick, double lever) {
    cockpit_move_stick(cockpit, stick, 0.0, 0.0, slider_at(lever), -1, 0);
    cockpit_fly(cockpit, 2);
    print_message("lever at %.2f: throttle %.4f\n", lever, cockpit->session->flight.state.throttle);
    return cockpit->session->flight.state.throttle;
}

static void test_the_throttle_is_picked_up_softly(void **state) {
    Cockpit *cockpit = FLY(state);
    double begin = cockpit->session->keyboard.controls.throttle = 0.6; // as keys left it
    FakeStick *stick = cockpit_plug_stick(cockpit, 0, IDLE);
    cockpit_fly(cockpit, 2);
    assert_true(cockpit->session->flight.state.throttle == begin);
    assert_true(throttle_after(cockpit, stick, 0.2) == begin);
    assert_true(throttle_after(cockpit, stick, begin - 0.1) == begin);
    double taken = throttle_after(cockpit, stick, begin + 0.05);
    assert_true(fabs(taken - begin - 0.05) < 0.01);
    assert_true(fabs(throttle_after(cockpit, stick, 0.3) - 0.3) < 0.01);
    double held = cockpit->session->flight.state.throttle;
    fake_stick_unplug(stick);
    cockpit_wait(cockpit, DEVICE_LEFT, 1);
    cockpit_fly(cockpit, 120);
    assert_true(cockpit->session->flight.state.throttle == held);
    stick = cockpit_plug_stick(cockpit, 1, IDLE);
    assert_true(throttle_after(cockpit, stick, 0.1) == held);
    assert_true(fabs(throttle_after(cockpit, stick, 0.4) - 0.4) < 0.01);
}

// ---- Several, and none ----

// A stick's aileron and a pad's rudder and left brake, each all the way.
static FakePad *fly_with_both(Cockpit *cockpit) {
    FakeStick *stick = cockpit_plug_stick(cockpit, 0, IDLE);
    FakePad *pad = cockpit_plug_pad(cockpit, 3);
    cockpit_fly(cockpit, 2);
    cockpit_move_stick(cockpit, stick, FULL, 0.0, IDLE, -1, 0);
    cockpit_move_pad(cockpit, pad, (FakePadHands){.right_x = -FULL, .left_trigger = 1.0});
    cockpit_fly(cockpit, 1);
    return pad;
}

static void test_two_devices_fly_at_once(void **state) {
    Cockpit *cockpit = FLY(state);
    FakePad *pad = fly_with_both(cockpit);
    Controls both = cockpit_last(cockpit)->controls;
    cockpit_move_pad(cockpit, pad, (FakePadHands){.left_x = -FULL, .right_x = -FULL});
    cockpit_fly(cockpit, 31);
    Controls last = cockpit_last(cockpit)->controls;
    print_message("aileron %+g of the stick, rudder %+g and brakes %g of the pad; then the pad's aileron %+g\n",
                  both.aileron, both.rudder, both.brake_left, last.aileron);
    assert_true(both.aileron == 1.0 && fabs(both.rudder + 1.0) < SIXTEEN_BITS);
    assert_true(both.brake_left == 1.0 && both.brake_right == 1.0 && last.brake_left == 0.0);
    assert_true(fabs(last.aileron + 1.0) < SIXTEEN_BITS && fabs(last.rudder + 1.0) < SIXTEEN_BITS);
}

static void test_pedals_that_leave_take_only_theirs_along(void **state) {
    Cockpit *cockpit = FLY(state);
    FakePad *pad = fly_with_both(cockpit);
    fake_pad_unplug(pad);
    cockpit_wait(cockpit, DEVICE_LEFT, 1);
    cockpit_fly(cockpit, 1);
    print_message("on the screen: %s\n", cockpit->session->message);
    assert_non_null(strstr(cockpit->session->message, "was unplugged, with it rudder, brake-left, brake-right"));
    assert_null(strstr(cockpit->session->message, "the keyboard flies"));
    assert_true(pilot_drives_stick(cockpit->session->pilot));
}

// Evenly to rest, and on without a pilot.
static void expect_to_fly_on(Cockpit *cockpit, double aileron, double throttle) {
    for (int i = 1; i <= 60; i++) {
        cockpit_fly(cockpit, 1);
        double expected = aileron * (1.0 - i / 60.0), found = cockpit_last(cockpit)->controls.aileron;
        if (fabs(found - expected) > 1e-9)
            fail_msg("step %d: aileron %.9f, expected %.9f", i, found, expected);
    }
    print_message("on the screen: %s\n", cockpit->session->message);
    assert_non_null(strstr(cockpit->session->message, "Pretended")); // its maker is not always told
    assert_non_null(strstr(cockpit->session->message, "was unplugged, with it aileron"));
    assert_non_null(strstr(cockpit->session->message, ": the keyboard flies"));
    assert_true(cockpit->session->message_s > 0.0);
    cockpit_fly(cockpit, 120 * 5);
    FlightInstruments now = flight_instruments(&cockpit->session->flight);
    print_message("5 s later: %.0f m/s, %.0f m, bank %.0f degrees, throttle %.3f\n", now.true_airspeed, now.h_m,
                  now.bank_rad * DEG, cockpit->session->flight.state.throttle);
    assert_true(cockpit_last(cockpit)->controls.aileron == 0.0);
    assert_true(cockpit->session->flight.state.throttle == throttle);
    assert_true(cockpit->session->flight.state.contact == FLIGHT_AIRBORNE && now.h_m > 700.0);
}

static void test_a_stick_that_is_unplugged_and_plugged_in_again_flies_on(void **state) {
    Cockpit *cockpit = FLY(state);
    for (int round = 0; round < 2; round++) {
        FakeStick *stick = cockpit_plug_stick(cockpit, round, IDLE);
        cockpit_fly(cockpit, 2);
        assert_non_null(strstr(cockpit->session->message, "thrustmaster-t16000m"));
        cockpit_move_stick(cockpit, stick, 0.2, 0.0, IDLE, -1, 0);
        cockpit_fly(cockpit, 20);
        double aileron = cockpit_last(cockpit)->controls.aileron;
        assert_true(aileron > 0.05 && pilot_drives_stick(cockpit->session->pilot));
        fake_stick_unplug(stick);
        cockpit_wait(cockpit, DEVICE_LEFT, round + 1);
        expect_to_fly_on(cockpit, aileron, cockpit->session->flight.controls.throttle);
        assert_false(pilot_drives_stick(cockpit->session->pilot));
    }
}

static void test_a_pad_that_is_unplugged_and_plugged_in_again_flies_on(void **state) {
    Cockpit *cockpit = FLY(state);
    for (int round = 0; round < 2; round++) {
        FakePad *pad = cockpit_plug_pad(cockpit, 3 + round);
        cockpit_move_pad(cockpit, pad, (FakePadHands){.left_x = 0.5, .left_trigger = 1.0});
        cockpit_fly(cockpit, 20);
        double aileron = cockpit_last(cockpit)->controls.aileron;
        assert_true(aileron > 0.05 && cockpit_last(cockpit)->controls.brake_left == 1.0);
        fake_pad_unplug(pad);
        cockpit_wait(cockpit, DEVICE_LEFT, round + 1);
        expect_to_fly_on(cockpit, aileron, cockpit->session->flight.controls.throttle);
        assert_true(cockpit_last(cockpit)->controls.brake_left == 0.0);
    }
}

// ---- Hat and buttons ----

static void press(Cockpit *cockpit, FakeStick *stick, int button, bool down) {
    cockpit_move_stick(cockpit, stick, 0.0, 0.0, IDLE, -1, down ? (uint8_t)(1u << (button - 1)) : 0);
    cockpit_fly(cockpit, 1);
}

static void test_the_hat_looks_around(void **state) {
    Cockpit *cockpit = FLY(state);
    FakeStick *stick = cockpit_plug_stick(cockpit, 0, IDLE);
    static const struct {
        int hat;
        double right, up;
    } looks[] = {{-1, 0, 0}, {0, 0, 1}, {1, 1, 1}, {2, 1, 0}, {4, 0, -1}, {6, -1, 0}, {7, -1, 1}, {-1, 0, 0}};
    RenderCamera ahead = camera_of_flight(&cockpit->session->flight, &cockpit->session->rig, CAMERA_COCKPIT, 1.0);
    for (size_t i = 0; i < COUNT_OF(looks); i++) {
        cockpit_move_stick(cockpit, stick, 0.0, 0.0, IDLE, looks[i].hat, 0);
        cockpit_fly(cockpit, 1);
        const CameraRig *rig = &cockpit->session->rig;
        RenderCamera camera = camera_of_flight(&cockpit->session->flight, rig, CAMERA_COCKPIT, 1.0);
        double turned = 0.0;
        for (int k = 0; k < 3; k++)
            turned += ahead.camera_from_ecef.m[2][k] * camera.camera_from_ecef.m[2][k];
        print_message("hat %2d: right %+g, up %+g; the view is turned by %.1f degrees\n", looks[i].hat, rig->look_right,
                      rig->look_up, acos(fmin(turned, 1.0)) * DEG);
        assert_true(rig->look_right == looks[i].right && rig->look_up == looks[i].up);
        assert_true((turned < 0.99) == (looks[i].hat >= 0));
    }
}

static void test_buttons_change_view_flaps_and_brakes(void **state) {
    Cockpit *cockpit = FLY(state);
    FakeStick *stick = cockpit_plug_stick(cockpit, 0, IDLE);
    press(cockpit, stick, 2, true);
    CameraView view = cockpit->session->settings.view;
    press(cockpit, stick, 2, false);
    press(cockpit, stick, 5, true);
    press(cockpit, stick, 5, false);
    press(cockpit, stick, 5, true);
    Controls flaps = cockpit_last(cockpit)->controls;
    press(cockpit, stick, 1, true);
    Controls braked = cockpit_last(cockpit)->controls;
    press(cockpit, stick, 1, false);
    Controls after = cockpit_last(cockpit)->controls;
    print_message("view %s; flaps %g after two presses; brakes %g while held, %g after\n", camera_view_name(view),
                  flaps.flaps, braked.brake_left, after.brake_left);
    assert_int_equal(view, CAMERA_CHASE);
    assert_true(flaps.flaps == 0.5 && braked.brake_left == 1.0 && braked.brake_right == 1.0);
    assert_true(after.brake_left == 0.0 && after.flaps == 0.5);
}

static void test_buttons_move_the_gear(void **state) {
    Cockpit *cockpit = FLY(state);
    FakeStick *stick = cockpit_plug_stick(cockpit, 0, IDLE);
    cockpit_fly(cockpit, 1);
    assert_true(cockpit_last(cockpit)->controls.gear_up);
    press(cockpit, stick, 8, true);
    bool up = cockpit_last(cockpit)->controls.gear_up;
    press(cockpit, stick, 8, false);
    cockpit_fly(cockpit, (int)(cockpit->session->aircraft.gear_s * 120.0) + 2);
    double down = cockpit->session->flight.state.gear;
    press(cockpit, stick, 7, true);
    print_message("gear wanted up: %d in the step of the press, expected 0; %g down after %g s; then %d\n", up, down,
                  cockpit->session->aircraft.gear_s, cockpit_last(cockpit)->controls.gear_up);
    assert_true(!up && down == 1.0 && cockpit_last(cockpit)->controls.gear_up);
}

// ---- Help for keys ----

static void test_keys_are_helped_and_a_stick_is_not(void **state) {
    Cockpit *cockpit = FLY(state);
    FlightSession *session = cockpit->session;
    FakeStick *stick = cockpit_plug_stick(cockpit, 0, IDLE);
    cockpit_fly(cockpit, 30);
    bool helped = session->help.engaged;
    cockpit_move_stick(cockpit, stick, 0.5, 0.0, IDLE, -1, 0);
    cockpit_fly(cockpit, 1);
    double aileron = cockpit_last(cockpit)->controls.aileron, stick_aileron = session->keyboard.controls.aileron;
    bool helped_stick = session->help.engaged;
    cockpit_fly(cockpit, 30);
    fake_stick_unplug(stick);
    cockpit_wait(cockpit, DEVICE_LEFT, 1);
    cockpit_fly(cockpit, 120 * 2);
    double bank = bank_deg(cockpit);
    cockpit_fly(cockpit, 120 * 3);
    print_message("helped: keys %d, stick %d, unplugged %d; the stick's aileron %.4f flies as %.4f; bank %.1f, 3 s "
                  "later %.1f degrees\n",
                  helped, helped_stick, session->help.engaged, stick_aileron, aileron, bank, bank_deg(cockpit));
    assert_true(helped && !helped_stick && session->help.engaged);
    assert_true(aileron == stick_aileron && aileron > 0.2);
    assert_true(fabs(bank_deg(cockpit) - bank) < 1.0); // which the help holds
}

// ---- Motors ----

static void print_rumbles(const uint8_t rumbles[][8], int count) {
    for (int i = 0; i < count; i++)
        print_message("%02x %02x %02x %02x %02x\n", rumbles[i][0], rumbles[i][1], rumbles[i][2], rumbles[i][3],
                      rumbles[i][4]);
}

// The newest message, once there are so many, within 3 s.
static int wait_for_rumbles(FakePad *pad, int least, uint8_t rumbles[FAKE_RUMBLES_MAX][8]) {
    int count = 0;
    for (int i = 0; i < 600 && (count = fake_pad_rumbles(pad, rumbles)) < least; i++)
        cockpit_sleep_ms(5);
    return count;
}

static void test_a_stall_shakes_the_pad_until_it_is_over(void **state) {
    Cockpit *cockpit = FLY(state);
    FlightSession *session = cockpit->session;
    uint8_t rumbles[FAKE_RUMBLES_MAX][8];
    FakePad *pad = cockpit_plug_pad(cockpit, 3);
    session->keyboard.controls.throttle = 0.0;
    cockpit_move_pad(cockpit, pad, (FakePadHands){.left_y = -FULL});
    int steps = 0;
    for (; steps < 120 * 20 && session->feel.shake == 0.0; steps++)
        cockpit_fly(cockpit, 1);
    FlightInstruments now = flight_instruments(&session->flight);
    double stalled = airframe_stalled(&session->aircraft, now.alpha_rad, session->flight.state.flaps);
    int count = wait_for_rumbles(pad, 2, rumbles); // and the one that ends it, as nothing is flown on
    print_rumbles(rumbles, count);
    print_message("after %.1f s: angle of attack %.1f degrees, %.2f of the flow separated; slow motor %.3f\n",
                  steps / 120.0, now.alpha_rad * DEG, stalled, session->feel.shake);
    assert_true(stalled >= FEEL_STALLED);
    assert_int_equal(count, 2);
    assert_int_equal(rumbles[0][3], lround(session->feel.shake * 255.0));
    assert_memory_equal(rumbles[0], ((const uint8_t[]){0, 8, 0}), 3);
    assert_true(rumbles[0][3] >= 76 && rumbles[0][4] == 0 && rumbles[1][3] == 0 && rumbles[1][4] == 0);
}

// Just above the ground, level, with this sink.
static void put_above_ground(Cockpit *cockpit, double sink) {
    FlightState *state = &cockpit->session->flight.state;
    const Aircraft *aircraft = &cockpit->session->aircraft;
    double lowest = 0.0, speed = 1.3 * airframe_stall_speed(aircraft, 1.2, 0.0);
    for (int i = 0; i < aircraft->leg_count; i++)
        lowest = fmax(lowest, aircraft->legs[i].z);
    Quatd level = flight_attitude(FLIGHT_LAT, FLIGHT_LON, 0.3, 0.0, 0.0);
    state->position_ecef = geodesy_to_ecef((Geodetic){FLIGHT_LAT, FLIGHT_LON, cockpit->ground_m + lowest + 0.1});
    state->velocity_ecef = quatd_rotate(level, vec3d(speed, 0.0, sink));
    state->ecef_from_body = level;
    state->rate_body = vec3d(0.0, 0.0, 0.0);
    state->contact = FLIGHT_AIRBORNE;
    state->wheels = 0;
    cockpit->session->keyboard.controls.throttle = 0.0;
}

// Until the knock; how fast it sank before the step of the touch.
static double put_down(Cockpit *cockpit, double sink) {
    double sank = 0.0;
    put_above_ground(cockpit, sink);
    cockpit->session->feel = (Feel){.shake = 0.0};
    for (int i = 0; i < 60 && cockpit->session->feel.knock_s == 0.0; i++) {
        sank = -flight_instruments(&cockpit->session->flight).vertical_speed_m_s;
        cockpit_fly(cockpit, 1);
    }
    return sank;
}

static void test_a_touchdown_knocks_by_its_sink(void **state) {
    Cockpit *cockpit = FLY(state);
    uint8_t rumbles[FAKE_RUMBLES_MAX][8];
    FakePad *pad = cockpit_plug_pad(cockpit, 3);
    int count = 0, last = 0;
    for (double sink = 1.0; sink < 3.2; sink += 1.0) {
        double sank = put_down(cockpit, sink);
        count = wait_for_rumbles(pad, count + 2, rumbles);
        int knock = rumbles[count - 2][3];
        double limit = cockpit->session->aircraft.sink_limit;
        double expected = 255.0 * (FEEL_KNOCK_LEAST + (1.0 - FEEL_KNOCK_LEAST) * sank / limit);
        print_message("%.2f m/s: motors %d and %d of 255, expected %.1f; then %d\n", sank, knock, rumbles[count - 2][4],
                      expected, rumbles[count - 1][3]);
        assert_true(fabs(knock - expected) < 1.0 && knock > last && rumbles[count - 2][4] == knock);
        assert_true(rumbles[count - 1][3] == 0 && rumbles[count - 1][4] == 0);
        last = knock;
    }
}

// ---- Latency ----

#define REPORTS 40

typedef struct Hand {
    FakeStick *stick;
    FakePad *pad;
    int64_t written_ns[REPORTS];
    double x[REPORTS];
    volatile bool done;
} Hand;

// At any time with respect to the frames; every position comes once.
static void *move_about(void *argument) {
    Hand *hand = argument;
    uint32_t seed = 12345;
    for (int i = 0; i < REPORTS; i++) {
        uint8_t report[FAKE_PAD_BYTES];
        seed = seed * 1664525u + 1013904223u;
        clock_sleep_until_ns(clock_now_ns() + 18000000 + (int64_t)(seed >> 8) % 12000000);
        hand->x[i] = (i % 2 ? -1.0 : 1.0) * (0.2 + 0.7 * i / REPORTS);
        if (hand->stick)
            fake_joystick_report(hand->x[i], 0.0, 0.0, IDLE, -1, 0, report);
        else
            fake_pad_report(&(FakePadHands){.left_x = hand->x[i]}, report);
        hand->written_ns[i] = clock_now_ns();
        if (hand->stick)
            fake_stick_send(hand->stick, report, FAKE_STICK_BYTES);
        else
            fake_pad_send(hand->pad, report, FAKE_PAD_BYTES);
    }
    cockpit_sleep_ms(80);
    hand->done = true;
    return NULL;
}

static double aileron_of(const PadInfo *info, double x) {
    char path[PATHS_BYTES_MAX];
    PadProfile profile;
    assert_int_equal(joystick_find_profile(info, &profile, path), RESULT_OK);
    assert_true(profile.axes[0].control == PAD_CONTROL_AILERON);
    return profile_axis_value(&profile.axes[0], x);
}

// The first step in which the flight had that aileron; NULL: none.
static const CockpitStep *step_of(const Cockpit *cockpit, double aileron) {
    for (int i = 0; i < cockpit->step_count; i++)
        if (cockpit->steps[i].begin_ns && fabs(cockpit->steps[i].controls.aileron - aileron) < 1e-9)
            return &cockpit->steps[i];
    return NULL;
}

typedef struct Latency {
    double begins_ms[REPORTS]; // from the report's time to the begin of the step that it acts in
    DeviceTiming *seen;        // from writing it until the moved aircraft can be drawn
    int count, overtaken;      // by the next report, before a step began
} Latency;

static void add_report(const Cockpit *cockpit, const PadInfo *info, const Hand *hand, int index, Latency *latency) {
    const CockpitReport *report = &cockpit->reports[index];
    const CockpitStep *step = step_of(cockpit, aileron_of(info, report->state.axes[0]));
    bool is_last = index + 1 == cockpit->report_count;
    if (!step) {
        bool overtaken = !is_last && report[1].time_ns - report->time_ns <= (int64_t)COCKPIT_STEP_NS + 1;
        if (!overtaken)
            fail_msg("report %d, x %g, has moved nothing", index, report->state.axes[0]);
        latency->overtaken++;
        return;
    }
    latency->begins_ms[latency->count++] = (double)(step->begin_ns - report->time_ns) * 1e-6;
    for (int i = 0; i < REPORTS; i++)
        if (fabs(hand->x[i] - report->state.axes[0]) < 1e-4) {
            assert_true(report->time_ns >= hand->written_ns[i]);
            device_timing_add(latency->seen, hand->written_ns[i], step->seen_ns);
        }
}

static void expect_latency(Cockpit *cockpit, Hand *hand, const PadInfo *info) {
    pthread_t thread;
    Latency latency = {.seen = calloc(1, sizeof *latency.seen)};
    cockpit_fly(cockpit, 2);
    int first = cockpit->report_count;
    cockpit_start_clock(cockpit);
    assert_int_equal(pthread_create(&thread, NULL, move_about, hand), 0);
    while (!hand->done)
        cockpit_frame(cockpit);
    pthread_join(thread, NULL);
    for (int i = first; i < cockpit->report_count; i++)
        add_report(cockpit, info, hand, i, &latency);
    statistics_sort(latency.begins_ms, latency.count);
    double least = latency.begins_ms[0], most = latency.begins_ms[latency.count - 1];
    print_message("%d reports of %d acted, %d were overtaken; in the step that began %.3f to %.3f ms after, expected 0 "
                  "to %.3f\n",
                  latency.count, REPORTS, latency.overtaken, least, most, COCKPIT_STEP_NS * 1e-6);
    device_timing_print(latency.seen, "from writing a report until the aircraft has moved");
    free(latency.seen);
    assert_true(latency.count > REPORTS / 2);
    assert_true(least > -1e-3 && most <= COCKPIT_STEP_NS * 1e-6 + 1e-3);
}

static void test_a_sticks_report_acts_in_the_first_step_that_begins_after_it(void **state) {
    Cockpit *cockpit = FLY(state);
    Hand hand = {.stick = cockpit_plug_stick(cockpit, 0, IDLE)};
    expect_latency(cockpit, &hand, &(PadInfo){.vendor = 0x044f, .product = 0xb10a});
}

static void test_a_pads_report_acts_in_the_first_step_that_begins_after_it(void **state) {
    Cockpit *cockpit = FLY(state);
    Hand hand = {.pad = cockpit_plug_pad(cockpit, 3)};
    expect_latency(cockpit, &hand, &(PadInfo){.vendor = 0x045e, .product = 0x028e});
}

// ---- Frames around the plug ----

#define ROUNDS 5
#define FRAMES_EACH 5 // after the change was heard

typedef struct Plug {
    Cockpit *cockpit;
    FakeStick *stick;
    int number;
} Plug;

static void *put_in(void *argument) {
    Plug *plug = argument;
    plug->stick = fake_stick_plug(plug->cockpit->bed, &FAKE_JOYSTICK, plug->number);
    return NULL;
}

static void *pull_out(void *argument) {
    Plug *plug = argument;
    fake_stick_unplug(plug->stick);
    return NULL;
}

// By another hand, while frames are flown; how often the flight's thread slept in them.
static long frames_around(Plug *plug, void *(*act)(void *), DeviceEventKind kind, DeviceTiming *all) {
    Cockpit *cockpit = plug->cockpit;
    pthread_t thread;
    int heard = cockpit->heard[kind], first = cockpit->frame_count, left = FRAMES_EACH;
    long sleeps = 0;
    assert_int_equal(pthread_create(&thread, NULL, act, plug), 0);
    for (int i = 0; i < 180 && left > 0; i++) {
        cockpit_frame(cockpit);
        left -= cockpit->heard[kind] > heard;
    }
    pthread_join(thread, NULL);
    assert_int_equal(cockpit->heard[kind], heard + 1);
    for (int i = first; i < cockpit->frame_count; i++) {
        const CockpitFrame *frame = &cockpit->frames[i];
        device_timing_add(all, 0, (int64_t)(frame->ms * 1e6));
        all->busy_ms = fmax(all->busy_ms, frame->busy_ms);
        sleeps += frame->sleeps;
    }
    all->sleeps += sleeps;
    return sleeps;
}

// Who waits for a device, a thread or a disk sleeps at every plug; who finds a mutex taken, at one now and then.
static void test_no_frame_waits_for_a_plug(void **state) {
    Cockpit *cockpit = FLY(state);
    DeviceTiming *in = calloc(1, sizeof *in), *out = calloc(1, sizeof *out);
    Plug plug = {.cockpit = cockpit};
    int slept_in = 0, slept_out = 0, here = cockpit_files_read(true), elsewhere = cockpit_files_read(false);
    cockpit_start_clock(cockpit);
    for (int round = 0; round < ROUNDS; round++) {
        plug.number = round;
        slept_in += frames_around(&plug, put_in, DEVICE_ARRIVED, in) > 0;
        slept_out += frames_around(&plug, pull_out, DEVICE_LEFT, out) > 0;
    }
    device_timing_print(in, "session_advance around plugging in");
    device_timing_print(out, "session_advance around unplugging");
    here = cockpit_files_read(true) - here;
    elsewhere = cockpit_files_read(false) - elsewhere;
    print_message("slept in %d and %d of %d rounds; profiles looked for by this thread %d times, by others %d\n",
                  slept_in, slept_out, ROUNDS, here, elsewhere);
    free(in);
    free(out);
    assert_true(slept_in <= ROUNDS / 2 && slept_out <= ROUNDS / 2);
    assert_true(here == 0 && elsewhere == ROUNDS);
}

#define COCKPIT_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void) {
    const struct CMUnitTest tests[] = {
        COCKPIT_TEST(test_a_stick_to_the_right_rolls_the_aircraft_to_the_right),
        COCKPIT_TEST(test_a_pad_to_the_right_rolls_the_aircraft_to_the_right),
        COCKPIT_TEST(test_a_stick_pulled_back_raises_the_nose),
        COCKPIT_TEST(test_the_throttle_is_picked_up_softly),
        COCKPIT_TEST(test_two_devices_fly_at_once),
        COCKPIT_TEST(test_pedals_that_leave_take_only_theirs_along),
        COCKPIT_TEST(test_a_stick_that_is_unplugged_and_plugged_in_again_flies_on),
        COCKPIT_TEST(test_a_pad_that_is_unplugged_and_plugged_in_again_flies_on),
        COCKPIT_TEST(test_the_hat_looks_around),
        COCKPIT_TEST(test_buttons_change_view_flaps_and_brakes),
        cmocka_unit_test_setup_teardown(test_buttons_move_the_gear, set_up_jet, tear_down),
        cmocka_unit_test_setup_teardown(test_keys_are_helped_and_a_stick_is_not, set_up_helped, tear_down),
        COCKPIT_TEST(test_a_stall_shakes_the_pad_until_it_is_over),
        COCKPIT_TEST(test_a_touchdown_knocks_by_its_sink),
        COCKPIT_TEST(test_a_sticks_report_acts_in_the_first_step_that_begins_after_it),
        COCKPIT_TEST(test_a_pads_report_acts_in_the_first_step_that_begins_after_it),
        COCKPIT_TEST(test_no_frame_waits_for_a_plug),
    };
    if (!fake_bed_works())
        return 77;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
