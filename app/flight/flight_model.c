#include "app/flight/flight_model.h"

#include "app/flight/flight_contact.h"
#include "app/flight/flight_forces.h"
#include "terrain/geodesy.h"

#include <math.h>

#define START_CLEARANCE_M 60.0
#define RESET_CLEARANCE_M 300.0
#define RESET_SPEED 100.0
#define ENGINE_LAG_S 0.8

static double clamp(double value, double least, double greatest) {
    return fmin(fmax(value, least), greatest);
}

Quatd flight_attitude(double lat_rad, double lon_rad, double heading_rad, double pitch_rad, double bank_rad) {
    // ECEF from east-north-up, then north-east-down to body by heading, pitch, bank.
    Quatd lon = quatd_from_axis_angle(vec3d(0, 0, 1), lon_rad);
    Quatd lat = quatd_from_axis_angle(vec3d(0, 1, 0), -lat_rad - GEODESY_PI / 2.0);
    Quatd yaw = quatd_from_axis_angle(vec3d(0, 0, 1), heading_rad);
    Quatd pitch = quatd_from_axis_angle(vec3d(0, 1, 0), pitch_rad);
    Quatd roll = quatd_from_axis_angle(vec3d(1, 0, 0), bank_rad);
    return quatd_normalize(quatd_mul(quatd_mul(quatd_mul(quatd_mul(lon, lat), yaw), pitch), roll));
}

double flight_trim_alpha(double speed_m_s, double h_m) {
    double pressure = FLIGHT_LIFT * flight_density(h_m) * fmax(speed_m_s * speed_m_s, 1.0);
    double weight = fmax(flight_gravity(h_m) - speed_m_s * speed_m_s / GEODESY_A_M, 0.0);
    return fmin(weight / (pressure * FLIGHT_LIFT_SLOPE), FLIGHT_STALL_RAD);
}

double flight_trim_throttle(double speed_m_s, double h_m) {
    double pressure = FLIGHT_LIFT * flight_density(h_m) * speed_m_s * speed_m_s;
    double drag = pressure * flight_drag_coefficient(flight_trim_alpha(speed_m_s, h_m));
    return clamp(drag / flight_thrust(1.0, h_m), 0.0, 1.0);
}

static double height_above_ground(const FlightGround *ground, double lat_rad, double lon_rad, double h_m) {
    double ground_m;
    return ground->height && ground->height(ground->user, lat_rad, lon_rad, &ground_m) ? h_m - ground_m : INFINITY;
}

Flight flight_create(const FlightStart *start, FlightGround ground) {
    double above_m = height_above_ground(&ground, start->lat_rad, start->lon_rad, start->h_m);
    double h_m = start->h_m + fmax(START_CLEARANCE_M - above_m, 0.0);
    double alpha = flight_trim_alpha(start->speed_m_s, h_m);
    Flight flight = {.ground = ground};
    FlightState *state = &flight.state;
    state->position_ecef = geodesy_to_ecef((Geodetic){start->lat_rad, start->lon_rad, h_m});
    Quatd path = flight_attitude(start->lat_rad, start->lon_rad, start->heading_rad, start->pitch_rad, 0.0);
    state->velocity_ecef = vec3d_scale(quatd_rotate(path, vec3d(1, 0, 0)), start->speed_m_s);
    state->ecef_from_body =
        flight_attitude(start->lat_rad, start->lon_rad, start->heading_rad, start->pitch_rad + alpha, 0.0);
    state->throttle = flight_trim_throttle(start->speed_m_s, h_m);
    return flight;
}

static void begin_anew(Flight *flight) {
    FlightInstruments now = flight_instruments(flight);
    FlightStart start = {.lat_rad = now.lat_rad,
                         .lon_rad = now.lon_rad,
                         .h_m = fmax(now.h_m, 0.0) + RESET_CLEARANCE_M,
                         .heading_rad = now.heading_rad,
                         .speed_m_s = RESET_SPEED};
    int64_t step = flight->state.step;
    *flight = flight_create(&start, flight->ground);
    flight->state.step = step;
}

static Quatd quatd_mad(Quatd a, Quatd b, double s) { // a + b s
    return (Quatd){a.w + b.w * s, a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}

// `state` moved along `motion` for `dt_s`. Not normalised: the stages of an integration need the plain sum.
static FlightState moved(const FlightState *state, const FlightMotion *motion, double dt_s) {
    FlightState next = *state;
    next.position_ecef = vec3d_mad(state->position_ecef, motion->velocity, dt_s);
    next.velocity_ecef = vec3d_mad(state->velocity_ecef, motion->acceleration, dt_s);
    next.rate_body = vec3d_mad(state->rate_body, motion->rate_change_body, dt_s);
    next.ecef_from_body = quatd_mad(state->ecef_from_body, motion->attitude_change, dt_s);
    return next;
}

static FlightMotion summed(const FlightMotion *a, const FlightMotion *b, double s) { // a + b s
    return (FlightMotion){vec3d_mad(a->velocity, b->velocity, s), vec3d_mad(a->acceleration, b->acceleration, s),
                          quatd_mad(a->attitude_change, b->attitude_change, s),
                          vec3d_mad(a->rate_change_body, b->rate_change_body, s)};
}

// The classical Runge-Kutta step of fourth order.
static FlightState integrate(const FlightState *state, const Controls *controls, double dt_s) {
    FlightMotion k1 = flight_motion(state, controls);
    FlightState stage = moved(state, &k1, 0.5 * dt_s);
    FlightMotion k2 = flight_motion(&stage, controls);
    stage = moved(state, &k2, 0.5 * dt_s);
    FlightMotion k3 = flight_motion(&stage, controls);
    stage = moved(state, &k3, dt_s);
    FlightMotion k4 = flight_motion(&stage, controls);
    FlightMotion sum = summed(&k1, &k2, 2.0);
    sum = summed(&sum, &k3, 2.0);
    sum = summed(&sum, &k4, 1.0);
    FlightState next = moved(state, &sum, dt_s / 6.0);
    next.ecef_from_body = quatd_normalize(next.ecef_from_body);
    return next;
}

void flight_step(Flight *flight, const Controls *controls, double dt_s) {
    FlightState *state = &flight->state;
    state->step++;
    if (state->contact == FLIGHT_CRASHED) {
        state->crashed_s += dt_s;
        if (state->crashed_s >= FLIGHT_RESET_S)
            begin_anew(flight);
        return;
    }
    state->throttle += (controls->throttle - state->throttle) * (1.0 - exp(-dt_s / ENGINE_LAG_S));
    Vec3d from = state->position_ecef;
    *state = integrate(state, controls, dt_s);
    flight_touch_ground(flight, from, controls, dt_s);
}

FlightInstruments flight_instruments(const Flight *flight) {
    const FlightState *state = &flight->state;
    Geodetic place = geodesy_from_ecef(state->position_ecef);
    Mat3d enu = geodesy_enu_from_ecef(place.lat_rad, place.lon_rad);
    Vec3d ahead = mat3d_mul_vec(&enu, quatd_rotate(state->ecef_from_body, vec3d(1, 0, 0)));
    Vec3d wing = mat3d_mul_vec(&enu, quatd_rotate(state->ecef_from_body, vec3d(0, 1, 0)));
    Vec3d belly = mat3d_mul_vec(&enu, quatd_rotate(state->ecef_from_body, vec3d(0, 0, 1)));
    double heading = atan2(ahead.x, ahead.y), beta;
    FlightInstruments out = {.lat_rad = place.lat_rad,
                             .lon_rad = place.lon_rad,
                             .h_m = place.h_m,
                             .heading_rad = heading < 0.0 ? heading + 2.0 * GEODESY_PI : heading,
                             .pitch_rad = asin(clamp(ahead.z, -1.0, 1.0)),
                             .bank_rad = atan2(-wing.z, -belly.z),
                             .speed_m_s = vec3d_length(state->velocity_ecef),
                             .vertical_speed_m_s = mat3d_mul_vec(&enu, state->velocity_ecef).z};
    flight_air_angles(quatd_rotate(quatd_conjugate(state->ecef_from_body), state->velocity_ecef), &out.alpha_rad,
                      &beta);
    out.over_ground = flight_ground_below(&flight->ground, state->position_ecef, &out.above_ground_m);
    return out;
}
