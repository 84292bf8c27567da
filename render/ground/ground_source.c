#include "render/ground/ground_source.h"

#include "base/log.h"

#include <stdlib.h>

static int clamp_int(int value, int low, int high) {
    return value < low ? low : value > high ? high : value;
}

static size_t node_index(const GroundSource *source, int block_x, int block_y) {
    return (size_t)block_y * (size_t)source->blocks_x + (size_t)block_x;
}

// Differences of the grid's own map, over one sample, in the local frame.
static GroundJacobian jacobian_at(const GroundSource *source, int col, int row) {
    const Grid *grid = terrain_grid(source->terrain);
    const Dem *dem = terrain_dem(source->terrain);
    col = clamp_int(col, 0, dem->width - 2);
    row = clamp_int(row, 0, dem->height - 2);
    Vec3d here, right, below, up, unused;
    grid_base(grid, col, row, &here, &up);
    grid_base(grid, col + 1, row, &right, &unused);
    grid_base(grid, col, row + 1, &below, &unused);
    Vec3d east = vec3d_normalize(vec3d(-up.y, up.x, 0.0)), north = vec3d_cross(up, east);
    Vec3d along_col = vec3d_scale(vec3d_sub(right, here), source->step);
    Vec3d along_row = vec3d_scale(vec3d_sub(below, here), source->step);
    return (GroundJacobian){(float)vec3d_dot(along_col, east), (float)vec3d_dot(along_col, north),
                            (float)vec3d_dot(along_row, east), (float)vec3d_dot(along_row, north)};
}

static void fill_nodes(GroundSource *source) {
    const Grid *grid = terrain_grid(source->terrain);
    int block = GROUND_BLOCK * source->step; // samples
    for (int y = 0; y < source->blocks_y; y++) {
        for (int x = 0; x < source->blocks_x; x++) {
            double lat_deg = 0.0, lon_deg = 0.0;
            grid_geodetic(grid, (double)x * block, (double)y * block, &lat_deg, &lon_deg);
            lat_deg = fmin(fmax(lat_deg, -90.0), 90.0); // nodes lie beyond the last cell too
            source->undulation_m[node_index(source, x, y)] =
                (float)terrain_undulation_m(source->terrain, lat_deg, lon_deg);
            source->jacobians[node_index(source, x, y)] = jacobian_at(source, x * block, y * block);
        }
    }
}

static void find_range(GroundSource *source) {
    const Dem *dem = terrain_dem(source->terrain);
    float low = source->undulation_m[0], high = low;
    size_t count = (size_t)source->blocks_x * (size_t)source->blocks_y;
    for (size_t i = 1; i < count; i++) {
        low = fminf(low, source->undulation_m[i]);
        high = fmaxf(high, source->undulation_m[i]);
    }
    source->min_m = dem->min_m - high;
    source->max_m = dem->max_m - low;
}

Result ground_source_create(const Terrain *terrain, int side_max, GroundSource *out) {
    const Dem *dem = terrain_dem(terrain);
    GroundSource source = {.terrain = terrain, .step = 1, .width = dem->width, .height = dem->height};
    while (source.width > side_max || source.height > side_max) {
        source.step *= 2;
        source.width = (dem->width - 1) / source.step + 1;
        source.height = (dem->height - 1) / source.step + 1;
    }
    if (source.step > 1)
        log_warn(
            "the grid of %d x %d samples is larger than this driver's textures (%d): colours and normals have every "
            "%dth sample",
            dem->width, dem->height, side_max, source.step);
    source.blocks_x = (source.width - 1) / GROUND_BLOCK + 2;
    source.blocks_y = (source.height - 1) / GROUND_BLOCK + 2;
    size_t nodes = (size_t)source.blocks_x * (size_t)source.blocks_y;
    source.undulation_m = malloc(nodes * sizeof *source.undulation_m);
    source.jacobians = malloc(nodes * sizeof *source.jacobians);
    if (!source.undulation_m || !source.jacobians) {
        log_error("out of memory for the picture of the ground");
        ground_source_destroy(&source);
        return RESULT_MEMORY;
    }
    fill_nodes(&source);
    find_range(&source);
    *out = source;
    return RESULT_OK;
}

void ground_source_destroy(GroundSource *source) {
    free(source->undulation_m);
    free(source->jacobians);
    *source = (GroundSource){0};
}

// The undulation along a row, interpolated between the nodes' rows: one value a node column.
static float undulation_at(const GroundSource *source, int block_x, int row) {
    int block_y = row / GROUND_BLOCK;
    float share = (float)(row % GROUND_BLOCK) / GROUND_BLOCK;
    float above = source->undulation_m[node_index(source, block_x, block_y)];
    float below = source->undulation_m[node_index(source, block_x, block_y + 1)];
    return above + (below - above) * share;
}

void ground_source_row(const GroundSource *source, int row, float *out_m) {
    const Dem *dem = terrain_dem(source->terrain);
    row = clamp_int(row, 0, source->height - 1);
    const float *samples = dem->height_m + (size_t)row * (size_t)source->step * (size_t)dem->width;
    for (int begin = 0; begin < source->width; begin += GROUND_BLOCK) {
        int end = begin + GROUND_BLOCK < source->width ? begin + GROUND_BLOCK : source->width;
        float left = undulation_at(source, begin / GROUND_BLOCK, row);
        float slope = (undulation_at(source, begin / GROUND_BLOCK + 1, row) - left) / GROUND_BLOCK;
        for (int col = begin; col < end; col++)
            out_m[col] = samples[(size_t)col * (size_t)source->step] - (left + slope * (float)(col - begin));
    }
}
