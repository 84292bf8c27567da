// A flight between its points: bank, gaps, jumps; and attitude that is worked out from the path.
#include "app/track/track_attitude.h"
#include "app/track/track_build.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

#define NEAR(value, expected, within)                                                                                  \
    do {                                                                                                               \
        double found_ = (value), wanted_ = (expected);                                                                 \
        if (!(fabs(found_ - wanted_) <= (within)))                                                                     \
            fail_msg("%s: %.12g, expected %.12g within %g", #value, found_, wanted_, (double)(within));                \
    } while (0)

static Track track_of(TrackPoint *points, int count) {
    return (Track){.name = "here", .points = points, .count = count, .start_unix_s = NAN};
}

// ---- between points ----

static void test_a_roll_goes_on_through_upside_down(void **state) {
    (void)state;
    TrackPoint points[] = {{.t_s = 0, .at = {46, 8, 2000, 90, 0}, .bank_deg = 150},
                           {.t_s = 2, .at = {46, 8.001, 2000, 90, 0}, .bank_deg = -150}};
    Track track = track_of(points, 2);
    for (int i = 0; i <= 20; i++) {
        TrackState at = track_state_at(&track, 0.1 * i);
        NEAR(remainder(at.bank_deg - (150.0 + 3.0 * i), 360.0), 0.0, 1e-2); // the local frame turns by 0.001 degrees
        NEAR(at.at.heading_deg, 90.0, 1e-2);
        NEAR(at.at.pitch_deg, 0.0, 1e-2);
        assert_false(at.in_gap || at.derived);
    }
}

// Half of a rotation about one axis is half its angle: about the axis ahead, and about that to the right at 90 degrees
// of bank, where pulling turns the heading.
static void test_attitude_turns_about_one_axis(void **state) {
    (void)state;
    TrackPoint points[] = {{.t_s = 0, .at = {0, 0, 1000, 0, 0}, .bank_deg = 90},
                           {.t_s = 1, .at = {0, 0, 1000, 80, 0}, .bank_deg = 90},
                           {.t_s = 2, .at = {0, 0, 1000, 80, 60}, .bank_deg = 0},
                           {.t_s = 3, .at = {0, 0, 1000, 260, 60}, .bank_deg = 180}}; // over the top of a loop
    Track track = track_of(points, 4);
    TrackState pulled = track_state_at(&track, 0.5), over = track_state_at(&track, 2.5);
    NEAR(pulled.at.heading_deg, 40.0, 1e-5);
    NEAR(pulled.bank_deg, 90.0, 1e-5);
    NEAR(over.at.pitch_deg, 90.0, 1e-4);
}

static void test_points_are_met_with_their_bank(void **state) {
    (void)state;
    TrackPoint points[] = {{.t_s = 0, .at = {46, 8, 2000, 10, -5}, .bank_deg = 12},
                           {.t_s = 2, .at = {46.001, 8.001, 2100, 30, 80}, .bank_deg = -170},
                           {.t_s = 5, .at = {46.003, 8.001, 2050, 350, 5}, .bank_deg = 0}};
    Track track = track_of(points, 3);
    for (int i = 0; i < 3; i++) {
        TrackState at = track_state_at(&track, points[i].t_s);
        NEAR(at.at.heading_deg, points[i].at.heading_deg, 1e-5);
        NEAR(at.at.pitch_deg, points[i].at.pitch_deg, 1e-5);
        NEAR(at.bank_deg, points[i].bank_deg, 1e-5);
        NEAR(at.at.alt_m, points[i].at.alt_m, 1e-3);
    }
}

static void test_without_bank_the_eye_stays_level(void **state) {
    (void)state;
    TrackPoint points[] = {{.t_s = 0, .at = {46, 8, 2000, 10, -60}}, {.t_s = 1, .at = {46, 8, 2000, 150, 50}}};
    Track track = track_of(points, 2);
    for (int i = 0; i <= 10; i++) {
        TrackState at = track_state_at(&track, 0.1 * i);
        Viewpoint eye = track_at(&track, 0.1 * i);
        NEAR(at.bank_deg, 0.0, 0.0);
        NEAR(at.at.heading_deg, eye.heading_deg, 0.0);
    }
}

static void test_a_gap_is_held_and_told_and_bends_nothing_beside_it(void **state) {
    (void)state;
    TrackPoint points[] = {{.t_s = 0, .at = {46, 8, 2000, 0, 0}},
                           {.t_s = 1, .at = {46.001, 8, 2000, 0, 0}},
                           {.t_s = 60, .at = {46.5, 9, 500, 90, 0}, .flags = TRACK_GAP},
                           {.t_s = 61, .at = {46.5, 9.001, 500, 90, 0}}};
    Track track = track_of(points, 4);
    TrackState before = track_state_at(&track, 0.5), in = track_state_at(&track, 30.0),
               end = track_state_at(&track, 60.0);
    NEAR(before.at.lat_deg, 46.0005, 1e-7); // a straight line: no slope comes across
    assert_false(before.in_gap);
    assert_true(in.in_gap);
    NEAR(in.at.lat_deg, 46.001, 0.0);
    NEAR(in.at.heading_deg, 0.0, 0.0);
    assert_false(end.in_gap);
    NEAR(end.at.lon_deg, 9.0, 0.0);
    assert_int_equal(track_gap_count(&track), 1);
}

static void test_jumps_and_long_silences_are_gaps(void **state) {
    (void)state;
    TrackPoint points[40];
    for (int i = 0; i < 40; i++)
        points[i] = (TrackPoint){.t_s = i + (i >= 30 ? 10.5 : 0.0), .at = {46 + 3e-4 * i, 8, 1000, 0, 0}};
    points[20].at.lon_deg = 8.02; // 1.5 km in a second, and back
    Track track = track_of(points, 40);
    track_mark_gaps(&track);
    for (int i = 0; i < 40; i++)
        assert_int_equal(points[i].flags, i == 20 || i == 21 || i == 30 ? TRACK_GAP : 0);
}

static void test_what_is_fast_or_seldom_throughout_has_no_gaps(void **state) {
    (void)state;
    TrackPoint points[40];
    for (int i = 0; i < 40; i++) // 1600 m/s, a point a minute
        points[i] = (TrackPoint){.t_s = 60.0 * i, .at = {0, 0.9 * i, 30000, 0, 0}};
    Track track = track_of(points, 40);
    track_mark_gaps(&track);
    assert_int_equal(track_gap_count(&track), 0);
}

// ---- attitude from the path ----

#define POINTS 240

// A circle of this speed and turn rate, climbing; `per_s` points a second.
static void fly_circle(TrackPoint points[POINTS], double speed_m_s, double turn_deg_s, double climb_m_s, double per_s) {
    double omega = turn_deg_s * GEODESY_RAD_PER_DEG, radius = speed_m_s / omega, lat = 46.0;
    Geodetic here = {lat * GEODESY_RAD_PER_DEG, 8.0 * GEODESY_RAD_PER_DEG, 1500.0};
    Mat3d enu = geodesy_enu_from_ecef(here.lat_rad, here.lon_rad);
    for (int i = 0; i < POINTS; i++) {
        double t = i / per_s;
        Vec3d local = {radius * (1.0 - cos(omega * t)), radius * sin(omega * t), climb_m_s * t}; // northwards, right
        Geodetic at = geodesy_from_ecef(vec3d_add(geodesy_to_ecef(here), mat3d_mul_vec_transposed(&enu, local)));
        points[i] = (TrackPoint){.t_s = t, .flags = TRACK_DERIVED};
        points[i].at.lat_deg = at.lat_rad / GEODESY_RAD_PER_DEG;
        points[i].at.lon_deg = at.lon_rad / GEODESY_RAD_PER_DEG;
        points[i].at.alt_m = at.h_m;
    }
}

static void test_a_circle_gives_the_bank_of_a_coordinated_turn(void **state) {
    (void)state;
    static const struct {
        double speed_m_s, turn_deg_s, climb_m_s, per_s;
    } CASES[] = {{30, 18, 2, 1}, {30, -18, 2, 1}, {70, 3, 0, 1}, {25, 14, -1.5, 10}, {200, 6, 50, 4}};
    for (size_t k = 0; k < COUNT_OF(CASES); k++) {
        TrackPoint points[POINTS];
        fly_circle(points, CASES[k].speed_m_s, CASES[k].turn_deg_s, CASES[k].climb_m_s, CASES[k].per_s);
        Track track = track_of(points, POINTS);
        assert_int_equal(track_derive_attitude(&track), RESULT_OK);
        double omega = CASES[k].turn_deg_s * GEODESY_RAD_PER_DEG;
        double bank = atan(CASES[k].speed_m_s * omega / 9.80665) / GEODESY_RAD_PER_DEG;
        double pitch = atan(CASES[k].climb_m_s / CASES[k].speed_m_s) / GEODESY_RAD_PER_DEG;
        int edge = (int)(2.0 * TRACK_WINDOW_S * CASES[k].per_s) + 1; // where windows are not whole
        for (int i = edge; i < POINTS - edge; i++) {
            double heading = CASES[k].turn_deg_s * i / CASES[k].per_s;
            NEAR(remainder(points[i].at.heading_deg - heading, 360.0), 0.0, 0.1);
            NEAR(points[i].bank_deg, bank, 0.5);
            NEAR(points[i].at.pitch_deg, pitch, 0.5);
        }
    }
}

static void test_a_straight_flight_does_not_bank(void **state) {
    (void)state;
    TrackPoint points[60];
    for (int i = 0; i < 60; i++) // quantised as an IGC file is: 1/1000 minute, 1 m
        points[i] = (TrackPoint){.t_s = i,
                                 .at = {round((46 + 2e-4 * i) * 60000) / 60000, round((8 + 3e-4 * i) * 60000) / 60000,
                                        round(1000 + 0.7 * i), 0, 0},
                                 .flags = TRACK_DERIVED};
    Track track = track_of(points, 60);
    assert_int_equal(track_derive_attitude(&track), RESULT_OK);
    double heading = atan2(3e-4 * cos(46.0 * GEODESY_RAD_PER_DEG), 2e-4) / GEODESY_RAD_PER_DEG;
    for (int i = 3; i < 57; i++) {
        NEAR(points[i].at.heading_deg, heading, 1.5);
        NEAR(points[i].bank_deg, 0.0, 4.0);
        NEAR(points[i].at.pitch_deg, 1.3, 0.6);
    }
}

static void test_standing_still_says_nothing_of_heading(void **state) {
    (void)state;
    TrackPoint points[60];
    for (int i = 0; i < 60; i++) { // a minute on the apron, with the noise of a receiver, but for 20 s of flight east
        double way = i < 20 ? 0.0 : i < 40 ? 4e-4 * (i - 20) : 8e-3;
        points[i] = (TrackPoint){.t_s = i, .at = {46 + 2e-6 * (i * 7 % 3), 8 + way, 500, 0, 0}, .flags = TRACK_DERIVED};
    }
    Track track = track_of(points, 60);
    assert_int_equal(track_derive_attitude(&track), RESULT_OK);
    for (int i = 0; i < 60; i++) {
        NEAR(points[i].at.heading_deg, 90.0, 1.0);
        NEAR(points[i].bank_deg, 0.0, 2.0);
        NEAR(points[i].at.pitch_deg, 0.0, 0.1);
    }
}

static void test_attitude_does_not_look_across_a_gap(void **state) {
    (void)state;
    TrackPoint points[20];
    for (int i = 0; i < 20; i++) {
        points[i] = (TrackPoint){.t_s = i, .at = {46 + 3e-4 * i, 8, 1000, 0, 0}, .flags = TRACK_DERIVED};
        if (i >= 10)
            points[i].at = (Viewpoint){46.5, 8 + 4e-4 * (i - 10), 3000, 0, 0};
    }
    points[10].flags |= TRACK_GAP;
    Track track = track_of(points, 20);
    assert_int_equal(track_derive_attitude(&track), RESULT_OK);
    for (int i = 0; i < 20; i++) {
        NEAR(remainder(points[i].at.heading_deg - (i < 10 ? 0.0 : 90.0), 360.0), 0.0, 0.01);
        NEAR(points[i].bank_deg, 0.0, 0.05);
        NEAR(points[i].at.pitch_deg, 0.0, 0.05);
    }
}

static void test_recorded_attitude_is_left_alone(void **state) {
    (void)state;
    TrackPoint points[] = {{.t_s = 0, .at = {46, 8, 1000, 200, 45}, .bank_deg = 77},
                           {.t_s = 1, .at = {46.001, 8, 1000, 0, 0}, .flags = TRACK_DERIVED},
                           {.t_s = 2, .at = {46.002, 8, 1000, 200, 45}, .bank_deg = 77}};
    Track track = track_of(points, 3);
    assert_int_equal(track_derive_attitude(&track), RESULT_OK);
    NEAR(points[0].bank_deg, 77.0, 0.0);
    NEAR(points[2].at.heading_deg, 200.0, 0.0);
    NEAR(remainder(points[1].at.heading_deg, 360.0), 0.0, 1e-6);
    assert_true(track_state_at(&track, 0.5).derived);
}

static void test_one_point_is_a_flight(void **state) {
    (void)state;
    TrackPoint points[] = {{.t_s = 0, .at = {46, 8, 1000, 0, 0}, .flags = TRACK_DERIVED}};
    Track track = track_of(points, 1);
    track_mark_gaps(&track);
    assert_int_equal(track_derive_attitude(&track), RESULT_OK);
    NEAR(track_state_at(&track, 5.0).at.alt_m, 1000.0, 0.0);
    NEAR(points[0].bank_deg, 0.0, 0.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_roll_goes_on_through_upside_down),
        cmocka_unit_test(test_attitude_turns_about_one_axis),
        cmocka_unit_test(test_points_are_met_with_their_bank),
        cmocka_unit_test(test_without_bank_the_eye_stays_level),
        cmocka_unit_test(test_a_gap_is_held_and_told_and_bends_nothing_beside_it),
        cmocka_unit_test(test_jumps_and_long_silences_are_gaps),
        cmocka_unit_test(test_what_is_fast_or_seldom_throughout_has_no_gaps),
        cmocka_unit_test(test_a_circle_gives_the_bank_of_a_coordinated_turn),
        cmocka_unit_test(test_a_straight_flight_does_not_bank),
        cmocka_unit_test(test_standing_still_says_nothing_of_heading),
        cmocka_unit_test(test_attitude_does_not_look_across_a_gap),
        cmocka_unit_test(test_recorded_attitude_is_left_alone),
        cmocka_unit_test(test_one_point_is_a_flight),
    };
    return cmocka_run_group_tests_name("test_track_attitude", tests, NULL, NULL);
}
