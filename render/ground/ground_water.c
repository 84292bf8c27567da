#include "render/ground/ground_surface.h"

#include "base/log.h"

#include <stdlib.h>
#include <string.h>

#define LAKE_CELLS_MIN 24 // with their rims some 8 x 8 cells: noise makes no such plane
#define SEA_CELLS_MIN 4
#define SEA_LEVEL_M 0.6f // above or below the geoid
#define RIM 0x80         // a cell of a region that is water, or one beside it

// A run of level cells in one row; regions are trees of runs, with the totals at the root.
typedef struct Run {
    int32_t row, begin, end; // cells begin .. end - 1
    int32_t parent;
    int64_t cells;
} Run;

typedef struct Runs {
    Run *items;
    int32_t count, capacity;
} Runs;

static int32_t find_root(Runs *runs, int32_t index) {
    while (runs->items[index].parent != index) {
        int32_t parent = runs->items[index].parent;
        runs->items[index].parent = runs->items[parent].parent; // halves the path
        index = parent;
    }
    return index;
}

static void join(Runs *runs, int32_t a, int32_t b) {
    a = find_root(runs, a);
    b = find_root(runs, b);
    if (a == b)
        return;
    runs->items[b].parent = a;
    runs->items[a].cells += runs->items[b].cells;
}

static bool push_run(Runs *runs, int row, int begin, int end) {
    if (runs->count == runs->capacity) {
        int32_t capacity = runs->capacity ? runs->capacity * 2 : 4096;
        Run *grown = realloc(runs->items, (size_t)capacity * sizeof *grown);
        if (!grown)
            return false;
        runs->items = grown;
        runs->capacity = capacity;
    }
    runs->items[runs->count] =
        (Run){.row = row, .begin = begin, .end = end, .parent = runs->count, .cells = end - begin};
    runs->count++;
    return true;
}

static bool find_runs(Runs *runs, const uint8_t *row_cells, int width, int row) {
    for (int col = 0; col < width;) {
        int begin = col;
        while (col < width && row_cells[(size_t)col * 4 + 3] == 1)
            col++;
        if (col > begin && !push_run(runs, row, begin, col))
            return false;
        if (col == begin)
            col++;
    }
    return true;
}

// Joins the runs of two neighbouring rows, [upper, lower) and [lower, end), where they touch.
static void join_rows(Runs *runs, int32_t upper, int32_t lower, int32_t end) {
    for (int32_t a = upper, b = lower; a < lower && b < end;) {
        if (runs->items[a].begin < runs->items[b].end && runs->items[b].begin < runs->items[a].end)
            join(runs, a, b);
        if (runs->items[a].end < runs->items[b].end)
            a++;
        else
            b++;
    }
}

static bool find_regions(Runs *runs, const GroundSurface *surface) {
    int32_t upper = 0;
    for (int row = 0; row < surface->height; row++) {
        int32_t lower = runs->count;
        const uint8_t *row_cells = surface->cells + (size_t)row * (size_t)surface->width * 4;
        if (!find_runs(runs, row_cells, surface->width, row))
            return false;
        join_rows(runs, upper, lower, runs->count);
        upper = lower;
    }
    return true;
}

static bool is_water(const GroundSource *source, const GroundSurface *surface, const Run *run, int64_t cells) {
    size_t index = (size_t)run->row * (size_t)surface->width + (size_t)run->begin;
    float share = (float)surface->heights[index] / 65535.0f;
    float h_m = source->min_m + (source->max_m - source->min_m) * share;
    return cells >= LAKE_CELLS_MIN || (cells >= SEA_CELLS_MIN && fabsf(h_m) < SEA_LEVEL_M);
}

// A level cell is as high as all its neighbours, so that its water reaches over them.
static void mark_with_rim(GroundSurface *surface, const Run *run) {
    int begin = run->begin > 0 ? run->begin - 1 : 0;
    int end = run->end < surface->width ? run->end + 1 : run->end;
    for (int row = run->row - 1; row <= run->row + 1; row++)
        for (int col = begin; col < end && row >= 0 && row < surface->height; col++)
            surface->cells[((size_t)row * (size_t)surface->width + (size_t)col) * 4 + 3] |= RIM;
}

static void settle(GroundSurface *surface) {
    size_t count = (size_t)surface->width * (size_t)surface->height;
    for (size_t i = 0; i < count; i++)
        surface->cells[i * 4 + 3] = surface->cells[i * 4 + 3] & RIM ? 255 : 0;
}

Result ground_water_find(const GroundSource *source, GroundSurface *surface) {
    Runs runs = {0};
    if (!find_regions(&runs, surface)) {
        log_error("out of memory while looking for lakes");
        free(runs.items);
        return RESULT_MEMORY;
    }
    for (int32_t i = 0; i < runs.count; i++)
        if (is_water(source, surface, &runs.items[i], runs.items[find_root(&runs, i)].cells))
            mark_with_rim(surface, &runs.items[i]);
    settle(surface);
    free(runs.items);
    return RESULT_OK;
}

static bool block_is_wet(const GroundSurface *surface, int block_x, int block_y) {
    int x_end = (block_x + 1) * GROUND_BLOCK < surface->width ? (block_x + 1) * GROUND_BLOCK : surface->width;
    int y_end = (block_y + 1) * GROUND_BLOCK < surface->height ? (block_y + 1) * GROUND_BLOCK : surface->height;
    for (int y = block_y * GROUND_BLOCK; y < y_end; y++)
        for (int x = block_x * GROUND_BLOCK; x < x_end; x++)
            if (surface->cells[((size_t)y * (size_t)surface->width + (size_t)x) * 4 + 3])
                return true;
    return false;
}

Result ground_water_count(GroundSurface *surface) {
    int width = surface->width / GROUND_BLOCK + 2, height = surface->height / GROUND_BLOCK + 2;
    surface->wet_width = width;
    surface->wet_blocks = calloc((size_t)width * (size_t)height, sizeof *surface->wet_blocks);
    if (!surface->wet_blocks) {
        log_error("out of memory for the table of waters");
        return RESULT_MEMORY;
    }
    for (int y = 1; y < height; y++) {
        uint32_t *row = surface->wet_blocks + (size_t)y * (size_t)width, *above = row - width;
        for (int x = 1; x < width; x++)
            row[x] = row[x - 1] + above[x] - above[x - 1] + block_is_wet(surface, x - 1, y - 1);
    }
    return RESULT_OK;
}
