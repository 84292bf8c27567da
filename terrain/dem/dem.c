#define _POSIX_C_SOURCE 200809L
#include "terrain/dem/dem.h"

#include "base/log.h"
#include "terrain/geo.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

DemOptions dem_default_options(void) {
    return (DemOptions){.voids = DEM_VOIDS_FILL};
}

static void set_names(Dem *dem, const DemGeoref *georef) {
    snprintf(dem->type, sizeof dem->type, "float32");
    if (georef->crs == DEM_CRS_UTM)
        snprintf(dem->crs_name, sizeof dem->crs_name, "EPSG:%d",
                 (georef->utm_north ? 32600 : 32700) + georef->utm_zone);
    else
        snprintf(dem->crs_name, sizeof dem->crs_name, "EPSG:4326");
}

Result dem_create(int width, int height, const DemGeoref *georef, DemDatum datum, Dem **out) {
    if (width < 2 || height < 2 || width > DEM_SIDE_MAX || height > DEM_SIDE_MAX) {
        log_error("elevation model of %d x %d samples; a surface needs 2 to %d a side", width, height, DEM_SIDE_MAX);
        return RESULT_RANGE;
    }
    Dem *dem = calloc(1, sizeof *dem);
    if (dem) {
        *dem = (Dem){.width = width, .height = height, .georef = *georef, .datum = datum, .georeferenced = true};
        set_names(dem, georef);
        dem->file = strdup("");
        dem->height_m = calloc((size_t)width * (size_t)height, sizeof *dem->height_m);
    }
    if (!dem || !dem->file || !dem->height_m) {
        log_error("no memory for an elevation model of %d x %d samples", width, height);
        dem_destroy(&dem);
        return RESULT_MEMORY;
    }
    *out = dem;
    return RESULT_OK;
}

void dem_destroy(Dem **dem) {
    if (!*dem)
        return;
    free((*dem)->file);
    for (int i = 0; i < (*dem)->file_count; i++)
        free((*dem)->files[i]);
    free((*dem)->files);
    free((*dem)->height_m);
    free((*dem)->void_bits);
    free(*dem);
    *dem = NULL;
}

// ---- Bounds and spacing -----------------------------------------------------------------------------------------

static Result geodetic_at(const DemGeoref *georef, double col, double row, double *lat_deg, double *lon_deg) {
    double x = georef->x0 + col * georef->dx, y = georef->y0 + row * georef->dy;
    if (georef->crs == DEM_CRS_UTM)
        return geo_utm_reverse(georef->utm_zone, georef->utm_north, x, y, lat_deg, lon_deg);
    *lat_deg = y;
    *lon_deg = x;
    return RESULT_OK;
}

// Longitudes are kept within half a turn of `reference_deg`, so that the antimeridian does not tear the hull.
static Result extend_bounds(const DemGeoref *georef, double col, double row, double reference_deg, DemBounds *bounds) {
    double lat, lon;
    Result result = geodetic_at(georef, col, row, &lat, &lon);
    if (result != RESULT_OK)
        return result;
    lon = georef->crs == DEM_CRS_UTM ? reference_deg + remainder(lon - reference_deg, 360.0) : lon;
    bounds->west_deg = fmin(bounds->west_deg, lon);
    bounds->east_deg = fmax(bounds->east_deg, lon);
    bounds->south_deg = fmin(bounds->south_deg, lat);
    bounds->north_deg = fmax(bounds->north_deg, lat);
    return RESULT_OK;
}

// The curves of a side's image are smooth: between 256 points on each they bulge by less than 1e-6 of their sagitta.
#define SIDE_POINTS 256

Result dem_bounds(const Dem *dem, DemBounds *out) {
    double right = dem->width - 1, bottom = dem->height - 1, lat, middle;
    Result result = geodetic_at(&dem->georef, 0.5 * right, 0.5 * bottom, &lat, &middle);
    *out = (DemBounds){INFINITY, INFINITY, -INFINITY, -INFINITY};
    for (int i = 0; i <= SIDE_POINTS && result == RESULT_OK; i++) {
        double share = (double)i / SIDE_POINTS;
        const double ends[4][2] = {
            {share * right, 0.0}, {share * right, bottom}, {0.0, share * bottom}, {right, share * bottom}};
        for (int side = 0; side < 4 && result == RESULT_OK; side++)
            result = extend_bounds(&dem->georef, ends[side][0], ends[side][1], middle, out);
    }
    return result;
}

static Result ellipsoid_point(const DemGeoref *georef, double col, double row, Vec3d *out) {
    double lat, lon;
    Result result = geodetic_at(georef, col, row, &lat, &lon);
    if (result == RESULT_OK)
        *out = geodesy_to_ecef((Geodetic){lat * GEODESY_RAD_PER_DEG, lon * GEODESY_RAD_PER_DEG, 0.0});
    return result;
}

static Result distance_between(const DemGeoref *georef, const double a[2], const double b[2], double *out_m) {
    Vec3d from, to;
    Result result = ellipsoid_point(georef, a[0], a[1], &from);
    if (result == RESULT_OK)
        result = ellipsoid_point(georef, b[0], b[1], &to);
    if (result == RESULT_OK)
        *out_m = vec3d_distance(from, to);
    return result;
}

Result dem_spacing_m(const Dem *dem, double out_m[2]) {
    double col = 0.5 * (dem->width - 1), row = 0.5 * (dem->height - 1);
    Result result = distance_between(&dem->georef, (double[2]){col - 0.5, row}, (double[2]){col + 0.5, row}, &out_m[0]);
    if (result == RESULT_OK)
        result = distance_between(&dem->georef, (double[2]){col, row - 0.5}, (double[2]){col, row + 0.5}, &out_m[1]);
    return result;
}

uint64_t dem_hash(const Dem *dem) {
    uint64_t hash = UINT64_C(14695981039346656037);
    size_t count = (size_t)dem->width * (size_t)dem->height;
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &dem->height_m[i], sizeof bits);
        hash = (hash ^ bits) * UINT64_C(1099511628211);
    }
    return hash;
}
