// tests/cut_support.h: terrains, flights and checks shared by the tests of cuts.
// As terrain/lod/lod.h. Random numbers from seeds that the tests print.
// What is created here is destroyed by the test. Failures end the test through cmocka.
#pragma once
#include "terrain/lod/lod.h"
#include "terrain/measure/measure.h"

uint64_t support_random(uint64_t *state);
double support_between(uint64_t *state, double low, double high);

// Fractal noise of `relief_m`, above the ellipsoid.
Dem *support_rough_dem(int width, int height, const DemGeoref *georef, double relief_m, uint64_t seed);
Terrain *support_terrain(Dem *dem, TerrainErrorKind error, int patch_level, Jobs *jobs);
// ../shared/dem/NAME with the geoid beside it; NULL where they are missing: the test is to skip.
Terrain *support_shared_terrain(const char *name, Geoid **geoid, Jobs *jobs);

// So far above the ground at a place of the grid.
Vec3d support_eye(const Terrain *terrain, double col, double row, double above_m);
LodView support_view(Vec3d eye_ecef, double tau_px);

// Of all that is drawn: each item's level and indices, and where their vertices are.
uint64_t support_cut_hash(const LodCut *cut);

// Measures the cut; fails unless it is whole, covers every sample, and keeps what it promises.
Measure support_check_cut(const Terrain *terrain, const LodCut *cut, Jobs *jobs, const char *what);
