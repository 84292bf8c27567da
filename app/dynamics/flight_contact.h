// app/dynamics/flight_contact.h: the aircraft against the ground.
// Metres, seconds, radians, ECEF.
// Values only.
#pragma once
#include "app/dynamics/flight_forces.h"

// The ground below a position; false where there is none.
bool flight_ground_below(const FlightGround *ground, Vec3d position_ecef, double *above_m);
// The ground's plane below a position, from its heights here and REACH to the north and east; false where there is
// none.
bool flight_ground_plane(const FlightGround *ground, Vec3d position_ecef, Vec3d *point_ecef, Vec3d *normal_ecef);

// What the ground is like for the coming step: planes under the legs when they are near it.
FlightStepSetting flight_look_at_ground(const Flight *flight, const Controls *controls);
// After a step with this setting that brought wheels down at `sink_m_s`: airborne, rolling, or a crash. Looks along
// the way, so that fast flight does not pass through a ridge. A crash takes all energy of motion.
void flight_touch_ground(Flight *flight, const FlightStepSetting *setting, uint8_t wheels, double sink_m_s);
