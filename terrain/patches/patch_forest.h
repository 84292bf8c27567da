// terrain/patches/patch_forest.h: the hierarchy of triangular patches over the base tiles, and when a patch splits.
// Columns and rows in samples; ECEF metres; errors in metres.
// A PatchForest owns its tables; constant after creation.
//
// Source: Loeffler, Schwanke, Schumann 2010, section 4.1: patches on the diamond graph, their errors the largest among
// the vertices they can not show, nested like those.
#pragma once
#include "base/vec.h"
#include "terrain/errors/error_field.h"
#include "terrain/forest.h"
#include "terrain/grid.h"
#include "terrain/jobs.h"
#include "terrain/patches/patch_template.h"

#define PATCH_FOREST_TEMPLATES (PATCH_TEMPLATE_DEPTH_MAX / 2 + 1)

typedef struct PatchCorner {
    int32_t col, row;
} PatchCorner;

// A patch: a triangle of the bintree of one base tile. (left, right) is the hypotenuse.
typedef struct PatchTriangle {
    PatchCorner left, right, apex;
} PatchTriangle;

// Where two patches of one diamond split. Both, or neither.
typedef struct PatchVertex {
    Vec3d position; // ECEF, on the lattice
    float delta;    // largest error among the diamonds of the first level that the two patches' pages lack; nested
    float radius;   // the vertex's own: so a patch that splits always splits at an active vertex
} PatchVertex;

typedef struct PatchPlane {
    int step, width, height; // as in ErrorPlane; entries with both even are unused
    PatchVertex *vertices;
} PatchPlane;

typedef struct PatchTile {
    ForestTile tile;
    int levels;         // splits from the tile's triangles down to its finest patches
    int template_index; // depth / 2
    int32_t first_node; // node = first_node + root << levels + 1 | heap; heap is 1 for the root
} PatchTile;

typedef struct PatchForest {
    int depth; // bisections within a patch, where the tile has them
    int side;  // 2^(depth / 2)
    int32_t tile_count, node_count;
    PatchTile *tiles;
    int plane_count;
    PatchPlane planes[FOREST_LEVEL_MAX];
    PatchTemplate templates[PATCH_FOREST_TEMPLATES]; // those in use
} PatchForest;

typedef struct PatchForestInput {
    const float *height_m; // [height][width]
    const Grid *grid;
    const Forest *forest;
    const ErrorField *errors;
    int depth;
} PatchForestInput;
MUST_USE Result patch_forest_create(const PatchForestInput *input, Jobs *jobs, PatchForest *out);
void patch_forest_destroy(PatchForest *forest);

// Which part of a diamond: from its middle so far, in units of its step, 0 or 1.
typedef struct PatchReach {
    int west, east, north, south;
} PatchReach;
#define PATCH_REACH_ALL ((PatchReach){1, 1, 1, 1})

// The largest codes among the vertices of the same kind, `side` times finer, inside the diamond at entry (i, j) of
// patch plane k. They are the first that the pages of the diamond's two patches lack.
ErrorCodes patch_forest_missing(const ErrorField *errors, int side, int k, int i, int j, PatchReach within);

// The triangle of root 0 or 1 of a tile.
PatchTriangle patch_forest_root(const ForestTile *tile, int root);
static inline PatchCorner patch_triangle_middle(const PatchTriangle *t) {
    return (PatchCorner){(t->left.col + t->right.col) / 2, (t->left.row + t->right.row) / 2};
}
static inline PatchTriangle patch_triangle_half(const PatchTriangle *t, PatchCorner middle, int half) {
    return half ? (PatchTriangle){t->right, t->apex, middle} : (PatchTriangle){t->apex, t->left, middle};
}
// The vertex that splits a patch which is not among its tile's finest.
const PatchVertex *patch_forest_vertex(const PatchForest *forest, PatchCorner middle);
