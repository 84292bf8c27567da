#include "app/dynamics/flight_contact.h"

#include "terrain/geodesy.h"

#include <math.h>

#define SWEEP_M 30.0 // ground is looked at so often along the way
#define SWEEP_MAX 8
#define REACH_M 0.5       // between the heights that make a plane
#define FLOOR_M (-1500.0) // below every land: where there is no terrain, the flight ends here
#define GEAR_DOWN 0.99    // of the gear's way; before, nothing bears

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

static bool ground_height_at(const FlightGround *ground, Vec3d position, double *h_m) {
    return ground_height(ground, geodesy_from_ecef(position), h_m);
}

bool flight_ground_plane(const FlightGround *ground, Vec3d position, Vec3d *point, Vec3d *normal) {
    Geodetic place = geodesy_from_ecef(position);
    double here, north, east;
    if (!ground_height(ground, place, &here))
        return false;
    Mat3d enu = geodesy_enu_from_ecef(place.lat_rad, place.lon_rad);
    Vec3d e = {enu.m[0][0], enu.m[0][1], enu.m[0][2]}, n = {enu.m[1][0], enu.m[1][1], enu.m[1][2]};
    Vec3d up = {enu.m[2][0], enu.m[2][1], enu.m[2][2]};
    if (!ground_height_at(ground, vec3d_mad(position, n, REACH_M), &north))
        north = here;
    if (!ground_height_at(ground, vec3d_mad(position, e, REACH_M), &east))
        east = here;
    *point = vec3d_mad(position, up, here - place.h_m);
    *normal = vec3d_normalize(vec3d_mad(vec3d_mad(up, n, (here - north) / REACH_M), e, (here - east) / REACH_M));
    return true;
}

static Vec3d place_of(const FlightState *state, Vec3d body) {
    return vec3d_add(state->position_ecef, quatd_rotate(state->ecef_from_body, body));
}

// How far the aircraft's farthest part is from its centre of gravity.
static double radius_of(const Aircraft *a) {
    double farthest = fmax(fmax(vec3d_length(a->nose), vec3d_length(a->tail)), vec3d_length(a->tip));
    for (int i = 0; i < a->leg_count; i++)
        farthest = fmax(farthest, vec3d_length((Vec3d){a->legs[i].x, a->legs[i].y, a->legs[i].z}));
    return fmax(farthest, vec3d_length(a->belly));
}

FlightStepSetting flight_look_at_ground(const Flight *flight, const Controls *controls) {
    const FlightState *state = &flight->state;
    FlightStepSetting setting = flight_setting(state);
    setting.brake_left = controls->brake_left;
    setting.brake_right = controls->brake_right;
    double h_m, reach_m = radius_of(flight->aircraft) + vec3d_length(state->velocity_ecef) * FLIGHT_STEP_S;
    if (!ground_height(&flight->ground, flight_place(&setting, state->position_ecef), &h_m))
        return setting;
    setting.ground_h_m = h_m;
    if (setting.origin_h_m - h_m > 2.0 * reach_m || state->gear < GEAR_DOWN)
        return setting;
    setting.plane_count = flight->aircraft->leg_count;
    for (int i = 0; i < setting.plane_count; i++) {
        const AircraftLeg *leg = &flight->aircraft->legs[i];
        setting.planes[i].there = flight_ground_plane(&flight->ground, place_of(state, (Vec3d){leg->x, leg->y, leg->z}),
                                                      &setting.planes[i].point_ecef, &setting.planes[i].normal_ecef);
    }
    return setting;
}

// Height above the ground, or above the floor of the world where there is none.
static double height_of(const FlightGround *ground, const FlightStepSetting *setting, Vec3d position) {
    Geodetic place = flight_place(setting, position);
    double h_m;
    return place.h_m - (ground_height(ground, place, &h_m) ? h_m : FLOOR_M);
}

// Where the centre of gravity came into the ground, if it did; else how high it is at the end.
static bool find_contact(const FlightGround *ground, const FlightStepSetting *setting, Vec3d to, Vec3d *where,
                         double *above_m) {
    Vec3d from = setting->origin_ecef, way = vec3d_sub(to, from);
    int count = (int)fmin(ceil(vec3d_length(way) / SWEEP_M), SWEEP_MAX);
    for (int i = 1; i <= count || i == 1; i++) {
        *where = i >= count ? to : vec3d_mad(from, way, (double)i / count);
        *above_m = height_of(ground, setting, *where);
        if (*above_m <= 0.0)
            return true;
    }
    return false;
}

static bool hull_touches(const Flight *flight, const FlightStepSetting *setting) {
    const Aircraft *a = flight->aircraft;
    const Vec3d parts[] = {a->nose, a->tail, a->tip, {a->tip.x, -a->tip.y, a->tip.z}, a->belly};
    for (size_t i = 0; i < COUNT_OF(parts); i++)
        if (height_of(&flight->ground, setting, place_of(&flight->state, parts[i])) < 0.0)
            return true;
    return false;
}

static void crash(FlightState *state, Vec3d where) {
    state->position_ecef = where;
    state->velocity_ecef = state->rate_body = vec3d(0.0, 0.0, 0.0);
    state->contact = FLIGHT_CRASHED;
    state->crashed_s = 0.0;
    state->throttle = state->engine = 0.0;
    state->wheels = 0;
}

void flight_touch_ground(Flight *flight, const FlightStepSetting *setting, uint8_t wheels, double sink_m_s) {
    FlightState *state = &flight->state;
    Vec3d where;
    double above_m;
    state->wheels = wheels;
    state->contact = wheels ? FLIGHT_ROLLING : FLIGHT_AIRBORNE;
    if (find_contact(&flight->ground, setting, state->position_ecef, &where, &above_m)) {
        crash(state, where);
        return;
    }
    bool near = above_m < radius_of(flight->aircraft);
    if (sink_m_s > flight->aircraft->sink_limit || (near && hull_touches(flight, setting)))
        crash(state, state->position_ecef);
}
