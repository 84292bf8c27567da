#include "app/performance/modes.h"

#include "app/dynamics/flight_forces.h"
#include "terrain/geodesy.h"

#include <complex.h>
#include <math.h>
#include <string.h>

#define ROOTS_MAX 8
#define ROOT_STEPS 500
#define REAL_ROOT 1e-7 // of its size: an imaginary part below is none

// ---- linearisation ----------------------------------------------------------------------------------------------

typedef enum Axis { AXIS_U, AXIS_V, AXIS_W, AXIS_P, AXIS_Q, AXIS_R, AXIS_BANK, AXIS_PITCH, AXIS_H, AXIS_ENGINE } Axis;
static const Axis longitudinal[MODES_LONGITUDINAL] = {AXIS_U, AXIS_W, AXIS_Q, AXIS_PITCH, AXIS_H, AXIS_ENGINE};
static const Axis lateral[MODES_LATERAL] = {AXIS_V, AXIS_P, AXIS_R, AXIS_BANK};

static Vec3d unit_axis(int index) {
    return vec3d(index == 0, index == 1, index == 2);
}

// Turned in body axes; the velocity turns along, so that only gravity's direction changes.
static void turn(FlightState *state, Vec3d axis, double angle_rad) {
    Quatd before = state->ecef_from_body;
    Vec3d velocity_body = quatd_rotate(quatd_conjugate(before), state->velocity_ecef);
    state->ecef_from_body = quatd_normalize(quatd_mul(before, quatd_from_axis_angle(axis, angle_rad)));
    state->velocity_ecef = quatd_rotate(state->ecef_from_body, velocity_body);
}

static void disturb(FlightState *state, const FlightStepSetting *setting, Axis axis, double by, double speed) {
    double *const rates[3] = {&state->rate_body.x, &state->rate_body.y, &state->rate_body.z};
    if (axis <= AXIS_W) {
        Vec3d change = quatd_rotate(state->ecef_from_body, unit_axis((int)axis));
        state->velocity_ecef = vec3d_mad(state->velocity_ecef, change, by * speed);
    } else if (axis <= AXIS_R) {
        *rates[axis - AXIS_P] += by;
    } else if (axis <= AXIS_PITCH) {
        turn(state, unit_axis((int)(axis - AXIS_BANK)), by);
    } else if (axis == AXIS_H) {
        state->position_ecef = vec3d_mad(state->position_ecef, setting->up, by * speed);
    } else {
        state->engine += by;
    }
}

// The change of each quantity, at a state.
static void changes(const Flight *flight, const FlightState *state, const FlightStepSetting *setting, double speed,
                    double out[AXIS_ENGINE + 1]) {
    FlightMotion motion = flight_motion(flight, state, setting);
    Quatd body_from_ecef = quatd_conjugate(state->ecef_from_body);
    Vec3d v = quatd_rotate(body_from_ecef, state->velocity_ecef), w = state->rate_body;
    Vec3d dv = vec3d_sub(quatd_rotate(body_from_ecef, motion.acceleration), vec3d_cross(w, v));
    Vec3d up = quatd_rotate(body_from_ecef, setting->up);
    out[AXIS_U] = dv.x / speed;
    out[AXIS_V] = dv.y / speed;
    out[AXIS_W] = dv.z / speed;
    out[AXIS_P] = motion.rate_change_body.x;
    out[AXIS_Q] = motion.rate_change_body.y;
    out[AXIS_R] = motion.rate_change_body.z;
    out[AXIS_BANK] = w.x + w.z * up.x / fmax(-up.z, 1e-6); // p + r tan(pitch)
    out[AXIS_PITCH] = w.y;
    out[AXIS_H] = vec3d_dot(v, up) / speed;
    out[AXIS_ENGINE] = motion.engine_rate;
}

static void jacobian(const Flight *flight, const Axis *axes, int n, double *out) {
    FlightStepSetting setting = flight_setting(&flight->state);
    double speed = vec3d_length(flight->state.velocity_ecef);
    for (int j = 0; j < n; j++) {
        double above[AXIS_ENGINE + 1], below[AXIS_ENGINE + 1], by = axes[j] == AXIS_H ? 1e-3 : 1e-5;
        FlightState up = flight->state, down = flight->state;
        disturb(&up, &setting, axes[j], by, speed);
        disturb(&down, &setting, axes[j], -by, speed);
        changes(flight, &up, &setting, speed, above);
        changes(flight, &down, &setting, speed, below);
        for (int i = 0; i < n; i++)
            out[i * n + j] = (above[axes[i]] - below[axes[i]]) / (2.0 * by);
    }
}

void modes_longitudinal_matrix(const Flight *flight, double out[MODES_LONGITUDINAL][MODES_LONGITUDINAL]) {
    jacobian(flight, longitudinal, MODES_LONGITUDINAL, &out[0][0]);
}

void modes_lateral_matrix(const Flight *flight, double out[MODES_LATERAL][MODES_LATERAL]) {
    jacobian(flight, lateral, MODES_LATERAL, &out[0][0]);
}

// ---- eigenvalues ------------------------------------------------------------------------------------------------

static double trace(const double *m, int n) {
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += m[i * n + i];
    return sum;
}

// c[0] = 1: x^n + c[1] x^(n-1) + ... of det(x I - A).
static void characteristic(const double *a, int n, double *c) {
    double m[ROOTS_MAX * ROOTS_MAX] = {0}, next[ROOTS_MAX * ROOTS_MAX];
    c[0] = 1.0;
    for (int k = 1; k <= n; k++) {
        for (int i = 0; i < n; i++) // M <- A M + c I, from M = 0
            m[i * n + i] += c[k - 1];
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) {
                double sum = 0.0;
                for (int l = 0; l < n; l++)
                    sum += a[i * n + l] * m[l * n + j];
                next[i * n + j] = sum;
            }
        c[k] = -trace(next, n) / k;
        memcpy(m, next, sizeof *m * (size_t)(n * n));
    }
}

static double complex polynomial(const double *c, int n, double complex x) {
    double complex value = c[0];
    for (int i = 1; i <= n; i++)
        value = value * x + c[i];
    return value;
}

void modes_eigenvalues(const double *matrix, int n, ModesRoot *out) {
    double c[ROOTS_MAX + 1], size = 1e-3;
    double complex x[ROOTS_MAX];
    characteristic(matrix, n, c);
    for (int i = 1; i <= n; i++)
        size = fmax(size, pow(fabs(c[i]), 1.0 / i));
    for (int i = 0; i < n; i++) // on a circle, none of them real
        x[i] = size * cexp(I * (6.283185307179586 * i / n + 0.4));
    for (int step = 0; step < ROOT_STEPS; step++)
        for (int i = 0; i < n; i++) {
            double complex others = 1.0;
            for (int j = 0; j < n; j++)
                others *= j == i ? 1.0 : x[i] - x[j];
            if (cabs(others) > 0.0)
                x[i] -= polynomial(c, n, x[i]) / others;
        }
    for (int i = 0; i < n; i++)
        out[i] = (ModesRoot){creal(x[i]), fabs(cimag(x[i])) > REAL_ROOT * cabs(x[i]) ? cimag(x[i]) : 0.0};
}

static Mode mode_of(ModesRoot root) {
    if (root.im == 0.0)
        return (Mode){true, NAN, NAN, root.re};
    return (Mode){true, 6.283185307179586 / fabs(root.im), -root.re / hypot(root.re, root.im), root.re};
}

// Of the oscillations the slowest and the fastest.
static void pick_pairs(const ModesRoot *roots, int n, Mode *slow, Mode *fast) {
    double least = INFINITY, most = 0.0;
    for (int i = 0; i < n; i++) {
        double size = hypot(roots[i].re, roots[i].im);
        if (roots[i].im > 0.0 && size < least)
            *slow = mode_of(roots[i]);
        if (roots[i].im > 0.0 && size > most)
            *fast = mode_of(roots[i]);
        least = roots[i].im > 0.0 ? fmin(least, size) : least;
        most = roots[i].im > 0.0 ? fmax(most, size) : most;
    }
}

static void pick_real(const ModesRoot *roots, int n, Mode *slow, Mode *fast) {
    for (int i = 0; i < n; i++) {
        if (roots[i].im != 0.0)
            continue;
        if (!slow->there || fabs(roots[i].re) < fabs(slow->rate))
            *slow = mode_of(roots[i]);
        if (!fast->there || fabs(roots[i].re) > fabs(fast->rate))
            *fast = mode_of(roots[i]);
    }
}

Modes modes_of_theory(const Flight *flight) {
    double along[MODES_LONGITUDINAL][MODES_LONGITUDINAL], across[MODES_LATERAL][MODES_LATERAL];
    ModesRoot roots[ROOTS_MAX];
    Modes modes = {.phugoid = {.there = false}};
    modes_longitudinal_matrix(flight, along);
    modes_eigenvalues(&along[0][0], MODES_LONGITUDINAL, roots);
    pick_pairs(roots, MODES_LONGITUDINAL, &modes.phugoid, &modes.short_period);
    modes_lateral_matrix(flight, across);
    modes_eigenvalues(&across[0][0], MODES_LATERAL, roots);
    pick_pairs(roots, MODES_LATERAL, &modes.dutch_roll, &modes.dutch_roll);
    pick_real(roots, MODES_LATERAL, &modes.spiral, &modes.roll);
    return modes;
}

// ---- from a flight ----------------------------------------------------------------------------------------------

#define SAMPLES_MAX 400
#define UNKNOWNS 4

// Gauss's elimination with pivots, in place; false where the matrix is singular.
static bool eliminate(double m[UNKNOWNS][UNKNOWNS + 1]) {
    for (int k = 0; k < UNKNOWNS; k++) {
        int pivot = k;
        for (int i = k + 1; i < UNKNOWNS; i++)
            pivot = fabs(m[i][k]) > fabs(m[pivot][k]) ? i : pivot;
        if (!(fabs(m[pivot][k]) > 1e-300))
            return false;
        for (int j = 0; j <= UNKNOWNS; j++) {
            double swapped = m[k][j];
            m[k][j] = m[pivot][j];
            m[pivot][j] = swapped;
        }
        for (int i = 0; i < UNKNOWNS; i++) {
            double share = i == k ? 0.0 : m[i][k] / m[k][k];
            for (int j = 0; j <= UNKNOWNS; j++)
                m[i][j] -= share * m[k][j];
        }
    }
    return true;
}

// a and b of x[k+2] = a x[k+1] + b x[k] + c + d k, by least squares.
static bool fit(const double *x, int count, double *a, double *b) {
    double m[UNKNOWNS][UNKNOWNS + 1] = {{0}};
    for (int k = 0; k + 2 < count; k++) {
        const double row[UNKNOWNS + 1] = {x[k + 1], x[k], 1.0, (double)k / count, x[k + 2]};
        for (int i = 0; i < UNKNOWNS; i++)
            for (int j = 0; j <= UNKNOWNS; j++)
                m[i][j] += row[i] * row[j];
    }
    if (!eliminate(m))
        return false;
    *a = m[0][UNKNOWNS] / m[0][0];
    *b = m[1][UNKNOWNS] / m[1][1];
    return true;
}

// z^2 = a z + b, and z = exp((rate + i omega) dt).
static Mode mode_of_samples(const double *x, int count, double dt_s) {
    double a, b;
    if (!fit(x, count, &a, &b) || a * a + 4.0 * b >= 0.0)
        return (Mode){.there = false, .period_s = NAN, .damping = NAN, .rate = NAN};
    double complex z = 0.5 * (a + I * sqrt(-a * a - 4.0 * b)), s = clog(z) / dt_s;
    return mode_of((ModesRoot){creal(s), cimag(s)});
}

// What to disturb by how much, and what to look at, in steps of the period sought.
typedef struct Trial {
    Axis axis;
    double by;
    double begin_s; // until what is faster has died away
    double periods; // looked at
    Axis signal;    // AXIS_U: the speed; AXIS_W: the angle of attack; AXIS_R: the rate of yaw
} Trial;

static double signal_of(const Flight *flight, Axis signal, Vec3d trim_velocity) {
    Vec3d v = quatd_rotate(quatd_conjugate(flight->state.ecef_from_body), flight->state.velocity_ecef);
    if (signal == AXIS_R)
        return flight->state.rate_body.z;
    return signal == AXIS_W ? atan2(v.z, v.x) - atan2(trim_velocity.z, trim_velocity.x)
                            : vec3d_length(v) - vec3d_length(trim_velocity);
}

static Mode fly_trial(const Flight *trimmed, const Trial *trial, double period_s) {
    Flight flight = *trimmed;
    FlightStepSetting setting = flight_setting(&flight.state);
    Vec3d trim = quatd_rotate(quatd_conjugate(flight.state.ecef_from_body), flight.state.velocity_ecef);
    int every = (int)fmax(period_s / (40.0 * FLIGHT_STEP_S), 1.0), count = 0;
    double samples[SAMPLES_MAX];
    disturb(&flight.state, &setting, trial->axis, trial->by, vec3d_length(trim));
    int first = (int)(trial->begin_s / FLIGHT_STEP_S);
    int last = first + (int)(trial->periods * period_s / FLIGHT_STEP_S);
    for (int i = 0; i < last && count < SAMPLES_MAX; i++) {
        if (i >= first && (i - first) % every == 0)
            samples[count++] = signal_of(&flight, trial->signal, trim);
        flight_step(&flight, &flight.controls, FLIGHT_STEP_S);
    }
    return mode_of_samples(samples, count, every * FLIGHT_STEP_S);
}

Modes modes_of_flight(const Flight *flight, const Modes *about) {
    Modes modes = {.phugoid = {.there = false}};
    double settled_s = about->short_period.there ? 4.0 * about->short_period.period_s : 5.0;
    double rolled_s = about->roll.there ? fmin(4.0 / fabs(about->roll.rate), 3.0) : 1.0;
    const Trial phugoid = {AXIS_U, 0.02, settled_s, 2.5, AXIS_U};
    const Trial fast = {AXIS_Q, 0.02, 0.0, 0.8, AXIS_W}, dutch = {AXIS_V, 0.02, rolled_s, 2.5, AXIS_R};
    if (about->phugoid.there)
        modes.phugoid = fly_trial(flight, &phugoid, about->phugoid.period_s);
    if (about->short_period.there)
        modes.short_period = fly_trial(flight, &fast, about->short_period.period_s);
    if (about->dutch_roll.there)
        modes.dutch_roll = fly_trial(flight, &dutch, about->dutch_roll.period_s);
    return modes;
}
