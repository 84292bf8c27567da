// Aircraft files: what they give, how broken ones are refused, and that no file makes the simulation leave the numbers.
#define _GNU_SOURCE
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/flight_support.h"

#include "base/paths.h"
#include "tests/heard.h"

#define TEXT_BYTES 16384
#define MUTANTS 1500

static void read_own(const char *name, char text[TEXT_BYTES]) {
    char relative[64], path[PATHS_BYTES_MAX];
    snprintf(relative, sizeof relative, "aircraft/%s.aircraft", name);
    assert_int_equal(paths_find_data(relative, path), RESULT_OK);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    size_t length = fread(text, 1, TEXT_BYTES - 1, file);
    text[length] = '\0';
    fclose(file);
}

static Result read_text(const char *text, size_t length, Aircraft *out, Heard *heard) {
    char path[] = "/tmp/overfly-XXXXXX.aircraft";
    int file = mkstemps(path, 9);
    assert_true(file >= 0);
    assert_int_equal(write(file, text, length), length);
    close(file);
    heard_begin(heard);
    Result result = aircraft_read(path, out);
    heard_end();
    unlink(path);
    return result;
}

static void replace(char text[TEXT_BYTES], const char *old, const char *with) {
    char *at = strstr(text, old);
    if (!at)
        fail_msg("the file has no '%s'", old);
    char rest[TEXT_BYTES];
    snprintf(rest, sizeof rest, "%s", at + strlen(old));
    snprintf(at, (size_t)(TEXT_BYTES - (at - text)), "%s%s", with, rest);
}

static void an_aircraft_is_read_in_si_units(void **state) {
    (void)state;
    Aircraft a = flight_type("c172");
    assert_string_equal(a.id, "c172");
    assert_string_equal(a.name, "Cessna 172P");
    const double values[][2] = {
        {a.mass, 2400.0 * 0.45359237},
        {a.ixx, 948.0 * 1.3558179483},
        {a.area, 174.0 * 0.09290304},
        {a.span, 36.0 * 0.3048},
        {a.torque, 311.2 * 1.3558179483},
        {a.rated_speed, 45.0},
        {a.elevator_rad, 28.0 * GEODESY_PI / 180.0},
        {a.published.climb_rate, 700.0 * 0.3048 / 60.0},
        {a.stall_width_rad, 10.0 * GEODESY_PI / 180.0}, // a default
        {a.legs[1].friction, 0.7},                      // another
        {a.legs[2].y, 1.27},
        {a.nose.x, 1.9},
    };
    for (size_t i = 0; i < COUNT_OF(values); i++)
        if (fabs(values[i][0] - values[i][1]) > 1e-4 * fabs(values[i][1]))
            fail_msg("value %zu: %.9g; expected %.9g", i, values[i][0], values[i][1]);
    assert_int_equal(a.engine, AIRCRAFT_PISTON);
    assert_int_equal(a.leg_count, 3);
    assert_true(isnan(flight_type("t37").published.stall_clean));
}

static void the_own_aircraft_are_listed_in_order(void **state) {
    (void)state;
    NamedFiles list;
    assert_int_equal(aircraft_list(&list), RESULT_OK);
    assert_int_equal(list.count, 3);
    for (int i = 1; i < list.count; i++)
        assert_true(strcmp(list.names[i - 1], list.names[i]) < 0);
}

static void broken_files_are_refused_with_file_and_line(void **state) {
    (void)state;
    static const struct {
        const char *old, *with, *said;
    } broken[] = {
        {"mass = 2400lb", "mass = heavy", ": [mass] mass: expected a number from 1 to 1e+06 (kg, lb"},
        {"mass = 2400lb", "mass = 0.5", "found '0.5"},
        {"mass = 2400lb", "mass = 2400ft", ": [mass] mass: expected"},
        {"mass = 2400lb", "mas = 2400lb", "no 'mas' in [mass]; did you mean 'mass'?"},
        {"mass = 2400lb", "", "'mass' is missing in [mass]"},
        {"[mass]", "[masses]", "in [masses]; did you mean [mass]?"},
        {"mass = 2400lb", "mass = 2400lb\nmass = 2300lb", "was given on line"},
        {"ixx = 948 slug ft2", "ixx = 9480 slug ft2", "no body has these moments of inertia"},
        {"ixz = 0 slug ft2", "ixz = 1900 slug ft2", "no body has these moments of inertia"},
        {"kind = piston", "kind = steam", "expected none, piston or jet; found 'steam'"},
        {"kind = piston", "kind = none", "an aircraft with the engine 'none' has no 'torque'; remove it"},
        {"torque = 311.2ft lbf", "", "'torque' is missing in [engine]"},
        {"nose = 1.9m, 0m, 0.1m", "nose = 1.9m, 0m", ": [hull] nose: expected AHEAD,RIGHT,DOWN"},
        {"nose = 1.9m, 0m, 0.1m", "nose = 1.9m, 0m, 300m", "at most 200 m"},
        {"[leg right]", "[leg left]", "was given on line"},
        {"stiffness = 32000 N/m", "", "'stiffness' is missing in [leg nose]"},
        {"stiffness = 32000 N/m", "stifness = 32000 N/m", "did you mean 'stiffness'?"},
        {"damping = 3200 N s/m", "damping = 1e7", "lower 'stiffness' or 'damping'"},
        {"maximum = 1.60", "maximum = 0.55", "no stall angle"},
        {"area = 174ft2", "area = 1900m2", "at a rate of"},
        {"name = Cessna 172P", "name =", "expected a text of 1 to 255 bytes"},
        {"mass = 2400lb", "mass 2400lb", "expected 'name = value'"},
    };
    for (size_t i = 0; i < COUNT_OF(broken); i++) {
        char text[TEXT_BYTES];
        Aircraft aircraft;
        Heard heard;
        read_own("c172", text);
        replace(text, broken[i].old, broken[i].with);
        Result result = read_text(text, strlen(text), &aircraft, &heard);
        if (result != RESULT_FORMAT || heard.errors != 1 || !strstr(heard.text, broken[i].said) ||
            !strstr(heard.text, ".aircraft:"))
            fail_msg("%s: %s: %s; expected \"%s\"", broken[i].with, result_name(result), heard.text, broken[i].said);
    }
}

static void two_wheels_are_too_few(void **state) {
    (void)state;
    char text[TEXT_BYTES];
    Aircraft aircraft;
    Heard heard;
    read_own("c172", text);
    char *leg = strstr(text, "[leg right]"), *after = strstr(text, "[published]");
    memmove(leg, after, strlen(after) + 1);
    assert_int_equal(read_text(text, strlen(text), &aircraft, &heard), RESULT_FORMAT);
    assert_non_null(strstr(heard.text, "2 legs; expected at least three"));
}

static void unknown_names_are_told_the_nearest(void **state) {
    (void)state;
    Aircraft aircraft;
    Heard heard;
    heard_begin(&heard);
    Result unknown = aircraft_load("c127", &aircraft), missing = aircraft_load("no/such.aircraft", &aircraft);
    heard_end();
    assert_int_equal(unknown, RESULT_NOT_FOUND);
    assert_int_equal(missing, RESULT_NOT_FOUND);
    assert_non_null(strstr(heard.text,
                           "aircraft: expected the file of an aircraft (.aircraft), or one of ask21, c172, t37; found "
                           "'c127'; did you mean 'c172'?"));
    assert_non_null(strstr(heard.text, "there is no file 'no/such.aircraft'"));
    assert_int_equal(heard.errors, 2);
}

static uint32_t next_random(uint32_t *seed) { // xorshift32
    *seed ^= *seed << 13;
    *seed ^= *seed >> 17;
    *seed ^= *seed << 5;
    return *seed;
}

// A few bytes changed, a line doubled or lost, the end cut off.
static size_t mutate(char *text, size_t length, uint32_t *seed) {
    static const char bytes[] = "0123456789.-+eE \n=[];,mklbft";
    for (uint32_t i = next_random(seed) % 4 + 1; i > 0; i--) {
        size_t at = next_random(seed) % length;
        text[at] = next_random(seed) % 8 ? bytes[next_random(seed) % (sizeof bytes - 1)] : (char)next_random(seed);
    }
    return next_random(seed) % 10 ? length : next_random(seed) % length + 1;
}

// What is not refused flies: finite, whatever it is.
static void mutated_files_are_refused_or_fly(void **state) {
    (void)state;
    uint32_t seed = 20260731;
    int read = 0;
    double ground = 0.0;
    print_message("seed %u\n", seed);
    for (int i = 0; i < MUTANTS; i++) {
        char text[TEXT_BYTES];
        Aircraft aircraft;
        Heard heard;
        read_own(flight_types[i % 3], text);
        size_t length = mutate(text, strlen(text), &seed);
        Result result = read_text(text, length, &aircraft, &heard);
        if (result != RESULT_OK && (result != RESULT_FORMAT || heard.errors != 1))
            fail_msg("mutant %d: %s with %d messages", i, result_name(result), heard.errors);
        if (result != RESULT_OK)
            continue;
        read++;
        Flight flight =
            flight_at(&aircraft, 100.0, 0.0, 0.0, aircraft.cruise_speed, (FlightGround){flight_flat, &ground});
        flight_on(&flight, (Controls){.elevator = 0.2, .aileron = 0.1, .throttle = 1.0}, 2.0);
    }
    print_message("%d of %d mutants were read, and flew\n", read, MUTANTS);
    assert_true(read > MUTANTS / 20 && read < MUTANTS);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_aircraft_is_read_in_si_units),
        cmocka_unit_test(the_own_aircraft_are_listed_in_order),
        cmocka_unit_test(broken_files_are_refused_with_file_and_line),
        cmocka_unit_test(two_wheels_are_too_few),
        cmocka_unit_test(unknown_names_are_told_the_nearest),
        cmocka_unit_test(mutated_files_are_refused_or_fly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
