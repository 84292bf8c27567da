// app/reproduce/reproduce_circuit.h: the flight of an experiment: once round an ellipse in the terrain, above the
// ground. Metres above the ellipsoid; parts of the circuit 0 .. 1, and on beyond. A value, after circuit_plan constant;
// borrows the Terrain.
#pragma once
#include "app/viewpoint.h"
#include "base/base.h"
#include "terrain/lod/lod.h"
#include "terrain/terrain.h"

#define CIRCUIT_STATIONS 720

typedef struct Circuit {
    const Terrain *terrain;
    double altitude_m[CIRCUIT_STATIONS]; // the greatest ground near by and the height, smoothed
    double length_m;                     // along the ground
} Circuit;

// 0.3 of the terrain's sides around its middle, counter-clockwise from the east; never lower than `height_m` above the
// ground of the stations. The same terrain gives the same circuit.
void circuit_plan(const Terrain *terrain, double height_m, Circuit *out);

// Where one is after that part of the circuit, looking along it; alt_m is above the ellipsoid.
Viewpoint circuit_at(const Circuit *circuit, double part);
LodView circuit_view(const Viewpoint *at, double px_per_rad, double tau_px);
