// app/scene_load.h: from what the command line names to a terrain ready to be refined.
// Degrees and metres as people type them; altitudes above the geoid.
// A World owns everything in it. Main thread.
#pragma once
#include "base/base.h"
#include "base/vec.h"
#include "config/options.h"
#include "config/scene.h"
#include "terrain/geo.h"
#include "terrain/jobs.h"
#include "terrain/lod.h"
#include "terrain/terrain.h"

typedef struct World {
    Scene scene; // from the scene file; for plain DEMs empty but for the DEM paths
    Jobs *jobs;
    Geoid *geoid; // NULL for a DEM above the ellipsoid where no geoid was needed
    Terrain *terrain;
} World;

// How the DEM is to be read: --datum, --voids, --spacing, --bounds.
DemOptions scene_dem_options(const Options *options);
// --method, --partitions, --max-triangles, --reuse.
LodOptions scene_lod_options(const Options *options);
// The EGM96 grid: --geoid, else the program's own. NOT_FOUND, FORMAT.
MUST_USE Result scene_open_geoid(const Options *options, Geoid **out);

// Loads what the positional arguments name: nothing (the default scene), a scene (a file ending in .scene, or the name of
// one that came with the program), or DEM files and folders. Jobs, geoid, DEM and terrain as the options say. On failure
// one message was logged and `out` is empty.
MUST_USE Result world_load(const Options *options, World *out);
void world_unload(World *world);

// A place and a direction to look from: degrees, altitude in metres above the geoid.
typedef struct Viewpoint {
    double lat_deg, lon_deg, alt_m;
    double heading_deg, pitch_deg;
} Viewpoint;
// --eye and --look, else the scene's start, else a three-quarter view of the highest relief computed from the terrain. An
// eye given without a direction looks north, level.
MUST_USE Result world_viewpoint(const World *world, const Options *options, Viewpoint *out);
Vec3d world_viewpoint_ecef(const World *world, const Viewpoint *viewpoint);
// Metres above the ellipsoid of an altitude above the geoid.
double world_ellipsoid_m(const World *world, double lat_deg, double lon_deg, double alt_m);

// Unit vectors of the viewpoint in ECEF.
Vec3d viewpoint_forward(const Viewpoint *viewpoint);
// Pixels a radian at the image centre for --size and --fov.
double scene_px_per_rad(const Options *options);
// What to refine for: the eye, --tau, --size, --fov.
LodView world_lod_view(const World *world, const Options *options, const Viewpoint *viewpoint);
