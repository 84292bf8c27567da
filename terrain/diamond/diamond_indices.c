// Yalcin, Weiss, De Floriani 2011, section 8: a triangle for each split parent of a diamond that is not split; super-
// squares that are split throughout have none, but at the finest level. Our own: exact counts first, so that the
// triangles are packed and no degenerate one is needed; at the rim of the DEM only what lies inside.
#include "terrain/diamond/diamond_internal.h"
#include "terrain/diamond/diamond_rules.h"

#include "base/log.h"

#include <stdlib.h>
#include <string.h>

typedef struct Generation {
    const DiamondModel *model;
    const uint32_t *bits;
    int plane;
    size_t *counts;    // [rows of super-squares, of all planes, and one]: indices, then where they begin
    size_t row_first;  // of this plane
    uint32_t *indices; // NULL: count only
} Generation;

static uint32_t word_at(const Generation *g, int64_t i, int64_t j) {
    const DiamondLayout *layout = &g->model->layout;
    if (i < 0 || j < 0)
        return 0;
    return g->bits[layout->offset[g->plane] + (uint32_t)j * layout->across[g->plane] + (uint32_t)i];
}

static bool is_split(const Generation *g, DiamondPoint v) {
    if (!diamond_is_inside(&g->model->layout, v))
        return false;
    DiamondPlace place = diamond_place(&g->model->layout, v.col, v.row);
    return place.plane >= g->model->layout.level_count || g->bits[place.word] >> place.bit & 1;
}

// Which diamonds of a super-square have their first (west or north) and second parent split.
typedef struct Parents {
    uint32_t first, second;
} Parents;

static uint32_t moved(uint32_t word, int from, int to) {
    return (word >> from & 1) << to;
}

static Parents edge_parents(uint32_t own, uint32_t west, uint32_t north) {
    return (Parents){moved(north, 13, 1) | moved(north, 15, 3) | moved(own, 5, 9) | moved(own, 7, 11) |
                         moved(west, 7, 4) | moved(own, 5, 6) | moved(west, 15, 12) | moved(own, 13, 14),
                     moved(own, 5, 1) | moved(own, 7, 3) | moved(own, 13, 9) | moved(own, 15, 11) | moved(own, 5, 4) |
                         moved(own, 7, 6) | moved(own, 13, 12) | moved(own, 15, 14)};
}

// The midpoints of the sides of a square around super-square (i, j) that are split: north, west, east, south. They are
// in the next plane: in the super-square whose quarter this one is, and in those to its east and south.
typedef struct Sides {
    uint32_t north, west, east, south;
} Sides;

static Sides sides_in_next_plane(const Generation *g, uint32_t i, uint32_t j) {
    const DiamondLayout *layout = &g->model->layout;
    uint32_t across = layout->across[g->plane + 1], down = layout->down[g->plane + 1];
    const uint32_t *own = g->bits + layout->offset[g->plane + 1] + (size_t)(j >> 1) * across + (i >> 1);
    int at = (int)(8 * (j & 1) + 2 * (i & 1)); // the quarter's first bit
    Sides sides = {.north = *own >> (at + 1) & 1, .west = *own >> (at + 4) & 1};
    if (i & 1)
        sides.east = (i >> 1) + 1 < across ? own[1] >> (at + 2) & 1 : 0;
    else
        sides.east = *own >> (at + 6) & 1;
    if (j & 1)
        sides.south = (j >> 1) + 1 < down ? own[across] >> (at - 7) & 1 : 0;
    else
        sides.south = *own >> (at + 9) & 1;
    return sides;
}

static Sides sides_at_the_top(const Generation *g, uint32_t i, uint32_t j) {
    int s = 1 << g->plane;
    DiamondPoint nw = {(int32_t)(4 * i) << g->plane, (int32_t)(4 * j) << g->plane};
    return (Sides){.north = is_split(g, (DiamondPoint){nw.col + 2 * s, nw.row}),
                   .west = is_split(g, (DiamondPoint){nw.col, nw.row + 2 * s}),
                   .east = is_split(g, (DiamondPoint){nw.col + 4 * s, nw.row + 2 * s}),
                   .south = is_split(g, (DiamondPoint){nw.col + 2 * s, nw.row + 4 * s})};
}

static Parents centre_parents(const Generation *g, uint32_t i, uint32_t j) {
    bool top = g->plane + 1 == g->model->layout.level_count;
    Sides s = top ? sides_at_the_top(g, i, j) : sides_in_next_plane(g, i, j);
    return (Parents){s.west << 5 | s.north << 7 | s.west << 13 | s.south << 15,
                     s.north << 5 | s.east << 7 | s.south << 13 | s.east << 15};
}

static uint32_t *put_triangle(const Generation *g, uint32_t *out, DiamondPoint a, DiamondPoint b, DiamondPoint c) {
    const DiamondLayout *layout = &g->model->layout;
    int64_t turn = (int64_t)(b.col - a.col) * (c.row - a.row) - (int64_t)(b.row - a.row) * (c.col - a.col);
    out[0] = (uint32_t)diamond_sample(layout, a);
    out[1] = (uint32_t)diamond_sample(layout, turn < 0 ? b : c); // rows run south
    out[2] = (uint32_t)diamond_sample(layout, turn < 0 ? c : b);
    return out + 3;
}

// The halves of a split edge diamond of the finest plane: one in each of the four cells around its vertex.
static size_t put_halves(const Generation *g, DiamondPoint v, uint32_t *out) {
    static const int8_t quarters[4][4] = {{1, 0, 0, -1}, {0, -1, -1, 0}, {-1, 0, 0, 1}, {0, 1, 1, 0}};
    size_t count = 0;
    for (int i = 0; i < 4; i++) {
        DiamondPoint a = {v.col + quarters[i][0], v.row + quarters[i][1]};
        DiamondPoint b = {v.col + quarters[i][2], v.row + quarters[i][3]};
        if (!diamond_is_inside(&g->model->layout, a) || !diamond_is_inside(&g->model->layout, b))
            continue;
        if (out)
            put_triangle(g, out + count, v, a, b);
        count += 3;
    }
    return count;
}

// Indices of one diamond; `out` NULL: only counted.
static size_t put_diamond(const Generation *g, DiamondPoint v, int slot, bool first, bool second, uint32_t *out) {
    if (out) {
        DiamondCorners c = diamond_corners(slot, v, 1 << g->plane);
        if (first)
            out = put_triangle(g, out, c.ends[0], c.ends[1], c.parents[0]);
        if (second)
            put_triangle(g, out, c.ends[0], c.ends[1], c.parents[1]);
    }
    return 3 * ((size_t)first + (size_t)second);
}

// Nothing is split in the super-square, nor where its diamonds have their parents.
static bool is_idle(const Generation *g, uint32_t i, uint32_t j, uint32_t own, uint32_t west, uint32_t north) {
    const DiamondLayout *layout = &g->model->layout;
    if ((own | west | north) || g->plane + 1 == layout->level_count)
        return false;
    uint32_t across = layout->across[g->plane + 1], down = layout->down[g->plane + 1];
    const uint32_t *next = g->bits + layout->offset[g->plane + 1] + (size_t)(j >> 1) * across + (i >> 1);
    uint32_t east = (i >> 1) + 1 < across ? next[1] : 0, south = (j >> 1) + 1 < down ? next[across] : 0;
    return !(*next | east | south);
}

static size_t put_word(const Generation *g, uint32_t i, uint32_t j, uint32_t *out) {
    const DiamondLayout *layout = &g->model->layout;
    uint32_t word = layout->offset[g->plane] + j * layout->across[g->plane] + i;
    uint32_t own = g->bits[word], west = word_at(g, (int64_t)i - 1, j), north = word_at(g, i, (int64_t)j - 1);
    if (is_idle(g, i, j, own, west, north))
        return 0;
    uint32_t whole = g->model->valid[word] & ~own;
    uint32_t halved = g->plane == 0 ? own & DIAMOND_EDGES : 0;
    if (!whole && !halved)
        return 0;
    Parents edges = edge_parents(own, west, north);
    Parents centres = whole & DIAMOND_CENTRES ? centre_parents(g, i, j) : (Parents){0, 0};
    uint32_t first = whole & (edges.first | centres.first), second = whole & (edges.second | centres.second);
    if (!out && !halved)
        return 3 * (size_t)(diamond_popcount(first) + diamond_popcount(second));
    size_t count = 0;
    for (int slot = 0; slot < DIAMOND_SLOTS && (first | second | halved); slot++) {
        int bit = diamond_slot_bit(slot);
        DiamondPoint v = diamond_vertex(g->plane, i, j, slot);
        count += put_diamond(g, v, slot, first >> bit & 1, second >> bit & 1, out ? out + count : NULL);
        if (halved >> bit & 1)
            count += put_halves(g, v, out ? out + count : NULL);
    }
    return count;
}

static void generate_task(void *user, int64_t begin, int64_t end, int worker) {
    const Generation *g = user;
    (void)worker;
    for (int64_t j = begin; j < end; j++) {
        size_t *here = &g->counts[g->row_first + (size_t)j], count = 0;
        if (g->indices && here[0] == here[1]) // no triangles
            continue;
        for (uint32_t i = 0; i < g->model->layout.across[g->plane]; i++)
            count += put_word(g, i, (uint32_t)j, g->indices ? g->indices + *here + count : NULL);
        if (!g->indices)
            *here = count;
    }
}

static void run_planes(Generation *g, Jobs *jobs) {
    g->row_first = 0;
    for (g->plane = 0; g->plane < g->model->layout.level_count; g->plane++) {
        diamond_run_rows(jobs, &g->model->layout, g->plane, generate_task, g);
        g->row_first += g->model->layout.down[g->plane];
    }
}

static size_t begins_of_counts(size_t *counts, size_t rows) {
    size_t sum = 0;
    for (size_t i = 0; i < rows; i++) {
        size_t count = counts[i];
        counts[i] = sum;
        sum += count;
    }
    counts[rows] = sum;
    return sum;
}

static bool make_room(DiamondIndices *out, size_t count) {
    if (count <= out->capacity)
        return true;
    uint32_t *grown = realloc(out->indices, sizeof *grown * count);
    if (!grown)
        return false;
    out->indices = grown;
    out->capacity = count;
    return true;
}

Result diamond_generate_indices(const DiamondModel *model, const uint32_t *bits, Jobs *jobs, DiamondIndices *out) {
    size_t rows = 0;
    for (int k = 0; k < model->layout.level_count; k++)
        rows += model->layout.down[k];
    Generation g = {.model = model, .bits = bits, .counts = malloc(sizeof *g.counts * (rows + 1))};
    if (!g.counts)
        goto fail;
    run_planes(&g, jobs);
    size_t count = begins_of_counts(g.counts, rows);
    if (!make_room(out, count))
        goto fail;
    g.indices = out->indices;
    out->count = count;
    run_planes(&g, jobs);
    free(g.counts);
    return RESULT_OK;
fail:
    free(g.counts);
    log_error("diamonds: not enough memory for the indices of %d x %d samples", model->layout.width,
              model->layout.height);
    return RESULT_MEMORY;
}

void diamond_indices_destroy(DiamondIndices *indices) {
    free(indices->indices);
    *indices = (DiamondIndices){0};
}
