#include "terrain/squares/square_grid.h"

#include "base/log.h"
#include "terrain/terrain_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int blocks_along(int samples, int side) {
    return (samples - 1 + side - 1) / side;
}

static int least(int a, int b) {
    return a < b ? a : b;
}

// Squares of one tile: itself where it is small, else in rows.
static int32_t squares_of(const ForestTile *tile, int side_max) {
    int along = tile->side > side_max ? tile->side / side_max : 1;
    return along * along;
}

typedef struct Filling {
    SquareGrid *grid;
    int32_t cell_blocks; // blocks of smaller squares so far
} Filling;

static void mark_small(Filling *f, const ForestTile *square, int32_t number) {
    SquareGrid *grid = f->grid;
    int side = grid->side_max;
    size_t area = (size_t)side * (size_t)side;
    int32_t *block = &grid->blocks[square->row / side * grid->blocks_across + square->col / side];
    if (*block >= 0) {
        memset(grid->cells + (size_t)f->cell_blocks * area, 0xFF, area * sizeof *grid->cells);
        *block = -1 - (int32_t)((size_t)f->cell_blocks++ * area);
    }
    int32_t *cells = grid->cells + (-1 - *block);
    for (int y = 0; y < square->side; y++)
        for (int x = 0; x < square->side; x++)
            cells[(square->row % side + y) * side + square->col % side + x] = number;
}

static void add_square(Filling *f, ForestTile square) {
    SquareGrid *grid = f->grid;
    int32_t number = grid->count++;
    grid->squares[number] = square;
    if (square.side < grid->side_max)
        mark_small(f, &square, number);
    else
        grid->blocks[square.row / grid->side_max * grid->blocks_across + square.col / grid->side_max] = number;
}

static void add_tile(Filling *f, const ForestTile *tile) {
    int side = least(tile->side, f->grid->side_max);
    for (int row = tile->row; row < tile->row + tile->side; row += side)
        for (int col = tile->col; col < tile->col + tile->side; col += side)
            add_square(f, (ForestTile){col, row, side});
}

// A block that no large square fills lies at the south or east end.
static size_t small_blocks_max(const SquareGrid *grid) {
    return (size_t)(grid->blocks_across + blocks_along(grid->height, grid->side_max));
}

static bool allocate(const Forest *forest, SquareGrid *grid) {
    int32_t count = 0;
    for (int32_t i = 0; i < forest->tile_count; i++)
        count += squares_of(&forest->tiles[i], grid->side_max);
    size_t blocks = (size_t)grid->blocks_across * (size_t)blocks_along(grid->height, grid->side_max);
    size_t area = (size_t)grid->side_max * (size_t)grid->side_max;
    grid->squares = malloc(sizeof *grid->squares * (size_t)count);
    grid->blocks = calloc(blocks, sizeof *grid->blocks);
    grid->cells = malloc(sizeof *grid->cells * area * small_blocks_max(grid));
    return grid->squares && grid->blocks && grid->cells;
}

Result square_grid_create(const Forest *forest, int side_max, SquareGrid *out) {
    SquareGrid grid = {.width = forest->width, .height = forest->height, .side_max = side_max};
    grid.blocks_across = blocks_along(grid.width, side_max);
    if (!allocate(forest, &grid)) {
        log_error("squares: not enough memory for %d x %d samples", grid.width, grid.height);
        square_grid_destroy(&grid);
        return RESULT_MEMORY;
    }
    Filling filling = {.grid = &grid};
    for (int32_t i = 0; i < forest->tile_count; i++)
        add_tile(&filling, &forest->tiles[i]);
    *out = grid;
    return RESULT_OK;
}

void square_grid_destroy(SquareGrid *grid) {
    free(grid->squares);
    free(grid->blocks);
    free(grid->cells);
    *grid = (SquareGrid){0};
}

int square_grid_fitting_side(const Terrain *terrain, int wanted) {
    GridBounds bounds = grid_bounds(terrain->grid, 0, terrain->dem->height - 1, 0.0);
    double cell_m = fmax(bounds.across_m, bounds.down_m);
    int side = wanted;
    while (side > 2 && 2.0 * side * cell_m * GRID_LATTICE_PER_M > (double)INT32_MAX)
        side /= 2;
    return side;
}

int32_t square_grid_at(const SquareGrid *grid, int col, int row) {
    if (col < 0 || row < 0 || col >= grid->width - 1 || row >= grid->height - 1)
        return -1;
    int side = grid->side_max;
    int32_t block = grid->blocks[row / side * grid->blocks_across + col / side];
    return block >= 0 ? block : grid->cells[(-1 - block) + (row % side) * side + col % side];
}
