// Demonstrations: their files, the ones that come along flown to their end, and a stand that begins again.
#include "app/demo/demo_list.h"
#include "app/flight/flight_session.h"
#include "config/options.h"
#include "heard.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define FRAME_S (1.0 / 60.0)
#define FLIGHT_S_MOST 1200.0
static const char PATH[] = "demo_test.demo";

typedef struct Stand {
    Options *options;
    World world;
    FlightSession session;
} Stand;

static Stand *begin(const char *name, bool kiosk) {
    Stand *stand = calloc(1, sizeof *stand);
    char words[3][16] = {"demo", "", "--kiosk"};
    snprintf(words[1], sizeof words[1], "%s", name);
    char *argv[] = {words[0], words[1], words[2]};
    assert_non_null(stand);
    assert_int_equal(options_create(COMMAND_DEMO, &stand->options), RESULT_OK);
    assert_int_equal(options_read_arguments(stand->options, kiosk ? 2 : 1, argv + 1), RESULT_OK);
    assert_int_equal(world_load(stand->options, &stand->world), RESULT_OK);
    assert_int_equal(session_create(&stand->world, stand->options, &stand->session), RESULT_OK);
    return stand;
}

static void end(Stand *stand) {
    session_end(&stand->session);
    world_unload(&stand->world);
    options_destroy(&stand->options);
    free(stand);
}

static void write_text(const char *text) {
    FILE *file = fopen(PATH, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static Result read_text(const char *text, Demo *out) {
    write_text(text);
    Result result = demo_read_title(PATH, out->title);
    unlink(PATH);
    return result;
}

#define TO "to 36,-84,900m 100m/s\n"

static void a_file_tells_its_title_and_where_it_is_wrong(void **state) {
    (void)state;
    static const struct {
        const char *text, *said; // on the second line
    } BAD[] = {
        {"to\n", "expected 'to LAT,LON,ALT SPEED'"},
        {"to 36,-84,900m\n", "found '36,-84,900m'"},
        {"to 36,-84,900m 5m/s\n", "15 to 1000 m/s"},
        {"to 36,-84,900m 100m/s more\n", "found '36,-84,900m 100m/s more'"},
        {"to 96,-84,900m 100m/s\n", "expected 'to LAT,LON,ALT SPEED'"},
        {"to 36,-84,nan 100m/s\n", "expected 'to LAT,LON,ALT SPEED'"},
        {"from 36,-84,900m 100m/s\n", "expected 'from LAT,LON,ALT HEADING SPEED'"},
        {"from 36,-84,900m 1e9 100m/s\n", "-360 to 360 degrees"},
        {"from 36,-84,900m 10 100m/s\nfrom 36,-84,900m 10 100m/s\n", "demo_test.demo:3: 'from' was given on line 2"},
        {"clearance 1m\n", "10 to 10000 m"},
        {"clearance\n", "expected 'clearance LENGTH'"},
        {"title\n", "expected 'title TEXT'"},
        {"aircraft\n", "expected 'aircraft NAME'"},
        {"view\n", "expected 'view VIEW' (one of cockpit|"},
        {"view moon\n", "found 'moon'"},
        {"stick\n", "expected 'stick FILE'"},
        {"stick no-such.reports\n", "there is no file 'no-such.reports' beside this one"},
        {"stick demo_test.demo\n" TO, "demo_test.demo:3: 'to', and 'stick' on line 2"},
        {"form 36,-84,900m 100m/s\n", "found 'form'; did you mean 'from'?"},
    };
    Demo *demo = calloc(1, sizeof *demo);
    assert_non_null(demo);
    assert_int_equal(read_text("# a comment\n title  Over the hills # and far away\n" TO, demo), RESULT_OK);
    assert_string_equal(demo->title, "Over the hills");
    for (size_t i = 0; i < COUNT_OF(BAD); i++) {
        char text[256];
        Heard heard;
        snprintf(text, sizeof text, "# first\n%s", BAD[i].text);
        heard_begin(&heard);
        Result result = read_text(text, demo);
        heard_end();
        if (result == RESULT_OK || heard.errors != 1 || !strstr(heard.text, BAD[i].said) ||
            strncmp(heard.text, "demo_test.demo:", 15) != 0)
            fail_msg("'%s': %s, said '%s', expected '%s'", BAD[i].text, result_name(result), heard.text, BAD[i].said);
    }
    free(demo);
}

static void too_many_places_are_told_with_the_line(void **state) {
    (void)state;
    char text[300 * sizeof TO] = "";
    Demo *demo = calloc(1, sizeof *demo);
    Heard heard;
    assert_non_null(demo);
    for (int i = 0; i <= DEMO_WAYPOINTS_MAX; i++)
        strcat(text, TO);
    heard_begin(&heard);
    assert_int_equal(read_text(text, demo), RESULT_FORMAT);
    heard_end();
    assert_string_equal(heard.text, "demo_test.demo:257: expected at most 256 lines 'to'\n");
    free(demo);
}

static void a_demo_without_places_goes_nowhere(void **state) {
    (void)state;
    Geoid *geoid = NULL;
    char path[PATHS_BYTES_MAX];
    Demo *demo = calloc(1, sizeof *demo);
    Heard heard;
    assert_non_null(demo);
    assert_int_equal(paths_find_data("geoid/egm96-15.pgm", path), RESULT_OK);
    assert_int_equal(geoid_open(path, &geoid), RESULT_OK);
    write_text("title Nowhere\n");
    heard_begin(&heard);
    assert_int_equal(demo_read(PATH, geoid, demo), RESULT_FORMAT);
    heard_end();
    unlink(PATH);
    assert_non_null(strstr(heard.text, "demo_test.demo: the demo flight goes nowhere; expected lines 'to "));
    geoid_close(&geoid);
    free(demo);
}

// What stands in the file, but depends on what else there is.
static void an_unknown_aircraft_is_told_with_file_and_line(void **state) {
    (void)state;
    Stand *stand = begin("round", false);
    char *argv[] = {(char *)PATH};
    Options *options = NULL;
    FlightSession *session = calloc(1, sizeof *session);
    Heard heard;
    assert_non_null(session);
    write_text("# first\naircraft t73\n" TO);
    assert_int_equal(options_create(COMMAND_DEMO, &options), RESULT_OK);
    assert_int_equal(options_read_arguments(options, 1, argv), RESULT_OK);
    heard_begin(&heard);
    Result unknown = session_create(&stand->world, options, session);
    heard_end();
    assert_int_equal(unknown, RESULT_NOT_FOUND);
    assert_non_null(strstr(heard.text, "demo_test.demo:2: aircraft: expected the file of an aircraft"));
    assert_non_null(strstr(heard.text, "found 't73'; did you mean 't37'?"));
    assert_int_equal(options_set(options, OPTION_AIRCRAFT, "c172", SOURCE_COMMAND_LINE, "--aircraft"), RESULT_OK);
    assert_int_equal(session_create(&stand->world, options, session), RESULT_OK); // it is not asked for
    assert_string_equal(session->aircraft.id, "c172");
    session_end(session);
    free(session);
    options_destroy(&options);
    unlink(PATH);
    end(stand);
}

static void three_demos_come_along_with_titles(void **state) {
    (void)state;
    DemoList list;
    char path[PATHS_BYTES_MAX];
    assert_int_equal(demo_list(&list), RESULT_OK);
    assert_true(list.count >= 3);
    for (int i = 0; i < list.count; i++) {
        assert_true(strlen(list.entries[i].title) > 10);
        assert_int_equal(demo_find(list.entries[i].name, path), RESULT_OK);
        assert_true(i == 0 || strcmp(list.entries[i - 1].name, list.entries[i].name) < 0);
    }
    assert_int_equal(demo_find("rond", path), RESULT_NOT_FOUND);
}

// To its end, and never into the ground.
static void check_flown(const char *name, double lowest_least_m) {
    Stand *stand = begin(name, false);
    FlightSession *session = &stand->session;
    double passed_s = 0.0, lowest_m = INFINITY;
    assert_true(session->demo_flies);
    for (; session->demo_flies && passed_s < FLIGHT_S_MOST; passed_s += FRAME_S) {
        session_advance(session, FRAME_S);
        lowest_m = fmin(lowest_m, flight_instruments(&session->flight).above_ground_m);
    }
    print_message("%s: %.0f s, never below %.0f m; %d crashes\n", name, passed_s, lowest_m, session->crashes);
    assert_false(session->demo_flies);
    assert_int_equal(session->crashes, 0);
    assert_true(lowest_m > lowest_least_m);
    end(stand);
}

static void demos_are_flown_to_their_end(void **state) {
    (void)state;
    check_flown("round", 60.0);
    check_flown("ridge", 30.0);
    check_flown("stick", 400.0);
}

// Nothing but the reports flies: a loop and a roll are in them, and at their end the hand is taken off.
static void the_sticks_reports_turn_the_aircraft_over(void **state) {
    (void)state;
    Stand *stand = begin("stick", false);
    FlightSession *session = &stand->session;
    double rolled_rad = 0.0, pitched_rad = 0.0, load_most = 0.0, last_bank_rad = 0.0, last_path_rad = 0.0;
    double last_s = stick_stream_duration_s(session->demo.stick) - 6.0;
    for (double passed_s = 0.0; session->demo_flies; passed_s += FRAME_S) {
        session_advance(session, FRAME_S);
        FlightInstruments now = flight_instruments(&session->flight);
        rolled_rad += fmax(session->flight.state.rate_body.x, 0.0) * FRAME_S;
        pitched_rad += fmax(session->flight.state.rate_body.y, 0.0) * FRAME_S;
        load_most = fmax(load_most, now.load_factor);
        last_bank_rad = passed_s > last_s ? fmax(last_bank_rad, fabs(now.bank_rad)) : 0.0;
        last_path_rad = passed_s > last_s ? fmax(last_path_rad, fabs(now.path_rad)) : 0.0;
    }
    print_message(
        "rolled right by %.1f rad, pitched up by %.1f rad, at most %.1f g; in the end within %.4f rad of bank "
        "and %.4f of path\n",
        rolled_rad, pitched_rad, load_most, last_bank_rad, last_path_rad);
    assert_true(last_bank_rad > 0.0 && last_bank_rad < 0.03 && last_path_rad < 0.03);
    assert_true(rolled_rad > 6.28 && pitched_rad > 6.28 && load_most > 3.0 && load_most < 6.0);
    assert_string_equal(session->aircraft.id, "t37");
    assert_int_equal(session->settings.view, CAMERA_CHASE);
    end(stand);
}

static void pass(FlightSession *session, double seconds) {
    for (double passed_s = 0.0; passed_s < seconds; passed_s += FRAME_S)
        session_advance(session, FRAME_S);
}

static void press(FlightSession *session, int key) {
    session_on_key(session, key, true, false);
    session_advance(session, FRAME_S);
    session_on_key(session, key, false, false);
}

static void a_stand_begins_again_when_nobody_steers(void **state) {
    (void)state;
    Stand *stand = begin("stick", true);
    FlightSession *session = &stand->session;
    const FlightState first = session->flight.state;
    pass(session, 5.0);
    assert_true(session->demo_flies);
    press(session, KEY_RIGHT);
    assert_false(session->demo_flies); // somebody has taken the controls
    pass(session, 30.0);
    press(session, KEY_LEFT); // and is still there
    pass(session, 30.0);
    assert_false(session->demo_flies);
    pass(session, 16.0);
    assert_true(session->demo_flies);
    pass(session, 3.0);
    press(session, KEY_ESCAPE); // leaves nothing: the next visitor wants to see something
    assert_false(session->leave_wanted);
    assert_true(session->demo_flies);
    assert_true(vec3d_length(vec3d_sub(session->flight.state.position_ecef, first.position_ecef)) < 10.0);
    // Nor does a pause, or what else was changed, outlast the visitor.
    press(session, 'W');
    press(session, 'P');
    assert_true(session->settings.wireframe && session->settings.clock.paused);
    pass(session, 50.0);
    assert_false(session->settings.wireframe || session->settings.clock.paused);
    assert_true(session->demo_flies);
    // Flown to its end it begins again, as it began.
    pass(session, stick_stream_duration_s(session->demo.stick) + 2.0);
    assert_true(session->demo_flies);
    assert_true(vec3d_length(vec3d_sub(session->flight.state.position_ecef, first.position_ecef)) < 1000.0);
    end(stand);
}

static void the_autopilot_holds_until_somebody_steers(void **state) {
    (void)state;
    Stand *stand = begin("round", false);
    FlightSession *session = &stand->session;
    press(session, KEY_UP); // takes over
    assert_false(session->demo_flies);
    pass(session, 2.0);
    press(session, 'O');
    assert_true(session->holds);
    FlightInstruments before = flight_instruments(&session->flight);
    pass(session, 60.0);
    FlightInstruments now = flight_instruments(&session->flight);
    print_message("after a minute: %.1f m higher, %.2f degrees off, %.2f m/s faster\n", now.h_m - before.h_m,
                  (now.heading_rad - before.heading_rad) * 57.3, now.speed_m_s - before.speed_m_s);
    assert_true(session->holds && fabs(now.h_m - before.h_m) < 10.0 && fabs(now.speed_m_s - before.speed_m_s) < 2.0);
    assert_true(fabs(remainder(now.heading_rad - before.heading_rad, 6.283185307179586)) < 0.02);
    // Far too low a height is not flown to, and it is said why.
    FrameOrder *order = calloc(1, sizeof *order);
    assert_non_null(order);
    session_order(session, 640, 400, 0.0, 0.0, order);
    assert_null(order->look.hud.warning);
    session->wish.height_m = 0.0;
    pass(session, 40.0);
    session_order(session, 640, 400, 0.0, 0.0, order);
    now = flight_instruments(&session->flight);
    print_message("%.0f m above the ground: %s\n", now.above_ground_m, order->look.hud.warning);
    assert_non_null(order->look.hud.warning);
    assert_int_equal(strncmp(order->look.hud.warning, "TERRAIN AHEAD", 13), 0);
    assert_true(session->crashes == 0 && now.above_ground_m > 20.0);
    free(order);
    press(session, KEY_LEFT);
    pass(session, 0.5);
    assert_false(session->holds);
    end(stand);
}

// Switched off while it rolls into a turn: what it held fades.
static void the_autopilot_lets_go_without_a_jump(void **state) {
    (void)state;
    Stand *stand = begin("round", false);
    FlightSession *session = &stand->session;
    press(session, KEY_UP);
    pass(session, 1.0);
    press(session, 'O');
    session->wish.heading_rad += 2.0;
    session->assist = false;
    pass(session, 0.25);
    const FlightState before = session->flight.state;
    session_on_key(session, 'O', true, false);
    session_advance(session, 2.0 * FLIGHT_STEP_S);
    const FlightState *now = &session->flight.state;
    assert_true(now->step > before.step);
    double elevator = fabs(now->elevator - before.elevator), aileron = fabs(now->aileron - before.aileron);
    print_message("aileron %.3f, then %.3f; elevator by %.4f, throttle by %.4f\n", before.aileron, now->aileron,
                  elevator, fabs(now->throttle - before.throttle));
    assert_false(session->holds);
    assert_true(fabs(before.aileron) > 0.1 && aileron < 0.1 * fabs(before.aileron) && elevator < 0.01);
    assert_true(fabs(now->throttle - before.throttle) < 0.01);
    pass(session, 1.0);
    assert_true(session->flight.state.aileron == 0.0);
    end(stand);
}

// Esc does not leave a stand.
static void the_keys_of_a_stand_are_told_as_they_are(void **state) {
    static FrameOrder order;
    (void)state;
    for (int kiosk = 0; kiosk < 2; kiosk++) {
        Stand *stand = begin("round", kiosk);
        session_order(&stand->session, 640, 400, 0.0, 0.0, &order);
        const RenderHelpRow *last = &order.look.hud.help[order.look.hud.help_count - 1];
        assert_string_equal(last->keys, "Esc");
        assert_string_equal(last->meaning, kiosk ? "begin the demonstration again" : "leave");
        end(stand);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_tells_its_title_and_where_it_is_wrong),
        cmocka_unit_test(too_many_places_are_told_with_the_line),
        cmocka_unit_test(a_demo_without_places_goes_nowhere),
        cmocka_unit_test(an_unknown_aircraft_is_told_with_file_and_line),
        cmocka_unit_test(three_demos_come_along_with_titles),
        cmocka_unit_test(demos_are_flown_to_their_end),
        cmocka_unit_test(the_sticks_reports_turn_the_aircraft_over),
        cmocka_unit_test(a_stand_begins_again_when_nobody_steers),
        cmocka_unit_test(the_autopilot_holds_until_somebody_steers),
        cmocka_unit_test(the_autopilot_lets_go_without_a_jump),
        cmocka_unit_test(the_keys_of_a_stand_are_told_as_they_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
