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

// A sample's height, and its place: on the lattice as it is drawn and decided upon, and exactly.
static inline double terrain_height_m(const Terrain *terrain, int col, int row) {
    return (double)terrain->dem->height_m[(size_t)row * (size_t)terrain->dem->width + (size_t)col];
}
static inline GridPoint terrain_point(const Terrain *terrain, int col, int row) {
    return grid_lattice(terrain->grid, col, row, terrain_height_m(terrain, col, row));
}
static inline Vec3d terrain_ecef(const Terrain *terrain, int col, int row) {
    return grid_ecef(terrain->grid, col, row, terrain_height_m(terrain, col, row));
}
