// terrain/dem/dem_mosaic.h: how the files given together form one grid. Private to terrain/dem_*.c.
// Units of the CRS; samples.
// Values; the caller owns the arrays.
#pragma once
#include "terrain/dem/dem_source.h"

typedef struct DemPlace {
    int col, row; // of the source's sample (0, 0) in the common grid
} DemPlace;

// The common grid of `count` >= 1 sources, and each one's place in it. RANGE, naming two files: they are not of
// one grid, or do not touch.
MUST_USE Result dem_mosaic_layout(const DemSource *sources, int count, DemHeader *out, DemPlace *places);
