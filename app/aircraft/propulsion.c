#include "app/aircraft/propulsion.h"

#include <math.h>

#define TWO_PI 6.28318530717958648
#define PROPELLER_SPEED_MOST 2.0 // times the never-exceed speed: the polar was measured far below

static double clamp(double value, double least, double greatest) {
    return fmin(fmax(value, least), greatest);
}

// A fixed-pitch propeller on its polar CT / J^2 = slope CP / J^2 + intercept (Lowry, Performance of Light Aircraft,
// AIAA 1999: the bootstrap approach), with CP = static - advance J^2; written with n^2 and (V/d)^2, so that nothing is
// divided by either. Torque falls with the density as (density ratio - drop) / (1 - drop) (Gagg and Farrar, SAE Journal
// 34, 1934).
typedef struct Shaft {
    double engine_torque, per_n2, windmill; // N m; N m s^2; N m from the air ahead
    double advance2;                        // (V/d)^2 with the sign of V
} Shaft;

static Shaft shaft_of(const Aircraft *a, const Isa *air, double axial, double throttle) {
    double d = a->propeller_diameter, v = fmin(axial, PROPELLER_SPEED_MOST * a->never_exceed_speed) / d;
    v = fmax(v, -a->never_exceed_speed / d);
    double ratio = air->density / ISA_DENSITY_0, drop = a->altitude_drop,
           scale = air->density * d * d * d * d * d / TWO_PI;
    double breath = fmax((ratio - drop) / (1.0 - drop), 0.0);
    Shaft s = {.advance2 = v * fabs(v)};
    s.engine_torque = a->torque * breath * (a->idle_torque + (1.0 - a->idle_torque) * throttle);
    s.per_n2 = scale * a->power_static;
    s.windmill = scale * a->power_advance * s.advance2;
    return s;
}

static Propulsion piston(const Aircraft *a, const Isa *air, double axial, double engine, double throttle) {
    Shaft s = shaft_of(a, air, axial, throttle);
    double n = engine * a->rated_speed, d = a->propeller_diameter;
    double power = a->power_static * n * n - a->power_advance * s.advance2; // CP n^2
    double thrust = air->density * d * d * d * d * (a->polar_slope * power + a->polar_intercept * s.advance2);
    double torque = s.engine_torque + s.windmill - s.per_n2 * n * fabs(n);
    return (Propulsion){thrust, torque / (TWO_PI * a->rotor_inertia * a->rated_speed)};
}

static Propulsion jet(const Aircraft *a, const Isa *air, double axial, double engine, double throttle) {
    double mach = clamp(axial / air->sound_m_s, 0.0, 1.0);
    double lapse = pow(air->density / ISA_DENSITY_0, a->density_exponent) *
                   fmax(1.0 + a->mach_slope * mach + a->mach_curve * mach * mach, 0.0);
    double share = a->idle_thrust + (1.0 - a->idle_thrust) * engine;
    return (Propulsion){a->thrust * lapse * share, (throttle - engine) / a->spool_s};
}

Propulsion propulsion_at(const Aircraft *aircraft, const Isa *air, double axial, double engine, double throttle) {
    if (aircraft->engine == AIRCRAFT_PISTON)
        return piston(aircraft, air, axial, engine, throttle);
    if (aircraft->engine == AIRCRAFT_JET)
        return jet(aircraft, air, axial, engine, throttle);
    return (Propulsion){0.0, 0.0};
}

double propulsion_steady(const Aircraft *aircraft, const Isa *air, double axial, double throttle) {
    if (aircraft->engine != AIRCRAFT_PISTON)
        return aircraft->engine == AIRCRAFT_JET ? throttle : 0.0;
    Shaft s = shaft_of(aircraft, air, axial, throttle);
    return sqrt(fmax(s.engine_torque + s.windmill, 0.0) / s.per_n2) / aircraft->rated_speed;
}
