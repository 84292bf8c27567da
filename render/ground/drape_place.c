#include "render/ground/drape_place.h"

#include "assets/image.h"
#include "base/log.h"
#include "terrain/dem/geotiff_tags.h"
#include "terrain/geo.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MODEL_PROJECTED = 1, MODEL_GEOGRAPHIC = 2 };
enum { EPSG_WGS84 = 4326, EPSG_UTM_NORTH = 32600, EPSG_UTM_SOUTH = 32700 };

static bool utm_from_code(int code, DrapePlace *place) {
    int zone = code % 100;
    place->utm = true;
    place->zone = zone;
    place->zone_north = code / 100 * 100 == EPSG_UTM_NORTH;
    return (place->zone_north || code / 100 * 100 == EPSG_UTM_SOUTH) && zone >= 1 && zone <= 60;
}

static bool place_from_tags(const GeotiffTags *tags, DrapePlace *place) {
    if (!tags->has_keys || !tags->has_scale || tags->tie_count < 1 || tags->scale[0] <= 0.0 || tags->scale[1] <= 0.0)
        return false;
    double shift = tags->is_point ? 0.5 : 0.0; // the tie is a pixel's centre: half a pixel out
    place->west = tags->tie[3] - (tags->tie[0] + shift) * tags->scale[0];
    place->north = tags->tie[4] + (tags->tie[1] + shift) * tags->scale[1];
    place->across = tags->width * tags->scale[0];
    place->down = tags->height * tags->scale[1];
    if (tags->model == MODEL_GEOGRAPHIC)
        return tags->geographic == EPSG_WGS84 || tags->defined_wgs84;
    return tags->model == MODEL_PROJECTED &&
           utm_from_code(tags->defined_utm ? tags->defined_utm : tags->projected, place);
}

static Result place_from_bounds(const RenderOptions *options, DrapePlace *out) {
    double across = options->image_east_deg - options->image_west_deg;
    double down = options->image_north_deg - options->image_south_deg;
    // Written so that a NaN fails too.
    if (!(across > 0.0 && across <= 360.0 && down > 0.0 && down <= 180.0)) {
        log_error("%s: bounds west %g, south %g, east %g, north %g: east must lie east of west and north above south",
                  options->image_path, options->image_west_deg, options->image_south_deg, options->image_east_deg,
                  options->image_north_deg);
        return RESULT_RANGE;
    }
    *out = (DrapePlace){
        .west = options->image_west_deg, .north = options->image_north_deg, .across = across, .down = down};
    return RESULT_OK;
}

// Whether the file can be opened as a picture at all; says why not.
static Result check_picture(const char *path) {
    ImageFile *file = NULL;
    Result result = image_open(path, NULL, &file);
    if (result == RESULT_OK)
        image_close(&file);
    return result;
}

static bool is_tiff(const char *path) {
    uint8_t head[4] = {0};
    FILE *file = fopen(path, "rb");
    if (!file)
        return false;
    size_t length = fread(head, 1, sizeof head, file);
    fclose(file);
    return length == sizeof head && (memcmp(head, "II", 2) == 0 || memcmp(head, "MM", 2) == 0);
}

static Result refuse_without_place(const char *path, bool has_keys) {
    if (has_keys)
        log_error("%s: its georeference is neither WGS84 degrees nor UTM; convert it: gdalwarp -t_srs EPSG:4326 %s "
                  "OUT.tif",
                  path, path);
    else
        log_error("%s: a picture without a georeference of its own; say where its outer edges lie: --image-bounds "
                  "WEST,SOUTH,EAST,NORTH in degrees",
                  path);
    return RESULT_UNSUPPORTED;
}

Result drape_place_find(const RenderOptions *options, DrapePlace *out) {
    if (options->image_bounds_given)
        return place_from_bounds(options, out);
    const char *path = options->image_path;
    GeotiffTags tags = {0};
    *out = (DrapePlace){0};
    Result result = check_picture(path);
    if (result == RESULT_OK && is_tiff(path))
        result = geotiff_read_tags(path, &tags);
    if (result != RESULT_OK)
        return result;
    return place_from_tags(&tags, out) ? RESULT_OK : refuse_without_place(path, tags.has_keys);
}

bool drape_place_locate(const DrapePlace *place, double lat_deg, double lon_deg, double near_lon_deg, double *u,
                        double *v) {
    double x = near_lon_deg + remainder(lon_deg - near_lon_deg, 360.0), y = lat_deg;
    if (place->utm && geo_utm_forward(place->zone, place->zone_north, lat_deg, lon_deg, &x, &y) != RESULT_OK)
        return false;
    *u = (x - place->west) / place->across;
    *v = (place->north - y) / place->down;
    return true;
}
