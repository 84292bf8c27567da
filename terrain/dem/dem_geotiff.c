#include "base/log.h"
#include "terrain/dem/dem_source.h"
#include "terrain/dem/geotiff_tags.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

// ---- Samples ----------------------------------------------------------------------------------------------------

static ImageType type_of(const GeotiffTags *tags) {
    static const struct {
        GeotiffFormat format;
        int bits;
        ImageType type;
    } TYPES[] = {{GEOTIFF_UINT, 8, IMAGE_UINT8},    {GEOTIFF_INT, 8, IMAGE_INT8},     {GEOTIFF_UINT, 16, IMAGE_UINT16},
                 {GEOTIFF_INT, 16, IMAGE_INT16},    {GEOTIFF_UINT, 32, IMAGE_UINT32}, {GEOTIFF_INT, 32, IMAGE_INT32},
                 {GEOTIFF_FLOAT, 32, IMAGE_FLOAT32}};
    for (size_t i = 0; i < COUNT_OF(TYPES); i++)
        if (tags->format == TYPES[i].format && tags->bits == TYPES[i].bits)
            return TYPES[i].type;
    return IMAGE_OTHER;
}

static Result refuse_picture(const char *path, const GeotiffTags *tags) {
    log_error("%s: %d bands of %d bits in colours: a picture, not elevation; drape it over a terrain with --image",
              path, tags->bands, tags->bits);
    return RESULT_FORMAT;
}

// As a sample can hold it: the text of a float's nodata value is often rounded, the lowest float's beyond its range.
static double stored_nodata(const GeotiffTags *tags, ImageType type) {
    if (type != IMAGE_FLOAT32 || !isfinite(tags->nodata))
        return tags->nodata;
    return fabs(tags->nodata) < FLT_MAX ? (double)(float)tags->nodata : copysign(FLT_MAX, tags->nodata);
}

static Result set_samples(const char *path, const GeotiffTags *tags, DemSource *out) {
    DemCoding *coding = &out->coding;
    if (!tags->gray || (tags->bands >= 3 && tags->bits == 8))
        return refuse_picture(path, tags);
    coding->type = type_of(tags);
    if (coding->type == IMAGE_OTHER) {
        log_error("%s: samples of %d bits of a kind that is not read; expected integers of 8, 16 or 32 bits, or floats "
                  "of 32; convert it: gdal_translate -ot Float32 %s OUT.tif",
                  path, tags->bits, path);
        return RESULT_UNSUPPORTED;
    }
    if (tags->bands > 2) {
        log_error("%s: %d bands; expected one; take the one that is elevation: gdal_translate -b 1 %s OUT.tif", path,
                  tags->bands, path);
        return RESULT_UNSUPPORTED;
    }
    if (tags->bands == 2 && !tags->alpha)
        log_warn("%s: two bands; the first is read as elevation, the second is not read", path);
    coding->alpha = tags->alpha;
    coding->channels = tags->alpha ? 2 : 1;
    coding->has_nodata = tags->has_nodata;
    coding->nodata = stored_nodata(tags, coding->type);
    snprintf(out->header.type, sizeof out->header.type, "%s", image_type_name(coding->type));
    return RESULT_OK;
}

// ---- Heights ----------------------------------------------------------------------------------------------------

#define FOOT_M 0.3048
#define FOOT_US_M (1200.0 / 3937.0)
#define SCALE_MAX_M 1e9 // of scale and offset

// 0: the unit is not known.
static double metres_of_unit_code(int code) {
    switch (code) {
    case 9001:
        return 1.0;
    case 9002:
        return FOOT_M;
    case 9003:
        return FOOT_US_M;
    default:
        return 0.0;
    }
}

static double metres_of_unit_name(const char *name) {
    static const struct {
        const char *name;
        double metres;
    } UNITS[] = {{"m", 1.0},
                 {"metre", 1.0},
                 {"meter", 1.0},
                 {"metres", 1.0},
                 {"meters", 1.0},
                 {"ft", FOOT_M},
                 {"foot", FOOT_M},
                 {"feet", FOOT_M},
                 {"international foot", FOOT_M},
                 {"ft-us", FOOT_US_M},
                 {"us-ft", FOOT_US_M},
                 {"ftUS", FOOT_US_M},
                 {"US survey foot", FOOT_US_M},
                 {"cm", 0.01},
                 {"dm", 0.1},
                 {"mm", 0.001},
                 {"km", 1000.0}};
    for (size_t i = 0; i < COUNT_OF(UNITS); i++)
        if (strcmp(name, UNITS[i].name) == 0)
            return UNITS[i].metres;
    return 0.0;
}

// Vertical systems in feet need no units key.
static double metres_of_vertical(int vertical) {
    return vertical == 6360 ? FOOT_US_M : vertical == 8228 ? FOOT_M : 1.0;
}

static Result set_scale(const char *path, const GeotiffTags *tags, DemCoding *coding) {
    double unit_m = tags->gdal_unit[0]         ? metres_of_unit_name(tags->gdal_unit)
                    : tags->vertical_units > 0 ? metres_of_unit_code(tags->vertical_units)
                                               : metres_of_vertical(tags->vertical);
    coding->scale_m = tags->gdal_scale * unit_m;
    coding->offset_m = tags->gdal_offset * unit_m;
    // Written so that NaN is refused as well.
    if (unit_m > 0.0 && fabs(coding->scale_m) <= SCALE_MAX_M && fabs(coding->offset_m) <= SCALE_MAX_M &&
        coding->scale_m != 0.0)
        return RESULT_OK;
    log_error("%s: heights in the unit \"%s\" (EPSG:%d), scale %g, offset %g; expected metres or feet; rewrite it: "
              "gdal_translate -unscale -ot Float32 -a_scale METRES_PER_UNIT %s OUT.tif",
              path, tags->gdal_unit, tags->vertical_units, tags->gdal_scale, tags->gdal_offset, path);
    return RESULT_UNSUPPORTED;
}

// EPSG codes: of vertical systems, of the geoid's own datum, of 3D systems whose third axis is the ellipsoid's.
static bool is_egm96(int code) {
    return code == 5773 || code == 5171;
}
static bool is_ellipsoid(int code) {
    return code == 4979 || code == 4937 || code == 4957 || code == 5030 || code == 5019;
}

static void set_datum(const DemOptions *options, const char *path, const GeotiffTags *tags, DemHeader *header) {
    bool egm96 = is_egm96(tags->vertical) || is_egm96(tags->vertical_datum);
    bool ellipsoid = is_ellipsoid(tags->vertical) || (!egm96 && tags->vertical == 0 && is_ellipsoid(tags->geographic));
    header->datum = ellipsoid ? DEM_DATUM_ELLIPSOID : DEM_DATUM_EGM96;
    header->datum_assumed = !egm96 && !ellipsoid;
    if (options->datum_given)
        return;
    if (header->datum_assumed && tags->vertical != 0)
        log_warn("%s: heights above EPSG:%d are taken as above EGM96; the two may differ by a few metres; convert with "
                 "gdalwarp -t_srs EPSG:4326+5773, or say --datum",
                 path, tags->vertical);
}

// ---- Horizontal system ------------------------------------------------------------------------------------------

#define EPSG_WGS84 4326

// First code of a family of UTM zones, the zone of that code, and how many follow.
typedef struct UtmFamily {
    int first, zone, count;
    bool north, wgs84, near_wgs84; // near: within 2 m
} UtmFamily;

static const UtmFamily UTM_FAMILIES[] = {
    {32601, 1, 60, true, true, false},   {32701, 1, 60, false, true, false},
    {25828, 28, 11, true, false, true},  // ETRS89
    {26901, 1, 23, true, false, true},   // NAD83
    {26701, 1, 22, true, false, false},  // NAD27
    {23028, 28, 11, true, false, false}, // ED50
    {32201, 1, 60, true, false, false},  // WGS72
    {32301, 1, 60, false, false, false},
};

static const UtmFamily *utm_family(int code) {
    for (size_t i = 0; i < COUNT_OF(UTM_FAMILIES); i++)
        if (code >= UTM_FAMILIES[i].first && code < UTM_FAMILIES[i].first + UTM_FAMILIES[i].count)
            return &UTM_FAMILIES[i];
    return NULL;
}

// The code that gdalwarp should aim at: the same zone on WGS84, else degrees.
static int wgs84_twin(int code) {
    const UtmFamily *family = utm_family(code);
    return family ? (family->north ? 32600 : 32700) + family->zone + code - family->first : EPSG_WGS84;
}

static void warn_taken_as_wgs84(const char *path, int code) {
    log_warn("%s: EPSG:%d is taken as WGS84; positions are off by up to 2 m", path, code);
}

static void name_crs(DemHeader *header, int code) {
    snprintf(header->crs_name, sizeof header->crs_name, "EPSG:%d", code);
}

static bool set_utm(const char *path, int code, DemHeader *header) {
    const UtmFamily *family = utm_family(code);
    if (!family || !(family->wgs84 || family->near_wgs84))
        return false;
    if (family->near_wgs84)
        warn_taken_as_wgs84(path, code);
    header->georef.crs = DEM_CRS_UTM;
    header->georef.utm_zone = family->zone + code - family->first;
    header->georef.utm_north = family->north;
    name_crs(header, code);
    return true;
}

static bool set_geographic(const char *path, const GeotiffTags *tags, DemHeader *header) {
    static const int NEAR[] = {4269, 4258, 4937, 4957}; // NAD83, ETRS89, flat and 3D
    int code = tags->geographic;
    bool taken = code == EPSG_WGS84 || code == 4979 || (code == GEOTIFF_CODE_USER_DEFINED && tags->defined_wgs84);
    for (size_t i = 0; i < COUNT_OF(NEAR) && !taken; i++)
        if (code == NEAR[i]) {
            warn_taken_as_wgs84(path, code);
            taken = true;
        }
    header->georef.crs = DEM_CRS_GEOGRAPHIC;
    name_crs(header, code == GEOTIFF_CODE_USER_DEFINED ? EPSG_WGS84 : code);
    return taken;
}

static Result refuse_crs(const char *path, const GeotiffTags *tags) {
    int code = tags->model == 1 ? tags->projected : tags->geographic;
    if (!tags->has_keys) {
        log_error(
            "%s: it does not say in which coordinate system it is; declare it: gdal_translate -a_srs EPSG:CODE %s "
            "OUT.tif",
            path, path);
        return RESULT_UNSUPPORTED;
    }
    log_error("%s: its coordinate system, %s%d (%s), is neither longitude and latitude nor UTM on WGS84; convert it: "
              "gdalwarp "
              "-t_srs EPSG:%d -r bilinear %s OUT.tif",
              path, code == GEOTIFF_CODE_USER_DEFINED ? "user-defined " : "EPSG:", code,
              tags->citation[0] ? tags->citation : "unnamed", wgs84_twin(code), path);
    return RESULT_UNSUPPORTED;
}

static Result set_crs(const char *path, const GeotiffTags *tags, DemHeader *header) {
    int projected = tags->projected == GEOTIFF_CODE_USER_DEFINED ? tags->defined_utm : tags->projected;
    bool taken = (tags->model == 1 && set_utm(path, projected, header)) ||
                 (tags->model == 2 && set_geographic(path, tags, header));
    return taken ? RESULT_OK : refuse_crs(path, tags);
}

// ---- Placement --------------------------------------------------------------------------------------------------

// x = origin[0] + step[0] col + skew[0] row, y = origin[1] + skew[1] col + step[1] row, at the corners of pixels or at
// their centres as the raster type says.
typedef struct Placement {
    double origin[2], step[2], skew[2];
} Placement;

static bool find_placement(const GeotiffTags *tags, Placement *out) {
    if (tags->has_matrix) {
        const double *m = tags->matrix;
        *out = (Placement){{m[3], m[7]}, {m[0], m[5]}, {m[1], m[4]}};
        return true;
    }
    if (!tags->has_scale || tags->tie_count < 1)
        return false;
    // As GDAL has it: rows go south whatever the sign of the second scale; a negative first one mirrors.
    double sx = tags->scale[0], sy = -fabs(tags->scale[1]);
    *out = (Placement){{tags->tie[3] - tags->tie[0] * sx, tags->tie[4] - tags->tie[1] * sy}, {sx, sy}, {0.0, 0.0}};
    return true;
}

static bool is_rotated(const GeotiffTags *tags, const Placement *placement) {
    // A hundredth of a sample over the whole side is rounding.
    double over_x = fabs(placement->skew[0]) * tags->height, over_y = fabs(placement->skew[1]) * tags->width;
    return over_x > 0.01 * fabs(placement->step[0]) || over_y > 0.01 * fabs(placement->step[1]) ||
           placement->step[0] < 0.0;
}

static Result refuse_rotated(const char *path, const GeotiffTags *tags, const DemHeader *header) {
    int code = EPSG_WGS84;
    if (header->georef.crs == DEM_CRS_UTM)
        code = (header->georef.utm_north ? 32600 : 32700) + header->georef.utm_zone;
    log_error(
        "%s: %s; rows must run east and columns south; resample it: gdalwarp -t_srs EPSG:%d -r bilinear %s OUT.tif",
        path, tags->has_matrix ? "its matrix rotates or mirrors the grid" : "it is placed by control points only", code,
        path);
    return RESULT_UNSUPPORTED;
}

static void set_placement(const GeotiffTags *tags, const Placement *placement, DemSource *out) {
    DemGeoref *georef = &out->header.georef;
    double centre = tags->is_point ? 0.0 : 0.5;
    georef->dx = placement->step[0];
    georef->dy = -fabs(placement->step[1]);
    georef->x0 = placement->origin[0] + centre * placement->step[0];
    out->coding.south_up = placement->step[1] > 0.0;
    double first_row = centre, last_row = centre + tags->height - 1;
    georef->y0 = placement->origin[1] + (out->coding.south_up ? last_row : first_row) * placement->step[1];
    out->header.pixel_is_area = !tags->is_point;
    out->header.georeferenced = true;
}

static Result read_geotiff(const DemSource *source, const DemTarget *target) {
    return dem_raster_read(source, "tiff", target);
}

static Result place(const DemOptions *options, const char *path, const GeotiffTags *tags, DemSource *out) {
    Placement placement = {0};
    bool placed = find_placement(tags, &placement);
    if (!placed && tags->tie_count == 0)
        return dem_source_place(options, path, &out->header);
    Result result = set_crs(path, tags, &out->header);
    if (result != RESULT_OK)
        return result;
    if (!placed || is_rotated(tags, &placement))
        return refuse_rotated(path, tags, &out->header);
    set_placement(tags, &placement, out);
    return RESULT_OK;
}

Result dem_geotiff_open(const DemOptions *options, const char *path, DemSource *out) {
    GeotiffTags tags;
    Result result = geotiff_read_tags(path, &tags);
    if (result == RESULT_OK)
        result = set_samples(path, &tags, out);
    if (result == RESULT_OK)
        result = set_scale(path, &tags, &out->coding);
    if (result != RESULT_OK)
        return result;
    out->header.width = tags.width;
    out->header.height = tags.height;
    set_datum(options, path, &tags, &out->header);
    out->read = read_geotiff;
    return place(options, path, &tags, out);
}
