// app/scene_load.h: from what the command line names to a terrain ready to be refined.
// Degrees and metres as people type them; altitudes above the geoid.
// A World owns everything in it. Main thread.
#pragma once
#include "app/viewpoint.h"
#include "base/base.h"
#include "base/paths.h"
#include "base/vec.h"
#include "config/options.h"
#include "config/scene.h"
#include "terrain/geo.h"
#include "terrain/jobs.h"
#include "terrain/lod/lod.h"
#include "terrain/terrain.h"

#define WORLD_NAMES_BYTES 1024

#define WORLD_DEFAULT_SCENE "jacksboro"

typedef struct World {
    char names[WORLD_NAMES_BYTES]; // what was loaded, as it was named, with | between; "": the default scene
    DemOptions read_as;            // its elevation
    Scene scene;                   // from the scene file; for plain DEMs empty but for their paths
    Jobs *jobs;
    Geoid *geoid; // for people's altitudes, whatever the DEM's own datum
    Terrain *terrain;
} World;

// How the DEM is to be read: --datum, --voids, --spacing, --bounds; what is not given, as the scene says. `scene` may
// be NULL.
DemOptions scene_dem_options(const Options *options, const Scene *scene);
// --error, --patch-side.
TerrainOptions scene_terrain_options(const Options *options);
// The same with another kind of errors, as --error takes it. USAGE: there is no such kind; says nothing.
MUST_USE Result scene_error_kind(const Options *options, const char *name, TerrainOptions *out);
// --method, --partitions, --max-triangles, --reuse.
LodOptions scene_lod_options(const Options *options);
// Loads what the positional arguments name, as world_load does, but the elevation model only.
MUST_USE Result scene_load_dem(const Options *options, Dem **out);
// The EGM96 grid: --geoid, else the program's own. NOT_FOUND, FORMAT.
MUST_USE Result scene_open_geoid(const Options *options, Geoid **out);

// Before anything slow or visible is done for a picture: whether the files it is made of are there. What is wrong with
// their contents is found by those who read them. On failure one message names the file. USAGE: --image-bounds without
// an image.
MUST_USE Result world_check_inputs(const Options *options);

// Loads what the positional arguments name: nothing (the default scene), a scene (a file ending in .scene, or the name
// of one that came with the program), or DEM files and folders. Jobs, geoid, DEM and terrain as the options say. On
// failure one message was logged and `out` is empty.
MUST_USE Result world_load(const Options *options, World *out);
// The same with names of the caller's instead of the positional arguments; none: the default scene. `read_as`: how the
// DEM is to be read, instead of scene_dem_options; NULL: as that says.
MUST_USE Result world_check_listed(const Options *options, const char *const *names, int count);
MUST_USE Result world_load_listed(const Options *options, const char *const *names, int count,
                                  const DemOptions *read_as, World *out);
// Where the scene of that name lies that came with the program, whatever else has the name. False: there is none.
bool world_find_scene(const char *word, char out[PATHS_BYTES_MAX]);
// The same for one scene or DEM by its name, or the default scene where it is NULL, with a hierarchy of its own.
MUST_USE Result world_load_named(const Options *options, const char *name, const TerrainOptions *terrain, World *out);
// Names to `visit` each file that a world is read from: the scene's own, and what it names. What is not RESULT_OK ends
// it and is handed on; errors of reading a scene.
typedef Result WorldVisit(void *user, const char *file);
MUST_USE Result world_visit_files(const Options *options, WorldVisit *visit, void *user);
MUST_USE Result world_visit_listed(const char *const *names, int count, WorldVisit *visit, void *user);
// Whether its files are there, as world_check_inputs.
MUST_USE Result world_check_named(const Options *options, const char *name);
void world_unload(World *world);

// --eye and --look, else the scene's start, else a three-quarter view of the highest relief computed from the terrain.
// An eye given without a direction looks north, level.
MUST_USE Result world_viewpoint(const World *world, const Options *options, Viewpoint *out);
// Says so when the eye is under the ground.
void world_warn_underground(const World *world, const Viewpoint *viewpoint);
// Unit vector towards the sun at the viewpoint: --sun when given, else the scene's, else the default.
Vec3d world_sun(const World *world, const Options *options, const Viewpoint *viewpoint);
Vec3d world_viewpoint_ecef(const World *world, const Viewpoint *viewpoint);
// Metres above the ellipsoid of an altitude above the geoid.
double world_ellipsoid_m(const World *world, double lat_deg, double lon_deg, double alt_m);

// --bound corner: tau is to hold at the picture's corners.
bool scene_bound_corner(const Options *options);
// Pixels a radian for --size and --fov at the image's centre, or, with --bound corner, at its corners.
double scene_px_per_rad(const Options *options);
// What to refine for: the eye, --tau, --size, --fov.
LodView world_lod_view(const World *world, const Options *options, const Viewpoint *viewpoint);
