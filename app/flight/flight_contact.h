// app/flight/flight_contact.h: the aircraft against the ground.
// Metres, seconds, radians, ECEF.
// Values only.
#pragma once
#include "app/flight/flight_model.h"

// After a step that began at `from`: nothing, a landing (and rolling on), or a crash. Looks along the way, so that fast
// flight does not pass through a ridge. Contact never adds energy.
void flight_touch_ground(Flight *flight, Vec3d from, const Controls *controls, double dt_s);
// The ground below a position; false where there is none.
bool flight_ground_below(const FlightGround *ground, Vec3d position_ecef, double *above_m);
