#include "terrain/patches/patch_select.h"

#include <stdlib.h>

typedef struct Descent {
    const PatchForest *forest;
    const RefineView *view; // NULL: as `where` says
    PatchSplits *where;     // NULL: down to the finest
    void *user;
    const PatchTile *tile;
    int32_t root_node; // node number of heap 0 of this root
    int32_t count_max;
    PatchSelection *out;
} Descent;

static Result append(PatchSelection *out, PatchChoice choice) {
    if (out->count == out->capacity) {
        int32_t larger = out->capacity ? out->capacity * 2 : 256;
        PatchChoice *grown = realloc(out->choices, sizeof *grown * (size_t)larger);
        if (!grown)
            return RESULT_MEMORY;
        out->choices = grown;
        out->capacity = larger;
    }
    out->choices[out->count++] = choice;
    return RESULT_OK;
}

static bool splits(const Descent *d, PatchCorner middle) {
    if (!d->view)
        return !d->where || d->where(d->user, d->tile, middle);
    const PatchVertex *vertex = patch_forest_vertex(d->forest, middle);
    return refine_is_active(d->view, vertex->position, vertex->delta, vertex->radius);
}

static Result descend(const Descent *d, const PatchTriangle *triangle, int32_t heap, int level) {
    PatchCorner middle = patch_triangle_middle(triangle);
    if (level < d->tile->levels && splits(d, middle)) {
        PatchTriangle first = patch_triangle_half(triangle, middle, 0),
                      second = patch_triangle_half(triangle, middle, 1);
        Result result = descend(d, &first, 2 * heap, level + 1);
        return result == RESULT_OK ? descend(d, &second, 2 * heap + 1, level + 1) : result;
    }
    if (d->out->count >= d->count_max)
        return RESULT_BUDGET;
    return append(d->out, (PatchChoice){.triangle = *triangle,
                                        .node = d->root_node + heap,
                                        .level = (uint8_t)level,
                                        .template_index = (uint8_t)d->tile->template_index});
}

static Result select_all(Descent *d) {
    d->out->count = 0;
    for (int32_t i = 0; i < d->forest->tile_count; i++) {
        d->tile = &d->forest->tiles[i];
        for (int root = 0; root < 2; root++) {
            d->root_node = d->tile->first_node + (root << (d->tile->levels + 1));
            PatchTriangle triangle = patch_forest_root(&d->tile->tile, root);
            Result result = descend(d, &triangle, 1, 0);
            if (result != RESULT_OK)
                return result;
        }
    }
    return RESULT_OK;
}

Result patch_select(const PatchForest *forest, const RefineView *view, int32_t count_max, PatchSelection *out) {
    Descent d = {.forest = forest, .view = view, .count_max = count_max, .out = out};
    return select_all(&d);
}

Result patch_select_where(const PatchForest *forest, PatchSplits *where, void *user, int32_t count_max,
                          PatchSelection *out) {
    Descent d = {.forest = forest, .where = where, .user = user, .count_max = count_max, .out = out};
    return select_all(&d);
}

Result patch_select_finest(const PatchForest *forest, PatchSelection *out) {
    Descent d = {.forest = forest, .count_max = INT32_MAX, .out = out};
    return select_all(&d);
}

void patch_selection_destroy(PatchSelection *selection) {
    free(selection->choices);
    *selection = (PatchSelection){0};
}
