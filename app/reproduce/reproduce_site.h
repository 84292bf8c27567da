// app/reproduce/reproduce_site.h: the terrains of an experiment: the DEM at hand resampled to a size, and rough
// synthetic ground. Samples a side; metres. A Site owns the DEM as it was loaded and the geoid; the terrains made
// borrow the geoid and must not outlive it.
#pragma once
#include "base/base.h"
#include "config/options.h"
#include "terrain/dem/dem.h"
#include "terrain/geo.h"
#include "terrain/jobs.h"
#include "terrain/terrain.h"

typedef enum SiteGround {
    SITE_DEM,   // the DEM over its whole area, resampled: dem_resample
    SITE_ROUGH, // bench_fill_rough, a sample every 10 m: the larger, the more ground
    SITE_GROUND_COUNT
} SiteGround;
const char *site_ground_name(SiteGround ground); // "dem", "rough"

typedef struct Site {
    Dem *dem;
    Geoid *geoid;
} Site;

// Loads the DEM that the options name, else the default scene's. What dem_load and scene_open_geoid fail with.
MUST_USE Result site_open(const Options *options, Site *out);
void site_close(Site *site);

// Heights of `ground` with `side` x `side` samples; the rough one's above the ellipsoid.
MUST_USE Result site_make_dem(const Site *site, SiteGround ground, int side, Dem **out);
MUST_USE Result site_make_terrain(const Site *site, SiteGround ground, int side, TerrainErrorKind error, Jobs *jobs,
                                  Terrain **out);
