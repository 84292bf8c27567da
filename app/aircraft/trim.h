// app/aircraft/trim.h: steady flight, straight or in a turn: which attitude, elevator and throttle keep it.
// SI units, radians.
// Pure functions; any thread; deterministic.
#pragma once
#include "app/aircraft/aircraft.h"
#include "base/vec.h"

typedef struct TrimWish {
    double speed_m_s, h_m; // against the air; above the ellipsoid
    double path_rad;       // up; ignored where the throttle is given
    bool throttle_given;   // then the path follows: climbs at full throttle, glides
    double throttle;
    double flaps, gear; // 0 up .. 1 down
    double bank_rad;    // of a turn; + right wing down
} TrimWish;

typedef struct Trim {
    double alpha_rad, path_rad;
    double elevator; // share of full deflection, + nose up
    double throttle, engine;
} Trim;

// Newton's method on the three equations of motion in the vertical plane: along and across the path, and pitch; the
// path curves with the Earth. In a turn the wing carries more; what little ailerons and rudder hold is left out.
// RANGE: no such flight: too slow to carry the weight, too fast or too steep for the engine, more elevator than there
// is, more bank than TRIM_BANK_MOST; says nothing.
#define TRIM_BANK_MOST 1.2 // rad
MUST_USE Result trim_solve(const Aircraft *aircraft, const TrimWish *wish, Trim *out);

// How the body stands and turns in a steady turn without slip. Straight: by the path, no rates.
typedef struct TrimTurn {
    double pitch_rad;
    Vec3d rate_body; // without the Earth's curve
} TrimTurn;
TrimTurn trim_turn(const TrimWish *wish, double alpha_rad, double path_rad);

// Gravity at a height, m/s^2: 9.80665 (a / (a + h))^2 along the ellipsoid's normal.
#define TRIM_GRAVITY_0 9.80665
double trim_gravity(double h_m);
