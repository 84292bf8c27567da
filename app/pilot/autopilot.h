// app/pilot/autopilot.h: holds altitude, heading and speed; flies towards a point, and never into the ground; and
// helps a pilot who flies by keys. Gains follow from the aircraft's derivatives. Radians, metres above the ellipsoid,
// metres a second.
// Values only; deterministic.
#pragma once
#include "app/aircraft/trim.h"
#include "app/dynamics/flight_model.h"

#define AUTOPILOT_GRAVITY TRIM_GRAVITY_0
#define AUTOPILOT_PATH_MOST 0.3 // rad that a hold climbs

// What the laws remember from step to step.
typedef struct Autopilot {
    bool engaged;                        // false: takes over smoothly at the next step
    double elevator, throttle;           // integrals, shares
    double path_rad;                     // integral of a glider's speed
    double held_path_rad, held_bank_rad; // of the help for keys
    bool holds_path, holds_bank;
} Autopilot;

typedef struct AutopilotWish {
    double height_m; // above the ellipsoid; gliders hold the speed instead
    double heading_rad, speed_m_s;
    double bank_max_rad; // 0: 35 degrees
} AutopilotWish;

// The three holds, one step of `dt_s` on. Height by pitch, as far as the engine can climb; speed by throttle, of
// gliders by pitch; heading by bank, with the rudder against sideslip. Keeps below the stall.
Controls autopilot_hold(Autopilot *autopilot, const Flight *flight, const AutopilotWish *wish, double dt_s);

// How a hold could climb from now on, with all of the throttle.
#define AUTOPILOT_ZOOM_S 5.1 // in which most of the speed to spare is given up for height
typedef struct AutopilotReach {
    double steady, turning; // rad of path that stay: straight on, and in a turn of
    double bank_rad;        // as steep as the speed allows
    double zoom_m;          // height for the speed to spare
} AutopilotReach;
AutopilotReach autopilot_reach(const Flight *flight);

typedef struct Waypoint {
    double lat_rad, lon_rad, h_m;
    double speed_m_s;
} Waypoint;

// Controls for this moment: towards the waypoint, at its height and speed, `clearance_m` above the ground ahead or
// more, as far as the engine can; a glider at its cruise speed, as far as its height carries it.
Controls autopilot_fly(Autopilot *autopilot, const Flight *flight, const Waypoint *to, double clearance_m, double dt_s);
// Whether the waypoint is near enough to fly on to the next, or lies inside the turn that would lead back to it.
bool autopilot_has_reached(const Flight *flight, const Waypoint *to);
// Horizontal distance and bearing (0..2 pi) between two places.
void autopilot_course(double lat_rad, double lon_rad, const Waypoint *to, double *distance_m, double *bearing_rad);

// What the surfaces do when keys are the stick: it asks for a rate of pitch and of roll; let go, the path and the bank
// stay, as far as thrust and speed carry them and up to 60 degrees; the wings level from below 5. The rudder asks for
// sideslip. Throttle, flaps, gear and brakes pass through; on the ground, stalled or at angles near the vertical the
// stick works on the surfaces directly.
Controls autopilot_assist(Autopilot *autopilot, const Flight *flight, const Controls *pilot, double dt_s);
