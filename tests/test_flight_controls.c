// Keys to controls, actions to settings, demos to controls: what a person or a demo does with the aircraft.
#define _DEFAULT_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>
#include <math.h>

#include "app/aircraft/airframe.h"
#include "app/aircraft/isa.h"
#include "app/demo/demo.h"
#include "app/flight/flight_session.h"
#include "app/flight/flight_settings.h"
#include "app/flight/runway.h"
#include "app/pipeline/frame_times.h"
#include "base/clock.h"
#include "base/paths.h"
#include "input/keyboard.h"
#include "terrain/geodesy.h"
#include "tests/heard.h"

#define STEP (1.0 / 120.0)

static Controls hold(Keyboard *keyboard, double seconds) {
    Controls controls = keyboard->controls;
    for (int i = 0; i < (int)(seconds / STEP + 0.5); i++)
        controls = keyboard_sample(keyboard, STEP);
    return controls;
}

static void the_stick_deflects_while_held_and_centres_when_let_go(void **state) {
    (void)state;
    Keyboard keyboard = keyboard_create(0.4);
    keyboard_on_key(&keyboard, KEY_DOWN, true, false);
    keyboard_on_key(&keyboard, KEY_RIGHT, true, false);
    Controls half = hold(&keyboard, 0.5 * KEYBOARD_STICK_S);
    assert_true(half.elevator > 0.4 && half.elevator < 0.6 && half.aileron > 0.4 && half.aileron < 0.6);
    Controls full = hold(&keyboard, 2.0);
    assert_true(full.elevator == 1.0 && full.aileron == 1.0);
    keyboard_on_key(&keyboard, KEY_DOWN, false, false);
    keyboard_on_key(&keyboard, KEY_RIGHT, false, true); // shift came down in between
    Controls centred = hold(&keyboard, KEYBOARD_CENTRE_S + STEP);
    assert_true(centred.elevator == 0.0 && centred.aileron == 0.0 && centred.throttle == 0.4);
    assert_false(keyboard_touches_controls(&keyboard));
}

static void opposite_keys_cancel_and_repeats_do_not_stick(void **state) {
    (void)state;
    Keyboard keyboard = keyboard_create(0.0);
    for (int i = 0; i < 5; i++)
        keyboard_on_key(&keyboard, KEY_LEFT, true, false);
    keyboard_on_key(&keyboard, KEY_PAD_6, true, false);
    assert_true(hold(&keyboard, 1.0).aileron == 0.0);
    keyboard_on_key(&keyboard, KEY_PAD_6, false, false);
    assert_true(hold(&keyboard, 1.0).aileron == -1.0);
    keyboard_on_key(&keyboard, KEY_LEFT, false, false);
    keyboard_on_key(&keyboard, KEY_LEFT, false, false);
    assert_true(hold(&keyboard, 1.0).aileron == 0.0);
    keyboard_on_key(&keyboard, -1, true, false);
    keyboard_on_key(&keyboard, 9999, true, false);
    assert_false(keyboard_touches_controls(&keyboard));
}

// As if springs held the pedals.
static void the_rudder_deflects_slowly_while_held_and_centres_when_let_go(void **state) {
    (void)state;
    Keyboard keyboard = keyboard_create(0.0);
    keyboard_on_key(&keyboard, KEY_ENTER, true, false);
    Controls half = hold(&keyboard, 0.5 * KEYBOARD_RUDDER_S);
    assert_true(half.rudder > 0.45 && half.rudder < 0.55);
    assert_true(hold(&keyboard, 1.0).rudder == 1.0);
    keyboard_on_key(&keyboard, KEY_ENTER, false, false);
    keyboard_on_key(&keyboard, '0', true, false); // the other way: back to the middle as fast as let go
    Controls other = hold(&keyboard, KEYBOARD_CENTRE_S + 0.5 * KEYBOARD_RUDDER_S);
    assert_true(other.rudder < -0.45 && other.rudder > -0.55);
    keyboard_on_key(&keyboard, '0', false, false);
    assert_true(hold(&keyboard, 0.5 * KEYBOARD_CENTRE_S + STEP).rudder == 0.0);
}

static void throttle_stays_until_changed(void **state) {
    (void)state;
    Keyboard keyboard = keyboard_create(0.9);
    keyboard_on_key(&keyboard, KEY_ENTER, true, false);
    keyboard_on_key(&keyboard, KEY_PAGE_UP, true, false);
    hold(&keyboard, 0.5);
    keyboard_on_key(&keyboard, KEY_PAGE_UP, false, false);
    Controls later = hold(&keyboard, 3.0);
    assert_true(later.rudder == 1.0 && later.throttle == 1.0);
    keyboard_centre(&keyboard); // at once, whatever is held
    assert_true(keyboard.controls.rudder == 0.0 && keyboard.controls.throttle == 1.0);
}

static void presses_come_in_order_and_shift_matters(void **state) {
    (void)state;
    Keyboard keyboard = keyboard_create(0.0);
    static const struct {
        int key;
        bool shift;
        Action action;
    } presses[] = {
        {'T', false, ACTION_FINER},   {'T', true, ACTION_COARSER},      {'V', true, ACTION_VIEW_PREVIOUS},
        {'X', true, ACTION_ZOOM_OUT}, {'A', true, ACTION_TIME_SLOWER},  {'P', false, ACTION_PAUSE},
        {'5', false, ACTION_CENTRE},  {'M', true, ACTION_METHOD_RIGHT}, {KEY_F3, false, ACTION_SCREENSHOT},
        {KEY_F1, false, ACTION_HELP}, {'L', false, ACTION_COLOURING},   {KEY_ESCAPE, false, ACTION_LEAVE},
    };
    for (size_t i = 0; i < COUNT_OF(presses); i++) {
        keyboard_on_key(&keyboard, presses[i].key, true, presses[i].shift);
        keyboard_on_key(&keyboard, presses[i].key, false, presses[i].shift);
    }
    keyboard_on_key(&keyboard, 'Q', true, false);
    for (size_t i = 0; i < COUNT_OF(presses); i++)
        assert_int_equal(keyboard_next_action(&keyboard), presses[i].action);
    assert_int_equal(keyboard_next_action(&keyboard), ACTION_NONE);
}

static void every_action_has_keys_and_help(void **state) {
    (void)state;
    for (int i = 0; i < ACTION_COUNT; i++) {
        assert_non_null(action_keys((Action)i));
        assert_true(strlen(action_help((Action)i)) > 3);
        bool bound = false;
        for (int key = 0; key < 400 && !bound; key++)
            bound = (int)action_of_key(key, false) == i || (int)action_of_key(key, true) == i ||
                    (int)action_of_replay_key(key, 0) == i || (int)action_of_replay_key(key, KEY_SHIFT) == i ||
                    (int)action_of_replay_key(key, KEY_CONTROL) == i;
        if (!bound)
            fail_msg("no key does '%s'", action_help((Action)i));
    }
}

// The corner of the picture sees a pixel at the angle that projecting two neighbouring pixels gives.
static void the_corner_of_a_picture_sees_smaller_angles(void **state) {
    (void)state;
    for (double fov_deg = 5.0; fov_deg < 140.0; fov_deg += 15.0) {
        double fov_rad = fov_deg * GEODESY_RAD_PER_DEG, width = 1280.0, height = 800.0;
        double focal = camera_px_per_rad(fov_rad, width, height, false);
        assert_true(fabs(2.0 * atan(height / 2.0 / focal) - fov_rad) < 1e-12);
        double corner_px = hypot(width / 2.0, height / 2.0), step_px = 1e-3;
        double radians = atan((corner_px + step_px) / focal) - atan((corner_px - step_px) / focal);
        double expected = 2.0 * step_px / radians, found = camera_px_per_rad(fov_rad, width, height, true);
        if (fabs(found / expected - 1.0) > 1e-6)
            fail_msg("%.0f degrees: expected %.9g px/rad, found %.9g", fov_deg, expected, found);
    }
}

static FlightSettings default_settings(void) {
    Options *options = NULL;
    assert_int_equal(options_create(COMMAND_FLY, &options), RESULT_OK);
    FlightSettings settings = flight_settings_create(options);
    options_destroy(&options);
    return settings;
}

static void options_name_the_methods_that_there_are(void **state) {
    (void)state;
    char names[256] = "";
    for (int i = 0; i < LOD_METHOD_COUNT; i++) {
        strcat(names, i ? "|" : "");
        strcat(names, lod_method_name((LodMethod)i));
    }
    assert_string_equal(option_spec(OPTION_METHOD)->choices, names);
    assert_string_equal(option_spec(OPTION_COMPARE)->choices, names);
    assert_string_equal(option_spec(OPTION_AIRCRAFT)->default_text, AIRCRAFT_DEFAULT);
}

static void a_governed_flight_gets_more_time_for_finer(void **state) {
    (void)state;
    char message[64];
    FlightSettings settings = default_settings();
    assert_true(settings.target_ms == 0.0);
    settings.target_ms = 16.0;
    for (int i = 0; i < 3; i++)
        assert_true(flight_settings_apply(&settings, ACTION_FINER, message, sizeof message));
    assert_true(fabs(settings.target_ms - 32.0) < 1e-9 && settings.tau_px == 1.0);
    assert_string_equal(message, "target 32.0 ms a frame");
    for (int i = 0; i < 99; i++)
        flight_settings_apply(&settings, ACTION_COARSER, message, sizeof message);
    assert_true(settings.target_ms == 1.0);
}

static void keys_change_what_they_say(void **state) {
    (void)state;
    char message[64];
    FlightSettings settings = default_settings();
    assert_true(settings.tau_px == 1.0 && settings.method == LOD_HYBRID && settings.show_numbers);
    for (int i = 0; i < 3; i++)
        assert_true(flight_settings_apply(&settings, ACTION_FINER, message, sizeof message));
    assert_true(fabs(settings.tau_px - 0.5) < 1e-12);
    assert_non_null(strstr(message, "0.50"));
    for (int i = 0; i < 99; i++)
        flight_settings_apply(&settings, ACTION_COARSER, message, sizeof message);
    assert_true(settings.tau_px == 64.0);
    for (int i = 0; i < 99; i++)
        flight_settings_apply(&settings, ACTION_ZOOM_IN, message, sizeof message);
    assert_true(settings.fov_rad > 0.03 && settings.fov_rad < 0.04);
    for (int i = 0; i < LOD_METHOD_COUNT; i++)
        flight_settings_apply(&settings, ACTION_METHOD, message, sizeof message);
    assert_int_equal(settings.method, LOD_HYBRID);
    assert_true(flight_settings_apply(&settings, ACTION_METHOD_RIGHT, message, sizeof message));
    assert_string_equal(message, "press c to see two methods");
    flight_settings_apply(&settings, ACTION_METHOD, message, sizeof message);
    flight_settings_apply(&settings, ACTION_COMPARE, message, sizeof message);
    assert_true(settings.compare && settings.method == LOD_PATCH && settings.right == LOD_ROAM);
    assert_string_equal(message, "left: patch, right: roam");
    for (int i = 0; i < LOD_METHOD_COUNT + 1; i++)
        flight_settings_apply(&settings, ACTION_METHOD_RIGHT, message, sizeof message);
    assert_true(settings.method == LOD_PATCH && settings.right == LOD_ROAM_PARALLEL);
    flight_settings_apply(&settings, ACTION_COMPARE, message, sizeof message);
    assert_false(settings.compare);
    flight_settings_apply(&settings, ACTION_VIEW_PREVIOUS, message, sizeof message);
    assert_int_equal(settings.view, CAMERA_DOWN);
    flight_settings_apply(&settings, ACTION_VIEW_NEXT, message, sizeof message);
    assert_int_equal(settings.view, CAMERA_COCKPIT);
    flight_settings_apply(&settings, ACTION_HUD, message, sizeof message);
    assert_true(settings.show_flight && !settings.show_numbers);
    flight_settings_apply(&settings, ACTION_HUD, message, sizeof message);
    assert_true(!settings.show_flight && !settings.show_numbers);
    flight_settings_apply(&settings, ACTION_HUD, message, sizeof message);
    assert_true(settings.show_flight && settings.show_numbers);
    flight_settings_apply(&settings, ACTION_TIME_FASTER, message, sizeof message);
    assert_string_equal(message, "time 2 \xC3\x97");
    assert_false(flight_settings_apply(&settings, ACTION_LEAVE, message, sizeof message));
    assert_string_equal(message, "");
}

static void a_method_that_cannot_come_is_told_once(void **state) {
    (void)state;
    FlightSession session = {.settings = default_settings()};
    MethodChanges changes = {.changes = 3};
    session_hear_changes(&session, &changes, LOD_PATCH);
    assert_string_equal(session.message, "");
    changes.refusals = 1;
    changes.refused = LOD_ROAM;
    changes.refusal = RESULT_MEMORY;
    session_hear_changes(&session, &changes, LOD_PATCH);
    assert_string_equal(session.message, "roam: out of memory; flying on with patch");
    assert_true(session.message_s > 0.0);
    session_say(&session, "something else");
    session_hear_changes(&session, &changes, LOD_PATCH);
    assert_string_equal(session.message, "something else");
}

static bool hilly_ground(void *user, double lat_rad, double lon_rad, double *h_m) {
    (void)user;
    *h_m = 600.0 + 500.0 * sin(lat_rad * 3000.0) * cos(lon_rad * 2500.0);
    return true;
}

static void a_demo_reaches_its_places_without_touching_the_ground(void **state) {
    (void)state;
    Demo demo = {.clearance_m = 120.0, .count = 6};
    for (int i = 0; i < demo.count; i++)
        demo.waypoints[i] = (Waypoint){0.64 + 0.001 * sin(i * 1.7), -1.47 + 0.0013 * cos(i * 2.3), 500.0, 110.0};
    Aircraft aircraft;
    assert_int_equal(aircraft_load(AIRCRAFT_DEFAULT, &aircraft), RESULT_OK);
    FlightStart start = {.lat_rad = 0.64, .lon_rad = -1.47, .h_m = 1500.0, .speed_m_s = 110.0};
    Flight flight = flight_create(&aircraft, &start, (FlightGround){hilly_ground, NULL});
    double lowest = 1e9;
    int steps = 0;
    for (; !demo_is_over(&demo) && steps < 120 * 1200; steps++) {
        Controls controls = demo_fly(&demo, &flight, STEP);
        flight_step(&flight, &controls, STEP);
        lowest = fmin(lowest, flight_instruments(&flight).above_ground_m);
        assert_int_not_equal(flight.state.contact, FLIGHT_CRASHED);
    }
    print_message("%d places in %.0f s, never below %.0f m\n", demo.next, steps * STEP, lowest);
    assert_int_equal(demo.next, demo.count);
    assert_true(lowest > 30.0);
}

// A ridge across the way, 6 km ahead, as high as the user says above the plain, rising by 45 degrees.
static bool ridge_ground(void *user, double lat_rad, double lon_rad, double *h_m) {
    double ahead_m = (lat_rad - 0.64) * GEODESY_A_M, high_m = *(const double *)user;
    (void)lon_rad;
    *h_m = 200.0 + fmax(high_m - fabs(ahead_m - 6000.0), 0.0);
    return true;
}

typedef struct Held {
    double lowest_m, warned_s, turned_rad, highest_m; // above ground; before the lowest; at most
    FlightInstruments end;
    bool crashed;
} Held;

// Holds what it begins with, straight on.
static Held hold_for(const Aircraft *aircraft, const FlightStart *start, FlightGround ground, double seconds) {
    Flight flight = flight_create(aircraft, start, ground);
    FlightInstruments now = flight_instruments(&flight);
    const AutopilotWish held = {.height_m = now.h_m, .heading_rad = now.heading_rad, .speed_m_s = now.speed_m_s};
    TerrainWatch watch = terrain_watch_begin(&flight);
    Autopilot autopilot = {.engaged = false};
    Held out = {.lowest_m = INFINITY, .warned_s = INFINITY};
    double lowest_s = 0.0;
    for (int i = 0; i < (int)(seconds / STEP) && flight.state.contact != FLIGHT_CRASHED; i++) {
        AutopilotWish wish = held;
        terrain_watch_change(&watch, &flight, &wish);
        Controls controls = autopilot_hold(&autopilot, &flight, &wish, STEP);
        flight_step(&flight, &controls, STEP);
        if (watch.ahead)
            out.warned_s = fmin(out.warned_s, i * STEP);
        out.turned_rad = fmax(out.turned_rad, fabs(watch.turn_rad));
        if (i % 12 != 0)
            continue;
        now = flight_instruments(&flight);
        lowest_s = now.above_ground_m < out.lowest_m ? i * STEP : lowest_s;
        out.lowest_m = fmin(out.lowest_m, now.over_ground ? now.above_ground_m : INFINITY);
        out.highest_m = fmax(out.highest_m, now.h_m);
    }
    out.warned_s = lowest_s - out.warned_s;
    out.end = flight_instruments(&flight);
    out.crashed = flight.state.contact == FLIGHT_CRASHED;
    return out;
}

static void a_hold_flies_over_a_ridge_or_turns_away_until_it_can(void **state) {
    (void)state;
    static const struct {
        const char *aircraft;
        double ridge_m, seconds;
        bool turns;
    } KINDS[] = {{"c172", 400.0, 160.0, false},
                 {"t37", 700.0, 80.0, false},
                 {"c172", 800.0, 500.0, true},
                 {"t37", 3000.0, 350.0, true}};
    for (size_t i = 0; i < COUNT_OF(KINDS); i++) {
        Aircraft aircraft;
        double ridge_m = KINDS[i].ridge_m;
        assert_int_equal(aircraft_load(KINDS[i].aircraft, &aircraft), RESULT_OK);
        FlightStart start = {.lat_rad = 0.64, .lon_rad = -1.47, .h_m = 500.0, .speed_m_s = aircraft.cruise_speed};
        Held held = hold_for(&aircraft, &start, (FlightGround){ridge_ground, &ridge_m}, KINDS[i].seconds);
        double north_m = (held.end.lat_rad - 0.64) * GEODESY_A_M;
        print_message("%s, ridge of %.0f m: never below %.0f m, warned %.0f s before, turned by %.2f rad; at the end "
                      "%.0f m north\n",
                      aircraft.id, ridge_m, held.lowest_m, held.warned_s, held.turned_rad, north_m);
        assert_true(!held.crashed && held.lowest_m > 40.0 && north_m > 7000.0);
        assert_true(held.warned_s > 30.0 && held.highest_m > ridge_m + 200.0);
        assert_int_equal(held.turned_rad > 0.0, KINDS[i].turns);
    }
}

// Re-simulation, as a replay needs it: the recorded controls again, over the real terrain; a machine under sanitizers
// or many other jobs is given time.
static void re_simulation_is_far_faster_than_time(void **state) {
    (void)state;
    static FlightSession session; // too big for some stacks
    Options *options = NULL;
    World world;
    assert_int_equal(options_create(COMMAND_FLY, &options), RESULT_OK);
    assert_int_equal(options_set(options, OPTION_DEMO, "yes", SOURCE_COMMAND_LINE, "test"), RESULT_OK);
    assert_int_equal(world_load(options, &world), RESULT_OK);
    assert_int_equal(session_create(&world, options, &session), RESULT_OK);
    enum { STEPS = 120 * 120 };
    static Controls flown[STEPS];
    Flight again = session.flight;
    for (int i = 0; i < STEPS; i++) {
        flown[i] = demo_fly(&session.demo, &session.flight, STEP);
        flight_step(&session.flight, &flown[i], STEP);
    }
    int64_t begin_ns = clock_now_ns();
    for (int i = 0; i < STEPS; i++)
        flight_step(&again, &flown[i], STEP);
    double factor = STEPS * STEP / (1e-9 * (double)(clock_now_ns() - begin_ns));
    print_message("%.0f times real time, %.2f us a step; hash %016llx\n", factor, 1e6 * STEP / factor,
                  (unsigned long long)flight_state_hash(&again.state));
    assert_true(flight_state_hash(&again.state) == flight_state_hash(&session.flight.state));
    assert_true(factor > 200.0 && again.state.contact == FLIGHT_AIRBORNE);
    world_unload(&world);
    options_destroy(&options);
}

typedef struct Started {
    Options *options;
    World world;
    FlightSession session; // too big for some stacks
} Started;

static Started *start_with(OptionId option, const char *value, OptionId other, const char *other_value) {
    Started *out = calloc(1, sizeof *out);
    assert_non_null(out);
    assert_int_equal(options_create(COMMAND_FLY, &out->options), RESULT_OK);
    assert_int_equal(options_set(out->options, option, value, SOURCE_COMMAND_LINE, "test"), RESULT_OK);
    assert_int_equal(options_set(out->options, other, other_value, SOURCE_COMMAND_LINE, "test"), RESULT_OK);
    assert_int_equal(world_load(out->options, &out->world), RESULT_OK);
    assert_int_equal(session_create(&out->world, out->options, &out->session), RESULT_OK);
    return out;
}

static void leave(Started *started) {
    session_end(&started->session);
    world_unload(&started->world);
    options_destroy(&started->options);
    free(started);
}

// Low, towards the mountains, with either engine.
static void a_hold_never_flies_into_the_default_scene(void **state) {
    (void)state;
    Started *started = start_with(OPTION_ASSIST, "no", OPTION_AIRCRAFT, AIRCRAFT_DEFAULT);
    static const char *const KINDS[] = {"c172", "t37"};
    for (int i = 0; i < 8; i++) {
        Aircraft aircraft;
        assert_int_equal(aircraft_load(KINDS[i % 2], &aircraft), RESULT_OK);
        FlightStart start = {.lat_rad = 36.59 * GEODESY_RAD_PER_DEG,
                             .lon_rad = -84.245 * GEODESY_RAD_PER_DEG,
                             .heading_rad = GEODESY_PI * (1.0 + i / 8.0),
                             .speed_m_s = aircraft.cruise_speed};
        Held held = hold_for(&aircraft, &start, session_ground(&started->world), 80.0);
        print_message("%s, heading %.0f: never below %.0f m, turned by %.2f rad, at most %.0f m high\n", aircraft.id,
                      start.heading_rad / GEODESY_RAD_PER_DEG, held.lowest_m, held.turned_rad, held.highest_m);
        assert_true(!held.crashed && held.lowest_m > 20.0);
    }
    leave(started);
}

static void a_scene_starts_with_speed_to_spare_where_the_air_is_thin(void **state) {
    (void)state;
    Started *high = start_with(OPTION_EYE, "36.5,-84.2,12000m", OPTION_AIRCRAFT, AIRCRAFT_DEFAULT);
    FlightInstruments now = flight_instruments(&high->session.flight);
    double stall = airframe_stall_speed(&high->session.aircraft, isa_at(now.h_m).density, 0.0);
    print_message("%.1f m/s at %.0f m, where the stall comes at %.1f\n", now.true_airspeed, now.h_m, stall);
    assert_true(high->session.flight.trimmed && now.true_airspeed > 1.49 * stall);
    leave(high);
}

// Its engine alone would roll it off.
static void on_the_ground_it_stands_until_the_throttle_is_moved(void **state) {
    (void)state;
    Started *started = start_with(OPTION_ON_GROUND, "yes", OPTION_AIRCRAFT, AIRCRAFT_DEFAULT);
    FlightSession *session = &started->session;
    Vec3d from = session->flight.state.position_ecef;
    for (int i = 0; i < 60 * 20; i++)
        session_advance(session, 1.0 / 60.0);
    double crept_m = vec3d_distance(session->flight.state.position_ecef, from);
    session_on_key(session, KEY_PAGE_UP, true, false);
    for (int i = 0; i < 60 * 8; i++)
        session_advance(session, 1.0 / 60.0);
    double rolled_m = vec3d_distance(session->flight.state.position_ecef, from);
    print_message("%.3f m in 20 s at idle, %.1f m after 8 s of throttle\n", crept_m, rolled_m);
    assert_true(crept_m < 0.3 && rolled_m > 1.0 && !session->parked);
    leave(started);
}

static const RenderHud *told(FlightSession *session) {
    static FrameOrder order; // too big for some stacks
    session_order(session, 640, 400, 0.0, 0.0, &order);
    return &order.look.hud;
}

// Of hands and feet; what an autopilot does with the surfaces is no news.
static void the_display_tells_rudder_and_trim_that_the_pilot_holds(void **state) {
    (void)state;
    Started *started = start_with(OPTION_ASSIST, "no", OPTION_AIRCRAFT, AIRCRAFT_DEFAULT);
    FlightSession *session = &started->session;
    session_on_key(session, '0', true, false);
    session_on_key(session, KEY_END, true, false);
    double trim = told(session)->trim;
    session_advance(session, 0.25);
    assert_true(fabs(told(session)->rudder + 0.25 / KEYBOARD_RUDDER_S) < 0.02);
    assert_true(fabs(told(session)->trim - trim - 0.25 / KEYBOARD_TRIM_S) < 2e-3);
    session_on_key(session, '0', false, false);
    session_on_key(session, KEY_END, false, false);
    session_advance(session, KEYBOARD_CENTRE_S);
    assert_true(told(session)->rudder == 0.0);
    session_on_key(session, 'O', true, false);
    session_advance(session, 0.1);
    assert_true(told(session)->autopilot && told(session)->trim == 0.0);
    leave(started);
}

// Slopes of a tenth all about, and a plain of 1400 m, 3 km north of the middle; "lake": one, 2 km south, to be left
// alone.
static bool valley_ground(void *user, double lat_rad, double lon_rad, double *h_m) {
    double north_m = (lat_rad - 0.64) * GEODESY_A_M, east_m = (lon_rad + 1.47) * GEODESY_A_M * cos(0.64);
    bool lake = user && fabs(north_m + 2000.0) < 900.0;
    *h_m = 300.0 + 0.1 * fmax(fabs(north_m - 3000.0) - 700.0, 0.0) + 0.01 * fabs(east_m - 500.0);
    if (lake)
        *h_m = 500.0;
    return fabs(north_m) < 20000.0;
}

static Result find_runway(const RunwayWish *wish, FlightGround ground, Runway *out) {
    Result result = runway_find(&ground, wish, out);
    if (result == RESULT_OK)
        print_message("%.0f m north, %.0f m east, heading %.0f, %.1f %% steep, climb %.1f %%\n",
                      (out->lat_rad - 0.64) * GEODESY_A_M, (out->lon_rad + 1.47) * GEODESY_A_M * cos(0.64),
                      out->heading_rad / GEODESY_RAD_PER_DEG, 100.0 * out->slope, 100.0 * out->climb);
    return result;
}

static void a_runway_is_where_the_ground_is_flat(void **state) {
    (void)state;
    RunwayWish wish = {.lat_rad = 0.64, .lon_rad = -1.47, .heading_rad = 1.0, .length_m = 1000.0};
    Runway run, again;
    bool lake = true;
    assert_int_equal(find_runway(&wish, (FlightGround){valley_ground, NULL}, &run), RESULT_OK);
    double north_m = (run.lat_rad - 0.64) * GEODESY_A_M;
    assert_true(run.slope < 0.02 && run.climb < 0.03 && north_m > 2200.0 && north_m < 3800.0);
    assert_int_equal(find_runway(&wish, (FlightGround){valley_ground, &lake}, &again), RESULT_OK);
    assert_true(again.lat_rad == run.lat_rad && again.lon_rad == run.lon_rad && again.heading_rad == run.heading_rad);
    // Northwards all of the plain is too short for it, and nothing else is flat.
    wish.heading_rad = 0.0;
    wish.heading_given = true;
    wish.length_m = 3000.0;
    assert_int_equal(find_runway(&wish, (FlightGround){valley_ground, NULL}, &run), RESULT_OK);
    assert_true(run.heading_rad == 0.0 && run.slope > RUNWAY_SLOPE);
    wish.lat_rad = 0.1;
    assert_int_equal(find_runway(&wish, (FlightGround){valley_ground, NULL}, &run), RESULT_RANGE);
}

static void where_nothing_is_flat_it_is_said(void **state) {
    (void)state;
    Heard heard;
    heard_begin(&heard);
    Started *started = start_with(OPTION_ON_GROUND, "yes", OPTION_LOOK, "200,0");
    heard_end();
    assert_int_equal(heard.warnings, 1);
    assert_non_null(strstr(heard.text, "nothing within 8 km of the start is flat for 13"));
    assert_int_equal(started->session.flight.state.contact, FLIGHT_ROLLING);
    leave(started);
}

// By the keys of README.md, without a look at where: full throttle, pull when fast enough, let go at eight degrees.
static void every_aircraft_with_an_engine_takes_off_from_the_default_scene(void **state) {
    (void)state;
    static const struct {
        const char *aircraft;
        double pull_m_s;
    } KINDS[] = {{"c172", 30.0}, {"t37", 50.0}};
    for (size_t i = 0; i < COUNT_OF(KINDS); i++) {
        Started *started = start_with(OPTION_ON_GROUND, "yes", OPTION_AIRCRAFT, KINDS[i].aircraft);
        FlightSession *session = &started->session;
        Vec3d from = session->flight.state.position_ecef;
        double lifted_m = 0.0;
        session_on_key(session, KEY_PAGE_UP, true, false);
        for (int k = 0; k < 60 * 75; k++) {
            FlightInstruments now = flight_instruments(&session->flight);
            bool pulls = now.true_airspeed > KINDS[i].pull_m_s && now.pitch_rad < 8.0 * GEODESY_RAD_PER_DEG &&
                         now.above_ground_m < 15.0;
            session_on_key(session, KEY_DOWN, pulls, false);
            session_advance(session, 1.0 / 60.0);
            if (lifted_m == 0.0 && now.above_ground_m > 15.0)
                lifted_m = vec3d_distance(session->flight.state.position_ecef, from);
        }
        FlightInstruments now = flight_instruments(&session->flight);
        print_message("%s: at 15 m after %.0f m; then %.0f m high, %.0f m/s\n", KINDS[i].aircraft, lifted_m,
                      now.above_ground_m, now.true_airspeed);
        assert_int_equal(session->crashes, 0);
        assert_int_equal(session->flight.state.contact, FLIGHT_AIRBORNE);
        assert_true(now.over_ground && now.above_ground_m > 60.0);
        leave(started);
    }
}

static void flaps_gear_brakes_and_trim_follow_their_keys(void **state) {
    (void)state;
    Keyboard keyboard = keyboard_create(0.0);
    for (int i = 0; i < 5; i++)
        keyboard_move_flaps(&keyboard, true);
    assert_true(keyboard.controls.flaps == 1.0);
    keyboard_move_flaps(&keyboard, false);
    assert_true(fabs(keyboard.controls.flaps - 2.0 / 3.0) < 1e-12);
    keyboard_set_gear(&keyboard, true);
    keyboard_on_key(&keyboard, 'B', true, false);
    keyboard_on_key(&keyboard, KEY_END, true, false);
    Controls held = hold(&keyboard, 1.0);
    assert_true(held.gear_up && held.brake_left == 1.0 && held.brake_right == 1.0);
    assert_true(fabs(held.trim - 1.0 / KEYBOARD_TRIM_S) < 1e-6);
    keyboard_on_key(&keyboard, 'B', false, false);
    keyboard_on_key(&keyboard, KEY_END, false, false);
    Controls later = hold(&keyboard, 1.0);
    assert_true(later.brake_left == 0.0 && later.trim == held.trim);
    assert_int_equal(action_of_key('G', true), ACTION_GEAR_DOWN);
    assert_int_equal(action_of_key(']', false), ACTION_FLAPS_DOWN);
}

static void broken_demos_are_refused_with_file_and_line(void **state) {
    (void)state;
    static const struct {
        const char *text, *said;
    } broken[] = {
        {"to 36,-84\n", ":1: expected 'to LAT"},
        {"\nto 36,-84,900m\n", ":2: expected 'to LAT"},
        {"to 36,-84,900m 100kt fast\n", ":1: expected"},
        {"to 36,-84,900m 5m/s\n", ":1: expected"},
        {"clearance none\n", ":1: expected"},
        {"# nothing\n", "goes nowhere"},
        {"fly 36,-84,900m 100kt\n", ":1: expected"},
        {"to 99,-84,900m 100kt\n", ":1: expected"},
    };
    char geoid_path[PATHS_BYTES_MAX];
    Geoid *geoid = NULL;
    assert_int_equal(paths_find_data("geoid/egm96-15.pgm", geoid_path), RESULT_OK);
    assert_int_equal(geoid_open(geoid_path, &geoid), RESULT_OK);
    for (size_t i = 0; i < COUNT_OF(broken); i++) {
        char path[] = "/tmp/overfly-demo-XXXXXX";
        int file = mkstemp(path);
        assert_true(file >= 0);
        assert_int_equal(write(file, broken[i].text, strlen(broken[i].text)), strlen(broken[i].text));
        close(file);
        Demo demo;
        Heard heard;
        heard_begin(&heard);
        Result result = demo_read(path, geoid, &demo);
        heard_end();
        if (result != RESULT_FORMAT || heard.errors != 1 || !strstr(heard.text, broken[i].said))
            fail_msg("%s: %s: %s; expected \"%s\"", broken[i].text, result_name(result), heard.text, broken[i].said);
        unlink(path);
    }
    geoid_close(&geoid);
}

static void percentiles_are_of_the_latest_and_the_longest_of_all(void **state) {
    (void)state;
    static FrameTimes times; // too big for some stacks
    times = (FrameTimes){.count = 0};
    assert_true(frame_times_summary(&times, 100).p99 == 0.0);
    frame_times_add(&times, 5000.0);
    for (int i = 1; i <= FRAME_TIMES_KEPT + 1000; i++)
        frame_times_add(&times, i % 100 + 1);
    FrameTimesSummary all = frame_times_summary(&times, FRAME_TIMES_KEPT);
    assert_true(fabs(all.p50 - 50.0) <= 1.0 && fabs(all.p99 - 99.0) <= 1.0 && fabs(all.p95 - 95.0) <= 1.0);
    assert_true(all.max == 5000.0);
    frame_times_add(&times, 7.0);
    FrameTimesSummary last = frame_times_summary(&times, 1);
    assert_true(last.p50 == 7.0 && last.p99 == 7.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_stick_deflects_while_held_and_centres_when_let_go),
        cmocka_unit_test(opposite_keys_cancel_and_repeats_do_not_stick),
        cmocka_unit_test(the_rudder_deflects_slowly_while_held_and_centres_when_let_go),
        cmocka_unit_test(throttle_stays_until_changed),
        cmocka_unit_test(presses_come_in_order_and_shift_matters),
        cmocka_unit_test(every_action_has_keys_and_help),
        cmocka_unit_test(options_name_the_methods_that_there_are),
        cmocka_unit_test(keys_change_what_they_say),
        cmocka_unit_test(a_governed_flight_gets_more_time_for_finer),
        cmocka_unit_test(a_method_that_cannot_come_is_told_once),
        cmocka_unit_test(the_corner_of_a_picture_sees_smaller_angles),
        cmocka_unit_test(a_demo_reaches_its_places_without_touching_the_ground),
        cmocka_unit_test(re_simulation_is_far_faster_than_time),
        cmocka_unit_test(a_scene_starts_with_speed_to_spare_where_the_air_is_thin),
        cmocka_unit_test(on_the_ground_it_stands_until_the_throttle_is_moved),
        cmocka_unit_test(the_display_tells_rudder_and_trim_that_the_pilot_holds),
        cmocka_unit_test(a_hold_flies_over_a_ridge_or_turns_away_until_it_can),
        cmocka_unit_test(a_hold_never_flies_into_the_default_scene),
        cmocka_unit_test(a_runway_is_where_the_ground_is_flat),
        cmocka_unit_test(where_nothing_is_flat_it_is_said),
        cmocka_unit_test(every_aircraft_with_an_engine_takes_off_from_the_default_scene),
        cmocka_unit_test(flaps_gear_brakes_and_trim_follow_their_keys),
        cmocka_unit_test(broken_demos_are_refused_with_file_and_line),
        cmocka_unit_test(percentiles_are_of_the_latest_and_the_longest_of_all),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
