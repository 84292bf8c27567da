#include "terrain/terrain.h"

#include "base/log.h"
#include "terrain/terrain_parts.h"

#include <math.h>
#include <stdlib.h>

// Between samples of the undulation less than this apart, a bilinear interpolant stays within a millimetre of
// EGM96 on its 15' grid.
#define UNDULATION_STRIDE_M 1000.0

TerrainOptions terrain_default_options(void) {
    return (TerrainOptions){.error = TERRAIN_ERROR_TOTAL, .patch_level = 12};
}

typedef struct Lift {
    Dem *dem;
    const Grid *grid;
    const Geoid *geoid;
    int stride;  // samples
    double sign; // +1 to the ellipsoid, -1 back
} Lift;

static double undulation_at(const Lift *lift, int col, int row) {
    double lat, lon;
    grid_geodetic(lift->grid, col, row, &lat, &lon);
    return geoid_undulation_m(lift->geoid, lat, lon);
}

static void lift_row(const Lift *lift, int row) {
    int width = lift->dem->width, stride = lift->stride;
    float *h = lift->dem->height_m + (size_t)row * (size_t)width;
    double next = undulation_at(lift, 0, row);
    for (int col = 0; col < width; col += stride) {
        double here = next;
        next = undulation_at(lift, col + stride, row);
        double slope = (next - here) / stride;
        for (int i = 0; i < stride && col + i < width; i++)
            h[col + i] = (float)((double)h[col + i] + lift->sign * (here + slope * i));
    }
}

static void lift_task(void *user, int64_t begin, int64_t end, int worker) {
    (void)worker;
    for (int64_t row = begin; row < end; row++)
        lift_row(user, (int)row);
}

// Heights above the geoid become heights above the ellipsoid, or back.
static void lift_heights(Terrain *terrain, double sign, Jobs *jobs) {
    GridBounds bounds = grid_bounds(terrain->grid, 0, terrain->dem->height - 1, 0.0);
    int stride = (int)fmin(64.0, fmax(1.0, UNDULATION_STRIDE_M / bounds.across_m));
    Lift lift = {terrain->dem, terrain->grid, terrain->geoid, stride, sign};
    jobs_run(jobs, terrain->dem->height, 16, lift_task, &lift);
}

// Pages of coarse DEMs are made shallower until their finest patches fit into 32-bit offsets on the lattice.
static int fitting_depth(const Terrain *terrain) {
    GridBounds bounds = grid_bounds(terrain->grid, 0, terrain->dem->height - 1, 0.0);
    double cell = fmax(bounds.across_m, bounds.down_m);
    int depth = terrain->options.patch_level;
    while (depth > 2 && 3.0 * (1 << depth / 2) * cell * GRID_LATTICE_PER_M > (double)INT32_MAX)
        depth -= 2;
    return depth;
}

static Result check_options(const TerrainOptions *options, const Dem *dem, const Geoid *geoid) {
    if (options->patch_level < 2 || options->patch_level > PATCH_TEMPLATE_DEPTH_MAX || options->patch_level % 2) {
        log_error("terrain: a patch of %d bisections is not possible; give an even number from 2 to %d",
                  options->patch_level, PATCH_TEMPLATE_DEPTH_MAX);
        return RESULT_RANGE;
    }
    int stride = options->error_stride;
    if (stride < 0 || stride > TERRAIN_STRIDE_MAX || (stride & (stride - 1)) != 0) {
        log_error(
            "terrain: errors cannot be exact up to a stride of %d samples; give a power of two from 1 to %d, or 0",
            stride, TERRAIN_STRIDE_MAX);
        return RESULT_RANGE;
    }
    if (dem->datum == DEM_DATUM_EGM96 && !geoid) {
        log_error("%s: heights are above EGM96, and no geoid is loaded to turn them into heights above the ellipsoid",
                  dem->file ? dem->file : "terrain");
        return RESULT_NOT_FOUND;
    }
    return RESULT_OK;
}

static Result build_levels(Terrain *terrain, Jobs *jobs) {
    Result result = forest_create(terrain->dem->width, terrain->dem->height, &terrain->forest);
    if (result != RESULT_OK)
        return result;
    ErrorFieldInput errors = {.height_m = terrain->dem->height_m,
                              .grid = terrain->grid,
                              .forest = &terrain->forest,
                              .kind = terrain->options.error,
                              .stride = terrain->options.error_stride,
                              .scheme = ERROR_SCHEME_PARALLEL,
                              .void_bits = terrain->dem->void_bits};
    result = error_field_create(&errors, jobs, &terrain->errors);
    if (result != RESULT_OK)
        return result;
    PatchForestInput patches = {.height_m = terrain->dem->height_m,
                                .grid = terrain->grid,
                                .forest = &terrain->forest,
                                .errors = &terrain->errors,
                                .depth = fitting_depth(terrain)};
    return patch_forest_create(&patches, jobs, &terrain->patches);
}

Result terrain_create(const TerrainOptions *options, Dem *dem, const Geoid *geoid, Jobs *jobs, Terrain **out) {
    Result result = check_options(options, dem, geoid);
    if (result != RESULT_OK)
        return result;
    Terrain *terrain = calloc(1, sizeof *terrain);
    if (!terrain)
        return RESULT_MEMORY;
    terrain->options = *options;
    terrain->dem = dem;
    terrain->geoid = dem->datum == DEM_DATUM_EGM96 ? geoid : NULL;
    result = grid_create(&dem->georef, dem->width, dem->height, &terrain->grid);
    if (result != RESULT_OK)
        goto fail;
    if (terrain->geoid)
        lift_heights(terrain, 1.0, jobs);
    result = build_levels(terrain, jobs);
    if (result != RESULT_OK) {
        if (terrain->geoid)
            lift_heights(terrain, -1.0, jobs); // the caller gets the Dem back as it was
        goto fail;
    }
    *out = terrain;
    return RESULT_OK;
fail:
    terrain->dem = NULL;
    terrain_destroy(&terrain);
    return result;
}

void terrain_destroy(Terrain **terrain) {
    if (!*terrain)
        return;
    patch_forest_destroy(&(*terrain)->patches);
    error_field_destroy(&(*terrain)->errors);
    forest_destroy(&(*terrain)->forest);
    grid_destroy(&(*terrain)->grid);
    dem_destroy(&(*terrain)->dem);
    free(*terrain);
    *terrain = NULL;
}

const Dem *terrain_dem(const Terrain *terrain) {
    return terrain->dem;
}

const Grid *terrain_grid(const Terrain *terrain) {
    return terrain->grid;
}

double terrain_undulation_m(const Terrain *terrain, double lat_deg, double lon_deg) {
    return terrain->geoid ? geoid_undulation_m(terrain->geoid, lat_deg, lon_deg) : 0.0;
}

bool terrain_ground_m(const Terrain *terrain, double lat_deg, double lon_deg, double *h_m) {
    const Dem *dem = terrain->dem;
    double col, row;
    if (!grid_from_geodetic(terrain->grid, lat_deg, lon_deg, &col, &row))
        return false;
    if (!(col >= 0.0 && row >= 0.0 && col <= dem->width - 1 && row <= dem->height - 1))
        return false;
    int i = (int)fmin(floor(col), dem->width - 2), j = (int)fmin(floor(row), dem->height - 2);
    double u = col - i, v = row - j;
    const float *h = dem->height_m + (size_t)j * (size_t)dem->width + (size_t)i;
    const float *below = h + dem->width;
    *h_m = (1.0 - v) * ((1.0 - u) * (double)h[0] + u * (double)h[1]) +
           v * ((1.0 - u) * (double)below[0] + u * (double)below[1]);
    return true;
}

size_t terrain_sample_bytes(const Terrain *terrain) {
    size_t samples = (size_t)terrain->dem->width * (size_t)terrain->dem->height;
    return samples * sizeof(float) + terrain->errors.bytes + (terrain->dem->void_bits ? (samples + 7) / 8 : 0);
}
