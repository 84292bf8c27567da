// terrain/squares/square_grid.h: the base tiles cut into squares of one greatest side: what the methods over square
// patches share. Columns, rows in samples; sides in cells, powers of two.
// A SquareGrid owns its tables; constant after creation, any thread may read it.
#pragma once
#include "terrain/forest.h"
#include "terrain/patches/patch_forest.h"
#include "terrain/terrain.h"

typedef struct SquareGrid {
    int width, height; // samples
    int side_max;      // cells
    int32_t count;
    ForestTile *squares; // each corner a multiple of its side; row by row of blocks of side_max
    int blocks_across;
    int32_t *blocks; // [blocks]: a square, or -1 - where in `cells` a block of smaller squares begins
    int32_t *cells;  // [side_max * side_max] of each such block: the square of a cell; -1 outside the DEM
} SquareGrid;

// `side_max`: a power of two, 2..128. MEMORY.
MUST_USE Result square_grid_create(const Forest *forest, int side_max, SquareGrid *out);
void square_grid_destroy(SquareGrid *grid);

// The greatest side up to `wanted`, a power of two, whose squares' offsets fit 32 bits of the lattice; 2 at least.
int square_grid_fitting_side(const Terrain *terrain, int wanted);

// The square that holds the cell whose north-west sample is (col, row); -1 outside the DEM.
int32_t square_grid_at(const SquareGrid *grid, int col, int row);

// The two bintree roots of a square: their diagonal is the one that the bisection of any tile around it gives.
static inline PatchTriangle square_root_triangle(const ForestTile *square, int root) {
    return patch_forest_root(square, root);
}
