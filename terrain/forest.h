// terrain/forest.h: cover a W x H grid by square base tiles of power-of-two side, exactly.
// Columns and rows in samples, sides in cells. Every tile's corner is a multiple of its side.
// A Forest owns its tiles.
#pragma once
#include "base/base.h"

#define FOREST_SIDE_MAX 2048 // cells
#define FOREST_LEVEL_MAX 11  // log2 of it

// Of a power of two, as all sides and steps are.
static inline int forest_log2(int power) {
    return __builtin_ctz((unsigned)power);
}

typedef struct ForestTile {
    int32_t col, row; // of the north-west corner
    int32_t side;     // 2^k cells
} ForestTile;

typedef struct Forest {
    int width, height; // samples
    int32_t tile_count;
    ForestTile *tiles; // large ones first along each strip; the order is part of the results
} Forest;

// `width`, `height` >= 2 samples. Neighbouring tiles share their border samples.
MUST_USE Result forest_create(int width, int height, Forest *out);
void forest_destroy(Forest *forest);
