#include "terrain/patches/patch_template.h"

#include <stdlib.h>

typedef struct Numbering {
    PatchTemplate *patch;
    int next;
    uint16_t *number; // [(side + 1) * (side + 1)] of vertex (i, j); UINT16_MAX: not yet
} Numbering;

static uint16_t number_of(Numbering *n, int i, int j) {
    uint16_t *slot = &n->number[i * (n->patch->side + 1) + j];
    if (*slot == UINT16_MAX) {
        *slot = (uint16_t)n->next++;
        n->patch->position[*slot][0] = (uint8_t)i;
        n->patch->position[*slot][1] = (uint8_t)j;
    }
    return *slot;
}

static void set_corners(PatchTemplate *patch, int heap, uint16_t left, uint16_t right, uint16_t apex) {
    patch->corners[heap][0] = apex;
    patch->corners[heap][1] = right;
    patch->corners[heap][2] = left;
}

static void split_triangle(Numbering *n, int heap) {
    PatchTemplate *patch = n->patch;
    uint16_t apex = patch->corners[heap][0], right = patch->corners[heap][1], left = patch->corners[heap][2];
    int i = (patch->position[left][0] + patch->position[right][0]) / 2;
    int j = (patch->position[left][1] + patch->position[right][1]) / 2;
    uint16_t middle = number_of(n, i, j);
    patch->split[heap] = middle;
    set_corners(patch, 2 * heap, apex, left, middle);
    set_corners(patch, 2 * heap + 1, right, apex, middle);
}

static void number_vertices(Numbering *n) {
    PatchTemplate *patch = n->patch;
    uint16_t apex = number_of(n, 0, 0), left = number_of(n, patch->side, 0), right = number_of(n, 0, patch->side);
    set_corners(patch, 1, left, right, apex);
    for (int level = 0; level < patch->depth; level++) {
        patch->level_begin[level] = n->next;
        for (int heap = 1 << level; heap < 2 << level; heap++)
            split_triangle(n, heap);
    }
    patch->level_begin[patch->depth] = n->next;
}

Result patch_template_create(int depth, PatchTemplate *out) {
    if (depth < 0 || depth > PATCH_TEMPLATE_DEPTH_MAX || depth % 2)
        return RESULT_RANGE;
    int side = 1 << depth / 2;
    PatchTemplate patch = {.depth = depth, .side = side, .triangle_count = 1 << depth};
    patch.vertex_count = (side + 1) * (side + 2) / 2;
    patch.position = malloc(sizeof *patch.position * (size_t)patch.vertex_count);
    patch.corners = calloc((size_t)2 << depth, sizeof *patch.corners);
    patch.split = calloc((size_t)1 << depth, sizeof *patch.split);
    size_t slots = (size_t)(side + 1) * (size_t)(side + 1);
    Numbering numbering = {.patch = &patch, .number = malloc(sizeof(uint16_t) * slots)};
    Result result = RESULT_MEMORY;
    if (patch.position && patch.corners && patch.split && numbering.number) {
        for (size_t i = 0; i < slots; i++)
            numbering.number[i] = UINT16_MAX;
        number_vertices(&numbering);
        *out = patch;
        result = RESULT_OK;
    } else {
        patch_template_destroy(&patch);
    }
    free(numbering.number);
    return result;
}

void patch_template_destroy(PatchTemplate *patch) {
    free(patch->position);
    free(patch->corners);
    free(patch->split);
    *patch = (PatchTemplate){0};
}
