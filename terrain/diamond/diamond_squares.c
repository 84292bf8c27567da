// Yalcin, Weiss, De Floriani 2011, section 8, for machines without compute shaders: the same triangles as indices of
// 16 bits. Our own: a walk over the bintrees of a square instead of a look at every diamond; a triangle costs a table
// look-up, and a square whose bits are those of the frame before costs a comparison.
#include "terrain/diamond/diamond_squares.h"

#include "base/log.h"
#include "terrain/patches/patch_forest.h"

#include <stdlib.h>
#include <string.h>

// ---- trees ----

static uint16_t page_vertex(PatchCorner corner, int col0, int cells) {
    return (uint16_t)(corner.row * (cells + 1) + corner.col - col0);
}

static void fill_tree(DiamondSquareTree *tree, const PatchTriangle *t, uint32_t heap, int col0, int cells) {
    uint16_t *corners = tree->corners[heap];
    corners[0] = page_vertex(t->apex, col0, cells);
    corners[1] = page_vertex(t->right, col0, cells);
    corners[2] = page_vertex(t->left, col0, cells);
    corners[3] = 0;
    if (heap >= tree->leaves)
        return;
    PatchCorner middle = patch_triangle_middle(t);
    PatchTriangle first = patch_triangle_half(t, middle, 0), second = patch_triangle_half(t, middle, 1);
    tree->split[heap] = page_vertex(middle, col0, cells);
    fill_tree(tree, &first, 2 * heap, col0, cells);
    fill_tree(tree, &second, 2 * heap + 1, col0, cells);
}

static bool create_tree(DiamondSquareTree *tree, int cells, int parity, int root) {
    tree->leaves = (uint32_t)(cells * cells);
    tree->corners = malloc(sizeof *tree->corners * 2 * tree->leaves);
    tree->split = malloc(sizeof *tree->split * tree->leaves);
    if (!tree->corners || !tree->split)
        return false;
    ForestTile square = {.col = parity * cells, .row = 0, .side = cells};
    PatchTriangle triangle = square_root_triangle(&square, root);
    fill_tree(tree, &triangle, 1, square.col, cells);
    return true;
}

Result diamond_squares_create(const DiamondLayout *layout, const SquareGrid *grid, DiamondSquares *out) {
    *out = (DiamondSquares){.layout = layout, .grid = grid};
    bool created = true;
    for (int shift = 0; shift < DIAMOND_SQUARE_SHIFTS; shift++)
        for (int i = 0; i < 4; i++)
            created = created && create_tree(&out->trees[shift][i / 2][i % 2], 1 << shift, i / 2, i % 2);
    if (created)
        return RESULT_OK;
    log_error("diamonds: not enough memory for the tables of squares");
    diamond_squares_destroy(out);
    return RESULT_MEMORY;
}

void diamond_squares_destroy(DiamondSquares *squares) {
    for (int shift = 0; shift < DIAMOND_SQUARE_SHIFTS; shift++)
        for (int i = 0; i < 4; i++) {
            free(squares->trees[shift][i / 2][i % 2].corners);
            free(squares->trees[shift][i / 2][i % 2].split);
        }
    *squares = (DiamondSquares){0};
}

// ---- the super-squares of a square ----

// The vertices of one plane in a closed square: c0 .. c0 + side by r0 .. r0 + side, in steps of the plane.
typedef struct Region {
    int plane, c0, r0, side;
} Region;

static Region region_of(const ForestTile *square, int plane) {
    return (Region){plane, square->col >> plane, square->row >> plane, square->side >> plane};
}

static int clamped(int value) {
    return value < 0 ? 0 : value > 3 ? 3 : value;
}

// Bits of a super-square's columns (of dx) or rows (of dy) within begin .. begin + side.
static uint32_t columns_within(int at, int begin, int side) {
    uint32_t ones = (UINT32_C(2) << clamped(begin + side - 4 * at)) - (UINT32_C(1) << clamped(begin - 4 * at));
    return ones * 0x1111;
}
static uint32_t rows_within(int at, int begin, int side) {
    int first = 4 * clamped(begin - 4 * at), last = 4 * clamped(begin + side - 4 * at);
    return (UINT32_C(0x10) << last) - (UINT32_C(1) << first);
}

// Bits of a column (of dx) or row (of dy) that is begin or begin + side.
static uint32_t columns_at(int at, int begin, int side) {
    uint32_t mask = begin >> 2 == at ? UINT32_C(0x1111) << (begin & 3) : 0;
    return (begin + side) >> 2 == at ? mask | UINT32_C(0x1111) << ((begin + side) & 3) : mask;
}
static uint32_t rows_at(int at, int begin, int side) {
    uint32_t mask = begin >> 2 == at ? UINT32_C(0xF) << 4 * (begin & 3) : 0;
    return (begin + side) >> 2 == at ? mask | UINT32_C(0xF) << 4 * ((begin + side) & 3) : mask;
}

typedef struct Tally {
    int32_t inside, border; // split vertices
    uint32_t difference;
} Tally;

static void survey_row(const DiamondLayout *layout, const Region *region, int j, const uint32_t *bits,
                       const uint32_t *before, Tally *tally) {
    uint32_t rows = rows_within(j, region->r0, region->side), rim = rows_at(j, region->r0, region->side);
    size_t at = layout->offset[region->plane] + (size_t)j * layout->across[region->plane];
    for (int i = region->c0 >> 2; i <= (region->c0 + region->side) >> 2; i++) {
        uint32_t mask = rows & columns_within(i, region->c0, region->side);
        uint32_t split = bits[at + (size_t)i] & mask;
        if (before)
            tally->difference |= split ^ (before[at + (size_t)i] & mask);
        if (!split)
            continue;
        uint32_t border = rim | columns_at(i, region->c0, region->side);
        tally->inside += __builtin_popcount(split & ~border);
        tally->border += __builtin_popcount(split & border);
    }
}

static Tally survey_plane(const DiamondSquares *squares, const ForestTile *square, int plane, const uint32_t *bits,
                          const uint32_t *before) {
    Region region = region_of(square, plane);
    Tally tally = {0};
    for (int j = region.r0 >> 2; j <= (region.r0 + region.side) >> 2; j++)
        survey_row(squares->layout, &region, j, bits, before, &tally);
    return tally;
}

// A vertex inside splits two triangles of the square, one on its border the one that is in the square.
DiamondSurvey diamond_squares_survey(const DiamondSquares *squares, int32_t square, const uint32_t *bits,
                                     const uint32_t *before) {
    const ForestTile *tile = &squares->grid->squares[square];
    DiamondSurvey survey = {.stride = tile->side, .triangles = 2, .vertices = 4, .changed = !before};
    for (int plane = forest_log2(tile->side) - 1; plane >= 0; plane--) {
        Tally tally = survey_plane(squares, tile, plane, bits, before);
        if (tally.inside + tally.border > 0)
            survey.stride = 1 << plane;
        survey.triangles += 2 * tally.inside + tally.border;
        survey.vertices += tally.inside + tally.border;
        survey.changed = survey.changed || tally.difference;
    }
    return survey;
}

// ---- triangles ----

static void mark_word(const Region *region, int i, int j, uint32_t split, int shift, int across, uint8_t *active) {
    for (; split; split &= split - 1) {
        int bit = __builtin_ctz(split);
        int x = 4 * i + (bit & 3) - region->c0, y = 4 * j + (bit >> 2) - region->r0;
        active[(y << shift) * across + (x << shift)] = 1;
    }
}

// Marks the page's vertices that are split. `shift`: from the plane's steps to the page's strides.
static void mark_plane(const DiamondLayout *layout, const Region *region, const uint32_t *bits, int shift, int across,
                       uint8_t *active) {
    for (int j = region->r0 >> 2; j <= (region->r0 + region->side) >> 2; j++) {
        uint32_t rows = rows_within(j, region->r0, region->side);
        size_t at = layout->offset[region->plane] + (size_t)j * layout->across[region->plane];
        for (int i = region->c0 >> 2; i <= (region->c0 + region->side) >> 2; i++) {
            uint32_t mask = rows & columns_within(i, region->c0, region->side);
            mark_word(region, i, j, bits[at + (size_t)i] & mask, shift, across, active);
        }
    }
}

// Depth first over the heap: past a triangle that is drawn, go on at the next one whose parent is split.
static uint16_t *emit_tree(const DiamondSquareTree *tree, const uint8_t *active, uint16_t *out) {
    uint32_t heap = 1;
    do {
        while (heap < tree->leaves && active[tree->split[heap]])
            heap *= 2;
        memcpy(out, tree->corners[heap], sizeof *tree->corners);
        out += 3;
        heap++;
        heap >>= __builtin_ctz(heap);
    } while (heap > 1);
    return out;
}

void diamond_squares_emit(const DiamondSquares *squares, int32_t square, int32_t stride, const uint32_t *bits,
                          uint16_t *indices) {
    const ForestTile *tile = &squares->grid->squares[square];
    int finest = forest_log2(stride), shift = forest_log2(tile->side) - finest, across = (1 << shift) + 1;
    uint8_t active[DIAMOND_SQUARE_VERTICES];
    memset(active, 0, (size_t)(across * across));
    for (int plane = finest; 1 << plane < tile->side; plane++) {
        Region region = region_of(tile, plane);
        mark_plane(squares->layout, &region, bits, plane - finest, across, active);
    }
    const DiamondSquareTree *trees = squares->trees[shift][(tile->col / tile->side + tile->row / tile->side) & 1];
    emit_tree(&trees[1], active, emit_tree(&trees[0], active, indices));
}
