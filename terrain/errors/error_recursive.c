// The papers' baseline ("rpcs" of Loeffler et al. 2010, table 1): the bintree of each base tile is traversed triangle
// by triangle. One traversal that takes the maximum over a triangle's own children is not nested, since a diamond's two
// triangles are visited apart; so there is one traversal for each level, finest first, and each visit takes the whole
// diamond.
#include "terrain/errors/error_rows.h"

typedef struct Corner {
    int32_t col, row;
} Corner;

typedef struct Walk {
    const ErrorWork *work;
    ErrorField *field;
} Walk;

static bool inside(const ErrorWork *work, Corner c) {
    return c.col >= 0 && c.row >= 0 && c.col < work->width && c.row < work->height;
}

static float height_at(const ErrorWork *work, Corner c) {
    return error_height_row(work, c.row)[c.col];
}

static Corner middle(Corner a, Corner b) {
    return (Corner){(a.col + b.col) / 2, (a.row + b.row) / 2};
}

// Neighbours one hypotenuse apart lie at odd sums where the DEM ends; the middle of such a pair is outside it too.
static Corner child_of(Corner end, Corner apex) {
    return (Corner){(end.col + apex.col) >> 1, (end.row + apex.row) >> 1};
}

static void fold_child(const Walk *walk, Corner m, Corner child, float reach2, ErrorCodes *most) {
    if (!inside(walk->work, child))
        return;
    ErrorCodes codes = error_field_at(walk->field, child.col, child.row);
    float reach = error_reach(height_at(walk->work, m), height_at(walk->work, child), reach2, codes.radius);
    uint16_t code = error_field_encode(reach);
    most->delta = codes.delta > most->delta ? codes.delta : most->delta;
    most->radius = code > most->radius ? code : most->radius;
}

static float height_or(const ErrorWork *work, Corner c, float otherwise) {
    return inside(work, c) ? height_at(work, c) : otherwise;
}

// What the diamond adds to its children's errors where it is not looked at.
static uint16_t bound_diamond(const ErrorWork *work, Corner left, Corner right, Corner apex, const ErrorTerms *terms,
                              bool centre, uint16_t children) {
    Corner opposite = {left.col + right.col - apex.col, left.row + right.row - apex.row};
    float h = height_at(work, middle(left, right)), a = height_at(work, left), b = height_at(work, right);
    float range = error_range(a, b, height_or(work, apex, h), height_or(work, opposite, h));
    return error_bound(error_midpoint(h, a, b), children, range, centre ? terms->centre_drift : terms->edge_drift,
                       centre ? terms->centre_sag : terms->edge_sag);
}

static void visit_diamond(const Walk *walk, Corner left, Corner right, Corner apex) {
    const ErrorWork *work = walk->work;
    Corner m = middle(left, right);
    int k = __builtin_ctz((unsigned)(m.col | m.row));
    ErrorPlane *plane = &walk->field->planes[k];
    size_t at = (size_t)(m.row >> k) * plane->stride + (size_t)(m.col >> k);
    const ErrorTerms *terms = &work->terms[k][m.row >> k];
    bool centre = (m.col >> k) & (m.row >> k) & 1;
    ErrorCodes most = {0, 0};
    uint16_t own = plane->delta[at];
    if (work->input->kind == TERRAIN_ERROR_MIDPOINT) {
        float error = error_midpoint(height_at(work, m), height_at(work, left), height_at(work, right));
        uint16_t code = error_field_encode(error + (centre ? terms->centre_sag : terms->edge_sag));
        own = code > own ? code : own;
    }
    if (k > 0 || centre) {
        float reach2 = centre ? terms->centre_reach2 : terms->edge_reach2;
        Corner opposite = {left.col + right.col - apex.col, left.row + right.row - apex.row};
        fold_child(walk, m, child_of(left, apex), reach2, &most);
        fold_child(walk, m, child_of(right, apex), reach2, &most);
        fold_child(walk, m, child_of(left, opposite), reach2, &most);
        fold_child(walk, m, child_of(right, opposite), reach2, &most);
    }
    if (error_is_bounded(work->input, plane->step) && own != ERROR_FIELD_ALWAYS)
        own = bound_diamond(work, left, right, apex, terms, centre, most.delta);
    most.delta = own > most.delta ? own : most.delta;
    plane->delta[at] = most.delta;
    plane->radius[at] = most.delta == ERROR_FIELD_ALWAYS ? 0 : most.radius;
}

static void descend(const Walk *walk, Corner left, Corner right, Corner apex, int levels) {
    if (levels == 0) {
        visit_diamond(walk, left, right, apex);
        return;
    }
    Corner m = middle(left, right);
    descend(walk, apex, left, m, levels - 1);
    descend(walk, right, apex, m, levels - 1);
}

// `level` counts from the tile's root: 0 is its centre.
static void visit_tile(const Walk *walk, const ForestTile *tile, int level) {
    Corner nw = {tile->col, tile->row}, se = {tile->col + tile->side, tile->row + tile->side};
    Corner ne = {se.col, nw.row}, sw = {nw.col, se.row};
    bool rising = (tile->col / tile->side + tile->row / tile->side) & 1;
    if (rising) {
        descend(walk, ne, sw, nw, level);
        descend(walk, sw, ne, se, level);
    } else {
        descend(walk, nw, se, sw, level);
        descend(walk, se, nw, ne, level);
    }
}

Result error_nest_recursive(const ErrorWork *work, ErrorField *field) {
    Walk walk = {work, field};
    const Forest *forest = work->input->forest;
    for (int k = 0; k < field->plane_count; k++) {
        for (int centre = 0; centre <= 1; centre++) {
            for (int32_t i = 0; i < forest->tile_count; i++) {
                int log_side = __builtin_ctz((unsigned)forest->tiles[i].side);
                int level = 2 * (log_side - 1 - k) + 1 - centre;
                if (log_side > k)
                    visit_tile(&walk, &forest->tiles[i], level);
            }
        }
    }
    return RESULT_OK;
}
