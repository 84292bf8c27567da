// The views of a flight: where the eye is, what it looks at, and that no view loses the aircraft or goes underground.
#include "app/flight/camera.h"
#include "app/flight/flight_map.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#define GROUND_M 300.0

static bool flat_ground(void *user, double lat_rad, double lon_rad, double *h_m) {
    (void)user;
    (void)lat_rad;
    (void)lon_rad;
    *h_m = GROUND_M;
    return true;
}

// A state as it is, whatever aircraft flies it.
static Flight flight_at(double lat_deg, double heading_rad, double above_m, double speed_m_s) {
    Flight flight = {.ground = {flat_ground, NULL}};
    double lat_rad = lat_deg * GEODESY_RAD_PER_DEG;
    flight.state.position_ecef = geodesy_to_ecef((Geodetic){lat_rad, 0.3, GROUND_M + above_m});
    flight.state.ecef_from_body = flight_attitude(lat_rad, 0.3, heading_rad, 0.0, 0.0);
    flight.state.velocity_ecef = vec3d_scale(quatd_rotate(flight.state.ecef_from_body, vec3d(1, 0, 0)), speed_m_s);
    return flight;
}

static void move(Flight *flight, double passed_s) {
    flight->state.position_ecef = vec3d_mad(flight->state.position_ecef, flight->state.velocity_ecef, passed_s);
}

static Vec3d seen(const RenderCamera *camera, Vec3d point_ecef) {
    return mat3d_mul_vec(&camera->camera_from_ecef, vec3d_sub(point_ecef, camera->eye_ecef));
}

static double above_ground_m(const RenderCamera *camera) {
    return geodesy_from_ecef(camera->eye_ecef).h_m - GROUND_M;
}

static void check_orthonormal(const RenderCamera *camera, const char *what) {
    const double(*m)[3] = camera->camera_from_ecef.m;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            double dot = m[i][0] * m[k][0] + m[i][1] * m[k][1] + m[i][2] * m[k][2];
            if (fabs(dot - (i == k)) > 1e-9 || !isfinite(dot))
                fail_msg("%s: rows %d and %d of the camera: %g", what, i, k, dot);
        }
}

static void test_every_view_is_a_camera_above_the_ground(void **state) {
    (void)state;
    static const double LATITUDES[] = {0.0, 47.0, -89.99, 90.0};
    for (int view = 0; view < CAMERA_VIEW_COUNT; view++)
        for (size_t i = 0; i < COUNT_OF(LATITUDES); i++)
            for (int attitude = 0; attitude < 6; attitude++) {
                Flight flight = flight_at(LATITUDES[i], attitude, attitude == 5 ? -20.0 : 2.0, attitude ? 60.0 : 0.0);
                if (attitude >= 3) // straight up, straight down, in the ground
                    flight.state.ecef_from_body = flight_attitude(LATITUDES[i] * GEODESY_RAD_PER_DEG, 0.3, 1.0,
                                                                  attitude == 3 ? 1.5707963 : -1.5707963, 2.0);
                CameraRig rig = {0};
                const CameraMotion still = {0};
                camera_rig_advance(&rig, &flight, (CameraView)view, &still, 0.01);
                RenderCamera camera = camera_of_flight(&flight, &rig, (CameraView)view, 1.0);
                check_orthonormal(&camera, camera_view_name((CameraView)view));
                if (above_ground_m(&camera) < 0.99)
                    fail_msg("%s: %.2f m above the ground", camera_view_name((CameraView)view),
                             above_ground_m(&camera));
            }
}

static void test_the_fly_by_looks_at_the_aircraft_and_waits_for_it_again_ahead(void **state) {
    (void)state;
    Flight flight = flight_at(47.0, 0.7, 500.0, 60.0);
    CameraRig rig = {0};
    const CameraMotion still = {0};
    int places = 0;
    double nearest_m = INFINITY, farthest_m = 0.0;
    Vec3d before = {0};
    for (int i = 0; i < 3600; i++, move(&flight, 1.0 / 60.0)) {
        camera_rig_advance(&rig, &flight, CAMERA_FLY_BY, &still, 1.0 / 60.0);
        RenderCamera camera = camera_of_flight(&flight, &rig, CAMERA_FLY_BY, 1.0);
        Vec3d at = seen(&camera, flight.state.position_ecef);
        assert_true(at.z < 0.0 && fabs(at.x) < 1e-6 && fabs(at.y) < 1e-6);
        places += vec3d_length(vec3d_sub(camera.eye_ecef, before)) > 0.0;
        before = camera.eye_ecef;
        nearest_m = fmin(nearest_m, -at.z);
        farthest_m = fmax(farthest_m, -at.z);
    }
    print_message("%d places in a minute, from %.1f to %.1f m away\n", places, nearest_m, farthest_m);
    assert_true(places >= 4 && places <= 10);
    assert_true(nearest_m > 20.0 && nearest_m < 100.0 && farthest_m < 500.0);
}

static void test_the_map_has_north_up_and_the_aircraft_in_its_middle(void **state) {
    (void)state;
    Flight flight = flight_at(47.0, 2.0, 500.0, 60.0);
    const CameraRig rig = {0};
    RenderCamera camera = camera_of_flight(&flight, &rig, CAMERA_MAP, 1.0);
    Vec3d at = seen(&camera, flight.state.position_ecef);
    assert_true(fabs(at.x) < 1e-6 && fabs(at.y) < 1e-6 && at.z < -3000.0);
    Vec3d north = seen(&camera, geodesy_to_ecef((Geodetic){47.01 * GEODESY_RAD_PER_DEG, 0.3, GROUND_M}));
    assert_true(fabs(north.x) < 1.0 && north.y > 1000.0);
}

// The map of now, for the aircraft in its middle.
static RenderCamera tell(const FlightMap *map, const Flight *flight, int next, RenderMap *out) {
    const CameraRig rig = {0};
    RenderCamera camera = camera_of_flight(flight, &rig, CAMERA_MAP, 1.0);
    flight_map_tell(map, flight, &camera, true, next, out);
    return camera;
}

// Pixels of a focal length of 1, between two places of the ground in the picture's middle, are what ground_m says.
static void test_the_map_knows_what_its_scale_holds_for(void **state) {
    (void)state;
    static FlightMap map;
    static RenderMap told;
    static const double ABOVE[] = {2.0, 500.0, 9000.0};
    for (size_t i = 0; i < COUNT_OF(ABOVE); i++) {
        Flight flight = flight_at(47.0, 2.0, ABOVE[i], 60.0);
        RenderCamera camera = tell(&map, &flight, -1, &told);
        Geodetic below = geodesy_from_ecef(flight.state.position_ecef);
        below.h_m = GROUND_M;
        Vec3d place = geodesy_to_ecef(below), east = vec3d(-sin(below.lon_rad), cos(below.lon_rad), 0.0);
        Vec3d here = seen(&camera, place), there = seen(&camera, vec3d_mad(place, east, 100.0));
        double apart = there.x / -there.z - here.x / -here.z;
        print_message("%.0f m above: the ground is %.3f m below the eye\n", ABOVE[i], told.ground_m);
        assert_true(fabs(apart * told.ground_m / 100.0 - 1.0) < 1e-6);
    }
}

static double height_m(const RenderMapPlace *place) {
    return geodesy_from_ecef(place->ecef).h_m;
}

static void test_the_trail_lies_on_the_ground_and_keeps_the_last_minutes(void **state) {
    (void)state;
    static FlightMap map;
    static RenderMap told;
    Flight flight = flight_at(47.0, 0.7, 500.0, 60.0);
    for (int i = 0; i <= 64 * 20; i++, move(&flight, 1.0 / 64.0))
        flight_map_note(&map, &flight, i / 64.0);
    (void)tell(&map, &flight, -1, &told);
    assert_int_equal(told.trail_count, 22); // 0 .. 20 s, and now
    for (int i = 0; i < told.trail_count; i++) {
        assert_true(fabs(height_m(&told.trail[i]) - GROUND_M) < 1e-3 && told.trail[i].apart == (i == 0));
        double way_m = i ? vec3d_distance(told.trail[i].ecef, told.trail[i - 1].ecef) : 60.0;
        assert_true(i == told.trail_count - 1 ? way_m < 2.0 : fabs(way_m - 60.0) < 0.1);
    }
    for (int i = 21; i <= 30; i++) // it stands
        flight_map_note(&map, &flight, i);
    (void)tell(&map, &flight, -1, &told);
    assert_int_equal(told.trail_count, 22);
    flight.state.position_ecef = vec3d_add(flight.state.position_ecef, vec3d(0, 0, 5000.0)); // a new start
    flight_map_note(&map, &flight, 31.0);
    for (int i = 32; i < 32 + FLIGHT_MAP_TRAIL - 5; i++, move(&flight, 1.0))
        flight_map_note(&map, &flight, i);
    (void)tell(&map, &flight, -1, &told);
    int gaps = 0;
    for (int i = 1; i < told.trail_count; i++)
        gaps += told.trail[i].apart;
    assert_int_equal(told.trail_count, FLIGHT_MAP_TRAIL + 1);
    assert_int_equal(gaps, 1);
    flight_map_note(&map, &flight, 0.0); // somebody jumped in time
    (void)tell(&map, &flight, -1, &told);
    assert_int_equal(told.trail_count, 2);
}

static void test_the_route_of_a_demo_leads_from_stop_to_stop(void **state) {
    (void)state;
    static FlightMap map;
    static RenderMap told;
    static Demo demo;
    Flight flight = flight_at(47.0, 0.7, 500.0, 60.0);
    double lat_rad = 47.0 * GEODESY_RAD_PER_DEG;
    demo.waypoints[0] = (Waypoint){lat_rad + 1e-3, 0.301, 2000.0, 60.0};
    demo.waypoints[1] = (Waypoint){lat_rad, 0.303, 1500.0, 60.0};
    demo.count = 2;
    flight_map_take_demo(&map, &flight, &demo);
    (void)tell(&map, &flight, 1, &told);
    int stops = 0;
    for (int i = 0; i < told.route_count; i++) {
        assert_true(fabs(height_m(&told.route[i]) - GROUND_M) < 1e-3);
        if (!told.route[i].stop)
            continue;
        Geodetic at = geodesy_from_ecef(told.route[i].ecef);
        assert_true(fabs(at.lat_rad - demo.waypoints[stops].lat_rad) < 1e-9);
        assert_true(fabs(at.lon_rad - demo.waypoints[stops].lon_rad) < 1e-9);
        assert_true((told.next == i) == (stops == 1));
        stops++;
    }
    print_message("%d places, %d of them stops\n", told.route_count, stops);
    assert_true(stops == 2 && told.route_count > 20);
}

static void test_the_free_camera_begins_where_the_view_was_and_goes_where_it_is_flown(void **state) {
    (void)state;
    Flight flight = flight_at(47.0, 0.7, 500.0, 60.0);
    CameraRig rig = {.view = CAMERA_CHASE};
    const CameraMotion still = {0}, right = {.turn = 1.0}, ahead = {.ahead = 1.0};
    RenderCamera chase = camera_of_flight(&flight, &rig, CAMERA_CHASE, 1.0);
    camera_rig_advance(&rig, &flight, CAMERA_FREE, &still, 0.0);
    RenderCamera camera = camera_of_flight(&flight, &rig, CAMERA_FREE, 1.0);
    assert_true(vec3d_length(vec3d_sub(camera.eye_ecef, chase.eye_ecef)) < 1e-6);
    for (int i = 0; i < 3; i++)
        assert_true(fabs(camera.camera_from_ecef.m[2][i] - chase.camera_from_ecef.m[2][i]) < 1e-6);
    move(&flight, 10.0); // the aircraft goes on alone
    camera_rig_advance(&rig, &flight, CAMERA_FREE, &ahead, 1.0);
    Vec3d way = seen(&camera, rig.eye_ecef);
    assert_true(way.z < -100.0 && fabs(way.x) < 1e-6 && fabs(way.y) < 1e-6);
    double heading = rig.heading_rad;
    camera_rig_advance(&rig, &flight, CAMERA_FREE, &right, 0.5);
    assert_true(remainder(rig.heading_rad - heading, 2.0 * GEODESY_PI) > 0.3);
    for (int i = 0; i < 3000; i++) { // straight on, into the ground
        const CameraMotion down = {.ahead = 1.0, .tilt = -1.0};
        camera_rig_advance(&rig, &flight, CAMERA_FREE, &down, 0.1);
    }
    camera = camera_of_flight(&flight, &rig, CAMERA_FREE, 1.0);
    check_orthonormal(&camera, "free");
    assert_true(above_ground_m(&camera) > 0.99);
}

static void test_a_head_turns_in_the_cockpit(void **state) {
    (void)state;
    Flight flight = flight_at(47.0, 0.7, 500.0, 60.0);
    const CameraRig right = {.look_right = 1.0}, up = {.look_up = 1.0}, both = {.look_right = -0.7, .look_up = -0.4};
    Vec3d nose = vec3d_mad(flight.state.position_ecef, quatd_rotate(flight.state.ecef_from_body, vec3d(1, 0, 0)), 9.0);
    RenderCamera camera = camera_of_flight(&flight, &right, CAMERA_COCKPIT, 1.0);
    assert_true(seen(&camera, nose).x < -5.0); // the nose is on the left now
    camera = camera_of_flight(&flight, &up, CAMERA_COCKPIT, 1.0);
    assert_true(seen(&camera, nose).y < -5.0);
    camera = camera_of_flight(&flight, &both, CAMERA_COCKPIT, 1.0);
    check_orthonormal(&camera, "a turned head");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_view_is_a_camera_above_the_ground),
        cmocka_unit_test(test_the_fly_by_looks_at_the_aircraft_and_waits_for_it_again_ahead),
        cmocka_unit_test(test_the_map_has_north_up_and_the_aircraft_in_its_middle),
        cmocka_unit_test(test_the_map_knows_what_its_scale_holds_for),
        cmocka_unit_test(test_the_trail_lies_on_the_ground_and_keeps_the_last_minutes),
        cmocka_unit_test(test_the_route_of_a_demo_leads_from_stop_to_stop),
        cmocka_unit_test(test_a_head_turns_in_the_cockpit),
        cmocka_unit_test(test_the_free_camera_begins_where_the_view_was_and_goes_where_it_is_flown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
