// The flight model in the hard cases 15 to 17: attitudes through the vertical, contact, time. Floating-point exceptions
// trap. The ground is a plane or a slope given by a formula.
#define _GNU_SOURCE
#include <fenv.h>
#include <stdio.h>
#include <string.h>

#include "tests/flight_support.h"

#include "app/aircraft/trim.h"
#include "app/dynamics/flight_contact.h"
#include "app/flight/flight_clock.h"
#include "app/pilot/autopilot.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LONG_FLIGHT_H 0.25 // the sanitizers make the full length minutes
#define HOUR_S 600.0
#else
#define LONG_FLIGHT_H 10.0
#define HOUR_S 3600.0
#endif
#define GRAVITY TRIM_GRAVITY_0

static bool ridge_ground(void *user, double lat_rad, double lon_rad, double *h_m) {
    (void)user;
    (void)lon_rad;
    // A wall 80 m thick, 300 m north.
    *h_m = fabs((lat_rad - FLIGHT_LAT) * GEODESY_A_M - 300.0) < 40.0 ? 30000.0 : 0.0;
    return true;
}

static bool rolling_ground(void *user, double lat_rad, double lon_rad, double *h_m) {
    (void)user;
    double x = (lat_rad - FLIGHT_LAT) * GEODESY_A_M, y = (lon_rad - FLIGHT_LON) * GEODESY_A_M * cos(FLIGHT_LAT);
    *h_m = 300.0 + 0.5 * sin(x / 40.0) + 0.5 * cos(y / 30.0); // slopes up to 2 %
    return true;
}

static double norm_error(Quatd q) {
    return fabs(sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z) - 1.0);
}

// Of motion, height and the springs of the gear, J/kg, with the same gravity as the model.
static double energy(const Flight *flight) {
    const Aircraft *a = flight->aircraft;
    const FlightState *s = &flight->state;
    FlightInstruments now = flight_instruments(flight);
    double sum = 0.5 * now.speed_m_s * now.speed_m_s - GRAVITY * GEODESY_A_M * GEODESY_A_M / (GEODESY_A_M + now.h_m);
    Vec3d w = s->rate_body;
    sum += 0.5 * (a->ixx * w.x * w.x + a->iyy * w.y * w.y + a->izz * w.z * w.z - 2.0 * a->ixz * w.x * w.z) / a->mass;
    FlightStepSetting setting = flight_look_at_ground(flight, &(Controls){.throttle = 0.0});
    for (int i = 0; i < setting.plane_count; i++) {
        GearPlane plane = flight_gear_plane(s, &setting, i);
        sum += gear_spring_energy(&a->legs[i], &plane) / a->mass;
    }
    return sum;
}

// The bounds of docs/aircraft.md. A glider's spiral is unstable, so somebody must keep its wings level.
static void trimmed_flight_drifts_little_in_an_hour(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT_OF(flight_types); i++) {
        Aircraft a = flight_type(flight_types[i]);
        bool glider = a.engine == AIRCRAFT_GLIDER;
        Flight flight = flight_in_air(&a, glider ? 5000.0 : 1500.0, glider ? 32.0 : 0.9 * a.cruise_speed);
        assert_true(flight.trimmed);
        FlightInstruments begin = flight_instruments(&flight);
        Autopilot autopilot = {.engaged = false};
        AutopilotWish ahead = {.heading_rad = begin.heading_rad, .speed_m_s = 32.0};
        for (int k = 0; k < (int)(HOUR_S * 120.0); k++) {
            Controls controls = flight.controls, held = flight.controls;
            if (glider && k % 12 == 0) {
                held = autopilot_hold(&autopilot, &flight, &ahead, 0.1);
                flight.controls.aileron = held.aileron;
                flight.controls.rudder = held.rudder;
            }
            flight_step(&flight, &controls, FLIGHT_STEP_S);
        }
        FlightInstruments now = flight_instruments(&flight);
        print_message("%s after %.0f s: %.4f m higher, %.6f m/s calibrated before, %.6f after, bank %.2g rad\n", a.id,
                      HOUR_S, now.h_m - begin.h_m, begin.calibrated_airspeed, now.calibrated_airspeed, now.bank_rad);
        if (!glider)
            assert_true(fabs(now.h_m - begin.h_m) < 0.1);
        assert_true(fabs(now.calibrated_airspeed - begin.calibrated_airspeed) < (glider ? 0.2 : 1e-3));
        assert_true(fabs(now.bank_rad) < 1e-3);
    }
}

static void a_banked_turn_is_coordinated_and_level(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT_OF(flight_types); i++) {
        Aircraft a = flight_type(flight_types[i]);
        Flight flight = flight_in_air(&a, 1500.0, a.cruise_speed);
        Autopilot help = {.engaged = false};
        Controls pilot = flight.controls;
        double turned = 0.0, expected = 0.0, beta = 0.0;
        for (int k = 0; k < 120 * 20; k++) {
            FlightInstruments before = flight_instruments(&flight);
            pilot.aileron = before.bank_rad < 0.5 && k < 600 ? 0.4 : 0.0;
            pilot.throttle = a.engine == AIRCRAFT_GLIDER ? 0.0 : 0.8;
            Controls controls = autopilot_assist(&help, &flight, &pilot, FLIGHT_STEP_S);
            flight_step(&flight, &controls, FLIGHT_STEP_S);
            FlightInstruments now = flight_instruments(&flight);
            if (k < 120 * 10)
                continue;
            turned += remainder(now.track_rad - before.track_rad, 2.0 * GEODESY_PI);
            // Theory of the level turn: turn rate = g tan(bank) / V.
            expected += GRAVITY * tan(now.bank_rad) / now.true_airspeed * FLIGHT_STEP_S;
            beta = fmax(beta, fabs(now.beta_rad));
        }
        FlightInstruments now = flight_instruments(&flight);
        print_message("%s: bank %.3f rad, turned %.3f rad, theory %.3f; sideslip at most %.4f rad, load %.3f\n", a.id,
                      now.bank_rad, turned, expected, beta, now.load_factor);
        assert_true(now.bank_rad > 0.4 && fabs(turned - expected) < 0.08 * expected && beta < 0.03);
    }
}

static void loops_rolls_and_spins_stay_finite_and_normalised(void **state) {
    (void)state;
    for (int i = 0; i < 48; i++) {
        Aircraft a = flight_type(flight_types[i % 3]);
        double sea = -1000.0;
        Flight flight = flight_at(&a, 4000.0, 0.2 * i, 0.0, a.cruise_speed, (FlightGround){flight_flat, &sea});
        Controls controls = {.elevator = (i & 1) ? 1.0 : -1.0,
                             .aileron = (i & 2) ? 1.0 : 0.0,
                             .rudder = (i & 4) ? 1.0 : 0.0,
                             .throttle = (i & 8) ? 1.0 : 0.0,
                             .flaps = (i & 16) ? 1.0 : 0.0};
        flight_on(&flight, controls, 40.0);
        if (norm_error(flight.state.ecef_from_body) > 1e-12)
            fail_msg("controls %d: quaternion off by %g", i, norm_error(flight.state.ecef_from_body));
    }
}

// Pulled over the top: through pitch 90, inverted, and back to level, with the pitch rate never jumping.
static void a_loop_goes_through_the_vertical(void **state) {
    (void)state;
    Aircraft a = flight_type("t37");
    Flight flight = flight_in_air(&a, 2000.0, 150.0);
    double steepest = 0.0, jump = 0.0;
    bool inverted = false;
    Vec3d nose = quatd_rotate(flight.state.ecef_from_body, vec3d(1, 0, 0));
    for (int k = 0; k < 120 * 40; k++) {
        flight_step(&flight, &(Controls){.elevator = 0.35, .throttle = 1.0, .gear_up = true}, FLIGHT_STEP_S);
        Vec3d now = quatd_rotate(flight.state.ecef_from_body, vec3d(1, 0, 0));
        FlightInstruments at = flight_instruments(&flight);
        steepest = fmax(steepest, fabs(at.pitch_rad));
        inverted = inverted || fabs(at.bank_rad) > 3.0;
        jump = fmax(jump, vec3d_distance(now, nose));
        nose = now;
    }
    print_message("steepest %.3f rad, the nose moved at most %.4f rad a step\n", steepest, jump);
    assert_true(steepest > 1.5 && inverted && jump < 0.03);
}

// Stalled, with the rudder held, it turns about a steep axis with the wing stalled; stick ahead and opposite rudder
// stop it within two seconds.
static void a_stall_with_rudder_becomes_a_spin_and_ends_when_told_to(void **state) {
    (void)state;
    Aircraft a = flight_type("c172");
    Flight flight = flight_in_air(&a, 3000.0, 0.75 * a.cruise_speed);
    flight_on(&flight, (Controls){.elevator = 0.6}, 2.0);
    flight_on(&flight, (Controls){.elevator = 1.0}, 1.0);
    flight_on(&flight, (Controls){.elevator = 1.0, .rudder = 1.0}, 9.0);
    FlightInstruments spinning = flight_instruments(&flight);
    double rate = vec3d_length(flight.state.rate_body), sink = -spinning.vertical_speed_m_s;
    print_message("spin: %.2f rad/s, angle of attack %.2f rad, sinks %.1f m/s\n", rate, spinning.alpha_rad, sink);
    assert_true(rate > 1.2 && rate < 3.5 && spinning.alpha_rad > a.stall_rad && sink > 25.0 && sink < 70.0);
    flight_on(&flight, (Controls){.elevator = -0.3, .rudder = -1.0}, 0.7);
    flight_on(&flight, (Controls){.elevator = -0.1}, 1.3);
    FlightInstruments ended = flight_instruments(&flight);
    print_message("2 s later: %.2f rad/s, angle of attack %.2f rad\n", vec3d_length(flight.state.rate_body),
                  ended.alpha_rad);
    assert_true(ended.alpha_rad < 0.5 * a.stall_rad && vec3d_length(flight.state.rate_body) < 0.5);
}

static void the_quaternion_holds_over_ten_hours(void **state) {
    (void)state;
    Aircraft a = flight_type("c172");
    Flight flight = flight_in_air(&a, 3000.0, 50.0);
    Autopilot autopilot = {.engaged = false};
    Controls controls = flight.controls;
    double worst = 0.0;
    for (int i = 0; i < (int)(LONG_FLIGHT_H * 3600 * 120); i++) {
        AutopilotWish circle = {.height_m = 3000.0, .heading_rad = 1e-4 * i, .speed_m_s = 50.0};
        if (i % 30 == 0)
            controls = autopilot_hold(&autopilot, &flight, &circle, 30 * FLIGHT_STEP_S);
        flight_step(&flight, &controls, FLIGHT_STEP_S);
        worst = fmax(worst, norm_error(flight.state.ecef_from_body));
    }
    FlightInstruments now = flight_instruments(&flight);
    print_message("worst |q| - 1 in %.1f h of circling: %g; %.1f m high\n", LONG_FLIGHT_H, worst, now.h_m);
    assert_true(worst < 1e-12 && flight_is_finite(&flight.state) && fabs(now.h_m - 3000.0) < 50.0);
}

static void extreme_starts_stay_finite(void **state) {
    (void)state;
    double ground = 800.0;
    static const double speeds[] = {0.0, 1e-9, 5.0, 340.0, 10000.0, 20000.0};
    static const double pitches[] = {-0.5 * GEODESY_PI, -0.3, 0.0, 0.5 * GEODESY_PI};
    for (size_t i = 0; i < COUNT_OF(speeds) * COUNT_OF(pitches) * 3; i++) {
        Aircraft a = flight_type(flight_types[i % 3]);
        double speed = speeds[i / 3 % COUNT_OF(speeds)], pitch = pitches[i / 3 / COUNT_OF(speeds)];
        Flight flight = flight_at(&a, 5000.0, 0.0, pitch, speed, (FlightGround){flight_flat, &ground});
        flight_on(&flight, (Controls){.elevator = 0.7, .aileron = -0.4, .rudder = 0.3, .throttle = 1.0}, 20.0);
    }
}

// Backwards, sideways, from below: at no speed and at any.
static void every_direction_of_flow_is_finite(void **state) {
    (void)state;
    for (int i = 0; i < 26 * 6; i++) {
        Aircraft a = flight_type(flight_types[i % 3]);
        Flight flight = flight_in_air(&a, 3000.0, 50.0);
        Vec3d to = {i % 26 % 3 - 1, i % 26 / 3 % 3 - 1, i % 26 / 9 - 1};
        double speed = i < 78 ? 60.0 : 1e-3;
        flight.state.velocity_ecef = quatd_rotate(flight.state.ecef_from_body, vec3d_scale(vec3d_normalize(to), speed));
        flight_on(&flight, flight.controls, 10.0);
    }
}

static void every_pole_and_meridian_can_be_flown_over(void **state) {
    (void)state;
    static const double lats[] = {GEODESY_PI / 2.0, -GEODESY_PI / 2.0, GEODESY_PI / 2.0 - 1e-4, 0.0};
    Aircraft a = flight_type("t37");
    for (size_t i = 0; i < COUNT_OF(lats); i++) {
        FlightStart start = {.lat_rad = lats[i], .lon_rad = GEODESY_PI, .h_m = 1000.0, .speed_m_s = 150.0};
        Flight flight = flight_create(&a, &start, (FlightGround){flight_nowhere, NULL});
        flight_on(&flight, flight.controls, 60.0);
        FlightInstruments now = flight_instruments(&flight);
        if (fabs(now.h_m - 1000.0) > 0.5)
            fail_msg("from latitude %.4f rad: %.1f m high after a minute, from 1000 m", lats[i], now.h_m);
    }
}

static void a_start_under_ground_is_raised(void **state) {
    (void)state;
    double ground = 1234.0;
    Aircraft a = flight_type("t37");
    Flight flight = flight_at(&a, -500.0, 0.0, 0.0, 100.0, (FlightGround){flight_flat, &ground});
    FlightInstruments now = flight_instruments(&flight);
    assert_true(now.over_ground && now.above_ground_m >= 30.0);
    flight_on(&flight, flight.controls, 1.0);
    assert_int_equal(flight.state.contact, FLIGHT_AIRBORNE);
}

// Hands off, until ailerons would be wanted.
static void a_start_with_bank_is_a_steady_turn(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT_OF(flight_types) * 2; i++) {
        Aircraft a = flight_type(flight_types[i / 2]);
        const double bank_rad = i % 2 ? -0.7 : 0.7, speed_m_s = a.cruise_speed;
        const FlightStart start = {.lat_rad = FLIGHT_LAT,
                                   .lon_rad = FLIGHT_LON,
                                   .h_m = 1000.0,
                                   .heading_rad = 3.0,
                                   .speed_m_s = speed_m_s,
                                   .bank_rad = bank_rad};
        Flight flight = flight_create(&a, &start, (FlightGround){flight_nowhere, NULL});
        assert_true(flight.trimmed);
        const FlightInstruments begin = flight_instruments(&flight);
        flight_on(&flight, flight.controls, 1.0);
        const FlightInstruments now = flight_instruments(&flight);
        double turned = now.track_rad - begin.track_rad, wanted = 9.8 * tan(bank_rad) / (speed_m_s * cos(now.path_rad));
        print_message("%s: load %.4f, then %.4f; path %.4f, %.4f; bank %.4f, %.4f; slip %.4f; turned %.4f of %.4f\n",
                      a.id, begin.load_factor, now.load_factor, begin.path_rad, now.path_rad, begin.bank_rad,
                      now.bank_rad, now.beta_rad, turned, wanted);
        assert_true(fabs(begin.bank_rad - bank_rad) < 1e-9 && fabs(begin.beta_rad) < 1e-9);
        assert_true(fabs(begin.load_factor - 1.0 / cos(bank_rad)) < 0.02);
        assert_true(fabs(now.load_factor - begin.load_factor) < 0.03 && fabs(now.bank_rad - bank_rad) < 0.06);
        assert_true(fabs(turned / wanted - 1.0) < 0.03 && fabs(now.path_rad - begin.path_rad) < 0.02);
    }
}

static Flight stand(const Aircraft *aircraft, FlightGround ground) {
    FlightStart start = {.lat_rad = FLIGHT_LAT, .lon_rad = FLIGHT_LON, .on_ground = true, .heading_rad = 0.5};
    Flight flight = flight_create(aircraft, &start, ground);
    if (flight.state.contact != FLIGHT_ROLLING)
        fail_msg("%s does not stand", aircraft->id);
    return flight;
}

static void aircraft_stand_still_on_flat_and_sloping_ground(void **state) {
    (void)state;
    double ground = 300.0;
    for (size_t i = 0; i < COUNT_OF(flight_types) * 2; i++) {
        Aircraft a = flight_type(flight_types[i / 2]);
        Flight flight = stand(&a, i % 2 ? (FlightGround){rolling_ground, NULL} : (FlightGround){flight_flat, &ground});
        Vec3d from = flight.state.position_ecef;
        assert_int_equal(flight.state.step, 0);
        flight_on(&flight, (Controls){.brake_left = 1.0, .brake_right = 1.0}, 30.0);
        double crept = vec3d_distance(flight.state.position_ecef, from);
        FlightInstruments now = flight_instruments(&flight);
        print_message("%s crept %.4f m in 30 s%s; shows %.4f g, angles %.3f and %.3f\n", a.id, crept,
                      i % 2 ? " on a slope" : "", now.load_factor, now.alpha_rad, now.beta_rad);
        assert_true(fabs(now.load_factor - 1.0) < 0.02 && now.alpha_rad == 0.0 && now.beta_rad == 0.0);
        assert_int_equal(flight.state.contact, FLIGHT_ROLLING);
        assert_true(crept < (i % 2 ? 0.3 : 0.1));
    }
}

// Without engine and in no wind whatever the wheels do only takes energy, on flat ground to the last bit of the
// integration's error.
static void contact_never_adds_energy(void **state) {
    (void)state;
    double ground = 300.0;
    for (size_t i = 0; i < COUNT_OF(flight_types); i++) {
        Aircraft a = flight_type(flight_types[i]);
        a.engine = AIRCRAFT_GLIDER;
        Flight flight = stand(&a, (FlightGround){flight_flat, &ground});
        Vec3d up = geodesy_up(FLIGHT_LAT, FLIGHT_LON),
              ahead = quatd_rotate(flight.state.ecef_from_body, vec3d(1, 0, 0));
        flight.state.position_ecef = vec3d_mad(flight.state.position_ecef, up, 0.15);
        flight.state.velocity_ecef = vec3d_mad(vec3d_scale(ahead, 12.0), up, -1.0);
        double before = energy(&flight), first = before, worst = 0.0;
        for (int k = 0; k < 120 * 40; k++) {
            flight_step(&flight, &(Controls){.brake_left = k > 1200, .brake_right = k > 1200}, FLIGHT_STEP_S);
            double after = energy(&flight);
            worst = fmax(worst, after - before);
            before = after;
        }
        print_message("%s: %.3f J/kg lost, at most %.3g J/kg won in a step\n", a.id, first - before, worst);
        assert_int_equal(flight.state.contact, FLIGHT_ROLLING);
        assert_true(worst < 2e-5 && first - before > 60.0);
    }
}

static void bumps_do_not_make_it_bounce_ever_higher(void **state) {
    (void)state;
    Aircraft a = flight_type("c172");
    Flight flight = stand(&a, (FlightGround){rolling_ground, NULL});
    double highest = 0.0;
    for (int k = 0; k < 120 * 60; k++) {
        flight_step(&flight, &(Controls){.throttle = 0.3, .rudder = 0.2 * sin(k * 0.01)}, FLIGHT_STEP_S);
        highest = fmax(highest, flight_instruments(&flight).above_ground_m);
    }
    FlightInstruments now = flight_instruments(&flight);
    print_message("taxied at %.1f m/s, at most %.2f m above ground\n", now.speed_m_s, highest);
    assert_int_equal(flight.state.contact, FLIGHT_ROLLING);
    assert_true(now.speed_m_s > 2.0 && now.speed_m_s < 40.0 && highest < 1.6);
}

static void a_gentle_touch_is_a_landing(void **state) {
    (void)state;
    double ground = 300.0;
    for (size_t i = 0; i < COUNT_OF(flight_types); i++) {
        Aircraft a = flight_type(flight_types[i]);
        double stall = sqrt(2.0 * a.mass * GRAVITY / (1.19 * a.area * a.cl_max));
        Flight flight = flight_at(&a, 362.0, 0.0, -0.05, 1.35 * stall, (FlightGround){flight_flat, &ground});
        Autopilot help = {.engaged = false};
        for (int k = 0; k < 120 * 120 && flight.state.contact != FLIGHT_CRASHED; k++) {
            FlightInstruments now = flight_instruments(&flight);
            double height = now.above_ground_m - 1.2, sink = -fmin(fmax(0.12 * height, 0.4), 3.0);
            bool rolling = flight.state.contact == FLIGHT_ROLLING;
            Controls pilot = {.throttle = 0.0, .brake_left = rolling, .brake_right = rolling};
            pilot.elevator = fmin(fmax(0.2 * (sink - now.vertical_speed_m_s), -0.3), 0.5);
            Controls controls = autopilot_assist(&help, &flight, &pilot, FLIGHT_STEP_S);
            if (rolling)
                controls.elevator = 0.0;
            flight_step(&flight, &controls, FLIGHT_STEP_S);
        }
        FlightInstruments now = flight_instruments(&flight);
        print_message("%s landed: %.3f m/s left, bank %.3f rad\n", a.id, now.speed_m_s, now.bank_rad);
        assert_int_equal(flight.state.contact, FLIGHT_ROLLING);
        assert_true(now.speed_m_s < 0.3);
    }
}

static void a_standing_aircraft_takes_off(void **state) {
    (void)state;
    double ground = 300.0;
    for (int i = 0; i < 2; i++) {
        Aircraft a = flight_type(flight_types[i]);
        Flight flight = stand(&a, (FlightGround){flight_flat, &ground});
        FlightInstruments now = flight_instruments(&flight);
        double lift_off_s = 0.0;
        for (int k = 0; k < 120 * 60; k++) {
            double stall = sqrt(2.0 * a.mass * GRAVITY / (1.19 * a.area * a.cl_max));
            Controls controls = {.throttle = 1.0};
            controls.elevator = now.speed_m_s > 1.1 * stall ? 2.0 * (0.14 - now.pitch_rad) : 0.0;
            flight_step(&flight, &controls, FLIGHT_STEP_S);
            now = flight_instruments(&flight);
            lift_off_s = flight.state.contact == FLIGHT_ROLLING ? k * FLIGHT_STEP_S : lift_off_s;
        }
        print_message("%s off the ground after %.1f s; 60 s after the brakes %.0f m above it, %.0f m/s\n", a.id,
                      lift_off_s, now.above_ground_m, now.speed_m_s);
        assert_int_equal(flight.state.contact, FLIGHT_AIRBORNE);
        assert_true(lift_off_s > 8.0 && lift_off_s < 40.0 && now.above_ground_m > 50.0);
    }
}

static void a_hard_touch_is_a_crash_and_starts_anew(void **state) {
    (void)state;
    double ground = 300.0;
    for (size_t i = 0; i < COUNT_OF(flight_types); i++) {
        Aircraft a = flight_type(flight_types[i]);
        Flight flight = flight_at(&a, 305.0, 0.0, 0.0, a.cruise_speed, (FlightGround){flight_flat, &ground});
        Vec3d up = geodesy_up(FLIGHT_LAT, FLIGHT_LON);
        flight.state.velocity_ecef = vec3d_mad(flight.state.velocity_ecef, up, -60.0);
        double before = energy(&flight);
        for (int k = 0; k < 120 * 60 && flight.state.contact != FLIGHT_CRASHED; k++)
            flight_step(&flight, &(Controls){.elevator = -0.1}, FLIGHT_STEP_S);
        assert_int_equal(flight.state.contact, FLIGHT_CRASHED);
        assert_true(vec3d_length(flight.state.velocity_ecef) == 0.0 && energy(&flight) < before);
        flight_on(&flight, (Controls){.throttle = 0.5}, FLIGHT_RESET_S + 0.02);
        FlightInstruments now = flight_instruments(&flight);
        assert_int_equal(flight.state.contact, FLIGHT_AIRBORNE);
        assert_true(now.above_ground_m > 200.0 && fabs(now.speed_m_s - a.cruise_speed) < 1.0);
    }
}

static void landing_with_the_wheels_up_is_a_crash(void **state) {
    (void)state;
    double ground = 300.0;
    Aircraft a = flight_type("t37");
    Flight flight = flight_at(&a, 361.0, 0.0, -0.03, 60.0, (FlightGround){flight_flat, &ground});
    for (int k = 0; k < 120 * 60 && flight.state.contact == FLIGHT_AIRBORNE; k++)
        flight_step(&flight, &(Controls){.trim = flight.controls.trim, .gear_up = true}, FLIGHT_STEP_S);
    assert_int_equal(flight.state.contact, FLIGHT_CRASHED);
}

static void fast_flight_does_not_pass_through_a_ridge(void **state) {
    (void)state;
    static const double speeds[] = {100.0, 1000.0, 10000.0, 20000.0};
    Aircraft a = flight_type("t37");
    for (size_t i = 0; i < COUNT_OF(speeds); i++) {
        Flight flight = flight_at(&a, 1000.0, 0.0, 0.0, speeds[i], (FlightGround){ridge_ground, NULL});
        for (int k = 0; k < 120 * 6 && flight.state.contact != FLIGHT_CRASHED; k++)
            flight_step(&flight, &flight.controls, FLIGHT_STEP_S);
        FlightInstruments now = flight_instruments(&flight);
        if (flight.state.contact != FLIGHT_CRASHED || (now.lat_rad - FLIGHT_LAT) * GEODESY_A_M > 341.0)
            fail_msg("%.0f m/s went through the wall", speeds[i]);
    }
}

static Vec3d fly_with_step(const Aircraft *a, double dt_s) {
    Flight flight = flight_at(a, 3000.0, 0.3, 0.0, 1.1 * a->cruise_speed, (FlightGround){flight_nowhere, NULL});
    Controls controls = flight.controls; // engine and surfaces as they are: no paces of theirs
    controls.elevator = 0.1;
    controls.aileron = 0.1;
    controls.rudder = 0.05;
    int steps = (int)(4.0 / dt_s + 0.5);
    for (int i = 0; i < steps; i++)
        flight_step(&flight, &controls, dt_s);
    return flight.state.position_ecef;
}

// Hard case 17: the error of a fourth-order step falls by 16 when the step is halved.
static void halving_the_step_converges_with_fourth_order(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        Aircraft a = flight_type(flight_types[i]);
        Vec3d best = fly_with_step(&a, 1.0 / 960.0);
        double coarse = vec3d_distance(fly_with_step(&a, 1.0 / 15.0), best);
        double fine = vec3d_distance(fly_with_step(&a, 1.0 / 30.0), best);
        double flown = vec3d_distance(fly_with_step(&a, FLIGHT_STEP_S), best);
        print_message("%s: errors after 4 s: %.3g m, %.3g m with half the step: factor %.1f; %.3g m with 1/120 s\n",
                      a.id, coarse, fine, coarse / fine, flown);
        assert_true(coarse / fine > 10.0 && coarse / fine < 30.0 && flown < 1e-4);
    }
}

static void the_same_steps_give_the_same_bits(void **state) {
    (void)state;
    Aircraft type = flight_type("c172");
    Flight a = flight_in_air(&type, 3000.0, 50.0), b = a;
    for (int i = 0; i < 5000; i++) {
        Controls controls = {.elevator = sin(i * 0.01), .aileron = cos(i * 0.013), .rudder = sin(i * 0.007)};
        flight_step(&a, &controls, FLIGHT_STEP_S);
        flight_step(&b, &controls, FLIGHT_STEP_S);
        assert_true(flight_state_hash(&a.state) == flight_state_hash(&b.state));
    }
}

// A state from bytes flies on as the one that was packed: nothing that matters is missing.
static void a_packed_state_flies_on_bit_by_bit(void **state) {
    (void)state;
    double ground = 0.0;
    Aircraft type = flight_type("t37");
    Flight a = flight_at(&type, 400.0, 1.0, 0.0, 100.0, (FlightGround){flight_flat, &ground}), b = a;
    for (int i = 0; i < 120 * 60; i++) {
        Controls controls = {.elevator = 0.5 * sin(i * 0.01),
                             .aileron = cos(i * 0.013),
                             .throttle = 0.5,
                             .flaps = i > 1200,
                             .gear_up = i < 2400};
        uint8_t bytes[FLIGHT_STATE_BYTES];
        assert_int_equal(flight_state_pack(&a.state, bytes), FLIGHT_STATE_BYTES);
        memset(&b.state, 0x5a, sizeof b.state);
        assert_int_equal(flight_state_unpack(bytes, &b.state), RESULT_OK);
        uint64_t hash = flight_state_hash(&b.state);
        flight_step(&a, &controls, FLIGHT_STEP_S);
        flight_step(&b, &controls, FLIGHT_STEP_S);
        if (flight_state_hash(&a.state) != flight_state_hash(&b.state) || flight_state_hash(&a.state) == hash)
            fail_msg("step %d: %016llx and %016llx", i, (unsigned long long)flight_state_hash(&a.state),
                     (unsigned long long)flight_state_hash(&b.state));
    }
    uint8_t bytes[FLIGHT_STATE_BYTES] = {[FLIGHT_STATE_BYTES - 2] = FLIGHT_CRASHED + 1};
    assert_int_equal(flight_state_unpack(bytes, &b.state), RESULT_FORMAT);
}

static void controls_act_within_a_step(void **state) {
    (void)state;
    Aircraft type = flight_type("c172");
    Flight a = flight_in_air(&type, 3000.0, 50.0), b = a;
    Controls pulled = a.controls;
    pulled.elevator = 0.2;
    flight_step(&a, &a.controls, FLIGHT_STEP_S);
    flight_step(&b, &pulled, FLIGHT_STEP_S);
    assert_true(b.state.rate_body.y > a.state.rate_body.y + 1e-4);
}

static void flaps_and_gear_move_at_their_pace(void **state) {
    (void)state;
    Aircraft a = flight_type("t37");
    Flight flight = flight_in_air(&a, 2000.0, 80.0);
    assert_true(flight.state.gear == 0.0 && flight.state.flaps == 0.0);
    flight_on(&flight, (Controls){.throttle = 0.5, .flaps = 1.0, .trim = flight.controls.trim}, 0.5 * a.gear_s);
    assert_true(fabs(flight.state.gear - 0.5) < 1e-6 && fabs(flight.state.flaps - 0.5 * a.gear_s / a.flaps_s) < 1e-6);
    flight_on(&flight, (Controls){.throttle = 0.5, .flaps = 1.0, .trim = flight.controls.trim}, a.gear_s);
    assert_true(flight.state.gear == 1.0 && flight.state.flaps == 1.0);
}

static void wind_carries_the_aircraft_along(void **state) {
    (void)state;
    Aircraft a = flight_type("c172");
    Flight still = flight_in_air(&a, 2000.0, 50.0), windy = still;
    Mat3d enu = geodesy_enu_from_ecef(FLIGHT_LAT, FLIGHT_LON);
    windy.wind_ecef = vec3d_scale((Vec3d){enu.m[0][0], enu.m[0][1], enu.m[0][2]}, 10.0);
    windy.state.velocity_ecef = vec3d_add(windy.state.velocity_ecef, windy.wind_ecef);
    flight_on(&still, still.controls, 20.0);
    flight_on(&windy, windy.controls, 20.0);
    double carried = vec3d_distance(still.state.position_ecef, windy.state.position_ecef);
    assert_true(fabs(carried - 200.0) < 0.1);
    assert_true(fabs(flight_instruments(&windy).true_airspeed - 50.0) < 0.01);
}

static void time_comes_in_whole_steps_and_spikes_are_cut(void **state) {
    (void)state;
    FlightClock clock = flight_clock_create(FLIGHT_CLOCK_NORMAL);
    int64_t steps = 0;
    for (int i = 0; i < 3600; i++)
        steps += flight_clock_steps(&clock, 1.0 / 60.0, FLIGHT_STEP_S);
    assert_int_equal(steps, 7200);
    assert_int_equal(flight_clock_steps(&clock, 5.0, FLIGHT_STEP_S), (int)(FLIGHT_CLOCK_SPIKE_S / FLIGHT_STEP_S));
    for (int i = 0; i < 10; i++)
        flight_clock_change_rate(&clock, 1);
    assert_true(flight_clock_rate(&clock) == 16.0);
    int spike = flight_clock_steps(&clock, 5.0, FLIGHT_STEP_S);
    assert_true(spike >= 479 && spike <= 481);
    clock.paused = true;
    assert_int_equal(flight_clock_steps(&clock, 5.0, FLIGHT_STEP_S), 0);
    clock.paused = false;
    assert_int_equal(flight_clock_steps(&clock, -1.0, FLIGHT_STEP_S), 0);
    for (int i = 0; i < 20; i++)
        flight_clock_change_rate(&clock, -1);
    assert_true(flight_clock_rate(&clock) == 0.25);
}

static void heading_pitch_and_bank_come_back_from_attitudes(void **state) {
    (void)state;
    Aircraft a = flight_type("t37");
    for (int i = 0; i < 200; i++) {
        double heading = fmod(0.37 * i, 2.0 * GEODESY_PI), pitch = 1.5 * sin(0.9 * i), bank = 3.1 * sin(0.51 * i);
        Flight flight = flight_in_air(&a, 1000.0, 100.0);
        flight.state.ecef_from_body = flight_attitude(FLIGHT_LAT, FLIGHT_LON, heading, pitch, bank);
        FlightInstruments now = flight_instruments(&flight);
        if (fabs(remainder(now.heading_rad - heading, 2 * GEODESY_PI)) > 1e-9 || fabs(now.pitch_rad - pitch) > 1e-9 ||
            fabs(remainder(now.bank_rad - bank, 2 * GEODESY_PI)) > 1e-9)
            fail_msg("heading %.6f pitch %.6f bank %.6f came back as %.6f %.6f %.6f", heading, pitch, bank,
                     now.heading_rad, now.pitch_rad, now.bank_rad);
    }
}

int main(void) {
    feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trimmed_flight_drifts_little_in_an_hour),
        cmocka_unit_test(a_banked_turn_is_coordinated_and_level),
        cmocka_unit_test(loops_rolls_and_spins_stay_finite_and_normalised),
        cmocka_unit_test(a_loop_goes_through_the_vertical),
        cmocka_unit_test(a_stall_with_rudder_becomes_a_spin_and_ends_when_told_to),
        cmocka_unit_test(the_quaternion_holds_over_ten_hours),
        cmocka_unit_test(extreme_starts_stay_finite),
        cmocka_unit_test(every_direction_of_flow_is_finite),
        cmocka_unit_test(every_pole_and_meridian_can_be_flown_over),
        cmocka_unit_test(a_start_under_ground_is_raised),
        cmocka_unit_test(a_start_with_bank_is_a_steady_turn),
        cmocka_unit_test(aircraft_stand_still_on_flat_and_sloping_ground),
        cmocka_unit_test(contact_never_adds_energy),
        cmocka_unit_test(bumps_do_not_make_it_bounce_ever_higher),
        cmocka_unit_test(a_gentle_touch_is_a_landing),
        cmocka_unit_test(a_standing_aircraft_takes_off),
        cmocka_unit_test(a_hard_touch_is_a_crash_and_starts_anew),
        cmocka_unit_test(landing_with_the_wheels_up_is_a_crash),
        cmocka_unit_test(fast_flight_does_not_pass_through_a_ridge),
        cmocka_unit_test(halving_the_step_converges_with_fourth_order),
        cmocka_unit_test(the_same_steps_give_the_same_bits),
        cmocka_unit_test(a_packed_state_flies_on_bit_by_bit),
        cmocka_unit_test(controls_act_within_a_step),
        cmocka_unit_test(flaps_and_gear_move_at_their_pace),
        cmocka_unit_test(wind_carries_the_aircraft_along),
        cmocka_unit_test(time_comes_in_whole_steps_and_spikes_are_cut),
        cmocka_unit_test(heading_pitch_and_bank_come_back_from_attitudes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
