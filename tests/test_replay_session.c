// A session that shows a recording: keys along its time, taking over, and what a session records of itself.
#define _DEFAULT_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include <inttypes.h>
#include <math.h>
#include <time.h>

#include "app/aircraft/airframe.h"
#include "app/aircraft/isa.h"
#include "app/replay/replay_events.h"
#include "render/hud/hud_layout.h"
#include "terrain/geodesy.h"
#include "tests/heard.h"
#include "tests/replay_support.h"

#define STEPS 7200u // 60 s
#define DIVE 3600u

typedef struct Fixture {
    ReplayWorld world;
    Flown flown;
} Fixture;

static int set_up(void **state) {
    static Fixture fixture;
    replay_world_load(2, &fixture.world);
    replay_fly(&fixture.world, "session", STEPS, DIVE, 0, &fixture.flown);
    *state = &fixture;
    return 0;
}

static int tear_down(void **state) {
    Fixture *fixture = *state;
    flown_remove(&fixture->flown);
    replay_world_unload(&fixture->world);
    return 0;
}

// A replay as `overfly replay` makes one.
typedef struct Shown {
    const Fixture *fixture;
    Options *options;
    Playback *playback;
    FlightSession session;
} Shown;

static void set_option(Options *options, OptionId id, const char *text) {
    assert_int_equal(options_set(options, id, text, SOURCE_COMMAND_LINE, "--test"), RESULT_OK);
}

static Result try_show(const Fixture *fixture, Shown *shown) {
    shown->fixture = fixture;
    shown->playback = replay_open(&fixture->world, fixture->flown.path);
    assert_int_equal(session_create(&fixture->world.world, shown->options, &shown->session), RESULT_OK);
    return session_begin_replay(&shown->session, shown->playback, shown->options);
}

static Shown *show(const Fixture *fixture) {
    static Shown shown; // a session stays where it is
    memset(&shown, 0, sizeof shown);
    assert_int_equal(options_create(COMMAND_REPLAY, &shown.options), RESULT_OK);
    assert_int_equal(try_show(fixture, &shown), RESULT_OK);
    return &shown;
}

static void end_show(Shown *shown) {
    session_end(&shown->session);
    playback_close(&shown->playback);
    options_destroy(&shown->options);
}

static void press(Shown *shown, int key) {
    session_on_key(&shown->session, key, true, false);
    session_on_key(&shown->session, key, false, false);
}

// In frames, as a session never flies more at a time than a frame may take.
static void fly_s(FlightSession *session, double seconds) {
    for (int i = 0; i < (int)lround(seconds * 60.0); i++)
        session_advance(session, 1.0 / 60.0);
}

static void expect_at(const Shown *shown, double t_s) {
    const FlightSession *session = &shown->session;
    if (fabs(session->timeline.t_s - t_s) > 1e-9)
        fail_msg("at %.9f s, expected %.9f s", session->timeline.t_s, t_s);
    if (!flown_is(&shown->fixture->flown, (uint32_t)lround(t_s * 120.0), &session->flight.state, false))
        fail_msg("at %.9f s it shows another moment", t_s);
}

// ---- keys ----

static void keys_go_along_the_flight(void **state) {
    Shown *shown = show(*state);
    FlightSession *session = &shown->session;
    expect_at(shown, 0.0);
    session_advance(session, 1.0);
    expect_at(shown, 1.0);
    press(shown, KEY_RIGHT);
    expect_at(shown, 6.0);
    for (int i = 0; i < 3; i++) // held
        session_on_repeat(session, KEY_RIGHT, 0);
    expect_at(shown, 21.0);
    press(shown, KEY_LEFT);
    session_on_repeat(session, KEY_LEFT, 0);
    expect_at(shown, 11.0);
    press(shown, KEY_END);
    expect_at(shown, 60.0);
    press(shown, KEY_RIGHT);
    expect_at(shown, 60.0);
    press(shown, KEY_HOME);
    press(shown, KEY_LEFT);
    expect_at(shown, 0.0);
    for (int tenth = 9; tenth >= 0; tenth--) {
        press(shown, '0' + tenth);
        expect_at(shown, 6.0 * tenth);
    }
    end_show(shown);
}

// As if it were three hours long.
static void keys_hop_minutes(void **state) {
    Shown *shown = show(*state);
    FlightSession *session = &shown->session;
    Timeline *timeline = &session->timeline;
    timeline->duration_s = 10800.0;
    session_on_key(session, KEY_RIGHT, true, KEY_CONTROL);
    assert_true(timeline->t_s == 600.0);
    session_on_repeat(session, KEY_RIGHT, KEY_CONTROL);
    assert_true(timeline->t_s == 1200.0);
    session_on_key(session, KEY_LEFT, true, KEY_SHIFT);
    assert_true(timeline->t_s == 1140.0);
    session_on_key(session, KEY_RIGHT, true, KEY_SHIFT);
    session_on_repeat(session, KEY_RIGHT, KEY_SHIFT);
    assert_true(timeline->t_s == 1260.0);
    session_on_key(session, KEY_LEFT, true, KEY_CONTROL | KEY_SHIFT);
    assert_true(timeline->t_s == 660.0);
    end_show(shown);
}

static void the_bar_is_clicked_and_dragged(void **state) {
    Shown *shown = show(*state);
    FlightSession *session = &shown->session;
    HudLayout layout = hud_layout_make(1280, 800, false);
    HudReplayPlace place = hud_layout_replay(&layout, false);
    double left = place.bar.x0, length = place.bar.x1 - place.bar.x0, y = place.bar.y0;
    session_on_pointer(session, left + 0.5 * length, 100.0, true, 1280, 800);
    session_on_pointer(session, left + 0.5 * length, y, true, 1280, 800); // dragged there from elsewhere
    session_advance(session, 1.0);
    expect_at(shown, 1.0);
    session_on_pointer(session, left + 0.5 * length, y, false, 1280, 800);
    session_on_pointer(session, left + 0.25 * length, y, true, 1280, 800);
    session_on_pointer(session, left + 0.5 * length, 100.0, true, 1280, 800); // held, above it too
    session_advance(session, 1.0);
    expect_at(shown, 30.0);
    session_on_pointer(session, 5000.0, y, true, 1280, 800);
    session_on_pointer(session, 0.0, y, true, 1280, 800);
    session_on_pointer(session, 0.0, y, false, 1280, 800);
    session_on_pointer(session, left + length, y, false, 1280, 800);
    session_advance(session, 1.0);
    expect_at(shown, 1.0);
    session->settings.show_flight = false; // nor the bar
    session_on_pointer(session, left + 0.5 * length, y, true, 1280, 800);
    session_advance(session, 1.0);
    expect_at(shown, 2.0);
    end_show(shown);
}

static void keys_pause_and_turn_time_and_change_its_rate(void **state) {
    Shown *shown = show(*state);
    FlightSession *session = &shown->session;
    press(shown, '5');
    press(shown, ' ');
    session_advance(session, 3.0);
    expect_at(shown, 30.0);
    press(shown, ' ');
    session_advance(session, 0.5);
    expect_at(shown, 30.5);
    press(shown, KEY_BACKSPACE);
    session_advance(session, 10.5);
    expect_at(shown, 20.0);
    press(shown, KEY_UP);
    press(shown, KEY_UP);
    assert_string_equal(session->message, "replay \xE2\x88\x92"
                                          "4 \xC3\x97");
    session_advance(session, 2.0);
    expect_at(shown, 12.0);
    for (int i = 0; i < 4; i++)
        press(shown, KEY_DOWN);
    assert_string_equal(session->message, "replay \xE2\x88\x92"
                                          "1/4 \xC3\x97");
    session_advance(session, 4.0);
    expect_at(shown, 11.0);
    session_on_repeat(session, KEY_UP, 0); // which only hops take
    assert_true(timeline_rate(&session->timeline) == -0.25);
    press(shown, KEY_BACKSPACE);
    session_advance(session, 1000.0);
    expect_at(shown, 60.0);
    assert_true(session->timeline.paused);
    press(shown, ' '); // from the begin again
    session_advance(session, 4.0);
    expect_at(shown, 1.0);
    session_on_key(session, 'R', true, false); // which resets flights, not replays
    session_advance(session, 0.0);
    expect_at(shown, 1.0);
    end_show(shown);
}

static void options_say_where_it_begins(void **state) {
    static const struct {
        const char *at;
        bool backwards;
        double t_s;
    } GOOD[] = {{"12.5", false, 12.5}, {"0:45", false, 45.0}, {"0:45", true, 45.0}, {NULL, true, 60.0}};
    for (size_t i = 0; i < COUNT_OF(GOOD); i++) {
        Shown shown = {0};
        assert_int_equal(options_create(COMMAND_REPLAY, &shown.options), RESULT_OK);
        if (GOOD[i].at)
            set_option(shown.options, OPTION_AT, GOOD[i].at);
        if (GOOD[i].backwards)
            set_option(shown.options, OPTION_BACKWARDS, "true");
        set_option(shown.options, OPTION_REPLAY_RATE, "2");
        assert_int_equal(try_show(*state, &shown), RESULT_OK);
        expect_at(&shown, GOOD[i].t_s);
        session_advance(&shown.session, 1.0);
        expect_at(&shown, GOOD[i].t_s + (GOOD[i].backwards ? -2.0 : 2.0));
        end_show(&shown);
    }
    Shown shown = {0};
    Heard heard;
    assert_int_equal(options_create(COMMAND_REPLAY, &shown.options), RESULT_OK);
    set_option(shown.options, OPTION_AT, "1:01");
    heard_begin(&heard);
    Result result = try_show(*state, &shown);
    heard_end();
    assert_int_equal(result, RESULT_USAGE);
    assert_non_null(strstr(heard.text, "up to 0:01:00.0; found '1:01'"));
    end_show(&shown);
}

static bool no_ground(void *user, double lat_rad, double lon_rad, double *h_m) {
    (void)user, (void)lat_rad, (void)lon_rad, (void)h_m;
    return false;
}

// Without the ground that it was recorded over, the aircraft does not crash.
static void a_replay_that_differs_says_so_once(void **state) {
    const Fixture *fixture = *state;
    Shown *shown = show(fixture);
    const PlaybackOptions nowhere = {.how = track_reading_default(), .ground = {no_ground, NULL}};
    Heard heard;
    playback_close(&shown->playback);
    assert_int_equal(playback_open(fixture->flown.path, &nowhere, &shown->playback), RESULT_OK);
    heard_begin(&heard);
    assert_int_equal(session_begin_replay(&shown->session, shown->playback, shown->options), RESULT_OK);
    session_advance(&shown->session, 5.0);
    assert_int_equal(heard.warnings, 0);
    for (int i = 0; i < 60; i++)
        session_advance(&shown->session, 1.0);
    press(shown, KEY_HOME);
    press(shown, KEY_END);
    heard_end();
    print_message("%s%s\n", heard.text, shown->session.message);
    assert_int_equal(heard.warnings, 1);
    assert_non_null(strstr(heard.text, "another flight than was recorded"));
    assert_non_null(strstr(shown->session.message, "not as recorded, from 0:00:"));
    end_show(shown);
}

// ---- taking over ----

// From the step on as it was flown, with the controls that were recorded.
static void expect_same_flight(const Flown *flown, Flight *flight, uint32_t from, uint32_t steps) {
    assert_true(flown_is(flown, from, &flight->state, false));
    for (uint32_t i = from; i < from + steps && i < flown->steps; i++) {
        Controls controls = recording_controls(flown->codes[i]);
        flight_step(flight, &controls, FLIGHT_STEP_S);
        if (!flown_is(flown, i + 1, &flight->state, false))
            fail_msg("taken over before step %u, it differs after step %u", from, i);
    }
}

static void a_flight_goes_on_exactly_from_any_moment(void **state) {
    const Fixture *fixture = *state;
    const double at_s[] = {0.0,
                           0.0041, // between two steps
                           10.0,
                           17.7777,
                           29.999,
                           (fixture->flown.crash - 30) / 120.0,
                           (fixture->flown.crash + 60) / 120.0,
                           (fixture->flown.anew + 0.5) / 120.0,
                           60.0};
    for (size_t i = 0; i < COUNT_OF(at_s); i++) {
        Shown *shown = show(fixture);
        FlightSession *session = &shown->session;
        session_advance(session, at_s[i]);
        press(shown, KEY_ENTER);
        assert_null(session->playback);
        assert_string_equal(session->message, "you have control");
        expect_same_flight(&fixture->flown, &session->flight, (uint32_t)(at_s[i] * 120.0 + 1e-6), 600);
        end_show(shown);
    }
}

// To the place and to the controls, whatever was done with them since.
static void a_reset_goes_back_to_the_controls_of_the_take_over(void **state) {
    Shown *shown = show(*state);
    FlightSession *session = &shown->session;
    session_advance(session, 20.0);
    press(shown, KEY_ENTER);
    const FlightState begin = session->flight.state;
    session_on_key(session, begin.throttle > 0.5 ? KEY_PAGE_DOWN : KEY_PAGE_UP, true, false);
    fly_s(session, 1.0);
    assert_true(fabs(session->flight.state.throttle - begin.throttle) > 0.2);
    session_on_key(session, begin.throttle > 0.5 ? KEY_PAGE_DOWN : KEY_PAGE_UP, false, false);
    press(shown, 'R');
    fly_s(session, 0.5);
    const FlightState *now = &session->flight.state;
    print_message("throttle %.3f, taken over with %.3f\n", now->throttle, begin.throttle);
    assert_true(fabs(now->throttle - begin.throttle) < 0.002);
    assert_true(vec3d_distance(now->position_ecef, begin.position_ecef) < 0.55 * vec3d_length(begin.velocity_ecef));
    end_show(shown);
}

// The moment before the step `end` with the most of ailerons and rudder.
static double wildest_s(const Flown *flown, uint32_t end) {
    double most = 0.0, t_s = 0.0;
    for (uint32_t p = 240; p < end; p += 3) {
        FlightState state = flown_state(flown, p);
        double much = state.contact == FLIGHT_AIRBORNE ? fmin(fabs(state.aileron), 3.0 * fabs(state.rudder)) : 0.0;
        t_s = much > most ? p / 120.0 : t_s;
        most = fmax(most, much);
    }
    return t_s;
}

// Step by step after Enter, with nobody at the controls: by how much the surfaces move in a step at most.
static double most_moved(FlightSession *session) {
    double most = 0.0;
    for (int i = 0; i < 120; i++) {
        const FlightState before = session->flight.state;
        session_advance(session, FLIGHT_STEP_S);
        const FlightState *now = &session->flight.state;
        most = fmax(most, fmax(fabs(now->aileron - before.aileron), fabs(now->elevator - before.elevator)));
        most = fmax(most, fabs(now->rudder - before.rudder));
    }
    return most;
}

// With help for keys, and without.
static void nothing_jumps_when_it_is_taken_over_in_a_turn(void **state) {
    const Fixture *fixture = *state;
    for (int helped = 0; helped < 2; helped++) {
        double at_s = wildest_s(&fixture->flown, helped ? DIVE : STEPS); // after the dive it tumbles, beyond all help
        Shown *shown = show(fixture);
        FlightSession *session = &shown->session;
        session->assist = helped;
        session_advance(session, at_s);
        const FlightState begin = session->flight.state;
        press(shown, KEY_ENTER);
        double most = most_moved(session);
        const FlightState *now = &session->flight.state;
        print_message("at %.2f s, %s: aileron %.3f, rudder %.3f, elevator %.3f; at most %.4f in a step, to %.3f, %.3f, "
                      "%.3f\n",
                      at_s, helped ? "helped" : "alone", begin.aileron, begin.rudder, begin.elevator, most,
                      now->aileron, now->rudder, now->elevator);
        assert_true(fabs(begin.aileron) > 0.05 && most < 0.25 * fabs(begin.aileron));
        assert_true(now->throttle == begin.throttle);
        if (!helped)
            assert_true(now->aileron == 0.0 && now->rudder == 0.0 && fabs(now->elevator - begin.elevator) < 1e-9);
        end_show(shown);
    }
}

// ---- taking over a track ----

#define TRACK_LAT 36.59
#define TRACK_LON -84.245
#define TRACK_M 1500.0
#define METRES_PER_DEG 110970.0 // of latitude

// A replay of a track that a test wrote.
static Shown *show_track(const Fixture *fixture, const char *path) {
    static Shown shown;
    memset(&shown, 0, sizeof shown);
    assert_int_equal(options_create(COMMAND_REPLAY, &shown.options), RESULT_OK);
    shown.fixture = fixture;
    shown.playback = replay_open(&fixture->world, path);
    assert_int_equal(session_create(&fixture->world.world, shown.options, &shown.session), RESULT_OK);
    assert_int_equal(session_begin_replay(&shown.session, shown.playback, shown.options), RESULT_OK);
    return &shown;
}

// North for 20 s, nothing for 20 s, and on for 20 s.
static void write_gap(const char *path, double speed_m_s) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "t_s,lat_deg,lon_deg,alt_m,heading_deg,pitch_deg,gap\n");
    for (int i = 0; i <= 60; i++)
        if (i <= 20 || i >= 40)
            fprintf(file, "%d,%.9f,%.9f,%.3f,0,0,%d\n", i, TRACK_LAT + i * speed_m_s / METRES_PER_DEG, TRACK_LON,
                    TRACK_M, i == 40);
    assert_int_equal(fclose(file), 0);
}

static void expect_flies_on(FlightSession *session, double speed_m_s, const char *message) {
    const FlightInstruments begin = flight_instruments(&session->flight);
    double stall = airframe_stall_speed(&session->aircraft, isa_at(begin.h_m).density, 0.0);
    assert_non_null(strstr(session->message, message));
    assert_string_equal(session->aircraft_name, "c172");
    bool raised = speed_m_s < 1.3 * stall;
    assert_true(fabs(begin.true_airspeed - (raised ? 1.3 * stall : speed_m_s)) < 0.2);
    const char *told = strstr(session->message, "; too slow to fly: started at ");
    assert_true((told != NULL) == raised);
    assert_true(!told || fabs(strtod(told + 30, NULL) - 3.6 * begin.calibrated_airspeed) < 0.6);
    assert_true(fabs(sin(begin.track_rad)) < 0.02 && cos(begin.track_rad) > 0.0 && fabs(begin.path_rad) < 0.01);
    fly_s(session, 2.0);
    const FlightInstruments now = flight_instruments(&session->flight);
    print_message("%s: %.1f m/s, after 2 s %.1f m/s and %.2f m higher\n", session->message, begin.true_airspeed,
                  now.true_airspeed, now.h_m - begin.h_m);
    assert_true(fabs(now.h_m - begin.h_m) < 2.0 && now.true_airspeed > 1.2 * stall);
}

// At both ends, in a gap, at its edges, and at a walk.
static void a_track_is_never_taken_over_too_slow_to_fly(void **state) {
    static const double AT_S[] = {0.0, 10.0, 20.0, 20.04, 30.0, 40.0, 40.04, 60.0};
    char path[128];
    replay_path("gap", path);
    for (int walked = 0; walked < 2; walked++) {
        double speed_m_s = walked ? 1.5 : 55.0;
        write_gap(path, speed_m_s);
        for (size_t i = 0; i < COUNT_OF(AT_S); i++) {
            Shown *shown = show_track(*state, path);
            session_advance(&shown->session, AT_S[i]);
            press(shown, KEY_ENTER);
            expect_flies_on(&shown->session, speed_m_s, "you have control: c172");
            end_show(shown);
        }
    }
    unlink(path);
}

// The time that nothing is known of does not make it slow.
static void a_fast_track_with_a_long_gap_is_no_light_aircraft(void **state) {
    char path[128];
    replay_path("fast", path);
    write_gap(path, 110.0);
    Shown *shown = show_track(*state, path);
    assert_string_equal(shown->session.aircraft_name, AIRCRAFT_DEFAULT);
    session_advance(&shown->session, 30.0);
    press(shown, KEY_ENTER);
    assert_string_equal(shown->session.message, "you have control: " AIRCRAFT_DEFAULT);
    end_show(shown);
    unlink(path);
}

// Round in a turn of 45 degrees to the right, recorded or to be worked out.
static void write_turn(const char *path, double speed_m_s, bool told) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    double radius_m = speed_m_s * speed_m_s / 9.81, per_lon = METRES_PER_DEG * cos(TRACK_LAT * GEODESY_RAD_PER_DEG);
    fprintf(file, "t_s,lat_deg,lon_deg,alt_m%s\n", told ? ",heading_deg,pitch_deg,bank_deg" : "");
    for (int i = 0; i <= 80; i++) {
        double angle = 0.25 * i * speed_m_s / radius_m;
        fprintf(file, "%.2f,%.9f,%.9f,%.3f", 0.25 * i, TRACK_LAT + radius_m * sin(angle) / METRES_PER_DEG,
                TRACK_LON + radius_m * (1.0 - cos(angle)) / per_lon, TRACK_M);
        fprintf(file, told ? ",%.6f,3,45\n" : "\n", angle / GEODESY_RAD_PER_DEG);
    }
    assert_int_equal(fclose(file), 0);
}

static void expect_same_turn(FlightSession *session) {
    const FlightInstruments before = flight_instruments(&session->flight);
    const Vec3d rate = session->flight.state.rate_body;
    session_on_key(session, KEY_ENTER, true, false);
    session_advance(session, FLIGHT_STEP_S);
    const FlightInstruments after = flight_instruments(&session->flight);
    double rates_off = vec3d_distance(rate, session->flight.state.rate_body);
    fly_s(session, 1.0);
    const FlightInstruments later = flight_instruments(&session->flight);
    const double deg = GEODESY_RAD_PER_DEG;
    print_message("bank %.2f, then %.2f and %.2f; heading %.1f, then %.1f and %.1f; rates %.4f off; load %.2f\n",
                  before.bank_rad / deg, after.bank_rad / deg, later.bank_rad / deg, before.heading_rad / deg,
                  after.heading_rad / deg, later.heading_rad / deg, rates_off, after.load_factor);
    assert_true(fabs(before.bank_rad - 45.0 * deg) < 1.0 * deg && fabs(after.bank_rad - before.bank_rad) < 1.0 * deg);
    assert_true(fabs(after.heading_rad - before.heading_rad) < 0.5 * deg && rates_off < 0.02);
    assert_true(fabs(after.load_factor - sqrt(2.0)) < 0.05);
    assert_true(fabs(later.bank_rad - before.bank_rad) < 3.0 * deg &&
                later.heading_rad - after.heading_rad > 8.0 * deg);
}

static void a_track_is_taken_over_with_its_bank(void **state) {
    char path[128];
    replay_path("turn", path);
    for (int told = 0; told < 2; told++) {
        write_turn(path, 55.0, told);
        Shown *shown = show_track(*state, path);
        session_advance(&shown->session, 10.0);
        expect_same_turn(&shown->session);
        end_show(shown);
    }
    unlink(path);
}

// Until it is flown.
static void a_track_has_no_throttle_on_the_hud(void **state) {
    static FrameOrder order;
    char path[128];
    replay_path("bare", path);
    write_gap(path, 55.0);
    Shown *shown = show_track(*state, path);
    session_order(&shown->session, 640, 400, 0.0, 0.0, &order);
    assert_true(order.look.hud.no_engine);
    press(shown, KEY_ENTER);
    session_order(&shown->session, 640, 400, 0.0, 0.0, &order);
    assert_false(order.look.hud.no_engine);
    end_show(shown);
    unlink(path);
}

// ---- what is recorded after it ----

// What was taken over is recorded as a flight of its own, with the land and the aircraft of the one before.
static void what_is_flown_after_taking_over_is_recorded(void **state) {
    Fixture *fixture = *state;
    char path[128];
    replay_path("taken", path);
    Shown *shown = show(fixture);
    FlightSession *session = &shown->session;
    FlightRecorder *recorder;
    const RecordedFlight recorded = {&session->flight, session->aircraft_name};
    set_option(shown->options, OPTION_RECORD, path);
    snprintf(fixture->world.world.names, sizeof fixture->world.world.names, "a scene|of two"); // as if so named
    assert_int_equal(recorder_create(&fixture->world.world, shown->options, &recorded, &recorder), RESULT_OK);
    fixture->world.world.names[0] = '\0';
    session->recorder = recorder;
    session_advance(session, 20.0);
    press(shown, KEY_ENTER);
    session_on_key(session, KEY_DOWN, true, false);
    fly_s(session, 0.5);
    session_on_key(session, KEY_DOWN, false, false);
    fly_s(session, 9.5);
    press(shown, 'R'); // back to where it was taken over
    session_advance(session, 0.0);
    assert_true(flown_is(&fixture->flown, 2400, &session->flight.state, false));
    fly_s(session, 5.0);
    FlightState last = session->flight.state;
    uint64_t hash = recorder_hash(recorder);
    assert_int_equal(recorder_close(&recorder), RESULT_OK);
    end_show(shown);

    RecordingVerdict verdict = replay_verdict(&fixture->world, path);
    print_message("%u steps, hash %016" PRIx64 ", flown %016" PRIx64 "\n", verdict.steps, verdict.hash, hash);
    assert_true(verdict.equal && verdict.hash == hash);
    assert_int_equal(verdict.steps, 15 * 120);
    Playback *playback = replay_open(&fixture->world, path);
    PlaybackMoment first = playback_at(playback, 0.0), end = playback_at(playback, 15.0);
    assert_true(flown_is(&fixture->flown, 2400, &first.state, false));
    assert_int_equal(flight_state_hash(&end.state), flight_state_hash(&last));
    assert_string_equal(playback_header(playback)->environment[RECORDING_SCENE], "a scene|of two");
    assert_string_equal(playback_header(playback)->environment[RECORDING_AIRCRAFT], AIRCRAFT_DEFAULT);
    assert_string_equal(playback_header(playback)->environment[RECORDING_DATUM], "egm96"); // the scene's
    assert_string_equal(playback_header(playback)->environment[RECORDING_VOIDS], "fill");
    playback_close(&playback);
    unlink(path);
}

// ---- a session that is flown ----

static void begin_recorded(const Fixture *fixture, FlightSession *session, const char *path,
                           FlightRecorder **recorder) {
    set_option(fixture->world.options, OPTION_RECORD, path);
    assert_int_equal(session_create(&fixture->world.world, fixture->world.options, session), RESULT_OK);
    const RecordedFlight recorded = {&session->flight, session->aircraft_name};
    assert_int_equal(recorder_create(&fixture->world.world, fixture->world.options, &recorded, recorder), RESULT_OK);
    session->recorder = *recorder;
}

static void dive(FlightSession *session) {
    session->assist = false;
    session_on_key(session, KEY_UP, true, false);
    for (int i = 0; i < 60 * 60 && session->crashes == 0; i++)
        session_advance(session, 1.0 / 60.0);
    session_on_key(session, KEY_UP, false, false);
}

static void a_session_with_a_crash_and_a_reset_is_flown_again(void **state) {
    const Fixture *fixture = *state;
    static FlightSession session;
    FlightRecorder *recorder;
    char path[128];
    replay_path("flown", path);
    begin_recorded(fixture, &session, path, &recorder);
    fly_s(&session, 5.0);
    dive(&session);
    assert_int_equal(session.crashes, 1);
    assert_int_equal(session.flight.state.contact, FLIGHT_CRASHED);
    fly_s(&session, FLIGHT_RESET_S + 1.0);
    assert_int_equal(session.flight.state.contact, FLIGHT_AIRBORNE);
    session_on_key(&session, 'R', true, false);
    session_on_key(&session, 'R', false, false);
    session_advance(&session, 0.0);
    assert_true(session.flight.state.position_ecef.x == session.begin.position_ecef.x);
    fly_s(&session, 4.0);
    uint32_t steps = recorder_steps(recorder);
    uint64_t hash = recorder_hash(recorder);
    FlightState last = session.flight.state;
    assert_int_equal(recorder_close(&recorder), RESULT_OK);
    session_end(&session);
    RecordingVerdict verdict = replay_verdict(&fixture->world, path);
    print_message("%u steps, first difference %" PRId64 "\n", verdict.steps, verdict.first_difference_step);
    assert_true(verdict.equal && verdict.hash == hash && verdict.steps == steps);
    Playback *playback = replay_open(&fixture->world, path);
    PlaybackMoment end = playback_at(playback, steps / 120.0);
    assert_int_equal(flight_state_hash(&end.state), flight_state_hash(&last));
    playback_close(&playback);
    unlink(path);
}

static void tap(FlightSession *session, int key, bool shift) {
    session_on_key(session, key, true, shift);
    session_on_key(session, key, false, shift);
    session_advance(session, 0.0);
}

// A demo that pauses, runs twice as fast and is taken over; then a new start, and a pause that nothing follows.
static void fly_eventfully(FlightSession *session) {
    session->demo_flies = true;
    session->demo.count = 1;
    session->demo.waypoints[0] = (Waypoint){1.0, 1.0, 5000.0, 110.0};
    fly_s(session, 1.0);
    tap(session, 'P', false);
    fly_s(session, 1.0);
    tap(session, 'P', false);
    tap(session, 'A', false);
    fly_s(session, 1.0);
    tap(session, 'A', true);
    fly_s(session, 1.0);
    tap(session, KEY_LEFT, false);
    tap(session, 'R', false);
    tap(session, 'P', false);
}

static void what_happens_beside_the_controls_is_recorded(void **state) {
    const Fixture *fixture = *state;
    static FlightSession session;
    static const struct {
        const char *name;
        uint32_t step;
    } EXPECTED[] = {{"demo-on", 0},     {"pause", 120},    {"resume", 120}, {"time-rate", 120},
                    {"time-rate", 360}, {"demo-off", 480}, {"reset", 480},  {"pause", 480}};
    FlightRecorder *recorder;
    ReplayEvents events;
    char path[128];
    replay_path("events", path);
    begin_recorded(fixture, &session, path, &recorder);
    fly_eventfully(&session);
    assert_int_equal(recorder_close(&recorder), RESULT_OK);
    session_end(&session);
    assert_true(replay_verdict(&fixture->world, path).equal);
    Playback *playback = replay_open(&fixture->world, path);
    assert_int_equal(replay_events_read(playback, &events), RESULT_OK);
    replay_events_print(&events, "");
    assert_int_equal(events.count, COUNT_OF(EXPECTED));
    for (int i = 0; i < events.count; i++) {
        assert_string_equal(recording_event_name(events.events[i].kind), EXPECTED[i].name);
        assert_int_equal(events.events[i].step, EXPECTED[i].step);
    }
    replay_events_clear(&events);
    playback_close(&playback);
    unlink(path);
}

// A crash after a start on the wheels leads back there, as the recording has it.
static void a_crash_after_a_start_on_the_ground_leads_back_there(void **state) {
    const Fixture *fixture = *state;
    static FlightSession session;
    ReplayWorld standing = {.world = fixture->world.world};
    FlightRecorder *recorder;
    char path[128];
    replay_path("stood", path);
    assert_int_equal(options_create(COMMAND_FLY, &standing.options), RESULT_OK);
    set_option(standing.options, OPTION_ON_GROUND, "yes");
    begin_recorded(&(Fixture){.world = standing}, &session, path, &recorder);
    const FlightState begin = session.flight.state;
    session_on_key(&session, KEY_PAGE_UP, true, false);
    fly_s(&session, 30.0);
    session_on_key(&session, KEY_PAGE_UP, false, false);
    session_on_key(&session, KEY_DOWN, true, false); // off the ground, and over
    session.assist = false;
    for (int i = 0; i < 60 * 60 && session.crashes == 0; i++)
        session_advance(&session, 1.0 / 60.0);
    session_on_key(&session, KEY_DOWN, false, false);
    double away_m = vec3d_distance(session.flight.state.position_ecef, begin.position_ecef);
    fly_s(&session, FLIGHT_RESET_S + 1.0);
    FlightInstruments now = flight_instruments(&session.flight);
    double back_m = vec3d_distance(session.flight.state.position_ecef, begin.position_ecef);
    print_message("crashed %.0f m away; then %.3f m, %.1f m above the ground, throttle %.2f, parked %d\n", away_m,
                  back_m, now.above_ground_m, session.flight.state.throttle, session.parked);
    assert_true(session.crashes == 1 && away_m > 100.0 && back_m < 0.1 && session.parked);
    assert_int_equal(session.flight.state.contact, FLIGHT_ROLLING);
    assert_true(session.flight.state.throttle == 0.0 && now.speed_m_s < 0.1);
    uint64_t hash = recorder_hash(recorder);
    assert_int_equal(recorder_close(&recorder), RESULT_OK);
    session_end(&session);
    options_destroy(&standing.options);
    RecordingVerdict verdict = replay_verdict(&fixture->world, path);
    assert_true(verdict.equal && verdict.hash == hash);
    unlink(path);
}

// Rolls out with brakes and flaps that are on their way down, into a file.
static void record_a_roll(const Fixture *fixture, const char *path) {
    static FlightSession session;
    Fixture standing = {.world = {.world = fixture->world.world}};
    FlightRecorder *recorder;
    assert_int_equal(options_create(COMMAND_FLY, &standing.world.options), RESULT_OK);
    set_option(standing.world.options, OPTION_ON_GROUND, "yes");
    begin_recorded(&standing, &session, path, &recorder);
    session_on_key(&session, KEY_PAGE_UP, true, false);
    fly_s(&session, 8.0);
    session_on_key(&session, KEY_PAGE_UP, false, false);
    session_on_key(&session, KEY_PAGE_DOWN, true, false);
    session_on_key(&session, ']', true, false);
    session_on_key(&session, 'B', true, false);
    fly_s(&session, 3.0);
    assert_int_equal(recorder_close(&recorder), RESULT_OK);
    session_end(&session);
    options_destroy(&standing.world.options);
}

static void brakes_and_flaps_stay_as_recorded_until_they_are_touched(void **state) {
    Fixture *fixture = *state;
    Fixture roll = *fixture;
    replay_path("roll", roll.flown.path);
    record_a_roll(fixture, roll.flown.path);
    for (int i = 0; i < 2; i++) {
        Shown *shown = show(&roll);
        FlightSession *session = &shown->session;
        session_advance(session, 8.5);
        double flaps = session->flight.state.flaps;
        press(shown, KEY_ENTER);
        fly_s(session, 1.0);
        print_message("flaps %.2f when taken over, wanted %.2f; brakes %.2f\n", flaps, session->flown.flaps,
                      session->flown.brake_left);
        assert_true(flaps < 0.3 && fabs(session->flown.flaps - 1.0 / 3.0) < 1e-9);
        assert_true(session->flown.brake_left == 1.0 && session->flown.brake_right == 1.0);
        int key = i == 0 ? 'B' : KEY_PAGE_UP;
        session_on_key(session, key, true, false);
        fly_s(session, 0.2);
        session_on_key(session, key, false, false);
        fly_s(session, 0.1);
        assert_true(session->flown.brake_left == 0.0 && session->flown.brake_right == 0.0);
        end_show(shown);
    }
    unlink(roll.flown.path);
}

// F5: without --record too, and while the flight goes on.
static void the_last_minutes_are_saved_by_a_key(void **state) {
    const Fixture *fixture = *state;
    static FlightSession session;
    char folder[] = "/tmp/overfly-saved-XXXXXX", wanted[64], file[256];
    FlightRecorder *recorder;
    Options *options;
    assert_non_null(mkdtemp(folder));
    assert_int_equal(setenv("XDG_STATE_HOME", folder, 1), 0);
    assert_int_equal(options_create(COMMAND_FLY, &options), RESULT_OK);
    assert_int_equal(session_create(&fixture->world.world, options, &session), RESULT_OK);
    const RecordedFlight recorded = {&session.flight, session.aircraft_name};
    assert_int_equal(recorder_create(&fixture->world.world, options, &recorded, &recorder), RESULT_OK);
    assert_null(recorder_path(recorder));
    session.recorder = recorder;
    fly_s(&session, 20.0);
    session_on_key(&session, KEY_F5, true, false);
    session_on_key(&session, KEY_F5, false, false);
    uint64_t hash = recorder_hash(recorder);
    Heard heard;
    heard_begin(&heard);
    for (int i = 0; i < 1000 && strncmp(session.message, "recording: ", 11) != 0; i++) {
        fly_s(&session, 1.0 / 60.0);
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    }
    heard_end();
    print_message("%s\n", session.message);
    const char *told = strstr(heard.text, session.message + 11);
    assert_true(told && !strstr(told + 1, session.message + 11)); // once
    snprintf(wanted, sizeof wanted, "%s/overfly/recordings/overfly-", folder);
    assert_int_equal(strncmp(session.message, "recording: ", 11), 0);
    snprintf(file, sizeof file, "%.200s", session.message + 11);
    assert_int_equal(strncmp(file, wanted, strlen(wanted)), 0);
    assert_int_equal(recorder_close(&recorder), RESULT_OK);
    session_end(&session);
    RecordingVerdict verdict = replay_verdict(&fixture->world, file);
    assert_true(verdict.equal && verdict.hash == hash && verdict.steps == 20 * 120);
    options_destroy(&options);
    unlink(file);
    snprintf(file, sizeof file, "%s/overfly/recordings", folder);
    assert_int_equal(rmdir(file), 0);
    snprintf(file, sizeof file, "%s/overfly", folder);
    assert_int_equal(rmdir(file), 0);
    assert_int_equal(rmdir(folder), 0);
}

// Keys that fly do not work behind the replay's back.
static void keys_that_fly_wait_until_somebody_takes_over(void **state) {
    Shown *shown = show(*state);
    FlightSession *session = &shown->session;
    static const int KEYS[] = {'O', 'R', 'G', '[', ']'};
    const Controls before = session->keyboard.controls;
    for (size_t i = 0; i < COUNT_OF(KEYS); i++) {
        press(shown, KEYS[i]);
        session_advance(session, 0.01);
    }
    assert_false(session->holds);
    assert_true(session->keyboard.controls.flaps == before.flaps &&
                session->keyboard.controls.gear_up == before.gear_up);
    press(shown, 'P'); // as Space
    session_advance(session, 0.01);
    assert_true(session->timeline.paused && !session->settings.clock.paused);
    end_show(shown);
}

// ---- the map ----

// The whole way, each second of it where it flew; and who watches sees no other flight for it.
static void the_map_shows_the_way_of_all_of_the_recording(void **state) {
    const Fixture *fixture = *state;
    Shown *shown = show(fixture);
    FlightSession *session = &shown->session;
    session->settings.view = CAMERA_MAP;
    fly_s(session, 1.0);
    expect_at(shown, 1.0);
    static FrameOrder order;
    session_order(session, 640, 400, 0.0, 0.0, &order);
    const RenderMap *map = &order.look.hud.map;
    assert_true(map->show && map->next == -1);
    assert_int_equal(map->route_count, STEPS / 120 + 1);
    double worst_m = 0.0;
    for (int i = 0; i < map->route_count; i++) {
        Geodetic shows = geodesy_from_ecef(map->route[i].ecef);
        FlightState flown = flown_state(&fixture->flown, (uint32_t)i * 120);
        Geodetic was = geodesy_from_ecef(flown.position_ecef);
        shows.h_m = was.h_m;
        worst_m = fmax(worst_m, vec3d_distance(geodesy_to_ecef(shows), flown.position_ecef));
    }
    print_message("%d places within %.6f m, seen from above\n", map->route_count, worst_m);
    assert_true(worst_m < 1e-3);
    end_show(shown);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keys_go_along_the_flight),
        cmocka_unit_test(keys_hop_minutes),
        cmocka_unit_test(the_bar_is_clicked_and_dragged),
        cmocka_unit_test(keys_pause_and_turn_time_and_change_its_rate),
        cmocka_unit_test(keys_that_fly_wait_until_somebody_takes_over),
        cmocka_unit_test(options_say_where_it_begins),
        cmocka_unit_test(a_replay_that_differs_says_so_once),
        cmocka_unit_test(a_flight_goes_on_exactly_from_any_moment),
        cmocka_unit_test(a_reset_goes_back_to_the_controls_of_the_take_over),
        cmocka_unit_test(nothing_jumps_when_it_is_taken_over_in_a_turn),
        cmocka_unit_test(brakes_and_flaps_stay_as_recorded_until_they_are_touched),
        cmocka_unit_test(a_track_is_never_taken_over_too_slow_to_fly),
        cmocka_unit_test(a_fast_track_with_a_long_gap_is_no_light_aircraft),
        cmocka_unit_test(a_track_is_taken_over_with_its_bank),
        cmocka_unit_test(a_track_has_no_throttle_on_the_hud),
        cmocka_unit_test(what_is_flown_after_taking_over_is_recorded),
        cmocka_unit_test(a_session_with_a_crash_and_a_reset_is_flown_again),
        cmocka_unit_test(what_happens_beside_the_controls_is_recorded),
        cmocka_unit_test(a_crash_after_a_start_on_the_ground_leads_back_there),
        cmocka_unit_test(the_last_minutes_are_saved_by_a_key),
        cmocka_unit_test(the_map_shows_the_way_of_all_of_the_recording),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
