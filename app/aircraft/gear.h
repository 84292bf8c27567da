// app/aircraft/gear.h: wheels and skids on the ground.
// SI units; forces and moments in body axes at the centre of gravity.
// Pure functions; any thread; deterministic.
#pragma once
#include "app/aircraft/aircraft.h"

// The ground under a leg: a plane, in body axes at the moment of asking.
typedef struct GearPlane {
    bool there;
    Vec3d point, normal; // of the plane, from the centre of gravity; unit, out of the ground
} GearPlane;

typedef struct GearMotion {
    Vec3d velocity_body, rate_body; // over the ground
    double rudder;                  // -1..1 steers
    double brake_left, brake_right; // 0..1
} GearMotion;

typedef struct GearLoad {
    Vec3d force, moment;
    bool touches;
    double sink_m_s; // speed of the foot into the ground
} GearLoad;

// A spring and a damper along the plane's normal, and friction in the plane: rolling and braking along the wheel, slip
// across it, together at most the friction times the load. Friction grows with the speed up to CREEP, so that a braked
// wheel on a slope creeps.
#define GEAR_CREEP_M_S 0.03
GearLoad gear_load(const AircraftLeg *leg, const GearPlane *plane, const GearMotion *motion);
// Energy in the spring, J.
double gear_spring_energy(const AircraftLeg *leg, const GearPlane *plane);
