#include "app/pilot/feel.h"

#include "app/aircraft/airframe.h"
#include "app/dynamics/flight_contact.h"
#include "terrain/geodesy.h"

#include <math.h>

#define SHAKE_S 0.4     // that a message lasts
#define SHAKE_NEW_S 0.2 // before its end it is said again
#define SHAKE_LEVELS 8  // each change is a message

static double clamp(double value, double least, double greatest) {
    return fmin(fmax(value, least), greatest);
}

// The flow that has separated, where it is felt: in the air, and not when parked in the wind.
static double shake_of(const Flight *flight) {
    const FlightState *state = &flight->state;
    double alpha_rad, beta_rad;
    if (state->contact != FLIGHT_AIRBORNE)
        return 0.0;
    Vec3d air = vec3d_sub(state->velocity_ecef, flight->wind_ecef);
    airframe_angles(quatd_rotate(quatd_conjugate(state->ecef_from_body), air), &alpha_rad, &beta_rad);
    double stalled = airframe_stalled(flight->aircraft, alpha_rad, state->flaps);
    if (stalled < FEEL_STALLED)
        return 0.0;
    double shake = FEEL_SHAKE_LEAST + (1.0 - FEEL_SHAKE_LEAST) * (stalled - FEEL_STALLED) / (1.0 - FEEL_STALLED);
    return ceil(shake * SHAKE_LEVELS) / SHAKE_LEVELS;
}

// How fast it came down onto the ground there.
static double sink_m_s(const FlightState *before, const Flight *flight) {
    Vec3d point, normal;
    if (flight_ground_plane(&flight->ground, before->position_ecef, &point, &normal))
        return -vec3d_dot(before->velocity_ecef, normal);
    Geodetic place = geodesy_from_ecef(before->position_ecef);
    Mat3d enu = geodesy_enu_from_ecef(place.lat_rad, place.lon_rad);
    return -mat3d_mul_vec(&enu, before->velocity_ecef).z;
}

// 0: nothing touched.
static double knock_of(const FlightState *before, const Flight *flight) {
    FlightContact now = flight->state.contact;
    if (before->contact != FLIGHT_CRASHED && now == FLIGHT_CRASHED)
        return 1.0;
    if (before->contact != FLIGHT_AIRBORNE || now != FLIGHT_ROLLING)
        return 0.0;
    double share = clamp(sink_m_s(before, flight) / flight->aircraft->sink_limit, 0.0, 1.0);
    return FEEL_KNOCK_LEAST + (1.0 - FEEL_KNOCK_LEAST) * share;
}

FeelRumble feel_step(Feel *feel, const FlightState *before, const Flight *flight, double dt_s) {
    double knock = knock_of(before, flight), shake = shake_of(flight), was = feel->shake;
    feel->knock_s = fmax(feel->knock_s - dt_s, 0.0);
    feel->shake_s = fmax(feel->shake_s - dt_s, 0.0);
    if (knock > (feel->knock_s > 0.0 ? feel->knock : 0.0)) {
        *feel = (Feel){.knock = knock, .knock_s = FEEL_KNOCK_S};
        return (FeelRumble){knock, knock, FEEL_KNOCK_S};
    }
    if (feel->knock_s > 0.0 || (shake == was && (shake == 0.0 || feel->shake_s > SHAKE_NEW_S)))
        return (FeelRumble){0.0, 0.0, 0.0};
    feel->shake = shake;
    feel->shake_s = SHAKE_S;
    return (FeelRumble){shake, 0.0, SHAKE_S};
}
