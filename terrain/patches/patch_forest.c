#include "terrain/patches/patch_forest.h"

#include "base/log.h"

#include <stdlib.h>

PatchTriangle patch_forest_root(const ForestTile *tile, int root) {
    PatchCorner nw = {tile->col, tile->row}, se = {tile->col + tile->side, tile->row + tile->side};
    PatchCorner ne = {se.col, nw.row}, sw = {nw.col, se.row};
    if ((tile->col / tile->side + tile->row / tile->side) & 1)
        return root ? (PatchTriangle){sw, ne, se} : (PatchTriangle){ne, sw, nw};
    return root ? (PatchTriangle){se, nw, ne} : (PatchTriangle){nw, se, sw};
}

const PatchVertex *patch_forest_vertex(const PatchForest *forest, PatchCorner middle) {
    int k = __builtin_ctz((unsigned)(middle.col | middle.row));
    const PatchPlane *plane = &forest->planes[k - forest_log2(forest->side)];
    return &plane->vertices[(size_t)(middle.row >> k) * (size_t)plane->width + (size_t)(middle.col >> k)];
}

static Result create_tiles(const PatchForestInput *input, PatchForest *out) {
    out->tile_count = input->forest->tile_count;
    out->tiles = malloc(sizeof *out->tiles * (size_t)out->tile_count);
    if (!out->tiles)
        return RESULT_MEMORY;
    for (int32_t i = 0; i < out->tile_count; i++) {
        int log_side = forest_log2(input->forest->tiles[i].side);
        int half_depth = log_side < out->depth / 2 ? log_side : out->depth / 2;
        PatchTile tile = {.tile = input->forest->tiles[i], .template_index = half_depth, .first_node = out->node_count};
        tile.levels = 2 * (log_side - half_depth);
        out->node_count += 2 << (tile.levels + 1);
        out->tiles[i] = tile;
        PatchTemplate *patch = &out->templates[half_depth];
        if (!patch->position && patch_template_create(2 * half_depth, patch) != RESULT_OK)
            return RESULT_MEMORY;
    }
    return RESULT_OK;
}

static Result create_planes(const PatchForestInput *input, PatchForest *out) {
    for (int k = forest_log2(out->side); k < input->errors->plane_count; k++, out->plane_count++) {
        PatchPlane *plane = &out->planes[out->plane_count];
        const ErrorPlane *errors = &input->errors->planes[k];
        *plane = (PatchPlane){.step = errors->step, .width = errors->width, .height = errors->height};
        plane->vertices = calloc((size_t)plane->width * (size_t)plane->height, sizeof *plane->vertices);
        if (!plane->vertices)
            return RESULT_MEMORY;
    }
    return RESULT_OK;
}

typedef struct Fill {
    const PatchForestInput *input;
    PatchForest *forest;
    int plane;
} Fill;

static int clamp(int value, int least, int most) {
    return value < least ? least : value > most ? most : value;
}

ErrorCodes patch_forest_missing(const ErrorField *errors, int side, int k, int i, int j, PatchReach within) {
    const ErrorPlane *fine = &errors->planes[k];
    bool centre = i & j & 1;
    int ci = i * side, cj = j * side;
    ErrorCodes most = {0, 0};
    for (int dj = -side * within.north; dj <= side * within.south; dj++) {
        int fj = cj + dj;
        if (fj < 0 || fj >= fine->height || (centre && !(fj & 1)))
            continue;
        int reach = centre ? side : side - abs(dj);
        int first = clamp(ci - reach * within.west, 0, fine->width - 1);
        int last = clamp(ci + reach * within.east, 0, fine->width - 1);
        first +=
            centre || !(fj & 1) ? !(first & 1) : first & 1; // columns of the same kind are odd, or even on odd rows
        size_t row = (size_t)fj * fine->stride;
        for (int fi = first; fi <= last; fi += 2) {
            uint16_t delta = fine->delta[row + (size_t)fi], radius = fine->radius[row + (size_t)fi];
            most.delta = delta > most.delta ? delta : most.delta;
            most.radius = radius > most.radius ? radius : most.radius;
        }
    }
    return most;
}

static float child_delta(const PatchPlane *plane, int i, int j) {
    if (i < 0 || j < 0 || i >= plane->width || j >= plane->height)
        return 0.0f;
    return plane->vertices[(size_t)j * (size_t)plane->width + (size_t)i].delta;
}

static float largest_child(const Fill *fill, int i, int j) {
    const PatchPlane *plane = &fill->forest->planes[fill->plane];
    float most = 0.0f;
    for (int c = 0; c < 4; c++) {
        float delta = 0.0f;
        if (i & j & 1)
            delta = child_delta(plane, i + (c == 0) - (c == 1), j + (c == 2) - (c == 3));
        else if (fill->plane > 0)
            delta = child_delta(plane - 1, 2 * i + (c & 1 ? 1 : -1), 2 * j + (c & 2 ? 1 : -1));
        most = delta > most ? delta : most;
    }
    return most;
}

static void fill_vertex(const Fill *fill, int i, int j) {
    const PatchPlane *plane = &fill->forest->planes[fill->plane];
    PatchVertex *vertex = &plane->vertices[(size_t)j * (size_t)plane->width + (size_t)i];
    int col = i * plane->step, row = j * plane->step;
    ErrorCodes codes = error_field_at(fill->input->errors, col, row);
    float h = fill->input->height_m[(size_t)row * (size_t)fill->input->forest->width + (size_t)col];
    ErrorCodes missing =
        patch_forest_missing(fill->input->errors, fill->forest->side, fill->plane, i, j, PATCH_REACH_ALL);
    float own = error_field_decode(missing.delta), child = largest_child(fill, i, j);
    vertex->position = grid_point_ecef(grid_lattice(fill->input->grid, col, row, h));
    vertex->delta = codes.delta == ERROR_FIELD_ALWAYS ? error_field_decode(codes.delta) : own > child ? own : child;
    vertex->radius = error_field_decode(codes.radius);
}

static void fill_edges(void *user, int64_t begin, int64_t end, int worker) {
    const Fill *fill = user;
    (void)worker;
    for (int j = (int)begin; j < (int)end; j++)
        for (int i = j & 1 ? 0 : 1; i < fill->forest->planes[fill->plane].width; i += 2)
            fill_vertex(fill, i, j);
}

static void fill_centres(void *user, int64_t begin, int64_t end, int worker) {
    const Fill *fill = user;
    (void)worker;
    for (int j = (int)begin | 1; j < (int)end; j += 2)
        for (int i = 1; i < fill->forest->planes[fill->plane].width; i += 2)
            fill_vertex(fill, i, j);
}

Result patch_forest_create(const PatchForestInput *input, Jobs *jobs, PatchForest *out) {
    PatchForest forest = {.depth = input->depth, .side = 1 << input->depth / 2};
    Result result = create_tiles(input, &forest);
    if (result == RESULT_OK)
        result = create_planes(input, &forest);
    if (result != RESULT_OK) {
        log_error("patch hierarchy: not enough memory");
        patch_forest_destroy(&forest);
        return result;
    }
    for (int k = 0; k < forest.plane_count; k++) {
        Fill fill = {input, &forest, k};
        jobs_run(jobs, forest.planes[k].height, 2, fill_edges, &fill);
        jobs_run(jobs, forest.planes[k].height, 2, fill_centres, &fill);
    }
    *out = forest;
    return RESULT_OK;
}

void patch_forest_destroy(PatchForest *forest) {
    free(forest->tiles);
    for (int k = 0; k < forest->plane_count; k++)
        free(forest->planes[k].vertices);
    for (int i = 0; i < PATCH_FOREST_TEMPLATES; i++)
        patch_template_destroy(&forest->templates[i]);
    *forest = (PatchForest){0};
}
