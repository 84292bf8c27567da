#include "terrain/roam/roam_seam.h"

#include "base/log.h"

#include <stdlib.h>

// The square across a side's middle.
static int32_t square_across(const SquareGrid *grid, const ForestTile *t, int side) {
    int half = t->side / 2;
    switch (side) {
    case 0:
        return square_grid_at(grid, t->col + half, t->row - 1);
    case 1:
        return square_grid_at(grid, t->col + t->side, t->row + half);
    case 2:
        return square_grid_at(grid, t->col + half, t->row + t->side);
    default:
        return square_grid_at(grid, t->col - 1, t->row + half);
    }
}

static void add_borders(const SquareGrid *grid, int32_t square, RoamSeams *seams) {
    const ForestTile *t = &grid->squares[square];
    for (int side = 0; side < 4; side++) {
        int32_t n = square_across(grid, t, side);
        if (n < 0 || grid->squares[n].side < t->side || (grid->squares[n].side == t->side && n < square))
            continue; // the DEM's edge, or a border that is counted from the other side
        seams->borders[seams->border_count++] = (RoamBorder){square, n, side};
    }
}

static bool has_corner(const ForestTile *t, int col, int row) {
    return (col == t->col || col == t->col + t->side) && (row == t->row || row == t->row + t->side);
}

// A corner belongs to the first square that has it.
static void add_corners(const SquareGrid *grid, int32_t square, RoamSeams *seams) {
    const ForestTile *t = &grid->squares[square];
    for (int k = 0; k < 4; k++) {
        int col = t->col + (k & 1) * t->side, row = t->row + (k >> 1) * t->side;
        RoamCorner corner;
        bool is_first = true;
        for (int i = 0; i < 4; i++) {
            int32_t n = corner.squares[i] = square_grid_at(grid, col - (i & 1), row - (i >> 1));
            is_first = is_first && !(n >= 0 && n < square && has_corner(&grid->squares[n], col, row));
        }
        if (is_first)
            seams->corners[seams->corner_count++] = corner;
    }
}

Result roam_seams_create(const SquareGrid *grid, RoamSeams *out) {
    size_t most = 4 * (size_t)grid->count;
    *out = (RoamSeams){.borders = malloc(most * sizeof *out->borders), .corners = malloc(most * sizeof *out->corners)};
    if (!out->borders || !out->corners) {
        log_error("roam: not enough memory for the borders of %d squares", grid->count);
        roam_seams_destroy(out);
        return RESULT_MEMORY;
    }
    for (int32_t i = 0; i < grid->count; i++) {
        add_borders(grid, i, out);
        add_corners(grid, i, out);
    }
    return RESULT_OK;
}

void roam_seams_destroy(RoamSeams *seams) {
    free(seams->borders);
    free(seams->corners);
    *seams = (RoamSeams){0};
}

static bool is_on_cut(const RoamCorner *corner, const RoamDrawn *drawn) {
    int first = -1;
    for (int i = 0; i < 4; i++) {
        if (corner->squares[i] < 0)
            continue;
        int partition = drawn[corner->squares[i]].partition;
        if (first >= 0 && partition != first)
            return true;
        first = partition;
    }
    return false;
}

int64_t roam_seams_count(const RoamSeams *seams, const RoamDrawn *drawn) {
    int64_t count = 0;
    for (int32_t i = 0; i < seams->border_count; i++) {
        const RoamBorder *b = &seams->borders[i];
        if (drawn[b->square].partition != drawn[b->across].partition)
            count += drawn[b->square].shape.sides[b->side];
    }
    for (int32_t i = 0; i < seams->corner_count; i++)
        count += is_on_cut(&seams->corners[i], drawn);
    return count;
}
