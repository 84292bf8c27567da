#include "app/aircraft/trim.h"

#include "app/aircraft/airframe.h"
#include "app/aircraft/isa.h"
#include "app/aircraft/propulsion.h"
#include "terrain/geodesy.h"

#include <math.h>

#define STEPS 60
#define DIFFERENCE 1e-6
#define SMALL 1e-11   // m/s^2 and rad/s^2
#define STEP_MOST 0.1 // of each unknown
#define THROTTLE_SLACK 1e-6
#define UNKNOWNS 3

double trim_gravity(double h_m) {
    double ratio = GEODESY_A_M / (GEODESY_A_M + fmax(h_m, -20000.0));
    return TRIM_GRAVITY_0 * ratio * ratio;
}

TrimTurn trim_turn(const TrimWish *wish, double alpha_rad, double path_rad) {
    if (wish->bank_rad == 0.0)
        return (TrimTurn){.pitch_rad = alpha_rad + path_rad};
    // Of the velocity, along x by the cosine and along z by the sine of alpha, the part that goes up.
    double x = cos(alpha_rad), z = sin(alpha_rad), down = z * cos(wish->bank_rad);
    double rises = fmin(fmax(sin(path_rad) / hypot(x, down), -1.0), 1.0);
    double pitch = asin(rises) + atan2(down, x);
    // Gravity pulls to the side what the turn takes: round the vertical, in rad/s.
    double across = cos(pitch) * cos(wish->bank_rad) * x + sin(pitch) * z;
    double turn = trim_gravity(wish->h_m) * cos(pitch) * sin(wish->bank_rad) / (wish->speed_m_s * across);
    return (TrimTurn){pitch, vec3d(-turn * sin(pitch), turn * cos(pitch) * sin(wish->bank_rad),
                                   turn * cos(pitch) * cos(wish->bank_rad))};
}

// Unknowns: angle of attack, elevator, and throttle or path.
static Trim trim_of(const Aircraft *aircraft, const TrimWish *wish, const Isa *air, const double x[UNKNOWNS]) {
    Trim trim = {.alpha_rad = x[0], .elevator = x[1], .path_rad = wish->throttle_given ? x[2] : wish->path_rad};
    trim.throttle = wish->throttle_given ? wish->throttle : x[2];
    trim.engine = propulsion_steady(aircraft, air, wish->speed_m_s * cos(x[0]), trim.throttle);
    return trim;
}

static void residual(const Aircraft *aircraft, const TrimWish *wish, const double x[UNKNOWNS], double r[UNKNOWNS]) {
    Isa air = isa_at(wish->h_m);
    Trim trim = trim_of(aircraft, wish, &air, x);
    double v = wish->speed_m_s, u = v * cos(trim.alpha_rad), w = v * sin(trim.alpha_rad);
    const TrimTurn turn = trim_turn(wish, trim.alpha_rad, trim.path_rad);
    double curve = -v * cos(trim.path_rad) / (GEODESY_A_M + wish->h_m), g = trim_gravity(wish->h_m);
    double q = curve * cos(wish->bank_rad) + turn.rate_body.y, pitch = turn.pitch_rad;
    AirframeFlow flow = {.air_body = {u, 0.0, w},
                         .rate_body = {turn.rate_body.x, q, turn.rate_body.z},
                         .density = air.density,
                         .elevator = trim.elevator,
                         .flaps = wish->flaps,
                         .gear = wish->gear,
                         .wing_above_m = INFINITY};
    AirframeLoad load = airframe_load(aircraft, &flow);
    double thrust = propulsion_at(aircraft, &air, u, trim.engine, trim.throttle).thrust_n;
    r[0] = (load.force.x + thrust) / aircraft->mass - g * sin(pitch) - q * w;
    r[1] = load.force.z / aircraft->mass + g * cos(pitch) * cos(wish->bank_rad) + q * u;
    r[2] = load.moment.y / aircraft->iyy;
}

static double determinant(const double m[3][3]) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

// Cramer's rule; false where the matrix is singular.
static bool solve(const double m[3][3], const double b[3], double x[3]) {
    double det = determinant(m);
    if (!(fabs(det) > 1e-30))
        return false;
    for (int column = 0; column < 3; column++) {
        double with[3][3];
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                with[i][j] = j == column ? b[i] : m[i][j];
        x[column] = determinant(with) / det;
    }
    return true;
}

static bool newton_step(const Aircraft *aircraft, const TrimWish *wish, double x[UNKNOWNS], const double r[UNKNOWNS]) {
    double jacobian[3][3], step[3];
    for (int j = 0; j < UNKNOWNS; j++) {
        double up[3] = {x[0], x[1], x[2]}, down[3] = {x[0], x[1], x[2]}, above[3], below[3];
        up[j] += DIFFERENCE;
        down[j] -= DIFFERENCE;
        residual(aircraft, wish, up, above);
        residual(aircraft, wish, down, below);
        for (int i = 0; i < 3; i++)
            jacobian[i][j] = (above[i] - below[i]) / (2.0 * DIFFERENCE);
    }
    if (!solve(jacobian, r, step))
        return false;
    for (int i = 0; i < UNKNOWNS; i++)
        x[i] -= fmin(fmax(step[i], -STEP_MOST), STEP_MOST);
    return true;
}

static bool is_small(const double r[UNKNOWNS]) {
    return fabs(r[0]) < SMALL && fabs(r[1]) < SMALL && fabs(r[2]) < SMALL;
}

// A jet's throttle counts down to idle; below it, and above full, there is none.
static bool is_possible(const Aircraft *aircraft, const TrimWish *wish, const Trim *trim) {
    bool engine = trim->throttle >= -THROTTLE_SLACK && trim->throttle <= 1.0 + THROTTLE_SLACK;
    return engine && fabs(trim->elevator) <= 1.0 && fabs(trim->path_rad) < 1.5 &&
           trim->alpha_rad < aircraft->stall_rad + wish->flaps * (aircraft->stall_flaps_rad - aircraft->stall_rad) &&
           trim->alpha_rad > -aircraft->stall_below_rad;
}

// Where the weight is carried: a start from which Newton's method does not stray.
static double first_alpha(const Aircraft *a, const TrimWish *wish) {
    double pressure = 0.5 * isa_at(wish->h_m).density * wish->speed_m_s * wish->speed_m_s * a->area;
    double lift = a->mass * trim_gravity(wish->h_m) / fmax(pressure, 1e-6) / cos(wish->bank_rad);
    return fmin(fmax((lift - a->cl_0 - a->cl_flaps * wish->flaps) / a->cl_alpha, -0.1), 0.9 * a->stall_rad);
}

Result trim_solve(const Aircraft *aircraft, const TrimWish *wish, Trim *out) {
    double x[UNKNOWNS] = {first_alpha(aircraft, wish), 0.0, wish->throttle_given ? 0.0 : 0.5}, r[UNKNOWNS];
    bool glider = aircraft->engine == AIRCRAFT_GLIDER && !wish->throttle_given;
    if (glider || !(wish->speed_m_s > 1.0) || !(wish->speed_m_s < 1e4) || !(fabs(wish->bank_rad) <= TRIM_BANK_MOST))
        return RESULT_RANGE;
    for (int i = 0; i < STEPS; i++) {
        residual(aircraft, wish, x, r);
        if (is_small(r))
            break;
        if (!newton_step(aircraft, wish, x, r) || !(fabs(x[0]) < 1.5) || !(fabs(x[2]) < 50.0))
            return RESULT_RANGE;
    }
    Isa air = isa_at(wish->h_m);
    *out = trim_of(aircraft, wish, &air, x);
    bool possible = is_small(r) && is_possible(aircraft, wish, out);
    out->throttle = fmin(fmax(out->throttle, 0.0), 1.0);
    return possible ? RESULT_OK : RESULT_RANGE;
}
