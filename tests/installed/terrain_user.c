// A program outside the project, built against the installed library only: reads an elevation model and prints how
// many triangles a view from 1500 m above its centre needs. Usage: terrain_user DEM GEOID
#include <stdio.h>

#include "terrain/geodesy.h"
#include "terrain/lod/lod.h"
#include "terrain/measure/measure.h"

static Vec3d eye_above(const Dem *dem, double h_m) {
    DemBounds b;
    if (dem_bounds(dem, &b) != RESULT_OK)
        return vec3d(0.0, 0.0, 0.0);
    return geodesy_to_ecef((Geodetic){(b.south_deg + b.north_deg) / 2 * GEODESY_RAD_PER_DEG,
                                      (b.west_deg + b.east_deg) / 2 * GEODESY_RAD_PER_DEG, h_m});
}

int main(int argc, char **argv) {
    DemOptions dem_options = dem_default_options();
    TerrainOptions terrain_options = terrain_default_options();
    LodOptions lod_options = lod_default_options();
    const char *paths[] = {argc > 1 ? argv[1] : ""};
    Dem *dem = NULL;
    Geoid *geoid = NULL;
    Jobs *jobs = NULL;
    Terrain *terrain = NULL;
    Lod *lod = NULL;
    Arena *frame = NULL;
    LodCut cut = {0};
    if (argc != 3 || dem_load(&dem_options, paths, 1, &dem) || geoid_open(argv[2], &geoid) || jobs_create(2, &jobs))
        return 1;
    LodView view = {eye_above(dem, 2000.0), vec3d(1.0, 0.0, 0.0), 700.0, 1.0};
    if (terrain_create(&terrain_options, dem, geoid, jobs, &terrain) || lod_create(&lod_options, terrain, &lod) ||
        arena_create(1 << 20, &frame) || lod_update(lod, &view, jobs, frame, &cut))
        return 1;
    printf("%lld triangles\n", (long long)cut.stats.triangles);
    arena_destroy(&frame);
    lod_destroy(&lod);
    terrain_destroy(&terrain);
    jobs_destroy(&jobs);
    geoid_close(&geoid);
    return cut.stats.triangles > 1000 ? 0 : 1;
}
