// terrain/roam/roam_seam.h: where squares meet, to count the vertices that partitions have in common.
// Squares by their number in the grid.
// A RoamSeams owns its tables; constant after creation.
#pragma once
#include "terrain/roam/roam_ground.h"

typedef struct RoamBorder {
    int32_t square, across; // the smaller one, or of equal ones the first; the one beside it
    int32_t side;           // of `square`: 0 north, 1 east, 2 south, 3 west
} RoamBorder;

typedef struct RoamCorner {
    int32_t squares[4]; // around a corner of a square; -1: outside the DEM
} RoamCorner;

typedef struct RoamSeams {
    RoamBorder *borders;
    RoamCorner *corners; // each point once
    int32_t border_count, corner_count;
} RoamSeams;

MUST_USE Result roam_seams_create(const SquareGrid *grid, RoamSeams *out);
void roam_seams_destroy(RoamSeams *seams);

// Vertices drawn on borders between squares of different partitions, each counted once.
int64_t roam_seams_count(const RoamSeams *seams, const RoamDrawn *drawn);
