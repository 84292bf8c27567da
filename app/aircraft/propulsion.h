// app/aircraft/propulsion.h: thrust along the body's x axis, through the centre of gravity.
// SI units. The engine's state is one number: a piston engine's shaft speed over its rated speed; the share of a
// jet's thrust between idle and full. Pure functions; any thread; deterministic.
#pragma once
#include "app/aircraft/aircraft.h"
#include "app/aircraft/isa.h"

typedef struct Propulsion {
    double thrust_n;    // may be negative: a windmilling propeller
    double engine_rate; // of the engine's state, 1/s
} Propulsion;

// `axial_m_s`: speed along x against the air; `throttle` 0..1.
Propulsion propulsion_at(const Aircraft *aircraft, const Isa *air, double axial_m_s, double engine, double throttle);
// The engine's state that stays.
double propulsion_steady(const Aircraft *aircraft, const Isa *air, double axial_m_s, double throttle);
