// Recorded flights of the eye: those that any terrain has, and those from CSV files.
#include "app/track/track_format.h"
#include "heard.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define LOOKS 400

static World default_world(void) {
    Options *options;
    World world;
    assert_int_equal(options_create(COMMAND_MESH, &options), RESULT_OK);
    assert_int_equal(world_load(options, &world), RESULT_OK);
    options_destroy(&options);
    return world;
}

static Result load(const char *path, Track *out) {
    TrackReading how = track_reading_default();
    return track_load(path, &how, out);
}

static Track flown(const World *world, TrackKind kind) {
    Track track;
    assert_int_equal(track_builtin(world, kind, &track), RESULT_OK);
    return track;
}

static double above_ground(const World *world, const Viewpoint *at) {
    double ground;
    if (!terrain_ground_m(world->terrain, at->lat_deg, at->lon_deg, &ground))
        return NAN;
    return world_ellipsoid_m(world, at->lat_deg, at->lon_deg, at->alt_m) - ground;
}

static double mean_altitude(const Track *track) {
    double sum = 0.0;
    for (int i = 0; i < track->count; i++)
        sum += track->points[i].at.alt_m;
    return sum / track->count;
}

static void test_built_in_flights_stay_over_the_terrain_and_above_its_ground(void **state) {
    (void)state;
    World world = default_world();
    for (int kind = 0; kind < TRACK_KIND_COUNT; kind++) {
        Track track = flown(&world, (TrackKind)kind);
        for (int i = 0; i <= LOOKS; i++) {
            Viewpoint at = track_at(&track, track_duration_s(&track) * i / LOOKS);
            double above = above_ground(&world, &at);
            if (!(above > 50.0))
                fail_msg("%s, %d of %d: %g m above the ground", track.name, i, LOOKS, above);
        }
        track_clear(&track);
    }
    world_unload(&world);
}

static void test_built_in_flights_are_what_their_names_say(void **state) {
    (void)state;
    World world = default_world();
    Track tracks[TRACK_KIND_COUNT];
    for (int kind = 0; kind < TRACK_KIND_COUNT; kind++)
        tracks[kind] = flown(&world, (TrackKind)kind);
    assert_true(mean_altitude(&tracks[TRACK_RIDGE]) > mean_altitude(&tracks[TRACK_VALLEY]) + 200.0);
    const Track *pass = &tracks[TRACK_PASS], *dive = &tracks[TRACK_DIVE], *turn = &tracks[TRACK_TURN];
    double duration = track_duration_s(pass), middle = track_at(pass, 0.5 * duration).alt_m;
    assert_true(middle > track_at(pass, 0.0).alt_m + 50.0 && middle > track_at(pass, duration).alt_m + 50.0);
    assert_true(track_at(dive, 0.0).alt_m > track_at(dive, track_duration_s(dive)).alt_m + 1000.0);
    for (int i = 0; i < turn->count; i++) {
        assert_float_equal(turn->points[i].at.lat_deg, turn->points[0].at.lat_deg, 0.0);
        assert_float_equal(turn->points[i].at.heading_deg, fmod(360.0 * i / (turn->count - 1), 360.0), 1e-9);
    }
    for (int kind = 0; kind < TRACK_KIND_COUNT; kind++)
        track_clear(&tracks[kind]);
    world_unload(&world);
}

static void test_the_same_terrain_gives_the_same_flights(void **state) {
    (void)state;
    World first = default_world(), second = default_world();
    for (int kind = 0; kind < TRACK_KIND_COUNT; kind++) {
        Track a = flown(&first, (TrackKind)kind), b = flown(&second, (TrackKind)kind);
        assert_true(track_hash(&a) == track_hash(&b));
        assert_int_equal(a.count, b.count);
        track_clear(&a);
        track_clear(&b);
    }
    world_unload(&first);
    world_unload(&second);
}

// ---- between points ----

static Track track_of(TrackPoint *points, int count) {
    return (Track){.name = "here", .points = points, .count = count};
}

static Vec3d place(const Track *track, double t_s) {
    Viewpoint at = track_at(track, t_s);
    return geodesy_to_ecef((Geodetic){at.lat_deg * GEODESY_RAD_PER_DEG, at.lon_deg * GEODESY_RAD_PER_DEG, at.alt_m});
}

static void test_points_are_met_and_the_way_between_has_no_kinks(void **state) {
    (void)state;
    TrackPoint points[] = {{.t_s = 0, .at = {46, 8, 2000, 10, -5}},
                           {.t_s = 2, .at = {46.001, 8.001, 2100, 30, -6}},
                           {.t_s = 5, .at = {46.003, 8.001, 2050, 350, 5}},
                           {.t_s = 6, .at = {46.004, 8.003, 2000, 270, 0}}};
    Track track = track_of(points, COUNT_OF(points));
    for (size_t i = 0; i < COUNT_OF(points); i++) {
        Viewpoint at = track_at(&track, points[i].t_s);
        assert_float_equal(at.lat_deg, points[i].at.lat_deg, 1e-9);
        assert_float_equal(at.alt_m, points[i].at.alt_m, 1e-3);
        assert_float_equal(at.heading_deg, points[i].at.heading_deg, 1e-5);
    }
    for (int i = 1; i < 3; i++) { // speeds before and after a point
        double h = 0.01, t = points[i].t_s;
        Vec3d before = vec3d_scale(vec3d_sub(place(&track, t), place(&track, t - h)), 1.0 / h);
        Vec3d after = vec3d_scale(vec3d_sub(place(&track, t + h), place(&track, t)), 1.0 / h);
        assert_true(vec3d_distance(before, after) < 0.1 * vec3d_length(before)); // straight lines: 0.7
        assert_true(vec3d_length(before) > 20.0);
    }
}

static void test_directions_go_the_short_way_round(void **state) {
    (void)state;
    TrackPoint points[] = {{.t_s = 0, .at = {0, 179.999, 100, 350, 0}}, {.t_s = 1, .at = {0, 180.001, 100, 10, 0}}};
    Track track = track_of(points, COUNT_OF(points));
    Viewpoint middle = track_at(&track, 0.5);
    assert_true(middle.heading_deg < 0.01 || middle.heading_deg > 359.99);
    assert_float_equal(fabs(middle.lon_deg), 180.0, 1e-6);
    assert_float_equal(track_at(&track, -7.0).heading_deg, 350.0, 1e-6);
    assert_float_equal(track_at(&track, 9.0).heading_deg, 10.0, 1e-6);
}

// ---- files ----

static void file_of(const char *text, size_t bytes, char path[64]) {
    snprintf(path, 64, "test_track_%ld.csv", (long)getpid());
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, bytes, file), bytes);
    fclose(file);
}

static void test_a_written_flight_reads_back_the_same(void **state) {
    (void)state;
    World world = default_world();
    Track track = flown(&world, TRACK_PASS), back;
    char path[64];
    snprintf(path, sizeof path, "test_track_%ld.csv", (long)getpid());
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(track_write(&track, file));
    fclose(file);
    assert_int_equal(load(path, &back), RESULT_OK);
    assert_true(track_hash(&back) == track_hash(&track));
    assert_int_equal(strncmp(back.name, "test_track_", 11), 0);
    unlink(path);
    track_clear(&track);
    track_clear(&back);
    world_unload(&world);
}

static void test_columns_may_stand_in_any_order_and_directions_may_be_left_out(void **state) {
    (void)state;
    const char text[] =
        "\xEF\xBB\xBF# a flight\n\nlon_deg, alt_m ,\"lat_deg\",note,t_s\r\n8,1000,46,a,0\r\n8,1000,46.01,b,1.5\n";
    char path[64];
    Track track;
    file_of(text + 3, sizeof text - 4, path);
    assert_int_equal(load(path, &track), RESULT_OK);
    unlink(path);
    assert_int_equal(track.count, 2);
    assert_float_equal(track.points[1].at.lat_deg, 46.01, 0.0);
    assert_float_equal(track.points[0].at.heading_deg, 0.0, 1e-6); // northwards
    assert_float_equal(track.points[0].at.pitch_deg, 0.0, 1e-6);   // level flight
    assert_true(track_is_derived(&track));
    track_clear(&track);
}

static void test_what_is_wrong_with_a_file_is_told_with_its_line(void **state) {
    (void)state;
    static const struct {
        const char *text, *said;
    } CASES[] = {
        {"", ": the file is empty; expected a flight as .ofr"},
        {"# none\n", ":1: the file is empty"},
        {"t_s,lat_deg,lon_deg\n", ":1: expected the columns"},
        {"t_s, lat_deg,lon_deg,alt_ft\n", "derived,unix_s; found t_s,lat_deg,lon_deg,alt_ft\n"},
        {"t_s,lat_deg,lon_deg,alt_m,heading_deg\n", ":1: expected the columns"},
        {"t_s,lat_deg,lon_deg,alt_m\n", ":1: no points"},
        {"t_s,lat_deg,lon_deg,alt_m\n0,46,8,x\n", ":2: alt_m: found 'x'"},
        {"t_s,lat_deg,lon_deg,alt_m\n0,46,8\n", ":2: alt_m: found ''"},
        {"t_s,lat_deg,lon_deg,alt_m\n0,96,8,1\n", ":2: lat_deg: found '96'"},
        {"t_s,lat_deg,lon_deg,alt_m\n0,nan,8,1\n", ":2: lat_deg: found 'nan'"},
        {"t_s,lat_deg,lon_deg,alt_m\n0,46,8,1\n# back\n0,46,8,1\n", ":4: t_s: found 0 after 0"},
        {"t_s,lat_deg,lon_deg,alt_m\n0,46,8,1\n5,46,8,1\n4,46,8,1\n", ":4: t_s: found 4 after 5"},
        {"t_s,lat_deg,lon_deg,alt_m\n0,46,8", ":2: alt_m: found ''"},               // cut off, and nothing before it
        {"t_s,lat_deg,lon_deg,alt_m\n0,46,8,1\n1,x,8,1", ":3: lat_deg: found 'x'"}, // wrong, not cut off
    };
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        char path[64];
        Track track;
        Heard heard;
        heard_begin(&heard);
        file_of(CASES[i].text, strlen(CASES[i].text), path);
        Result result = load(path, &track);
        heard_end();
        unlink(path);
        if (result != RESULT_FORMAT || !strstr(heard.text, CASES[i].said))
            fail_msg("'%s': %s, said '%s', expected '%s'", CASES[i].text, result_name(result), heard.text,
                     CASES[i].said);
    }
}

static void test_a_line_without_end_is_refused(void **state) {
    (void)state;
    size_t bytes = 1 << 20;
    char *text = malloc(bytes), path[64];
    assert_non_null(text);
    memset(text, '1', bytes);
    file_of(text, bytes, path);
    Track track;
    Heard heard;
    heard_begin(&heard);
    assert_int_equal(load(path, &track), RESULT_FORMAT);
    heard_end();
    assert_non_null(strstr(heard.text, "4095 bytes"));
    unlink(path);
    free(text);
}

static void test_a_file_that_is_not_there_is_named(void **state) {
    (void)state;
    Track track;
    Heard heard;
    heard_begin(&heard);
    assert_int_equal(load("no-such-flight.csv", &track), RESULT_NOT_FOUND);
    heard_end();
    assert_non_null(strstr(heard.text, "no-such-flight.csv"));
}

// A stretch of 10 s and one of 4 s, with a gap of 20 s between them.
static Track two_stretches(void) {
    static const double TIMES[] = {0, 3, 7, 10, 30, 34};
    Track track = {.name = "two", .count = COUNT_OF(TIMES), .start_unix_s = NAN};
    track.points = calloc(COUNT_OF(TIMES), sizeof *track.points);
    assert_non_null(track.points);
    for (int i = 0; i < track.count; i++)
        track.points[i] = (TrackPoint){.t_s = TIMES[i], .at = {46.0 + 1e-3 * TIMES[i], 8.0, 1000.0, 0.0, 0.0}};
    track.points[4].flags = TRACK_GAP;
    return track;
}

static void test_points_are_made_at_even_times_within_each_stretch(void **state) {
    (void)state;
    static const double WANTED[] = {0, 4, 8, 10, 30, 34};
    Track track = two_stretches(), before = two_stretches();
    assert_int_equal(track_resample(&track, 4.0), RESULT_OK);
    assert_int_equal(track.count, COUNT_OF(WANTED));
    for (int i = 0; i < track.count; i++) {
        assert_float_equal(track.points[i].t_s, WANTED[i], 1e-12);
        assert_float_equal(track.points[i].at.lat_deg, track_at(&before, WANTED[i]).lat_deg, 1e-9);
        assert_int_equal(track.points[i].flags, i == 4 ? TRACK_GAP : 0);
    }
    Heard heard;
    heard_begin(&heard);
    assert_int_equal(track_resample(&track, 1e-6), RESULT_RANGE);
    heard_end();
    assert_non_null(strstr(heard.text, "are the most; take --interval 0.001 or longer"));
    assert_int_equal(track.count, COUNT_OF(WANTED));
    track_clear(&track);
    track_clear(&before);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_built_in_flights_stay_over_the_terrain_and_above_its_ground),
        cmocka_unit_test(test_built_in_flights_are_what_their_names_say),
        cmocka_unit_test(test_the_same_terrain_gives_the_same_flights),
        cmocka_unit_test(test_points_are_met_and_the_way_between_has_no_kinks),
        cmocka_unit_test(test_directions_go_the_short_way_round),
        cmocka_unit_test(test_a_written_flight_reads_back_the_same),
        cmocka_unit_test(test_columns_may_stand_in_any_order_and_directions_may_be_left_out),
        cmocka_unit_test(test_what_is_wrong_with_a_file_is_told_with_its_line),
        cmocka_unit_test(test_a_line_without_end_is_refused),
        cmocka_unit_test(test_points_are_made_at_even_times_within_each_stretch),
        cmocka_unit_test(test_a_file_that_is_not_there_is_named),
    };
    return cmocka_run_group_tests_name("test_track", tests, NULL, NULL);
}
