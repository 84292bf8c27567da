#include "app/flight/flight_forces.h"

#include "terrain/geodesy.h"

#include <math.h>

#define SPEED_MIN 1.0       // below, directions of flight mean nothing
#define TURN_SPEED_MIN 20.0 // below, the nose no longer follows the path's turning
#define ROLL_RATE 1.7       // rad/s at full aileron
#define LOAD_STICK 3.0      // g at full stick
#define SIDESLIP_MAX 0.17   // rad at full rudder
#define SIDE_FORCE 0.6      // per radian of sideslip
#define NOSE_STIFFNESS 3.0  // 1/s: how fast the nose closes in on the wanted angles
#define RATE_LAG_S 0.12     // rates follow what is commanded with this lag
#define RATE_MAX 3.0        // rad/s commanded
#define LEVEL_BANK_COS 0.45 // up to some 63 degrees of bank a turn is held level
#define DRAG_RATE_MAX 60.0  // 1/s: keeps the explicit step stable at speeds no aircraft survives

static double clamp(double value, double least, double greatest) {
    return fmin(fmax(value, least), greatest);
}

double flight_density(double h_m) {
    return exp(-clamp(h_m, -2000.0, 90000.0) / 9000.0);
}

double flight_gravity(double h_m) {
    double ratio = GEODESY_A_M / (GEODESY_A_M + fmax(h_m, -20000.0));
    return FLIGHT_GRAVITY * ratio * ratio;
}

double flight_thrust(double throttle, double h_m) {
    return throttle * FLIGHT_THRUST * pow(flight_density(h_m), 0.7);
}

// Beyond the stall the lift of a flat plate, sin 2a, scaled to 0.9.
double flight_lift_coefficient(double alpha_rad) {
    double linear = FLIGHT_LIFT_SLOPE * alpha_rad, plate = 0.9 * sin(2.0 * alpha_rad);
    double beyond = clamp((fabs(alpha_rad) - FLIGHT_STALL_RAD) / 0.12, 0.0, 1.0);
    double blend = beyond * beyond * (3.0 - 2.0 * beyond);
    return linear * (1.0 - blend) + plate * blend;
}

double flight_drag_coefficient(double alpha_rad) {
    double lift = flight_lift_coefficient(alpha_rad), s = sin(alpha_rad);
    return FLIGHT_DRAG_ZERO + FLIGHT_DRAG_LIFT * fmin(lift * lift, 2.0) + 1.2 * s * s * fabs(s);
}

void flight_air_angles(Vec3d v, double *alpha_rad, double *beta_rad) {
    double speed = vec3d_length(v);
    *alpha_rad = speed > SPEED_MIN ? atan2(v.z, v.x) : 0.0;
    *beta_rad = speed > SPEED_MIN ? asin(clamp(v.y / speed, -1.0, 1.0)) : 0.0;
}

// What the forces depend on; vectors in body axes.
typedef struct Air {
    double speed, pressure; // pressure: FLIGHT_LIFT density V^2
    double alpha, beta;     // radians
    double effect;          // 0..1, of the control surfaces
    double gravity, thrust; // m/s^2
    Vec3d path, up, lift;   // unit: direction of flight, local vertical, of positive lift
} Air;

static Air look_at_air(const FlightState *state) {
    Geodetic place = geodesy_from_ecef(state->position_ecef);
    Quatd body_from_ecef = quatd_conjugate(state->ecef_from_body);
    Vec3d velocity = quatd_rotate(body_from_ecef, state->velocity_ecef);
    double speed = vec3d_length(velocity);
    Air air = {.speed = speed, .gravity = flight_gravity(place.h_m)};
    air.up = quatd_rotate(body_from_ecef, geodesy_up(place.lat_rad, place.lon_rad));
    air.thrust = flight_thrust(state->throttle, place.h_m);
    air.pressure = FLIGHT_LIFT * flight_density(place.h_m) * speed * speed;
    air.effect = speed * speed / (speed * speed + FLIGHT_CONTROL_V * FLIGHT_CONTROL_V);
    flight_air_angles(velocity, &air.alpha, &air.beta);
    air.path = speed > SPEED_MIN ? vec3d_scale(velocity, 1.0 / speed) : vec3d(1.0, 0.0, 0.0);
    air.lift = vec3d(sin(air.alpha), 0.0, -cos(air.alpha));
    return air;
}

// Lift across the path that keeps its climb angle, banked or not; past LEVEL_BANK_COS it fades, and changes its sign
// in inverted flight. The Earth curves away under fast flight, which then needs less.
static double path_lift(const Air *air) {
    Vec3d across = vec3d_mad(air->up, air->path, -vec3d_dot(air->up, air->path));
    double path_cos = vec3d_length(across);
    if (path_cos < 1e-6)
        return 0.0;
    double bank_cos = vec3d_dot(air->lift, across) / path_cos;
    double level_speed = air->speed * path_cos;
    double weight = (air->gravity - level_speed * level_speed / GEODESY_A_M) * path_cos;
    return weight * bank_cos / fmax(bank_cos * bank_cos, LEVEL_BANK_COS * LEVEL_BANK_COS);
}

// The angle of attack that the pilot's stick and the path ask for.
static double wanted_alpha(const Air *air, const Controls *controls) {
    double lift = path_lift(air) + controls->elevator * LOAD_STICK * FLIGHT_GRAVITY;
    lift = clamp(lift, -0.5 * FLIGHT_LOAD_MAX * FLIGHT_GRAVITY, FLIGHT_LOAD_MAX * FLIGHT_GRAVITY);
    double across = lift - air->thrust * sin(air->alpha);
    double alpha = across / (FLIGHT_LIFT_SLOPE * fmax(air->pressure, 1e-3));
    return clamp(alpha, -0.95 * FLIGHT_STALL_RAD, 0.95 * FLIGHT_STALL_RAD);
}

static Vec3d acceleration_body(const Air *air) {
    double limit = FLIGHT_LOAD_MAX * FLIGHT_GRAVITY;
    double lift = clamp(air->pressure * flight_lift_coefficient(air->alpha), -0.5 * limit, limit);
    double drag = fmin(air->pressure * flight_drag_coefficient(air->alpha), DRAG_RATE_MAX * air->speed);
    double side = clamp(-SIDE_FORCE * air->pressure * air->beta, -0.5 * limit, 0.5 * limit);
    Vec3d sum = vec3d(air->thrust, side * cos(air->beta), 0.0);
    sum = vec3d_mad(sum, air->lift, lift);
    sum = vec3d_mad(sum, air->path, -drag);
    return vec3d_mad(sum, air->up, -air->gravity);
}

// The nose turns with the path, and towards the wanted angles against the air.
static Vec3d wanted_rate(const Air *air, Vec3d acceleration, const Controls *controls) {
    double v2 = fmax(air->speed * air->speed, TURN_SPEED_MIN * TURN_SPEED_MIN);
    Vec3d turn = vec3d_scale(vec3d_cross(vec3d_scale(air->path, air->speed), acceleration), 1.0 / v2);
    double stiffness = NOSE_STIFFNESS * air->effect;
    double sideslip = -SIDESLIP_MAX * controls->rudder;
    Vec3d rate = {turn.x + ROLL_RATE * air->effect * controls->aileron,
                  turn.y + stiffness * (wanted_alpha(air, controls) - air->alpha),
                  turn.z + stiffness * (air->beta - sideslip)};
    return vec3d(clamp(rate.x, -RATE_MAX, RATE_MAX), clamp(rate.y, -RATE_MAX, RATE_MAX),
                 clamp(rate.z, -RATE_MAX, RATE_MAX));
}

static Quatd attitude_change(const FlightState *state) {
    Vec3d half = vec3d_scale(state->rate_body, 0.5);
    return quatd_mul(state->ecef_from_body, (Quatd){0.0, half.x, half.y, half.z});
}

FlightMotion flight_motion(const FlightState *state, const Controls *controls) {
    Air air = look_at_air(state);
    Vec3d acceleration = acceleration_body(&air);
    Vec3d rate = wanted_rate(&air, acceleration, controls);
    return (FlightMotion){.velocity = state->velocity_ecef,
                          .acceleration = quatd_rotate(state->ecef_from_body, acceleration),
                          .attitude_change = attitude_change(state),
                          .rate_change_body = vec3d_scale(vec3d_sub(rate, state->rate_body), 1.0 / RATE_LAG_S)};
}
