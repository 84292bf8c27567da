// terrain/lod/lod_patch_near.h: how near the terrain is to the eye.
// ECEF metres.
// Nothing owned.
#pragma once
#include "terrain/terrain.h"

// The smallest distance from the eye to a sample, the outer corners of base tiles excepted, which are always drawn.
// Milliseconds: for frames above their budget.
double near_distance_m(const Terrain *terrain, Vec3d eye_ecef);
