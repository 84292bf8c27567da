// terrain/lod/lod_patch_seam.h: where static patches meet the remainder: what splits and what is active, on both sides.
// Columns and rows in samples; sides and steps in cells.
// Owns its tables, borrows the Terrain; one thread at a time, but for seam_is_active, seam_is_static, seam_is_touched.
#pragma once
#include "terrain/patches/patch_select.h"
#include "terrain/squares/square_grid.h"
#include "terrain/terrain.h"

#define SEAM_LEVELS (2 * FOREST_LEVEL_MAX) // of vertices: 2 log2(step), 1 more for centres; 0 the finest

typedef struct SeamSphere { // as delta and radius of a PatchVertex, without what only tiles' corners force
    float delta, radius;
} SeamSphere;

typedef struct SeamList {
    int32_t *samples; // row * width + col
    int32_t count, capacity;
} SeamList;

typedef struct PatchSeam {
    const Terrain *terrain;
    int32_t width, height;
    int side;                              // of a page
    int32_t static_side;                   // tiles of this side and more are drawn as static patches
    double widest_step;                    // patches around vertices of a larger step do not fit and split
    bool empty;                            // all tiles are static: nothing below is there
    SquareGrid squares;                    // which tile a cell lies in
    int32_t *tile_sides;                   // [squares.count] of the tile that the square is part of
    uint8_t *marks;                        // [height][width]
    uint8_t *touched;                      // [squares.count] where the closure put vertices: now, or before
    uint8_t *split[FOREST_LEVEL_MAX];      // as the patch forest's planes
    SeamSphere *spheres[FOREST_LEVEL_MAX]; // as the patch forest's planes
    SeamList vertices[SEAM_LEVELS];        // active in the remainder, or shown on its border
    SeamList patches[SEAM_LEVELS];         // that split, at the level of the first vertices that the split shows
    SeamList shown;                        // on the border, by the coarsest patches
    SeamList corners;                      // of static tiles, within the sides of larger ones
    bool out_of_memory;
} PatchSeam;

MUST_USE Result seam_create(const Terrain *terrain, PatchSeam *out);
void seam_destroy(PatchSeam *seam);

bool seam_is_static(const PatchSeam *seam, const ForestTile *tile);

// A new frame: nothing is active, nothing splits but what must.
void seam_begin(PatchSeam *seam);
// What a view asks for. No sample is nearer to the eye than `nearest_m`: errors that are small enough there are so
// everywhere.
typedef struct SeamView {
    RefineView view;
    double nearest_m; // 0: not known
} SeamView;
static inline bool seam_view_matters(const SeamView *view, float delta_m) {
    return view->view.nu * (double)delta_m > view->nearest_m || view->nearest_m <= 0.0;
}
// Static patches split where the view asks for it. BUDGET, MEMORY as patch_select.
MUST_USE Result seam_split(PatchSeam *seam, const SeamView *view, int32_t count_max, PatchSelection *out);
// A vertex of the remainder is active in this frame.
void seam_activate(PatchSeam *seam, int32_t col, int32_t row);
// A vertex of the remainder is active by its error, or not, until told otherwise. With it are all its ancestors.
void seam_set_by_error(PatchSeam *seam, int32_t col, int32_t row, bool active);
// Adds what follows: parents of active vertices, vertices that static patches show on the border, patches that must
// split to show one. The smallest such set, whatever the order. MEMORY.
MUST_USE Result seam_close(PatchSeam *seam);
// The static patches that do not split, and the finest of the remainder.
MUST_USE Result seam_select(PatchSeam *seam, int32_t count_max, PatchSelection *out);

// Whether the closure put vertices into a square, in this frame or in one since seam_settle.
bool seam_is_touched(const PatchSeam *seam, int32_t square);
// What is active now is drawn: from here on it is what was before.
void seam_settle(PatchSeam *seam);

#define SEAM_ACTIVE 1   // in this frame
#define SEAM_BY_ERROR 2 // until told otherwise
static inline uint8_t seam_is_active(const PatchSeam *seam, int32_t col, int32_t row) {
    return (seam->marks[(size_t)row * (size_t)seam->width + (size_t)col] & (SEAM_ACTIVE | SEAM_BY_ERROR)) != 0;
}
