#include "app/commands/command.h"
#include "app/json.h"
#include "app/scene_load.h"
#include "base/log.h"
#include "terrain/dem/dem.h"

#include <stdio.h>

typedef struct Info {
    const Dem *dem;
    DemBounds bounds;
    double spacing_m[2];
} Info;

static const char *datum_name(const Dem *dem) {
    return dem->datum == DEM_DATUM_ELLIPSOID ? "ellipsoid" : "EGM96";
}

static const char *cell_name(const Dem *dem) {
    return dem->pixel_is_area ? "area" : "point";
}

static void add_files(Json *json, const Dem *dem) {
    Json *files = json_add_array(json, "files");
    for (int i = 0; i < dem->file_count; i++)
        json_append_text(files, dem->files[i]);
}

static Result print_json(const Info *info) {
    const Dem *dem = info->dem;
    Json *json = json_create();
    json_add_text(json, "file", dem->file);
    add_files(json, dem);
    json_add_integer(json, "width", dem->width);
    json_add_integer(json, "height", dem->height);
    json_add_text(json, "type", dem->type);
    json_add_text(json, "crs", dem->crs_name);
    json_add_bool(json, "georeferenced", dem->georeferenced);
    json_add_numbers(json, "spacing_m", info->spacing_m, 2);
    json_add_numbers(json, "step", (double[2]){dem->georef.dx, -dem->georef.dy}, 2);
    json_add_numbers(json, "first_sample", (double[2]){dem->georef.x0, dem->georef.y0}, 2);
    Json *bounds = json_add_object(json, "bounds");
    json_add_number(bounds, "west", info->bounds.west_deg);
    json_add_number(bounds, "south", info->bounds.south_deg);
    json_add_number(bounds, "east", info->bounds.east_deg);
    json_add_number(bounds, "north", info->bounds.north_deg);
    json_add_text(json, "bounds_of", "sample centres");
    json_add_text(json, "datum", datum_name(dem));
    json_add_bool(json, "datum_assumed", dem->datum_assumed);
    json_add_number(json, "min_m", (double)dem->min_m);
    json_add_number(json, "max_m", (double)dem->max_m);
    json_add_integer(json, "voids", dem->voids);
    json_add_text(json, "point_or_area", cell_name(dem));
    Result result = json_print(json);
    json_destroy(&json);
    return result;
}

static void print_text(const Info *info) {
    const Dem *dem = info->dem;
    int64_t samples = (int64_t)dem->width * dem->height;
    for (int i = 0; i < dem->file_count; i++)
        printf("file      %s\n", dem->files[i]);
    printf("samples   %d x %d %s, each for a%s %s\n", dem->width, dem->height, dem->type, dem->pixel_is_area ? "n" : "",
           cell_name(dem));
    printf("crs       %s%s\n", dem->crs_name, dem->georeferenced ? "" : ", placed at 0 N 0 E");
    printf("spacing   %.2f m east, %.2f m south, at the centre\n", info->spacing_m[0], info->spacing_m[1]);
    printf("bounds    %.6f .. %.6f east, %.6f .. %.6f north, of sample centres\n", info->bounds.west_deg,
           info->bounds.east_deg, info->bounds.south_deg, info->bounds.north_deg);
    printf("heights   %.2f .. %.2f m above %s%s\n", (double)dem->min_m, (double)dem->max_m,
           dem->datum == DEM_DATUM_ELLIPSOID ? "the WGS84 ellipsoid" : "the EGM96 geoid",
           dem->datum_assumed ? " (assumed: the file does not say)" : "");
    printf("voids     %lld, %.4f %%\n", (long long)dem->voids, 100.0 * (double)dem->voids / (double)samples);
}

Result cmd_info(const Options *options) {
    Info info = {0};
    Dem *dem = NULL;
    DemOptions dem_options = scene_dem_options(options, NULL);
    if (options_positional_count(options) == 0) {
        log_error("info: expected an elevation file, several adjacent ones, or a folder of them");
        return RESULT_USAGE;
    }
    Result result = dem_load(&dem_options, options_positionals(options), options_positional_count(options), &dem);
    if (result != RESULT_OK)
        return result;
    info.dem = dem;
    result = dem_bounds(dem, &info.bounds);
    if (result == RESULT_OK)
        result = dem_spacing_m(dem, info.spacing_m);
    if (result == RESULT_OK && options_flag(options, OPTION_JSON))
        result = print_json(&info);
    else if (result == RESULT_OK)
        print_text(&info);
    dem_destroy(&dem);
    return result;
}
