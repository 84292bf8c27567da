// terrain/patches/patch_template.h: the bintree inside a patch. All patches of one depth are alike but for an affine
// map, so its vertices and triangles are numbered once. Vertex (i, j) lies at apex + i (left - apex) / side + j (right
// - apex) / side, i + j <= side. A PatchTemplate owns its tables; constant after creation.
#pragma once
#include "base/base.h"

#define PATCH_TEMPLATE_DEPTH_MAX 14 // side 128: 8385 vertices

typedef struct PatchTemplate {
    int depth;          // bisections, even
    int side;           // 2^(depth / 2)
    int vertex_count;   // (side + 1)(side + 2) / 2
    int triangle_count; // 2^depth
    // Vertices are numbered level by level: 0 the apex, 1 left, 2 right; those that split the triangles of level k are
    // level_begin[k] .. level_begin[k + 1] - 1.
    int level_begin[PATCH_TEMPLATE_DEPTH_MAX + 1];
    uint8_t (*position)[2]; // [vertex] (i, j)
    // Triangles in heap order: 1 the patch, 2 h and 2 h + 1 the halves of h. Counter-clockwise seen from above.
    uint16_t (*corners)[4]; // [heap] apex, right, left, unused
    uint16_t *split;        // [heap < 2^depth] the vertex that splits it
} PatchTemplate;

MUST_USE Result patch_template_create(int depth, PatchTemplate *out);
void patch_template_destroy(PatchTemplate *patch);
