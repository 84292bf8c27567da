// terrain/diamond/diamond_squares.h: the triangles of closed split bits, square by square: 16-bit indices into the
// pages of terrain/squares. Columns and rows in samples; strides in samples.
// DiamondSquares own their tables and borrow layout and grid; constant after creation, any thread may read them.
#pragma once
#include "terrain/diamond/diamond_layout.h"
#include "terrain/squares/square_grid.h"

#define DIAMOND_SQUARE_SIDE 64 // cells, at most
#define DIAMOND_SQUARE_SHIFTS 7
#define DIAMOND_SQUARE_VERTICES ((DIAMOND_SQUARE_SIDE + 1) * (DIAMOND_SQUARE_SIDE + 1))

// The bintree of one root of a square: in heap order, 1 the root, 2 h and 2 h + 1 the halves of h. Vertices are
// numbered row by row of the page.
typedef struct DiamondSquareTree {
    uint16_t (*corners)[4]; // [2 * leaves]: three, counter-clockwise seen from above; the fourth is unused
    uint16_t *split;        // [leaves]: the vertex that splits it
    uint32_t leaves;        // cells of the square
} DiamondSquareTree;

typedef struct DiamondSquares {
    const DiamondLayout *layout;
    const SquareGrid *grid;
    DiamondSquareTree trees[DIAMOND_SQUARE_SHIFTS][2][2]; // [log2 of page cells a side][parity of the square][root]
} DiamondSquares;

// `grid` has squares of at most DIAMOND_SQUARE_SIDE cells. MEMORY, with a message.
MUST_USE Result diamond_squares_create(const DiamondLayout *layout, const SquareGrid *grid, DiamondSquares *out);
void diamond_squares_destroy(DiamondSquares *squares);

// What the bits say about one square, its border included. Vertices at which larger squares would split do not matter:
// nothing drawn is larger than a square.
typedef struct DiamondSurvey {
    int32_t stride; // of the page that has all its split vertices; the square's side where none is split
    int32_t triangles, vertices;
    bool changed; // since `before`
} DiamondSurvey;

// `before`: the bits of another frame, or NULL: changed.
DiamondSurvey diamond_squares_survey(const DiamondSquares *squares, int32_t square, const uint32_t *bits,
                                     const uint32_t *before);

// Writes 3 indices for each of the survey's triangles, and one more that means nothing.
void diamond_squares_emit(const DiamondSquares *squares, int32_t square, int32_t stride, const uint32_t *bits,
                          uint16_t *indices);
