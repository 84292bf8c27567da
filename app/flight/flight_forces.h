// app/flight/flight_forces.h: what acts on the aircraft. Metres, seconds, radians; accelerations, for a mass of one.
// A light jet with a path-holding control law: hands off it flies straight, or a level turn while banked.
// Values only.
#pragma once
#include "app/flight/flight_model.h"

#define FLIGHT_GRAVITY 9.80665
#define FLIGHT_LIFT 0.00438     // lift acceleration = FLIGHT_LIFT density V^2 CL: 1 g at 40 m/s with CL 1.4
#define FLIGHT_LIFT_SLOPE 5.2   // CL a radian
#define FLIGHT_STALL_RAD 0.2618 // 15 degrees
#define FLIGHT_DRAG_ZERO 0.025
#define FLIGHT_DRAG_LIFT 0.06
#define FLIGHT_THRUST 4.0     // full, at sea level
#define FLIGHT_LOAD_MAX 6.0   // structural limit, g, up; half of it down
#define FLIGHT_CONTROL_V 15.0 // controls work well above this speed

// The time derivative of a state.
typedef struct FlightMotion {
    Vec3d velocity, acceleration;
    Quatd attitude_change;
    Vec3d rate_change_body;
} FlightMotion;

FlightMotion flight_motion(const FlightState *state, const Controls *controls);

// Share of the density at sea level; > 0.
double flight_density(double h_m);
// Lift coefficient of an angle of attack, any angle: linear, then a stall.
double flight_lift_coefficient(double alpha_rad);
double flight_drag_coefficient(double alpha_rad);
double flight_gravity(double h_m);
double flight_thrust(double throttle, double h_m);

// Angle of attack and of sideslip of a velocity in body axes; 0 at rest.
void flight_air_angles(Vec3d velocity_body, double *alpha_rad, double *beta_rad);
