#define _POSIX_C_SOURCE 200809L
#include "terrain/dem/dem.h"

#include "base/log.h"
#include "terrain/dem/dem_mosaic.h"
#include "terrain/dem/dem_source.h"
#include "terrain/dem/dem_voids.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

// ---- Which files ------------------------------------------------------------------------------------------------

typedef struct PathList {
    char **path;
    size_t count, capacity;
} PathList;

static void paths_free(PathList *list) {
    for (size_t i = 0; i < list->count; i++)
        free(list->path[i]);
    free(list->path);
    *list = (PathList){0};
}

// Takes `path` over, also when it is NULL or there is no memory.
static Result paths_add(PathList *list, char *path) {
    if (path && list->count == list->capacity) {
        size_t capacity = list->capacity ? 2 * list->capacity : 16;
        char **grown = realloc(list->path, capacity * sizeof *grown);
        if (grown) {
            list->path = grown;
            list->capacity = capacity;
        }
    }
    if (!path || list->count == list->capacity) {
        free(path);
        log_error("no memory for the names of %zu files", list->count + 1);
        return RESULT_MEMORY;
    }
    list->path[list->count++] = path;
    return RESULT_OK;
}

static char *join(const char *folder, const char *name) {
    size_t length = strlen(folder) + strlen(name) + 2;
    char *path = malloc(length);
    if (path)
        snprintf(path, length, "%s/%s", folder, name);
    return path;
}

static bool is_elevation_name(const char *name) {
    static const char *const ENDINGS[] = {".tif", ".tiff", ".hgt", ".hgt.zip", ".hgt.gz", ".zip"};
    for (size_t i = 0; i < COUNT_OF(ENDINGS); i++)
        if (name[0] != '.' && dem_name_ends(name, ENDINGS[i]))
            return true;
    return false;
}

static int compare_paths(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

// The elevation files of a folder, in the order of their names, so that the result does not depend on the disk.
static Result paths_add_folder(PathList *list, const char *folder) {
    DIR *directory = opendir(folder);
    if (!directory) {
        log_error("%s: %s", folder, strerror(errno));
        return RESULT_IO;
    }
    size_t first = list->count;
    Result result = RESULT_OK;
    for (struct dirent *entry = readdir(directory); entry && result == RESULT_OK; entry = readdir(directory))
        if (is_elevation_name(entry->d_name))
            result = paths_add(list, join(folder, entry->d_name));
    closedir(directory);
    if (result == RESULT_OK && list->count == first) {
        log_error("%s: no elevation in this folder; expected .hgt (also in .zip or .gz) or .tif files", folder);
        result = RESULT_NOT_FOUND;
    }
    if (list->count > first)
        qsort(list->path + first, list->count - first, sizeof *list->path, compare_paths);
    return result;
}

static Result paths_collect(const char *const *paths, int count, PathList *out) {
    Result result = RESULT_OK;
    for (int i = 0; i < count && result == RESULT_OK; i++) {
        struct stat status;
        bool folder = stat(paths[i], &status) == 0 && S_ISDIR(status.st_mode);
        result = folder ? paths_add_folder(out, paths[i]) : paths_add(out, strdup(paths[i]));
    }
    return result;
}

// ---- Reading ----------------------------------------------------------------------------------------------------

static Result check_size(const DemSource *source) {
    const DemHeader *header = &source->header;
    if (header->width >= 2 && header->height >= 2 && header->width <= DEM_SIDE_MAX && header->height <= DEM_SIDE_MAX)
        return RESULT_OK;
    log_error("%s: %d x %d samples; a surface needs 2 to %d a side", source->path, header->width, header->height,
              DEM_SIDE_MAX);
    return RESULT_RANGE;
}

static Result open_source(const DemOptions *options, const char *path, DemSource *out) {
    Result result = dem_source_open(options, path, out);
    if (result == RESULT_OK)
        result = check_size(out);
    if (result == RESULT_OK)
        result = dem_source_check_georef(path, &out->header);
    if (result == RESULT_OK && options->datum_given) {
        out->header.datum = options->datum;
        out->header.datum_assumed = false;
    }
    return result;
}

static Result create_dem(const DemHeader *header, const char *file, Dem **out) {
    size_t count = (size_t)header->width * (size_t)header->height;
    Dem *dem = calloc(1, sizeof *dem);
    if (dem) {
        *dem = (Dem){.width = header->width,
                     .height = header->height,
                     .georef = header->georef,
                     .datum = header->datum,
                     .datum_assumed = header->datum_assumed,
                     .pixel_is_area = header->pixel_is_area,
                     .georeferenced = header->georeferenced};
        memcpy(dem->type, header->type, sizeof dem->type);
        memcpy(dem->crs_name, header->crs_name, sizeof dem->crs_name);
        dem->file = strdup(file);
        dem->height_m = malloc(count * sizeof *dem->height_m);
    }
    if (!dem || !dem->file || !dem->height_m) {
        log_error("%s: no memory for %d x %d samples; cut a part out: gdal_translate -srcwin COL ROW WIDTH HEIGHT",
                  file, header->width, header->height);
        dem_destroy(&dem);
        return RESULT_MEMORY;
    }
    for (size_t i = 0; i < count; i++)
        dem->height_m[i] = NAN;
    *out = dem;
    return RESULT_OK;
}

static Result read_sources(const DemSource *sources, const DemPlace *places, int count, Dem *dem) {
    Result result = RESULT_OK;
    for (int i = 0; i < count && result == RESULT_OK; i++) {
        size_t offset = (size_t)places[i].row * (size_t)dem->width + (size_t)places[i].col;
        DemTarget target = {.height_m = dem->height_m + offset, .stride = (size_t)dem->width};
        result = sources[i].read(&sources[i], &target);
    }
    return result;
}

static void set_range(Dem *dem) {
    size_t count = (size_t)dem->width * (size_t)dem->height;
    float low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        low = isless(dem->height_m[i], low) ? dem->height_m[i] : low; // voids are neither
        high = isgreater(dem->height_m[i], high) ? dem->height_m[i] : high;
    }
    dem->min_m = low;
    dem->max_m = high;
}

static Result check_voids(const DemOptions *options, const Dem *dem) {
    int64_t count = (int64_t)dem->width * dem->height;
    if (dem->voids == count) {
        log_error("%s: all %lld samples are voids; there is nothing to fly over", dem->file, (long long)count);
        return RESULT_RANGE;
    }
    if (dem->voids > 0 && options->voids == DEM_VOIDS_ERROR) {
        log_error(
            "%s: %lld of %lld samples are voids; fill them with --voids fill, or leave them out with --voids hole",
            dem->file, (long long)dem->voids, (long long)count);
        return RESULT_RANGE;
    }
    return RESULT_OK;
}

static Result settle_voids(const DemOptions *options, Dem *dem) {
    size_t count = (size_t)dem->width * (size_t)dem->height;
    uint8_t *bits = malloc(dem_voids_bytes(count));
    if (!bits) {
        log_error("%s: no memory to mark voids", dem->file);
        return RESULT_MEMORY;
    }
    dem->voids = dem_voids_mark(dem->height_m, count, bits);
    Result result = check_voids(options, dem);
    if (result == RESULT_OK && dem->voids > 0) {
        result = dem_voids_fill(dem->height_m, dem->width, dem->height, bits);
        if (result != RESULT_OK)
            log_error("%s: no memory to fill %lld voids; fill them in the file: gdal_fillnodata.py", dem->file,
                      (long long)dem->voids);
    }
    if (result == RESULT_OK && dem->voids > 0 && options->voids == DEM_VOIDS_HOLE)
        dem->void_bits = bits;
    else
        free(bits);
    return result;
}

// The list is the Dem's from now on. After the last use of the sources, which borrow their paths from it.
static void give_files(PathList *list, Dem *dem) {
    dem->files = list->path;
    dem->file_count = (int)list->count;
    *list = (PathList){0};
}

// `sources` and `places` have room for `count`; the Dem shows `name`.
static Result load(const DemOptions *options, PathList *list, const char *name, DemSource *sources, DemPlace *places,
                   Dem **out) {
    DemHeader header;
    Dem *dem = NULL;
    Result result = RESULT_OK;
    int count = (int)list->count;
    for (int i = 0; i < count && result == RESULT_OK; i++)
        result = open_source(options, list->path[i], &sources[i]);
    if (result == RESULT_OK)
        result = dem_mosaic_layout(sources, count, &header, places);
    if (result == RESULT_OK)
        result = create_dem(&header, name, &dem);
    if (result == RESULT_OK)
        result = read_sources(sources, places, count, dem);
    if (result == RESULT_OK) {
        set_range(dem);
        result = settle_voids(options, dem);
    }
    if (result == RESULT_OK) {
        give_files(list, dem);
        *out = dem;
    } else {
        dem_destroy(&dem);
    }
    return result;
}

Result dem_load(const DemOptions *options, const char *const *paths, int path_count, Dem **out) {
    PathList list = {0};
    DemSource *sources = NULL;
    DemPlace *places = NULL;
    if (path_count < 1) {
        log_error("no elevation file given; give a GeoTIFF, .hgt or PNG file, or a folder");
        return RESULT_USAGE;
    }
    Result result = paths_collect(paths, path_count, &list);
    if (result != RESULT_OK)
        goto done;
    sources = calloc(list.count, sizeof *sources);
    places = calloc(list.count, sizeof *places);
    if (!sources || !places) {
        log_error("no memory to open %zu files", list.count);
        result = RESULT_MEMORY;
        goto done;
    }
    result = load(options, &list, paths[0], sources, places, out);
done:
    free(places);
    free(sources);
    paths_free(&list);
    return result;
}
