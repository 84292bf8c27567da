#include "terrain/roam/roam_emit.h"

#include "base/log.h"

#include <stdlib.h>
#include <string.h>

#define STACK_MAX (ROAM_LEVEL_MAX + 4)
#define CORNERS_AT offsetof(RoamTriangle, left_col)

// A triangle's corners and level are moved as one word.
_Static_assert(sizeof(RoamTriangle) == CORNERS_AT + 8, "corners, level and a spare byte are the last eight");
_Static_assert(offsetof(RoamTriangle, level) == CORNERS_AT + 6, "after six bytes of corners");

Result roam_scratch_create(int side_max, RoamScratch *out) {
    size_t leaves = 2 * (size_t)side_max * (size_t)side_max, across = (size_t)side_max + 1;
    *out = (RoamScratch){malloc(leaves * sizeof *out->corners), malloc(3 * leaves * sizeof *out->indices),
                         malloc(across * across)};
    if (out->corners && out->indices && out->drawn)
        return RESULT_OK;
    log_error("roam: not enough memory for the triangles of a square");
    roam_scratch_destroy(out);
    return RESULT_MEMORY;
}

void roam_scratch_destroy(RoamScratch *scratch) {
    free(scratch->corners);
    free(scratch->indices);
    free(scratch->drawn);
    *scratch = (RoamScratch){0};
}

// Returns how many leaves there are, and the level of the finest.
static int32_t collect_leaves(const RoamMesh *mesh, int32_t root, uint64_t *out, int *level) {
    int32_t stack[STACK_MAX], count = 0;
    int waiting = 0, finest = 0;
    stack[waiting++] = root + 1;
    stack[waiting++] = root;
    while (waiting) {
        const RoamTriangle *t = &mesh->triangles[stack[--waiting]];
        while (!roam_is_leaf(t)) {
            stack[waiting++] = t->child + 1;
            t = &mesh->triangles[t->child];
        }
        memcpy(&out[count++], (const unsigned char *)t + CORNERS_AT, sizeof *out);
        finest = t->level > finest ? t->level : finest;
    }
    *level = finest;
    return count;
}

static void write_indices(const uint64_t *corners, int32_t count, int shift, int across, uint16_t *indices) {
    for (int32_t i = 0; i < count; i++) {
        uint8_t c[8]; // left, right, apex as (col, row)
        memcpy(c, &corners[i], sizeof c);
        indices[3 * i] = (uint16_t)((c[5] >> shift) * across + (c[4] >> shift));
        indices[3 * i + 1] = (uint16_t)((c[3] >> shift) * across + (c[2] >> shift));
        indices[3 * i + 2] = (uint16_t)((c[1] >> shift) * across + (c[0] >> shift));
    }
}

static uint8_t count_inside(const uint8_t *drawn, int first, int step, int count) {
    int sum = 0;
    for (int i = 1; i < count - 1; i++)
        sum += drawn[first + i * step];
    return (uint8_t)sum;
}

static void count_vertices(uint8_t *drawn, const uint16_t *indices, int across, RoamEmitted *out) {
    int area = across * across, last = across - 1;
    memset(drawn, 0, (size_t)area);
    for (int32_t i = 0; i < out->index_count; i++)
        drawn[indices[i]] = 1;
    for (int i = 0; i < area; i++)
        out->vertex_count += drawn[i];
    out->sides[0] = count_inside(drawn, 0, 1, across);
    out->sides[1] = count_inside(drawn, last, across, across);
    out->sides[2] = count_inside(drawn, last * across, 1, across);
    out->sides[3] = count_inside(drawn, 0, across, across);
}

RoamEmitted roam_emit(const RoamMesh *mesh, int32_t root, const SquareGrid *grid, RoamScratch *scratch) {
    RoamEmitted out = {0};
    int32_t leaves = collect_leaves(mesh, root, scratch->corners, &out.level);
    out.index_count = 3 * leaves;
    out.stride = out.level ? roam_level_step(grid->side_max, out.level - 1) : grid->side_max;
    int across = grid->squares[mesh->triangles[root].square].side / out.stride + 1;
    write_indices(scratch->corners, leaves, __builtin_ctz((unsigned)out.stride), across, scratch->indices);
    count_vertices(scratch->drawn, scratch->indices, across, &out);
    return out;
}
