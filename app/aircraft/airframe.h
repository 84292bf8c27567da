// app/aircraft/airframe.h: forces and moments of the air on an airframe, at any attitude and speed.
// SI units, radians; body axes, at the centre of gravity.
// Pure functions; any thread; deterministic.
#pragma once
#include "app/aircraft/aircraft.h"

typedef struct AirframeFlow {
    Vec3d air_body;  // velocity of the aircraft against the air
    Vec3d rate_body; // rad/s
    double density;
    double elevator, aileron, rudder; // shares of full deflection, -1..1; + nose up, right wing down, nose right
    double flaps, gear;               // 0 up .. 1 down
    double wing_above_m;              // height of the wing above the ground; INFINITY: none
} AirframeFlow;

typedef struct AirframeLoad {
    Vec3d force, moment;                     // N, N m, at no change of the angle of attack
    Vec3d force_alpha_dot, moment_alpha_dot; // for each rad/s of it
} AirframeLoad;

// Finite for finite input; zero without air or speed.
AirframeLoad airframe_load(const Aircraft *aircraft, const AirframeFlow *flow);

// Lift coefficient of the wing without elevator and rates: linear, then over a smooth stall to that of a flat plate.
double airframe_wing_lift(const Aircraft *aircraft, double alpha_rad, double flaps);
// Share of the flow that has separated: 0 short of the stall, 1 beyond, smooth between. The blend of the two is that of
// Beard and McLain, Small Unmanned Aircraft, section 4.2, over a finite width.
double airframe_stalled(const Aircraft *aircraft, double alpha_rad, double flaps);
// Angle of attack and of sideslip; 0 at rest.
void airframe_angles(Vec3d air_body, double *alpha_rad, double *beta_rad);
// What is left of the induced drag at this height: McCormick, Aerodynamics, Aeronautics and Flight Mechanics,
// Wiley 1979, on the ground effect.
double airframe_ground_effect(const Aircraft *aircraft, double wing_above_m);
// The fastest rate at which the air changes the motion, 1/s: damping of roll, pitch and yaw, the frequencies of pitch
// and yaw, drag at any angle. An explicit integration's step must be shorter than its inverse.
double airframe_stiffness(const Aircraft *aircraft, double density, double speed_m_s);
// Speed of the stall at a density, load factor 1, elevator neutral: sqrt(2 W / (density S CLmax)).
double airframe_stall_speed(const Aircraft *aircraft, double density, double flaps);
