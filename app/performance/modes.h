// app/performance/modes.h: how a trimmed aircraft swings: from the linearised equations, and from the simulation.
// Seconds, 1/s.
// Pure functions; deterministic.
#pragma once
#include "app/dynamics/flight_model.h"

typedef struct Mode {
    bool there;      // as an oscillation, or for roll and spiral at all
    double period_s; // of the damped oscillation; roll and spiral: NAN
    double damping;  // ratio to the critical one; roll and spiral: NAN
    double rate;     // real part, 1/s; < 0 dies away
} Mode;

typedef struct Modes {
    Mode phugoid, short_period, dutch_roll, roll, spiral;
} Modes;

#define MODES_LONGITUDINAL 6 // u, w, q, pitch, height, engine
#define MODES_LATERAL 4      // v, p, r, bank

// The Jacobian of the equations of motion at a trimmed, level or gliding, unbanked flight by central differences;
// velocities and heights in units of the speed.
void modes_longitudinal_matrix(const Flight *flight, double out[MODES_LONGITUDINAL][MODES_LONGITUDINAL]);
void modes_lateral_matrix(const Flight *flight, double out[MODES_LATERAL][MODES_LATERAL]);

typedef struct ModesRoot {
    double re, im;
} ModesRoot;
// Eigenvalues of the n x n matrix (row-major, n <= 8): characteristic polynomial by Faddeev and LeVerrier, its roots by
// Durand and Kerner.
void modes_eigenvalues(const double *matrix, int n, ModesRoot *out);

// From the eigenvalues: of complex pairs, the slower longitudinal one is the phugoid, the faster the short period, the
// lateral one the Dutch roll; of real lateral ones the slowest is the spiral, the fastest the roll.
Modes modes_of_theory(const Flight *flight);
// From the nonlinear simulation: disturbed a little, controls fixed, a damped oscillation fitted to what comes (least
// squares of x[k+2] = a x[k+1] + b x[k] + c + d k). `about`: the periods to look for. Roll and spiral are not there.
Modes modes_of_flight(const Flight *flight, const Modes *about);
