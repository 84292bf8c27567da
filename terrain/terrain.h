// terrain/terrain.h: a terrain ready to be refined: heights above the ellipsoid, the grid's map, the forest
// of base tiles, nested vertex errors, and the patch hierarchy.
// Metres; heights above the ellipsoid; columns and rows of the DEM.
// A Terrain owns all of it. After creation it is constant: any thread may read it.
#pragma once
#include "base/base.h"
#include "base/vec.h"
#include "terrain/dem/dem.h"
#include "terrain/geo.h"
#include "terrain/grid.h"
#include "terrain/jobs.h"

typedef enum TerrainErrorKind {
    TERRAIN_ERROR_MIDPOINT, // the papers' metric; does not bound the deviation
    TERRAIN_ERROR_TOTAL,    // bounds the deviation at every sample
} TerrainErrorKind;

typedef struct TerrainOptions {
    TerrainErrorKind error;
    int error_stride; // TOTAL: diamonds of a larger step (samples) are bounded from their parts, which is faster to
                      // build and takes more triangles; a power of two, or 0: every diamond is looked at
    int patch_level;  // bisections within a patch, even, 2..14; 12: pages of side 65
} TerrainOptions;
TerrainOptions terrain_default_options(void);

typedef struct Terrain Terrain;

#define TERRAIN_STRIDE_MAX 1024

// Takes the Dem over on success (and turns its heights into heights above the ellipsoid); on failure the
// caller keeps it. `geoid` may be NULL for a DEM above the ellipsoid, else RESULT_NOT_FOUND; it is borrowed and must
// outlive the terrain. `jobs` is used during the call only.
MUST_USE Result terrain_create(const TerrainOptions *options, Dem *dem, const Geoid *geoid, Jobs *jobs, Terrain **out);
void terrain_destroy(Terrain **terrain);

const Dem *terrain_dem(const Terrain *terrain); // height_m: above the ellipsoid; datum as the file had it
const Grid *terrain_grid(const Terrain *terrain);
// 0 where the datum is the ellipsoid.
double terrain_undulation_m(const Terrain *terrain, double lat_deg, double lon_deg);

// The ground at a fractional position, bilinear between samples, metres above the ellipsoid; false outside
// the DEM.
bool terrain_ground_m(const Terrain *terrain, double lat_deg, double lon_deg, double *h_m);
// Exact bytes held for samples and errors, patches aside.
size_t terrain_sample_bytes(const Terrain *terrain);
