// app/dynamics/flight_forces.h: the equations of motion of a rigid aircraft.
// ECEF metres, seconds, radians.
// Values only; pure functions.
#pragma once
#include "app/aircraft/gear.h"
#include "app/dynamics/flight_model.h"
#include "terrain/geodesy.h"

// What stays the same during a step.
typedef struct FlightStepSetting {
    Vec3d origin_ecef;              // where the step begins
    double origin_h_m;              // above the ellipsoid
    Vec3d east, north, up;          // there, unit, in ECEF
    double east_curve, north_curve; // 1/m: of the surfaces of equal height there
    double ground_h_m;              // of the ground below, above the ellipsoid, for the ground effect; -INFINITY: none
    int plane_count;                // 0: no leg can touch
    struct {
        bool there;
        Vec3d point_ecef, normal_ecef;
    } planes[AIRCRAFT_LEGS_MAX];
    double brake_left, brake_right;
} FlightStepSetting;

// The setting of a step that begins at `state`, above no ground.
FlightStepSetting flight_setting(const FlightState *state);
// Place of a position within a step, to the second order of the way from its origin: within 1e-14 of
// it for 1 m, 1e-9 for 200 m.
Geodetic flight_place(const FlightStepSetting *setting, Vec3d position_ecef);

// The time derivative of a state, and what else is known on the way.
typedef struct FlightMotion {
    Vec3d velocity, acceleration; // ECEF
    Quatd attitude_change;
    Vec3d rate_change_body;
    double engine_rate;
    Vec3d air_force_body;    // N, with the thrust, without gravity and ground
    Vec3d ground_force_body; // N, of the wheels
    uint8_t wheels;
    double sink_m_s; // of the leg that comes down fastest
} FlightMotion;

// Newton and Euler: m dv/dt = forces + m g; I dw/dt = moments - w x I w; dq/dt = q w / 2. Lift and moment that depend
// on the change of the angle of attack are solved for together with it.
FlightMotion flight_motion(const Flight *flight, const FlightState *state, const FlightStepSetting *setting);
// The fastest rate at which the air changes the motion, 1/s: an upper bound for the length of a step.
double flight_stiffness(const Flight *flight, const FlightStepSetting *setting);
// The plane under a leg in body axes of `state`.
GearPlane flight_gear_plane(const FlightState *state, const FlightStepSetting *setting, int leg);
