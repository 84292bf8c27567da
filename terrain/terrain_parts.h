// terrain/terrain_parts.h: what a Terrain consists of, for the files in terrain/ that refine or measure it.
// Metres above the ellipsoid; columns and rows in samples.
// The Terrain owns all parts but the geoid, which it borrows.
#pragma once
#include "terrain/errors/error_field.h"
#include "terrain/forest.h"
#include "terrain/patches/patch_forest.h"
#include "terrain/terrain.h"

struct Terrain {
    TerrainOptions options;
    Dem *dem;
    const Geoid *geoid; // NULL: the datum is the ellipsoid
    Grid *grid;
    Forest forest;
    ErrorField errors;
    PatchForest patches;
};
