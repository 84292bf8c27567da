#include "render/ground_surface.h"

#include "base/log.h"

#include <stdlib.h>
#include <string.h>

#define ROWS_A_PIECE 32
#define LEVEL_M 0.01f // neighbours closer than that are level: less than any file's step, more than the geoid's slope

// Means of 2^level x 2^level cells, level 1 up, in the unit of GroundSurface.heights.
#define PYRAMID_LEVELS 7
typedef struct Pyramid {
    uint16_t *levels[PYRAMID_LEVELS];
    int width[PYRAMID_LEVELS], height[PYRAMID_LEVELS];
} Pyramid;

typedef struct Build {
    const GroundSource *source;
    GroundSurface *surface;
    float *rows; // [workers][3][width]
    Pyramid pyramid;
    int level; // of the pyramid, being made
} Build;

static size_t cell_index(const GroundSurface *surface, int col, int row) {
    return (size_t)row * (size_t)surface->width + (size_t)col;
}

// --- slopes, heights and level cells, from three rows at a time

static uint8_t byte_from_signed(float value) {
    return (uint8_t)lrintf(128.0f + 127.0f * fminf(fmaxf(value, -1.0f), 1.0f));
}

static void put_normal(uint8_t *cell, const GroundJacobian *j, float per_col, float per_row) {
    float inverse = 1.0f / (j->east_col * j->north_row - j->east_row * j->north_col);
    float to_east = (per_col * j->north_row - per_row * j->north_col) * inverse;
    float to_north = (per_row * j->east_col - per_col * j->east_row) * inverse;
    float length = 1.0f / sqrtf(1.0f + to_east * to_east + to_north * to_north);
    cell[0] = byte_from_signed(-to_east * length);
    cell[1] = byte_from_signed(-to_north * length);
}

static bool is_level(const float *const rows[3], int left, int col, int right) {
    float h = rows[1][col], worst = 0.0f;
    for (int i = 0; i < 3; i++) {
        worst = fmaxf(worst, fabsf(rows[i][left] - h));
        worst = fmaxf(worst, fabsf(rows[i][col] - h));
        worst = fmaxf(worst, fabsf(rows[i][right] - h));
    }
    return worst < LEVEL_M;
}

static void build_row(const Build *build, int row, const float *const rows[3]) {
    GroundSurface *surface = build->surface;
    const GroundSource *source = build->source;
    float scale = 65535.0f / fmaxf(source->max_m - source->min_m, 1.0f);
    int down = (row > 0) + (row < surface->height - 1); // rows between the outer two
    for (int col = 0; col < surface->width; col++) {
        int left = col > 0 ? col - 1 : 0, right = col < surface->width - 1 ? col + 1 : col;
        uint8_t *cell = surface->cells + cell_index(surface, col, row) * 4;
        GroundJacobian jacobian = ground_source_jacobian(source, col, row);
        put_normal(cell, &jacobian, (rows[1][right] - rows[1][left]) / (float)(right - left),
                   (rows[2][col] - rows[0][col]) / (float)down);
        cell[3] = is_level(rows, left, col, right);
        float height = (rows[1][col] - source->min_m) * scale;
        surface->heights[cell_index(surface, col, row)] = (uint16_t)lrintf(fminf(fmaxf(height, 0.0f), 65535.0f));
    }
}

static void build_rows(void *user, int64_t begin, int64_t end, int worker) {
    const Build *build = user;
    size_t width = (size_t)build->surface->width;
    float *scratch = build->rows + (size_t)worker * 3 * width;
    float *rows[3] = {scratch, scratch + width, scratch + 2 * width};
    ground_source_row(build->source, (int)begin - 1, rows[0]);
    ground_source_row(build->source, (int)begin, rows[1]);
    for (int row = (int)begin; row < (int)end; row++) {
        ground_source_row(build->source, row + 1, rows[2]);
        build_row(build, row, (const float *const *)rows);
        float *oldest = rows[0];
        rows[0] = rows[1];
        rows[1] = rows[2];
        rows[2] = oldest;
    }
}

// --- open sky: how far a cell lies below the mean of its surroundings, near and far

static void reduce_rows(void *user, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const Build *build = user;
    const Pyramid *pyramid = &build->pyramid;
    int level = build->level;
    const uint16_t *from = level ? pyramid->levels[level - 1] : build->surface->heights;
    int from_width = level ? pyramid->width[level - 1] : build->surface->width;
    int from_height = level ? pyramid->height[level - 1] : build->surface->height;
    for (int64_t y = begin; y < end; y++) {
        int64_t below = 2 * y + 1 < from_height ? 2 * y + 1 : 2 * y;
        const uint16_t *upper = from + 2 * y * from_width, *lower = from + below * from_width;
        uint16_t *out = pyramid->levels[level] + y * pyramid->width[level];
        for (int x = 0; x < pyramid->width[level]; x++) {
            int a = 2 * x, b = 2 * x + 1 < from_width ? 2 * x + 1 : 2 * x;
            out[x] = (uint16_t)((upper[a] + upper[b] + lower[a] + lower[b] + 2) / 4);
        }
    }
}

static Result build_pyramid(Build *build, Jobs *jobs) {
    Pyramid *pyramid = &build->pyramid;
    int width = build->surface->width, height = build->surface->height;
    for (int level = 0; level < PYRAMID_LEVELS; level++) {
        width = (width + 1) / 2;
        height = (height + 1) / 2;
        pyramid->width[level] = width;
        pyramid->height[level] = height;
        pyramid->levels[level] = malloc((size_t)width * (size_t)height * sizeof(uint16_t));
        if (!pyramid->levels[level])
            return RESULT_MEMORY;
        build->level = level;
        jobs_run(jobs, height, ROWS_A_PIECE, reduce_rows, build);
    }
    return RESULT_OK;
}

static int clamp_int(int value, int low, int high) {
    return value < low ? low : value > high ? high : value;
}

// Bilinear between the centres of a level's cells.
static float pyramid_sample(const Pyramid *pyramid, int level, float col, float row) {
    int width = pyramid->width[level], height = pyramid->height[level];
    float scale = 1.0f / (float)(2 << level), x = (col + 0.5f) * scale - 0.5f, y = (row + 0.5f) * scale - 0.5f;
    int x0 = (int)floorf(x), y0 = (int)floorf(y);
    float fx = x - (float)x0, fy = y - (float)y0;
    int xa = clamp_int(x0, 0, width - 1), xb = clamp_int(x0 + 1, 0, width - 1);
    const uint16_t *upper = pyramid->levels[level] + (size_t)clamp_int(y0, 0, height - 1) * (size_t)width;
    const uint16_t *lower = pyramid->levels[level] + (size_t)clamp_int(y0 + 1, 0, height - 1) * (size_t)width;
    float high = (float)upper[xa] + ((float)upper[xb] - (float)upper[xa]) * fx;
    float low = (float)lower[xa] + ((float)lower[xb] - (float)lower[xa]) * fx;
    return high + (low - high) * fy;
}

#define SKY_LEVEL 0.72f // open sky of a plain, leaving room for ridges to be brighter
#define SKY_GAIN 0.85f

static void open_sky_rows(void *user, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const Build *build = user;
    const GroundSource *source = build->source;
    GroundSurface *surface = build->surface;
    float metres = (source->max_m - source->min_m) / 65535.0f;
    for (int row = (int)begin; row < (int)end; row++) {
        for (int col = 0; col < surface->width; col++) {
            GroundJacobian j = ground_source_jacobian(source, col, row);
            size_t index = cell_index(surface, col, row);
            float cell_m = sqrtf(fabsf(j.east_col * j.north_row)), hollow = 0.0f;
            for (int level = 1; level < PYRAMID_LEVELS; level++) {
                float mean = pyramid_sample(&build->pyramid, level, (float)col, (float)row);
                hollow += (mean - (float)surface->heights[index]) * metres / (cell_m * (float)(2 << level));
            }
            float sky = fminf(fmaxf(SKY_LEVEL - SKY_GAIN * hollow, 0.15f), 1.0f);
            surface->cells[index * 4 + 2] = (uint8_t)lrintf(255.0f * sky);
        }
    }
}

// --- the rim of the data

static void add_border_cell(GroundSurface *surface, const GroundSource *source, int col, int row, double *count) {
    size_t index = cell_index(surface, col, row);
    float share = (float)surface->heights[index] / 65535.0f;
    surface->border_m += source->min_m + (source->max_m - source->min_m) * share;
    surface->border_water += surface->cells[index * 4 + 3] ? 1.0f : 0.0f;
    *count += 1.0;
}

static void measure_border(GroundSurface *surface, const GroundSource *source) {
    double count = 0.0;
    for (int col = 0; col < surface->width; col++) {
        add_border_cell(surface, source, col, 0, &count);
        add_border_cell(surface, source, col, surface->height - 1, &count);
    }
    for (int row = 0; row < surface->height; row++) {
        add_border_cell(surface, source, 0, row, &count);
        add_border_cell(surface, source, surface->width - 1, row, &count);
    }
    surface->border_m /= (float)count;
    surface->border_water /= (float)count;
}

static Result build_all(Build *build, Jobs *jobs) {
    GroundSurface *surface = build->surface;
    jobs_run(jobs, surface->height, ROWS_A_PIECE, build_rows, build);
    Result result = build_pyramid(build, jobs);
    if (result != RESULT_OK) {
        log_error("out of memory for the picture of the ground");
        return result;
    }
    jobs_run(jobs, surface->height, ROWS_A_PIECE, open_sky_rows, build);
    if ((result = ground_water_find(build->source, surface)) != RESULT_OK)
        return result;
    measure_border(surface, build->source);
    return ground_water_count(surface);
}

Result ground_surface_create(const GroundSource *source, Jobs *jobs, GroundSurface *out) {
    size_t cells = (size_t)source->width * (size_t)source->height;
    GroundSurface surface = {.width = source->width, .height = source->height};
    Build build = {.source = source, .surface = &surface};
    Result result = RESULT_MEMORY;
    surface.cells = malloc(cells * 4);
    surface.heights = malloc(cells * sizeof *surface.heights);
    build.rows = malloc((size_t)jobs_worker_count(jobs) * 3 * (size_t)source->width * sizeof *build.rows);
    if (surface.cells && surface.heights && build.rows)
        result = build_all(&build, jobs);
    else
        log_error("out of memory for the picture of the ground, %zu MiB", cells * 6 >> 20);
    free(build.rows);
    for (int level = 0; level < PYRAMID_LEVELS; level++)
        free(build.pyramid.levels[level]);
    if (result != RESULT_OK)
        ground_surface_destroy(&surface);
    *out = surface;
    return result;
}

void ground_surface_destroy(GroundSurface *surface) {
    free(surface->cells);
    free(surface->heights);
    free(surface->wet_blocks);
    *surface = (GroundSurface){0};
}
