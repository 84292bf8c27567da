#include "render/ground/ground_surface.h"

#include "base/log.h"

#include <stdlib.h>
#include <string.h>

#define ROWS_A_PIECE 32
#define LEVEL_M 0.01f // neighbours closer than that are level: less than any file's step, more than the geoid's slope

// Means of (2 << level) x (2 << level) cells, metres above the source's lowest point; then, coarsest first, each
// level's sum of its own and all coarser means, weighted.
#define PYRAMID_LEVELS 7
typedef struct Pyramid {
    float *levels[PYRAMID_LEVELS];
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

static float metres_a_step(const GroundSource *source) { // of GroundSurface.heights
    return fmaxf(source->max_m - source->min_m, 1.0f) / 65535.0f;
}

// --- slopes, heights and level cells, from three rows at a time

static uint8_t byte_from_signed(float value) { // -1 .. 1
    return (uint8_t)(128.5f + 127.0f * value);
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
    float h = rows[1][col];
    for (int i = 0; i < 3; i++)
        if (fabsf(rows[i][left] - h) > LEVEL_M || fabsf(rows[i][col] - h) > LEVEL_M ||
            fabsf(rows[i][right] - h) > LEVEL_M)
            return false;
    return true;
}

static void build_row(const Build *build, int row, const float *const rows[3]) {
    GroundSurface *surface = build->surface;
    const GroundSource *source = build->source;
    float scale = 1.0f / metres_a_step(source);
    int down = (row > 0) + (row < surface->height - 1); // rows between the outer two
    for (int col = 0; col < surface->width; col++) {
        int left = col > 0 ? col - 1 : 0, right = col < surface->width - 1 ? col + 1 : col;
        uint8_t *cell = surface->cells + cell_index(surface, col, row) * 4;
        GroundJacobian jacobian = ground_source_jacobian(source, col, row);
        put_normal(cell, &jacobian, (rows[1][right] - rows[1][left]) / (float)(right - left),
                   (rows[2][col] - rows[0][col]) / (float)down);
        cell[3] = is_level(rows, left, col, right);
        float height = (rows[1][col] - source->min_m) * scale;
        height = height < 0.0f ? 0.0f : height > 65535.0f ? 65535.0f : height;
        surface->heights[cell_index(surface, col, row)] = (uint16_t)(height + 0.5f);
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

// Two rows of heights to one row of means.
static void reduce_first(const Build *build, int64_t y) {
    const GroundSurface *surface = build->surface;
    int64_t below = 2 * y + 1 < surface->height ? 2 * y + 1 : 2 * y;
    const uint16_t *upper = surface->heights + 2 * y * surface->width,
                   *lower = surface->heights + below * surface->width;
    float *out = build->pyramid.levels[0] + y * build->pyramid.width[0], metres = 0.25f * metres_a_step(build->source);
    for (int x = 0; x < surface->width / 2; x++)
        out[x] = metres * (float)(upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1]);
    if (surface->width & 1)
        out[surface->width / 2] = metres * (float)(2 * (upper[surface->width - 1] + lower[surface->width - 1]));
}

static void reduce_next(const Build *build, int64_t y) {
    const Pyramid *pyramid = &build->pyramid;
    int level = build->level, width = pyramid->width[level - 1];
    int64_t below = 2 * y + 1 < pyramid->height[level - 1] ? 2 * y + 1 : 2 * y;
    const float *upper = pyramid->levels[level - 1] + 2 * y * width,
                *lower = pyramid->levels[level - 1] + below * width;
    float *out = pyramid->levels[level] + y * pyramid->width[level];
    for (int x = 0; x < width / 2; x++)
        out[x] = 0.25f * (upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1]);
    if (width & 1)
        out[width / 2] = 0.5f * (upper[width - 1] + lower[width - 1]);
}

static void reduce_rows(void *user, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const Build *build = user;
    for (int64_t y = begin; y < end; y++) {
        if (build->level == 0)
            reduce_first(build, y);
        else
            reduce_next(build, y);
    }
}

static int clamp_int(int value, int low, int high) {
    return value < low ? low : value > high ? high : value;
}

// A level at a place of the next finer grid: bilinear between the centres of its cells, so 3/4 the own and 1/4 the
// neighbour's in each direction.
static float sample_finer(const float *own, const float *beside, int width, int x) {
    int near = x / 2, far = clamp_int(x & 1 ? near + 1 : near - 1, 0, width - 1);
    return 0.75f * (0.75f * own[near] + 0.25f * own[far]) + 0.25f * (0.75f * beside[near] + 0.25f * beside[far]);
}

// The rows of level `level` that sample_finer needs for row y of the next finer grid.
static const float *level_row(const Pyramid *pyramid, int level, int64_t y, bool beside) {
    int near = (int)(y / 2), row = beside ? (y & 1 ? near + 1 : near - 1) : near;
    return pyramid->levels[level] +
           (size_t)clamp_int(row, 0, pyramid->height[level] - 1) * (size_t)pyramid->width[level];
}

static float level_weight(int level) { // a hollow counts by its depth over its width
    return 1.0f / (float)(2 << level);
}

static void sum_rows(void *user, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const Build *build = user;
    const Pyramid *pyramid = &build->pyramid;
    int level = build->level, width = pyramid->width[level];
    for (int64_t y = begin; y < end; y++) {
        const float *own = level_row(pyramid, level + 1, y, false), *beside = level_row(pyramid, level + 1, y, true);
        float *out = pyramid->levels[level] + y * width;
        for (int x = 0; x < width; x++)
            out[x] = level_weight(level) * out[x] + sample_finer(own, beside, pyramid->width[level + 1], x);
    }
}

static Result build_pyramid(Build *build, Jobs *jobs) {
    Pyramid *pyramid = &build->pyramid;
    int width = build->surface->width, height = build->surface->height;
    for (build->level = 0; build->level < PYRAMID_LEVELS; build->level++) {
        int level = build->level;
        pyramid->width[level] = width = (width + 1) / 2;
        pyramid->height[level] = height = (height + 1) / 2;
        pyramid->levels[level] = malloc((size_t)width * (size_t)height * sizeof(float));
        if (!pyramid->levels[level])
            return RESULT_MEMORY;
        jobs_run(jobs, height, ROWS_A_PIECE, reduce_rows, build);
    }
    int coarsest = PYRAMID_LEVELS - 1;
    for (int i = 0; i < pyramid->width[coarsest] * pyramid->height[coarsest]; i++)
        pyramid->levels[coarsest][i] *= level_weight(coarsest);
    for (build->level = coarsest - 1; build->level >= 0; build->level--)
        jobs_run(jobs, pyramid->height[build->level], ROWS_A_PIECE, sum_rows, build);
    return RESULT_OK;
}

#define SKY_LEVEL 0.72f // open sky of a plain, leaving room for ridges to be brighter
#define SKY_GAIN 0.85f
#define SKY_MIN 0.15f

static void open_sky_rows(void *user, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const Build *build = user;
    const Pyramid *pyramid = &build->pyramid;
    GroundSurface *surface = build->surface;
    float metres = metres_a_step(build->source), weights = 0.0f;
    for (int level = 0; level < PYRAMID_LEVELS; level++)
        weights += level_weight(level);
    for (int64_t y = begin; y < end; y++) {
        const float *own = level_row(pyramid, 0, y, false), *beside = level_row(pyramid, 0, y, true);
        GroundJacobian j = ground_source_jacobian(build->source, surface->width / 2, (int)y);
        float gain = SKY_GAIN / sqrtf(fabsf(j.east_col * j.north_row));
        for (int x = 0; x < surface->width; x++) {
            size_t index = cell_index(surface, x, (int)y);
            float h_m = metres * (float)surface->heights[index];
            float sky = SKY_LEVEL - gain * (sample_finer(own, beside, pyramid->width[0], x) - weights * h_m);
            sky = sky < SKY_MIN ? SKY_MIN : sky > 1.0f ? 1.0f : sky;
            surface->cells[index * 4 + 2] = (uint8_t)(255.0f * sky + 0.5f);
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
