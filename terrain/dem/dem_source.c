#define _POSIX_C_SOURCE 200809L
#include "terrain/dem/dem_source.h"

#include "base/log.h"
#include "terrain/geo.h"
#include "terrain/geodesy.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

// ---- What kind of file ------------------------------------------------------------------------------------------

typedef enum Kind { KIND_UNKNOWN, KIND_EMPTY, KIND_TIFF, KIND_PNG, KIND_ZIP, KIND_GZIP, KIND_HGT, KIND_USGS_DEM } Kind;

bool dem_name_ends(const char *name, const char *ending) {
    size_t length = strlen(name), tail = strlen(ending);
    return length >= tail && strcasecmp(name + length - tail, ending) == 0;
}

// The old USGS format is text in records of 1024 bytes; its first one ends in the count of columns.
static bool looks_like_usgs_dem(const char *path, const uint8_t *head, size_t length) {
    if (!dem_name_ends(path, ".dem") || length < 64)
        return false;
    for (size_t i = 0; i < length; i++)
        if (head[i] < 32 || head[i] > 126)
            return false;
    return true;
}

static Kind kind_of(const char *path, const uint8_t *head, size_t length) {
    static const struct {
        const char *magic;
        size_t length;
        Kind kind;
    } MAGICS[] = {{"II*\0", 4, KIND_TIFF},   {"MM\0*", 4, KIND_TIFF},      {"II+\0", 4, KIND_TIFF},
                  {"MM\0+", 4, KIND_TIFF},   {"\x89PNG\r\n", 6, KIND_PNG}, {"PK\3\4", 4, KIND_ZIP},
                  {"\x1f\x8b", 2, KIND_GZIP}};
    // Raw samples may begin with any bytes: the name decides first.
    if (dem_name_ends(path, ".hgt"))
        return KIND_HGT;
    if (length == 0)
        return KIND_EMPTY;
    for (size_t i = 0; i < COUNT_OF(MAGICS); i++)
        if (length >= MAGICS[i].length && memcmp(head, MAGICS[i].magic, MAGICS[i].length) == 0)
            return MAGICS[i].kind;
    return looks_like_usgs_dem(path, head, length) ? KIND_USGS_DEM : KIND_UNKNOWN;
}

static Result read_head(const char *path, uint8_t *head, size_t *length, int64_t *bytes) {
    struct stat status;
    if (stat(path, &status)) {
        int cause = errno;
        log_error("%s: %s; check the path", path, strerror(cause));
        return cause == ENOENT || cause == ENOTDIR ? RESULT_NOT_FOUND : RESULT_IO;
    }
    if (!S_ISREG(status.st_mode)) {
        log_error("%s: not a file; give elevation files, or a folder of them", path);
        return RESULT_FORMAT;
    }
    FILE *file = fopen(path, "rb");
    if (!file) {
        log_error("%s: %s; make it readable", path, strerror(errno));
        return RESULT_IO;
    }
    *length = fread(head, 1, *length, file);
    *bytes = status.st_size;
    fclose(file);
    return RESULT_OK;
}

static Result refuse(const char *path, Kind kind) {
    if (kind == KIND_EMPTY) {
        log_error("%s: the file is empty; fetch it again", path);
        return RESULT_FORMAT;
    }
    if (kind == KIND_USGS_DEM) {
        log_error("%s: a USGS ASCII DEM, mostly on the old NAD27 datum, which is not read; convert it: "
                  "gdalwarp -t_srs EPSG:4326 -r bilinear -ot Float32 %s OUT.tif",
                  path, path);
        return RESULT_UNSUPPORTED;
    }
    log_error("%s: neither GeoTIFF, .hgt (also in .zip or .gz) nor PNG; if GDAL can read it, convert it: "
              "gdalwarp -t_srs EPSG:4326 -r bilinear %s OUT.tif",
              path, path);
    return RESULT_FORMAT;
}

Result dem_source_open(const DemOptions *options, const char *path, DemSource *out) {
    uint8_t head[256];
    size_t length = sizeof head;
    int64_t bytes = 0;
    Result result = read_head(path, head, &length, &bytes);
    if (result != RESULT_OK)
        return result;
    *out = (DemSource){.path = path};
    Kind kind = kind_of(path, head, length);
    switch (kind) {
    case KIND_TIFF:
        return dem_geotiff_open(options, path, out);
    case KIND_PNG:
        return dem_png_open(options, path, bytes, out);
    case KIND_ZIP:
    case KIND_GZIP:
    case KIND_HGT:
        return dem_hgt_open(path, out);
    default:
        return refuse(path, kind);
    }
}

// ---- Where it lies ----------------------------------------------------------------------------------------------

static Result place_by_bounds(const DemOptions *options, DemHeader *header) {
    double east = options->east_deg + (options->east_deg < options->west_deg ? 360.0 : 0.0);
    DemGeoref *georef = &header->georef;
    georef->x0 = options->west_deg;
    georef->y0 = options->north_deg;
    georef->dx = (east - options->west_deg) / (header->width - 1);
    georef->dy = (options->south_deg - options->north_deg) / (header->height - 1);
    header->georeferenced = true;
    snprintf(header->crs_name, sizeof header->crs_name, "EPSG:4326");
    return RESULT_OK;
}

// Around 0 N 0 E, where parallels shrink least, so that the spacing holds over the whole DEM.
static Result place_by_spacing(const DemOptions *options, const char *path, DemHeader *header) {
    double meridian_m = GEODESY_A_M * (1.0 - GEODESY_E2); // radius of curvature at the equator
    DemGeoref *georef = &header->georef;
    georef->dx = options->spacing_m / (GEODESY_A_M * GEODESY_RAD_PER_DEG);
    georef->dy = -options->spacing_m / (meridian_m * GEODESY_RAD_PER_DEG);
    georef->x0 = -0.5 * georef->dx * (header->width - 1);
    georef->y0 = -0.5 * georef->dy * (header->height - 1);
    header->georeferenced = false;
    snprintf(header->crs_name, sizeof header->crs_name, "none");
    if (georef->y0 <= 60.0 && georef->x0 >= -180.0)
        return RESULT_OK;
    log_error(
        "%s: %d x %d samples %g m apart do not fit between 60 S and 60 N; give --bounds W,S,E,N instead of --spacing",
        path, header->width, header->height, options->spacing_m);
    return RESULT_RANGE;
}

Result dem_source_place(const DemOptions *options, const char *path, DemHeader *header) {
    header->georef = (DemGeoref){.crs = DEM_CRS_GEOGRAPHIC};
    if (options->bounds_given)
        return place_by_bounds(options, header);
    if (options->spacing_m > 0.0)
        return place_by_spacing(options, path, header);
    log_error("%s: the image does not say where it lies; give the distance of its samples with --spacing METRES, or "
              "where it lies with --bounds W,S,E,N in degrees",
              path);
    return RESULT_UNSUPPORTED;
}

static bool fits_globe(const DemHeader *header) {
    const DemGeoref *georef = &header->georef;
    double south = georef->y0 + georef->dy * (header->height - 1);
    double tolerance = -1e-6 * georef->dy;
    return georef->y0 <= 90.0 + tolerance && south >= -90.0 - tolerance &&
           georef->dx * (header->width - 1) <= 360.0 * (1.0 + 1e-9);
}

static void normalize_longitude(DemHeader *header) {
    double middle = header->georef.x0 + 0.5 * header->georef.dx * (header->width - 1);
    header->georef.x0 -= 360.0 * floor((middle + 180.0) / 360.0);
    // Exactly 180 E stays in the east.
    if (middle == 180.0)
        header->georef.x0 += 360.0;
}

static bool fits_utm(const DemHeader *header) {
    const DemGeoref *georef = &header->georef;
    for (int corner = 0; corner < 4; corner++) {
        double lat, lon;
        double x = georef->x0 + (corner & 1 ? georef->dx * (header->width - 1) : 0.0);
        double y = georef->y0 + (corner & 2 ? georef->dy * (header->height - 1) : 0.0);
        if (geo_utm_reverse(georef->utm_zone, georef->utm_north, x, y, &lat, &lon) != RESULT_OK)
            return false;
    }
    return true;
}

Result dem_source_check_georef(const char *path, DemHeader *header) {
    const DemGeoref *georef = &header->georef;
    bool finite = isfinite(georef->x0) && isfinite(georef->y0) && isfinite(georef->dx) && isfinite(georef->dy) &&
                  fabs(georef->x0) < 1e9 && fabs(georef->y0) < 1e9;
    bool positive = georef->dx > 0.0 && georef->dy < 0.0;
    bool fits = finite && positive && (georef->crs == DEM_CRS_UTM ? fits_utm(header) : fits_globe(header));
    if (!fits) {
        log_error("%s: its georeference, first sample %.9g,%.9g, step %.9g,%.9g over %d x %d samples in %s, leaves the "
                  "globe or the projection; correct it: gdal_translate -a_srs EPSG:CODE -a_ullr W N E S %s OUT.tif",
                  path, georef->x0, georef->y0, georef->dx, georef->dy, header->width, header->height, header->crs_name,
                  path);
        return RESULT_RANGE;
    }
    if (georef->crs == DEM_CRS_GEOGRAPHIC)
        normalize_longitude(header);
    return RESULT_OK;
}

// ---- Rows -------------------------------------------------------------------------------------------------------

static Result refuse_height(const DemSource *source, int col, int file_row, float height_m) {
    if (source->coding.terrarium) {
        log_error(
            "%s: the colour at column %d, row %d stands for %.0f m as terrarium tiles encode heights: a picture, not "
            "elevation; drape it over a terrain with --image",
            source->path, col, file_row, (double)height_m);
        return RESULT_FORMAT;
    }
    log_error(
        "%s: the sample at column %d, row %d of the file is %g m: another unit, a nodata value that is not "
        "declared, or no elevation at all; declare it: gdal_translate -a_nodata VALUE (or -a_scale FACTOR) %s OUT.tif",
        source->path, col, file_row, (double)height_m, source->path);
    return RESULT_FORMAT;
}

static Result check_heights(const DemSource *source, int file_row, const float *height_m) {
    float low = (float)(source->coding.terrarium ? DEM_TERRARIUM_MIN_M : -DEM_HEIGHT_MAX_M);
    float high = (float)(source->coding.terrarium ? DEM_TERRARIUM_MAX_M : DEM_HEIGHT_MAX_M);
    for (int col = 0; col < source->header.width; col++)
        if (isless(height_m[col], low) || isgreater(height_m[col], high)) // voids are neither
            return refuse_height(source, col, file_row, height_m[col]);
    return RESULT_OK;
}

Result dem_source_put_row(const DemSource *source, const DemTarget *target, int file_row, const float *height_m) {
    Result result = check_heights(source, file_row, height_m);
    if (result != RESULT_OK)
        return result;
    int row = source->coding.south_up ? source->header.height - 1 - file_row : file_row;
    float *out = target->height_m + (size_t)row * target->stride;
    for (int col = 0; col < source->header.width; col++)
        out[col] = isnan(out[col]) ? height_m[col] : out[col];
    return RESULT_OK;
}
