// render/ground/ground_source.h: the DEM as the picture needs it: heights above the geoid, by rows, and the local map
// to east and north. Reduced 2:1 until it fits a texture. Metres above the geoid; cells: columns and rows of the
// (reduced) grid. A GroundSource borrows the Terrain. After creation any thread may read it.
#pragma once
#include "base/base.h"
#include "base/vec.h"
#include "terrain/terrain.h"

#define GROUND_BLOCK 32 // cells a side of what one undulation and one Jacobian stand for

// Metres towards east and north for one column and one row further.
typedef struct GroundJacobian {
    float east_col, north_col, east_row, north_row;
} GroundJacobian;

typedef struct GroundSource {
    const Terrain *terrain;
    int step;                  // samples a cell: 1, or 2, 4 ... for a reduced grid
    int width, height;         // cells
    int blocks_x, blocks_y;    // nodes of the tables below, one beyond the last cell
    float *undulation_m;       // [blocks_y][blocks_x], interpolated between
    GroundJacobian *jacobians; // [blocks_y][blocks_x]
    float min_m, max_m;        // above the geoid, bounds
} GroundSource;

// `side_max`: of a texture.
MUST_USE Result ground_source_create(const Terrain *terrain, int side_max, GroundSource *out);
void ground_source_destroy(GroundSource *source);

// Row `row` (clamped into the grid) of heights, `width` of them.
void ground_source_row(const GroundSource *source, int row, float *out_m);
static inline GroundJacobian ground_source_jacobian(const GroundSource *source, int col, int row) {
    return source->jacobians[(size_t)(row / GROUND_BLOCK) * (size_t)source->blocks_x + (size_t)(col / GROUND_BLOCK)];
}
