// What hands feel of a flight: stalls that are flown, landings of many sinks, crashes; and how often pads are told.
#include "app/pilot/feel.h"

#include "app/aircraft/airframe.h"
#include "app/aircraft/isa.h"
#include "tests/flight_support.h"

#include <stdio.h>

#define STEP FLIGHT_STEP_S

typedef struct Felt {
    Feel feel;
    int messages;
    FeelRumble last, strongest; // of all messages
    double told_s;              // since when the last message would have ended
    double quiet_shaking_s;     // longest time that a stall was not felt
} Felt;

static double separated(const Flight *flight) {
    FlightInstruments now = flight_instruments(flight);
    return airframe_stalled(flight->aircraft, now.alpha_rad, flight->state.flaps);
}

static FeelRumble feel_after(Felt *felt, Flight *flight, const Controls *controls) {
    const FlightState before = flight->state;
    flight_step(flight, controls, STEP);
    FeelRumble rumble = feel_step(&felt->feel, &before, flight, STEP);
    felt->told_s -= STEP;
    if (rumble.seconds > 0.0) {
        felt->messages++;
        felt->last = rumble;
        felt->told_s = rumble.seconds;
        if (rumble.low > felt->strongest.low)
            felt->strongest = rumble;
    }
    return rumble;
}

static void a_level_flight_is_not_felt(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT_OF(flight_types); i++) {
        Aircraft aircraft = flight_type(flight_types[i]);
        Flight flight = flight_in_air(&aircraft, 1500.0, aircraft.cruise_speed);
        Felt felt = {.messages = 0};
        for (int step = 0; step < 120 * 20; step++)
            feel_after(&felt, &flight, &flight.controls);
        print_message("%s: %d messages in 20 s, expected 0\n", flight_types[i], felt.messages);
        assert_int_equal(felt.messages, 0);
    }
}

// Pulled into a stall with the engine idle, held there for a while, and recovered.
static void fly_a_stall(const char *type, Felt *felt) {
    Aircraft aircraft = flight_type(type);
    double stall = airframe_stall_speed(&aircraft, isa_at(2500.0).density, 0.0);
    Flight flight = flight_in_air(&aircraft, 2500.0, 1.3 * stall);
    Controls pulled = flight.controls;
    pulled.throttle = 0.0;
    int stalled_steps = 0, early = 0;
    for (int step = 0; step < 120 * 25; step++) {
        pulled.elevator = fmin(pulled.elevator + 0.2 * STEP, step < 120 * 15 ? 1.0 : 0.0);
        feel_after(felt, &flight, &pulled);
        bool stalled = separated(&flight) >= FEEL_STALLED;
        stalled_steps += stalled;
        early += !stalled && felt->told_s > 0.0 && felt->last.low > 0.0;
        if (stalled && felt->told_s < 0.0)
            felt->quiet_shaking_s += STEP;
    }
    print_message("%s: stalled for %.2f s; %d messages, strongest %.3f; shaking goes on for %.2f s after stalls, and "
                  "was missing for %.3f s\n",
                  type, stalled_steps * STEP, felt->messages, felt->strongest.low, early * STEP, felt->quiet_shaking_s);
    assert_true(stalled_steps > 12);
    assert_int_equal(early, 0);
}

static void a_stall_shakes_as_long_as_it_lasts(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT_OF(flight_types); i++) {
        Felt felt = {.messages = 0};
        fly_a_stall(flight_types[i], &felt);
        assert_true(felt.messages >= 2 && felt.messages < 250); // 10 a second
        assert_true(felt.strongest.low >= FEEL_SHAKE_LEAST && felt.strongest.high == 0.0);
        assert_true(felt.quiet_shaking_s == 0.0);
    }
}

// Level over flat ground, wheels just above it, sinking so fast.
static FeelRumble touch_down(const Aircraft *aircraft, double sink, FlightContact *contact) {
    double ground_m = 100.0, lowest = 0.0;
    for (int i = 0; i < aircraft->leg_count; i++)
        lowest = fmax(lowest, aircraft->legs[i].z);
    Flight flight = flight_at(aircraft, 300.0, 0.3, 0.0, 1.3 * airframe_stall_speed(aircraft, 1.2, 0.0),
                              (FlightGround){flight_flat, &ground_m});
    Geodetic place = {FLIGHT_LAT, FLIGHT_LON, ground_m + lowest + 0.1};
    Vec3d ahead = quatd_rotate(flight_attitude(FLIGHT_LAT, FLIGHT_LON, 0.3, 0.0, 0.0), vec3d(1, 0, 0));
    Vec3d down = quatd_rotate(flight_attitude(FLIGHT_LAT, FLIGHT_LON, 0.3, 0.0, 0.0), vec3d(0, 0, 1));
    flight.state.position_ecef = geodesy_to_ecef(place);
    flight.state.velocity_ecef = vec3d_mad(vec3d_scale(ahead, vec3d_length(flight.state.velocity_ecef)), down, sink);
    flight.state.gear = 1.0;
    Felt felt = {.messages = 0};
    Controls controls = {.trim = flight.controls.trim};
    for (int step = 0; step < 60 && felt.messages == 0; step++)
        feel_after(&felt, &flight, &controls);
    *contact = flight.state.contact;
    return felt.last;
}

static void wheels_knock_the_harder_the_faster_they_come_down(void **state) {
    (void)state;
    Aircraft aircraft = flight_type("c172");
    double last = 0.0;
    for (double sink = 0.5; sink < aircraft.sink_limit; sink += 0.5) {
        FlightContact contact;
        FeelRumble knock = touch_down(&aircraft, sink, &contact);
        double expected = FEEL_KNOCK_LEAST + (1.0 - FEEL_KNOCK_LEAST) * sink / aircraft.sink_limit;
        print_message("%.1f m/s: %.3f and %.3f for %.2f s, expected about %.3f\n", sink, knock.low, knock.high,
                      knock.seconds, expected);
        assert_int_equal(contact, FLIGHT_ROLLING);
        assert_true(fabs(knock.low - expected) < 0.06 && knock.high == knock.low && knock.seconds == FEEL_KNOCK_S);
        assert_true(knock.low > last);
        last = knock.low;
    }
}

static void a_crash_knocks_with_all_that_there_is(void **state) {
    (void)state;
    Aircraft aircraft = flight_type("c172");
    FlightContact contact;
    FeelRumble knock = touch_down(&aircraft, 3.0 * aircraft.sink_limit, &contact);
    print_message("contact %d, %g and %g\n", contact, knock.low, knock.high);
    assert_int_equal(contact, FLIGHT_CRASHED);
    assert_true(knock.low == 1.0 && knock.high == 1.0);
}

// By hand-made states: nothing else moves.
static void a_knock_hides_shaking_and_softer_knocks(void **state) {
    (void)state;
    Aircraft aircraft = flight_type("c172");
    double ground_m = 0.0;
    Flight flight =
        flight_at(&aircraft, 500.0, 0.0, 0.0, aircraft.cruise_speed, (FlightGround){flight_flat, &ground_m});
    FlightState air = flight.state, falling = air;
    falling.velocity_ecef = vec3d_scale(vec3d_normalize(air.position_ecef), -2.0);
    Flight stalled = flight; // in the air, falling: the flow comes from below
    stalled.state.velocity_ecef = falling.velocity_ecef;
    flight.state.contact = FLIGHT_ROLLING;
    Feel feel = {.shake = 0.0};
    FeelRumble soft = feel_step(&feel, &air, &flight, STEP);
    FeelRumble hard = feel_step(&feel, &falling, &flight, STEP), softer = feel_step(&feel, &air, &flight, STEP);
    int hidden = 0;
    while (feel_step(&feel, &stalled.state, &stalled, STEP).seconds == 0.0 && hidden < 100)
        hidden++;
    print_message("knocks %.3f, %.3f, then %.3f; shaking was hidden for %d steps, then %.3f\n", soft.low, hard.low,
                  softer.low, hidden, feel.shake);
    assert_true(soft.low > 0.0 && hard.low > soft.low && softer.seconds == 0.0);
    assert_true(hidden >= 28 && hidden <= 30 && feel.shake == 1.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_level_flight_is_not_felt),
        cmocka_unit_test(a_stall_shakes_as_long_as_it_lasts),
        cmocka_unit_test(wheels_knock_the_harder_the_faster_they_come_down),
        cmocka_unit_test(a_crash_knocks_with_all_that_there_is),
        cmocka_unit_test(a_knock_hides_shaking_and_softer_knocks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
