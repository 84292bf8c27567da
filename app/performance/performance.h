// app/performance/performance.h: what an aircraft can do: from the equations of steady flight, from the simulation, and
// as published. Metres a second, seconds, ratios.
// Pure functions; deterministic.
#pragma once
#include "app/performance/modes.h"

typedef struct PerformanceRow {
    const char *name, *unit;
    double theory, simulation, published; // NAN: there is none
    const char *theory_is;                // where the theory's figure comes from
} PerformanceRow;

#define PERFORMANCE_ROWS 16
#define PERFORMANCE_HEIGHT_M 1500.0 // of the modes

typedef struct Performance {
    PerformanceRow rows[PERFORMANCE_ROWS];
    int count;
    double modes_speed; // m/s, true
} Performance;

// Modes at cruise speed and PERFORMANCE_HEIGHT_M, of gliders in a glide; stalls, climb and glide at sea level in the
// standard atmosphere. Takes some minutes of simulated time. RANGE: the aircraft does not fly at its cruise speed.
MUST_USE Result performance_measure(const Aircraft *aircraft, Performance *out);

// Calibrated speed of a stall approached at 1 kt a second with the engine idling and the gear down (14 CFR 23.49 as of
// 1996), flaps 0 or 1.
double performance_stall(const Aircraft *aircraft, double flaps);
