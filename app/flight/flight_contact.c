#include "app/flight/flight_contact.h"

#include "app/flight/flight_forces.h"
#include "terrain/geodesy.h"

#include <math.h>

#define SWEEP_M 30.0 // ground is looked at so often along the way
#define SWEEP_MAX 8
#define SLOPE_REACH_M 12.0
#define FLOOR_M (-1500.0) // below every land: where there is no terrain, the flight ends here
#define LANDING_SINK 3.5  // m/s against the ground, at most
#define LANDING_SPEED 85.0
#define LANDING_BANK 0.35
#define LANDING_NOSE_UP 0.35
#define LANDING_NOSE_DOWN 0.12
#define ROLL_FRICTION 0.25 // m/s^2
#define BRAKES 2.5         // m/s^2 with the throttle closed
#define SETTLE_S 0.15      // the wheels take the slope's attitude
#define STEER_RATE 0.5     // rad/s at full rudder

static bool ground_height(const FlightGround *ground, Geodetic place, double *h_m) {
    return ground->height && ground->height(ground->user, place.lat_rad, place.lon_rad, h_m);
}

bool flight_ground_below(const FlightGround *ground, Vec3d position, double *above_m) {
    Geodetic place = geodesy_from_ecef(position);
    double h_m;
    if (!ground_height(ground, place, &h_m))
        return false;
    *above_m = place.h_m - h_m;
    return true;
}

// How deep the wheels are in the ground; negative above it.
static double wheel_depth(const FlightGround *ground, Vec3d position) {
    double above_m;
    if (flight_ground_below(ground, position, &above_m))
        return FLIGHT_GEAR_M - above_m;
    return FLOOR_M - geodesy_from_ecef(position).h_m;
}

static bool find_contact(const FlightGround *ground, Vec3d from, Vec3d to, Vec3d *where, double *depth_m) {
    Vec3d way = vec3d_sub(to, from);
    int count = (int)fmin(ceil(vec3d_length(way) / SWEEP_M), SWEEP_MAX);
    for (int i = 1; i <= count || i == 1; i++) {
        *where = i >= count ? to : vec3d_mad(from, way, (double)i / count);
        *depth_m = wheel_depth(ground, *where);
        if (*depth_m > 0.0)
            return true;
    }
    return false;
}

static double slope_along(const FlightGround *ground, Vec3d position, Vec3d direction) {
    double before, behind;
    bool known = flight_ground_below(ground, vec3d_mad(position, direction, SLOPE_REACH_M), &before) &&
                 flight_ground_below(ground, vec3d_mad(position, direction, -SLOPE_REACH_M), &behind);
    return known ? (behind - before) / (2.0 * SLOPE_REACH_M) : 0.0;
}

static Vec3d ground_normal(const FlightGround *ground, Vec3d position, const Mat3d *enu) {
    Vec3d east = {enu->m[0][0], enu->m[0][1], enu->m[0][2]}, north = {enu->m[1][0], enu->m[1][1], enu->m[1][2]};
    Vec3d local = {-slope_along(ground, position, east), -slope_along(ground, position, north), 1.0};
    return vec3d_normalize(mat3d_mul_vec_transposed(enu, local));
}

static bool is_gentle(const FlightState *state, Vec3d normal) {
    Quatd body_from_ecef = quatd_conjugate(state->ecef_from_body);
    Vec3d up = quatd_rotate(body_from_ecef, normal);
    double bank = atan2(-up.y, -up.z), nose = asin(fmin(fmax(up.x, -1.0), 1.0));
    double bank_limit = state->contact == FLIGHT_ROLLING ? 2.0 * LANDING_BANK : LANDING_BANK;
    return -vec3d_dot(state->velocity_ecef, normal) < LANDING_SINK && fabs(bank) < bank_limit &&
           nose < LANDING_NOSE_UP && nose > -LANDING_NOSE_DOWN && vec3d_length(state->velocity_ecef) < LANDING_SPEED;
}

static void crash(FlightState *state, Vec3d where) {
    state->position_ecef = where;
    state->velocity_ecef = state->rate_body = vec3d(0.0, 0.0, 0.0);
    state->contact = FLIGHT_CRASHED;
    state->crashed_s = 0.0;
    state->throttle = 0.0;
}

// Turns the body so that its roof comes towards the normal; the nose may stay above the slope.
static void settle_attitude(FlightState *state, Vec3d normal, double dt_s) {
    Vec3d up = quatd_rotate(quatd_conjugate(state->ecef_from_body), normal);
    double bank = atan2(-up.y, -up.z), nose = asin(fmin(fmax(up.x, -1.0), 1.0));
    double share = 1.0 - exp(-dt_s / SETTLE_S);
    Quatd level = quatd_from_axis_angle(vec3d(1.0, 0.0, 0.0), -bank * share);
    Quatd lift = quatd_from_axis_angle(vec3d(0.0, 1.0, 0.0), nose < 0.0 ? -nose * share : 0.0);
    state->ecef_from_body = quatd_normalize(quatd_mul(quatd_mul(state->ecef_from_body, lift), level));
    state->rate_body.x *= 1.0 - share;
}

static Vec3d slowed(Vec3d velocity, double by) {
    double speed = vec3d_length(velocity);
    return speed > by ? vec3d_scale(velocity, 1.0 - by / speed) : vec3d(0.0, 0.0, 0.0);
}

// Wheels roll ahead and not sideways, and steer with the rudder.
static void roll_on(FlightState *state, Vec3d normal, const Controls *controls, double dt_s) {
    Vec3d v = vec3d_mad(state->velocity_ecef, normal, -fmin(vec3d_dot(state->velocity_ecef, normal), 0.0));
    Vec3d wing = quatd_rotate(state->ecef_from_body, vec3d(0.0, 1.0, 0.0));
    v = vec3d_mad(v, wing, -vec3d_dot(v, wing) * (1.0 - exp(-dt_s / SETTLE_S)));
    v = slowed(v, (controls->throttle < 0.02 ? BRAKES : ROLL_FRICTION) * dt_s);
    state->velocity_ecef = v;
    double steer = STEER_RATE * controls->rudder * fmin(vec3d_length(v) / 10.0, 1.0) * dt_s;
    Quatd turn = quatd_from_axis_angle(normal, -steer);
    state->ecef_from_body = quatd_normalize(quatd_mul(turn, state->ecef_from_body));
}

// Lifting the aircraft out of the ground costs what the height is worth.
static void raise_out(FlightState *state, Vec3d up, double depth_m) {
    double v2 = vec3d_dot(state->velocity_ecef, state->velocity_ecef), worth = 2.0 * FLIGHT_GRAVITY * depth_m;
    state->position_ecef = vec3d_mad(state->position_ecef, up, depth_m);
    state->velocity_ecef = vec3d_scale(state->velocity_ecef, v2 > worth ? sqrt(1.0 - worth / v2) : 0.0);
}

void flight_touch_ground(Flight *flight, Vec3d from, const Controls *controls, double dt_s) {
    FlightState *state = &flight->state;
    Vec3d where;
    double depth_m;
    if (!find_contact(&flight->ground, from, state->position_ecef, &where, &depth_m)) {
        state->contact = FLIGHT_AIRBORNE;
        return;
    }
    Geodetic place = geodesy_from_ecef(where);
    Mat3d enu = geodesy_enu_from_ecef(place.lat_rad, place.lon_rad);
    Vec3d up = {enu.m[2][0], enu.m[2][1], enu.m[2][2]};
    Vec3d normal = ground_normal(&flight->ground, where, &enu);
    double above_m;
    if (!flight_ground_below(&flight->ground, where, &above_m) || !is_gentle(state, normal)) {
        crash(state, where);
        return;
    }
    state->contact = FLIGHT_ROLLING;
    raise_out(state, up, depth_m);
    roll_on(state, normal, controls, dt_s);
    settle_attitude(state, normal, dt_s);
}
