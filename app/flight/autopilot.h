// app/flight/autopilot.h: fly towards a point, and never into the ground.
// Radians, metres above the ellipsoid, metres a second.
// Values only; deterministic.
#pragma once
#include "app/flight/flight_model.h"

typedef struct Waypoint {
    double lat_rad, lon_rad, h_m;
    double speed_m_s;
} Waypoint;

// Controls for this moment: towards the waypoint, at its height and speed, `clearance_m` above the ground ahead or
// more.
Controls autopilot_fly(const Flight *flight, const Waypoint *to, double clearance_m);
// Whether the waypoint is near enough to fly on to the next, or lies inside the turn that would lead back to it.
bool autopilot_has_reached(const Flight *flight, const Waypoint *to);
// Horizontal distance and bearing (0..2 pi) between two places.
void autopilot_course(double lat_rad, double lon_rad, const Waypoint *to, double *distance_m, double *bearing_rad);
