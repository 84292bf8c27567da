#include "app/reproduce/reproduce_site.h"

#include "app/bench/bench.h"
#include "app/scene_load.h"
#include "terrain/dem/dem_resample.h"

#define ROUGH_WEST_M 400000.0
#define ROUGH_NORTH_M 5600000.0
#define ROUGH_ZONE 34
#define ROUGH_STEP_M 10.0 // as of the Puget Sound elevation model, which Yalcin et al. fly over

const char *site_ground_name(SiteGround ground) {
    return ground == SITE_DEM ? "dem" : "rough";
}

Result site_open(const Options *options, Site *out) {
    *out = (Site){0};
    Result result = scene_load_dem(options, &out->dem);
    if (result == RESULT_OK)
        result = scene_open_geoid(options, &out->geoid);
    if (result != RESULT_OK)
        site_close(out);
    return result;
}

void site_close(Site *site) {
    if (site->geoid)
        geoid_close(&site->geoid);
    dem_destroy(&site->dem);
}

static Result make_rough(int side, Dem **out) {
    DemGeoref georef = {.crs = DEM_CRS_UTM,
                        .utm_zone = ROUGH_ZONE,
                        .utm_north = true,
                        .x0 = ROUGH_WEST_M,
                        .y0 = ROUGH_NORTH_M,
                        .dx = ROUGH_STEP_M,
                        .dy = -ROUGH_STEP_M};
    Result result = dem_create(side, side, &georef, DEM_DATUM_ELLIPSOID, out);
    if (result == RESULT_OK)
        bench_fill_rough((*out)->height_m, side);
    return result;
}

Result site_make_dem(const Site *site, SiteGround ground, int side, Dem **out) {
    return ground == SITE_ROUGH ? make_rough(side, out) : dem_resample(site->dem, side, side, out);
}

Result site_make_terrain(const Site *site, SiteGround ground, int side, TerrainErrorKind error, Jobs *jobs,
                         Terrain **out) {
    TerrainOptions options = terrain_default_options();
    options.error = error;
    Dem *dem = NULL;
    Result result = site_make_dem(site, ground, side, &dem);
    if (result != RESULT_OK)
        return result;
    result = terrain_create(&options, dem, site->geoid, jobs, out);
    if (result != RESULT_OK)
        dem_destroy(&dem);
    return result;
}
