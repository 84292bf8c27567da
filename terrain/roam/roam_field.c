#include "terrain/roam/roam_field.h"

#include "base/log.h"
#include "terrain/terrain_parts.h"

#include <stdlib.h>

Result roam_field_create(const SquareGrid *grid, const Terrain *terrain, RoamField *out) {
    *out = (RoamField){.grid = grid, .terrain = terrain};
    out->patches = calloc((size_t)grid->count, sizeof *out->patches);
    if (!out->patches) {
        log_error("roam: not enough memory for %d squares", grid->count);
        return RESULT_MEMORY;
    }
    out->levels = 2 * __builtin_ctz((unsigned)grid->side_max);
    return RESULT_OK;
}

void roam_field_destroy(RoamField *field) {
    for (int32_t i = 0; field->patches && i < field->grid->count; i++)
        free(field->patches[i].vertices);
    free(field->patches);
    *field = (RoamField){0};
}

static void fill_row(const RoamField *field, const RoamPatch *patch, const ForestTile *square, int j,
                     GridPoint origin) {
    RoamVertex *out = patch->vertices + (size_t)j * (size_t)patch->across;
    int row = square->row + (j << patch->shift);
    for (int i = 0; i < patch->across; i++) {
        int col = square->col + (i << patch->shift);
        GridPoint p = terrain_point(field->terrain, col, row);
        ErrorCodes codes = error_field_at(&field->terrain->errors, col, row);
        out[i] = (RoamVertex){(int32_t)(p.x - origin.x), (int32_t)(p.y - origin.y), (int32_t)(p.z - origin.z),
                              codes.delta, codes.radius};
    }
}

Result roam_field_deepen(RoamField *field, int32_t square, int level) {
    const ForestTile *tile = &field->grid->squares[square];
    RoamPatch *patch = &field->patches[square];
    int step = roam_level_step(field->grid->side_max, level), across = tile->side / step + 1;
    RoamVertex *vertices = malloc(sizeof *vertices * (size_t)across * (size_t)across);
    if (!vertices) {
        log_error("roam: not enough memory for %d x %d vertices of a square", across, across);
        return RESULT_MEMORY;
    }
    free(patch->vertices);
    patch->vertices = vertices;
    patch->across = (int16_t)across;
    patch->shift = (uint8_t)__builtin_ctz((unsigned)step);
    patch->level_end = (uint8_t)(level / 2 * 2 + 2); // two levels have vertices of one step
    GridPoint origin = terrain_point(field->terrain, tile->col + tile->side / 2, tile->row + tile->side / 2);
    patch->origin[0] = (double)origin.x;
    patch->origin[1] = (double)origin.y;
    patch->origin[2] = (double)origin.z;
    for (int j = 0; j < across; j++)
        fill_row(field, patch, tile, j, origin);
    return RESULT_OK;
}

void roam_field_drop(RoamField *field, int32_t square) {
    RoamPatch *patch = &field->patches[square];
    free(patch->vertices);
    *patch = (RoamPatch){0};
}

size_t roam_field_bytes(const RoamField *field) {
    size_t bytes = 0;
    for (int32_t i = 0; i < field->grid->count; i++) {
        const RoamPatch *patch = &field->patches[i];
        if (patch->vertices)
            bytes += sizeof *patch->vertices * (size_t)patch->across * (size_t)patch->across;
    }
    return bytes;
}
