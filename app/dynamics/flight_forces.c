#include "app/dynamics/flight_forces.h"

#include "app/aircraft/airframe.h"
#include "app/aircraft/isa.h"
#include "app/aircraft/propulsion.h"
#include "app/aircraft/trim.h"

#include <math.h>

#define ALPHA_DOT_SPEED 10.0 // m/s: well below, the change of the angle of attack means nothing

// Where the aircraft is and what surrounds it.
typedef struct Place {
    double h_m;
    Vec3d gravity_body;
    Vec3d air_body; // velocity against the air
    Isa air;
} Place;

FlightStepSetting flight_setting(const FlightState *state) {
    Geodetic at = geodesy_from_ecef(state->position_ecef);
    Mat3d enu = geodesy_enu_from_ecef(at.lat_rad, at.lon_rad);
    double sin_lat = enu.m[2][2], w2 = 1.0 - GEODESY_E2 * sin_lat * sin_lat, normal_m = GEODESY_A_M / sqrt(w2);
    return (FlightStepSetting){.origin_ecef = state->position_ecef,
                               .origin_h_m = at.h_m,
                               .east = {enu.m[0][0], enu.m[0][1], enu.m[0][2]},
                               .north = {enu.m[1][0], enu.m[1][1], enu.m[1][2]},
                               .up = {enu.m[2][0], enu.m[2][1], enu.m[2][2]},
                               .east_curve = 1.0 / (normal_m + at.h_m),
                               .north_curve = 1.0 / (normal_m * (1.0 - GEODESY_E2) / w2 + at.h_m),
                               .ground_h_m = -INFINITY};
}

static double height_and_up(const FlightStepSetting *at, Vec3d position, Vec3d *up) {
    Vec3d way = vec3d_sub(position, at->origin_ecef);
    double e = vec3d_dot(way, at->east), n = vec3d_dot(way, at->north);
    *up = vec3d_normalize(vec3d_mad(vec3d_mad(at->up, at->east, e * at->east_curve), at->north, n * at->north_curve));
    return at->origin_h_m + vec3d_dot(way, at->up) + 0.5 * (e * e * at->east_curve + n * n * at->north_curve);
}

Geodetic flight_place(const FlightStepSetting *setting, Vec3d position) {
    Vec3d up;
    double h_m = height_and_up(setting, position, &up);
    return (Geodetic){asin(fmin(fmax(up.z, -1.0), 1.0)), atan2(up.y, up.x), h_m};
}

static Place look_around(const Flight *flight, const FlightState *state, const FlightStepSetting *setting) {
    Vec3d up;
    Place place = {.h_m = height_and_up(setting, state->position_ecef, &up)};
    Quatd body_from_ecef = quatd_conjugate(state->ecef_from_body);
    place.gravity_body = quatd_rotate(body_from_ecef, vec3d_scale(up, -trim_gravity(place.h_m)));
    place.air_body = quatd_rotate(body_from_ecef, vec3d_sub(state->velocity_ecef, flight->wind_ecef));
    place.air = isa_at(place.h_m);
    return place;
}

static AirframeLoad air_load(const Flight *flight, const FlightState *state, const FlightStepSetting *setting,
                             const Place *place) {
    const Aircraft *a = flight->aircraft;
    double wing_m = a->wing_z * vec3d_dot(place->gravity_body, vec3d(0.0, 0.0, -1.0)) / trim_gravity(0.0);
    AirframeFlow flow = {.air_body = place->air_body,
                         .rate_body = state->rate_body,
                         .density = place->air.density,
                         .elevator = state->elevator,
                         .aileron = state->aileron,
                         .rudder = state->rudder,
                         .flaps = state->flaps,
                         .gear = state->gear,
                         .wing_above_m = place->h_m - setting->ground_h_m + wing_m};
    return airframe_load(a, &flow);
}

GearPlane flight_gear_plane(const FlightState *state, const FlightStepSetting *setting, int leg) {
    if (leg >= setting->plane_count || !setting->planes[leg].there)
        return (GearPlane){.there = false};
    Quatd body_from_ecef = quatd_conjugate(state->ecef_from_body);
    Vec3d from = vec3d_sub(setting->planes[leg].point_ecef, state->position_ecef);
    return (GearPlane){true, quatd_rotate(body_from_ecef, from),
                       quatd_rotate(body_from_ecef, setting->planes[leg].normal_ecef)};
}

// Adds the wheels' forces and moments.
static void add_gear(const Flight *flight, const FlightState *state, const FlightStepSetting *setting, Vec3d *force,
                     Vec3d *moment, FlightMotion *out) {
    if (setting->plane_count == 0)
        return;
    GearMotion motion = {quatd_rotate(quatd_conjugate(state->ecef_from_body), state->velocity_ecef), state->rate_body,
                         state->rudder, setting->brake_left, setting->brake_right};
    for (int i = 0; i < setting->plane_count; i++) {
        GearPlane plane = flight_gear_plane(state, setting, i);
        GearLoad load = gear_load(&flight->aircraft->legs[i], &plane, &motion);
        if (!load.touches)
            continue;
        *force = vec3d_add(*force, load.force);
        out->ground_force_body = vec3d_add(out->ground_force_body, load.force);
        *moment = vec3d_add(*moment, load.moment);
        out->wheels = (uint8_t)(out->wheels | 1u << i);
        out->sink_m_s = fmax(out->sink_m_s, load.sink_m_s);
    }
}

// The change of the angle of attack, where it brings forth forces that change it: a (1 - k b) = a0.
static double alpha_dot(const Place *place, Vec3d acceleration, Vec3d force_each, double mass) {
    Vec3d v = place->air_body;
    double s2 = v.x * v.x + v.z * v.z, v0 = ALPHA_DOT_SPEED * ALPHA_DOT_SPEED;
    double k = s2 / (s2 * s2 + v0 * v0);
    double first = k * (acceleration.z * v.x - acceleration.x * v.z);
    double feedback = k * (force_each.z * v.x - force_each.x * v.z) / mass;
    return first / (1.0 - feedback);
}

static Vec3d angular_momentum(const Aircraft *a, Vec3d w) {
    return vec3d(a->ixx * w.x - a->ixz * w.z, a->iyy * w.y, a->izz * w.z - a->ixz * w.x);
}

// Euler's equation, solved for the change of the rates.
static Vec3d rate_change(const Aircraft *a, Vec3d w, Vec3d moment) {
    Vec3d m = vec3d_sub(moment, vec3d_cross(w, angular_momentum(a, w)));
    double det = a->ixx * a->izz - a->ixz * a->ixz;
    return vec3d((a->izz * m.x + a->ixz * m.z) / det, m.y / a->iyy, (a->ixz * m.x + a->ixx * m.z) / det);
}

FlightMotion flight_motion(const Flight *flight, const FlightState *state, const FlightStepSetting *setting) {
    const Aircraft *a = flight->aircraft;
    Place place = look_around(flight, state, setting);
    AirframeLoad load = air_load(flight, state, setting, &place);
    Propulsion engine = propulsion_at(a, &place.air, place.air_body.x, state->engine, state->throttle);
    FlightMotion out = {.velocity = state->velocity_ecef, .engine_rate = engine.engine_rate};
    out.air_force_body = vec3d_add(load.force, vec3d(engine.thrust_n, 0.0, 0.0));
    Vec3d force = out.air_force_body, moment = load.moment, w = state->rate_body;
    add_gear(flight, state, setting, &force, &moment, &out);
    Vec3d turning = vec3d_sub(vec3d_mad(place.gravity_body, force, 1.0 / a->mass), vec3d_cross(w, place.air_body));
    double change = alpha_dot(&place, turning, load.force_alpha_dot, a->mass);
    out.air_force_body = vec3d_mad(out.air_force_body, load.force_alpha_dot, change);
    force = vec3d_mad(force, load.force_alpha_dot, change);
    moment = vec3d_mad(moment, load.moment_alpha_dot, change);
    out.acceleration = quatd_rotate(state->ecef_from_body, vec3d_mad(place.gravity_body, force, 1.0 / a->mass));
    out.rate_change_body = rate_change(a, w, moment);
    Vec3d half = vec3d_scale(w, 0.5);
    out.attitude_change = quatd_mul(state->ecef_from_body, (Quatd){0.0, half.x, half.y, half.z});
    return out;
}

double flight_stiffness(const Flight *flight, const FlightStepSetting *setting) {
    const FlightState *state = &flight->state;
    double speed = vec3d_length(vec3d_sub(state->velocity_ecef, flight->wind_ecef));
    return airframe_stiffness(flight->aircraft, isa_at(setting->origin_h_m).density, speed) +
           vec3d_length(state->rate_body);
}
