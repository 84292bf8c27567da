// terrain/geomipmap/geomip_error.c: de Boer 2000: the error of a level is the largest vertical distance of a sample
// from its mesh, found once. Our own: errors that bound: what a coarser neighbour's border displaces is measured as
// well, and to the difference of heights come bounds for the curvature of the map, the turning of the vertical, and
// rounding, as in terrain/errors/error_total.c.
#include "terrain/geomipmap/geomip_error.h"

#include "terrain/geodesy.h"
#include "terrain/geomipmap/geomip_zip.h"
#include "terrain/terrain_parts.h"

#include <float.h>
#include <math.h>

// A morphed vertex is the rounded mean of rounded means of rounded positions, each within sqrt(3)/2 lattice units.
#define LATTICE_SLACK_M (4.0 * 0.8661 / GRID_LATTICE_PER_M)
#define HEIGHT_SLACK (4.0 * FLT_EPSILON) // roundings of float heights
#define GROW 1.0001                      // covers the rounding of a term to float
// Between two levels the morph needs room, or it would be a jump; Ye, Wang's errors are assumed to differ.
#define RATIO_MIN 1.25f
#define STRIP_RATIO_MIN 1.05f

float geomip_error_highest(const float *height_m, size_t count) {
    float most = 0.0f;
    for (size_t i = 0; i < count; i++) {
        float h = fabsf(height_m[i]);
        most = h > most ? h : most;
    }
    return most;
}

// A tile's heights seen from one side: sample (t, depth) is at origin[t * step_t + depth * step_depth].
typedef struct Side {
    const float *origin;
    ptrdiff_t step_t, step_depth;
    int cells;
} Side;

static double height_at(const Side *s, int t, int depth) {
    return (double)s->origin[t * s->step_t + depth * s->step_depth];
}

static Side side_of(const Dem *dem, const ForestTile *square, int side) {
    int col, row, col_t, row_t, col_d, row_d;
    geomip_turn(square->side, side, 0, 0, &col, &row);
    geomip_turn(square->side, side, 1, 0, &col_t, &row_t);
    geomip_turn(square->side, side, 0, 1, &col_d, &row_d);
    ptrdiff_t width = dem->width;
    return (Side){.origin = dem->height_m + (square->row + row) * width + square->col + col,
                  .step_t = (row_t - row) * width + col_t - col,
                  .step_depth = (row_d - row) * width + col_d - col,
                  .cells = square->side};
}

// ---- regular cells ----

typedef struct Corners { // heights at (t, depth), (t + s, depth), (t, depth + s), (t + s, depth + s)
    double a, b, c, d;
} Corners;

// The largest deviation in the cell of side `s` at (t, depth) from its two triangles; rising: split from c to b.
static double cell_deviation(const Side *side, int t, int depth, int s, const Corners *q, bool rising) {
    double scale = 1.0 / s, most = 0.0;
    for (int y = 0; y <= s; y++) {
        for (int x = 0; x <= s; x++) {
            double u = x * scale, v = y * scale, plane;
            if (rising)
                plane = x + y <= s ? q->a + (q->b - q->a) * u + (q->c - q->a) * v
                                   : q->d + (q->c - q->d) * (1.0 - u) + (q->b - q->d) * (1.0 - v);
            else
                plane = x >= y ? q->a + (q->b - q->a) * u + (q->d - q->b) * v
                               : q->a + (q->d - q->c) * u + (q->c - q->a) * v;
            double off = fabs(height_at(side, t + x, depth + y) - plane);
            most = off > most ? off : most;
        }
    }
    return most;
}

static Corners corners_of(const Side *side, int t, int depth, int s) {
    return (Corners){height_at(side, t, depth), height_at(side, t + s, depth), height_at(side, t, depth + s),
                     height_at(side, t + s, depth + s)};
}

// `north`: the tile from its north side, so that t and depth are its columns and rows.
static double level_deviation(const Side *north, const ForestTile *square, int s) {
    double most = 0.0;
    for (int row = 0; row < square->side; row += s) {
        for (int col = 0; col < square->side; col += s) {
            Corners q = corners_of(north, col, row, s);
            most = fmax(most, cell_deviation(north, col, row, s, &q,
                                             geomip_is_rising(square->col + col, square->row + row, s)));
        }
    }
    return most;
}

// ---- strips along a side ----

// The border's height at t where it has a vertex every `border` samples only.
static double line_height(const Side *side, int t, int border) {
    int begin = t / border * border, rest = t - begin;
    double h = height_at(side, begin, 0);
    return rest ? h + (height_at(side, begin + border, 0) - h) * rest / border : h;
}

// Ye's strip: the level's cells, their border vertices on the coarser line. Of a corner cell the half at the other side
// has no vertex that moves.
static double fanned_deviation(const Side *side, int s, int border) {
    double most = 0.0;
    for (int t = 0; t < side->cells; t += s) {
        Corners q = corners_of(side, t, 0, s);
        q.a = line_height(side, t, border);
        q.b = line_height(side, t + s, border);
        most = fmax(most, cell_deviation(side, t, 0, s, &q, t / s & 1));
    }
    return most;
}

typedef struct Corner {
    int t, depth;
    double h;
} Corner;

static int cross(const Corner *a, const Corner *b, int t, int depth) {
    return (b->t - a->t) * (depth - a->depth) - (b->depth - a->depth) * (t - a->t);
}

// Counter-clockwise or clockwise, but not flat.
static double triangle_deviation(const Side *side, const Corner *a, const Corner *b, const Corner *c, int s) {
    int area = cross(a, b, c->t, c->depth), sign = area < 0 ? -1 : 1;
    int first = a->t < b->t ? a->t : b->t, last = a->t > b->t ? a->t : b->t;
    first = c->t < first ? c->t : first;
    last = c->t > last ? c->t : last;
    double most = 0.0;
    for (int depth = 0; depth <= s; depth++) {
        for (int t = first; t <= last; t++) {
            int wa = sign * cross(b, c, t, depth), wb = sign * cross(c, a, t, depth), wc = sign * cross(a, b, t, depth);
            if (wa < 0 || wb < 0 || wc < 0)
                continue;
            double plane = (wa * a->h + wb * b->h + wc * c->h) / (sign * area);
            most = fmax(most, fabs(height_at(side, t, depth) - plane));
        }
    }
    return most;
}

// De Boer's strip: the border vertices in between are omitted.
static double omitted_deviation(const Side *side, int s, int border) {
    int16_t outer[GEOMIP_ZIP_MAX];
    GeomipZip zip[GEOMIP_ZIP_MAX];
    int outer_count = 0;
    for (int t = 0; t <= side->cells; t += border)
        outer[outer_count++] = (int16_t)t;
    int count = geomip_zip(outer, outer_count, side->cells, s, zip);
    double most = 0.0;
    for (int i = 0; i < count; i++) {
        int at = outer[zip[i].at], third = zip[i].outer ? outer[zip[i].at + 1] : zip[i].t + s;
        int depth = zip[i].outer ? 0 : s;
        Corner a = {at, 0, height_at(side, at, 0)}, b = {zip[i].t, s, height_at(side, zip[i].t, s)};
        Corner c = {third, depth, height_at(side, third, depth)};
        most = fmax(most, triangle_deviation(side, &a, &b, &c, s));
    }
    return most;
}

// ---- bounds ----

// What differences of heights leave out. All vertices that a sample's place is interpolated from lie within a circle of
// squared radius (4^level + 4^border) / 4 cells.
typedef struct Terms {
    double bend_m, across_m; // grid_bounds: curvature; the longer side of a cell
    double range_m, slack_m; // of heights in the tile; of rounding
} Terms;

static Terms terms_of(const GeomipTiles *tiles, const ForestTile *square, float highest_m) {
    const Dem *dem = tiles->terrain->dem;
    Side north = side_of(dem, square, GEOMIP_NORTH);
    double low = INFINITY, high = -INFINITY;
    for (int row = 0; row <= square->side; row++) {
        for (int col = 0; col <= square->side; col++) {
            low = fmin(low, height_at(&north, col, row));
            high = fmax(high, height_at(&north, col, row));
        }
    }
    GridBounds bounds = grid_bounds(tiles->terrain->grid, square->row, square->row + square->side, (double)highest_m);
    return (Terms){.bend_m = bounds.bend_m,
                   .across_m = fmax(bounds.across_m, bounds.down_m),
                   .range_m = high - low,
                   .slack_m = (double)highest_m * HEIGHT_SLACK + LATTICE_SLACK_M};
}

static double bound_of(const Terms *terms, double deviation_m, int level, int border) {
    double cells2 = ldexp(1.0, 2 * level) + ldexp(1.0, 2 * border);
    double sag = terms->bend_m * cells2 / 8.0;
    double drift = 0.5 * terms->range_m * terms->across_m * sqrt(cells2) / (GEODESY_B_M * (1.0 - GEODESY_E2));
    return GROW * (deviation_m + sag + drift) + terms->slack_m;
}

static float rounded_up(double value) {
    float rounded = (float)value;
    return (double)rounded < value ? nextafterf(rounded, INFINITY) : rounded;
}

static float *strip_of(GeomipTiles *tiles, int32_t tile, int side) {
    size_t n = (size_t)tiles->levels;
    return tiles->strip + ((size_t)tile * GEOMIP_SIDES + (size_t)side) * n * n;
}

// By how much at least errors grow where Ye's tiles morph: were two the same, a level would jump from one to the other.
static float ratio_of(const GeomipInput *input, float ratio) {
    return input->border == GEOMIP_FANNED ? ratio : 1.0f;
}

// The entries of one level: at least as large as those of finer levels and finer borders; the first is the level's own.
static void fill_strip(GeomipTiles *tiles, const GeomipInput *input, const Terms *terms, int32_t tile, int side,
                       int level) {
    Side seen = side_of(tiles->terrain->dem, &tiles->squares.squares[tile], side);
    int n = tiles->levels, last = tiles->tiles[tile].log_side;
    float *row = strip_of(tiles, tile, side) + level * n;
    float grow = ratio_of(input, STRIP_RATIO_MIN);
    row[level] = geomip_delta(tiles, tile, level);
    for (int border = level + 1; border <= last; border++) {
        double off = input->border == GEOMIP_FANNED ? fanned_deviation(&seen, 1 << level, 1 << border)
                                                    : omitted_deviation(&seen, 1 << level, 1 << border);
        float bound = fmaxf(rounded_up(bound_of(terms, off, level, border)), grow * row[border - 1]);
        row[border] = level ? fmaxf(bound, grow * row[border - n]) : bound;
    }
}

// A level's own bound, from its deviation: no smaller than anything that a finer level has on its sides.
static float own_bound(const GeomipTiles *tiles, const GeomipInput *input, const Terms *terms, int32_t tile,
                       int level) {
    float deviation = geomip_delta(tiles, tile, level), finer = geomip_delta(tiles, tile, level - 1);
    float bound = rounded_up(bound_of(terms, (double)deviation, level, level));
    for (int side = 0; side < GEOMIP_SIDES; side++)
        bound = fmaxf(bound, ratio_of(input, STRIP_RATIO_MIN) * geomip_strip(tiles, tile, side, level - 1, level));
    return fmaxf(bound, ratio_of(input, RATIO_MIN) * finer);
}

static void fill_bounds(GeomipTiles *tiles, const GeomipInput *input, float highest_m, int32_t tile) {
    Terms terms = terms_of(tiles, &tiles->squares.squares[tile], highest_m);
    float *delta = tiles->delta + (size_t)tile * (size_t)tiles->levels;
    for (int level = 0; level <= tiles->tiles[tile].log_side; level++) {
        delta[level] = level ? own_bound(tiles, input, &terms, tile, level) : rounded_up(terms.slack_m);
        for (int side = 0; side < GEOMIP_SIDES; side++)
            fill_strip(tiles, input, &terms, tile, side, level);
    }
}

// Ye's morph runs between errors that grow; where they do not, the coarser level is used a little later.
static void spread(float *delta, int last) {
    for (int level = 1; level <= last; level++)
        delta[level] = fmaxf(delta[level], RATIO_MIN * delta[level - 1]);
}

void geomip_error_fill(GeomipTiles *tiles, const GeomipInput *input, float highest_m, int32_t tile) {
    const ForestTile *square = &tiles->squares.squares[tile];
    Side north = side_of(tiles->terrain->dem, square, GEOMIP_NORTH);
    float *delta = tiles->delta + (size_t)tile * (size_t)tiles->levels;
    int last = tiles->tiles[tile].log_side;
    for (int level = 1; level <= last; level++)
        delta[level] = rounded_up(level_deviation(&north, square, 1 << level));
    for (int level = last + 1; level < tiles->levels; level++)
        delta[level] = INFINITY;
    if (input->bounds)
        fill_bounds(tiles, input, highest_m, tile);
    else if (input->border == GEOMIP_FANNED)
        spread(delta, last);
}
