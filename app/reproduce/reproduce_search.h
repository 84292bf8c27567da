// app/reproduce/reproduce_search.h: the tolerance at which a method draws about so many triangles along a circuit.
// Pixels at the image centre.
// A Search owns a Lod and borrows circuit, terrain and jobs. One thread.
#pragma once
#include "app/reproduce/reproduce_circuit.h"
#include "app/reproduce/reproduce_race.h"

#define SEARCH_TAU_LEAST_PX 0.01
#define SEARCH_TAU_GREATEST_PX 200.0

typedef struct Search {
    const Circuit *circuit;
    double px_per_rad;
    double span; // the part of the circuit that is flown
    int probes;  // views, spread over it
    // Of the curve triangles = a tau^-power: the latest point, and its slope there. 0 triangles: none is known.
    double tau_px, triangles, power;
    Race race; // of one
} Search;

// `span` and `probes`: as above. What race_enter fails with.
MUST_USE Result search_begin(const Circuit *circuit, const LodOptions *method, Jobs *jobs, double px_per_rad,
                             double span, int probes, Search *out);
void search_end(Search *search);

// The tolerance for a mean of about `triangles` over the probes: within 2 % after at most ten steps, if the terrain has
// so many; a limit above otherwise.
MUST_USE Result search_tau(Search *search, double triangles, double *tau_px);
