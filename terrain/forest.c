#include "terrain/forest.h"

#include <stdlib.h>

static int32_t largest_side(int32_t cells) {
    int32_t side = FOREST_SIDE_MAX;
    while (side > cells)
        side >>= 1;
    return side;
}

// Visits the tiles of the rectangle: a block of the largest side that fits, then the strip east of it, then the strip
// south of both. Each recursion works on a strip narrower than the block's side, so alignment is kept.
static int32_t cover(int32_t col, int32_t row, int32_t cols, int32_t rows, ForestTile *tiles) {
    if (cols == 0 || rows == 0)
        return 0;
    int32_t side = largest_side(cols < rows ? cols : rows);
    int32_t across = cols / side, down = rows / side, count = 0;
    for (int32_t j = 0; j < down; j++)
        for (int32_t i = 0; i < across; i++, count++)
            if (tiles)
                tiles[count] = (ForestTile){col + i * side, row + j * side, side};
    count += cover(col + across * side, row, cols - across * side, down * side, tiles ? tiles + count : NULL);
    count += cover(col, row + down * side, cols, rows - down * side, tiles ? tiles + count : NULL);
    return count;
}

Result forest_create(int width, int height, Forest *out) {
    if (width < 2 || height < 2)
        return RESULT_RANGE;
    int32_t count = cover(0, 0, width - 1, height - 1, NULL);
    ForestTile *tiles = malloc(sizeof *tiles * (size_t)count);
    if (!tiles)
        return RESULT_MEMORY;
    cover(0, 0, width - 1, height - 1, tiles);
    *out = (Forest){.width = width, .height = height, .tile_count = count, .tiles = tiles};
    return RESULT_OK;
}

void forest_destroy(Forest *forest) {
    free(forest->tiles);
    *forest = (Forest){0};
}
