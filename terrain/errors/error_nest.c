// The level-parallel scheme: plane by plane, finest first; within a plane first all edge midpoints, whose children are
// the centres of the finer plane, then all centres, whose children are edge midpoints of the same plane.
// Rows are worked on whole, in vectors: half the lanes of a row belong to the other kind of vertex and are masked out.
#include "terrain/errors/error_rows.h"

#include <stdlib.h>
#include <string.h>

#define BLOCK_ROWS 16 // even
#define ROW_PAD 16    // entries before and after each row buffer

typedef uint32_t __attribute__((may_alias)) Pair; // two neighbouring 16-bit codes

// The heights of one plane's vertices. The finest plane's are the samples themselves; the others are packed, so that
// every row is contiguous, with a pad on both sides.
typedef struct Heights {
    const float *entries;
    size_t stride;
    int width, height;
} Heights;

typedef struct Rows {            // one worker's buffers, each ROW_PAD + width + ROW_PAD long; pointers are past the pad
    float *above, *here, *below; // copies of border rows, where a neighbour would be read outside the samples
    float *upper, *lower;        // heights of the finer plane's centres, entry i at column (i + 1/2) step
    uint16_t *own;               // codes of own errors
    uint16_t *children, *reach;  // folded codes; 0 in the finest plane, where there are no children
    uint16_t *delta, *radius;    // a copy of a plane row
} Rows;

typedef struct Pass {
    const ErrorWork *work;
    ErrorPlane *plane;
    const ErrorPlane *finer; // NULL for the finest plane
    const Heights *heights, *finer_heights;
    const uint16_t *zero_row;
    const ErrorTerms *terms;
    Rows *rows; // [worker]
} Pass;

// Row j with readable entries -1 and width; what they hold is masked out later.
static const float *height_row(const Heights *heights, int j, float *buffer) {
    const float *row = heights->entries + (size_t)j * heights->stride;
    if (j > 0 && j < heights->height - 1)
        return row;
    memcpy(buffer, row, sizeof *buffer * (size_t)heights->width);
    buffer[-1] = buffer[0];
    buffer[heights->width] = buffer[heights->width - 1];
    return buffer;
}

// Heights of the finer centres on finer row `j`, for entries -1 .. width - 1 of this plane. Where there is no centre
// the neighbour's height stands in: it asks for nothing that the neighbour does not.
static void load_centre_heights(const Heights *finer, int j, int width, float *out) {
    const float *in = finer->entries + (size_t)j * finer->stride;
    for (int i = 0; i < width - 1; i++)
        out[i] = in[2 * i + 1];
    out[width - 1] = 2 * width - 1 < finer->width ? in[2 * width - 1] : in[width > 1 ? 2 * width - 3 : 0];
    out[-1] = out[0];
}

typedef struct Packing {
    const Heights *from, *to;
    float *out;
} Packing;

static void pack_task(void *user, int64_t begin, int64_t end, int worker) {
    const Packing *packing = user;
    (void)worker;
    for (int64_t j = begin; j < end; j++) {
        const float *in = packing->from->entries + (size_t)(2 * j) * packing->from->stride;
        float *out = packing->out + (size_t)j * packing->to->stride;
        for (int i = 0; i < packing->to->width; i++)
            out[i] = in[2 * i];
        out[-1] = out[0];
        out[packing->to->width] = out[packing->to->width - 1];
    }
}

// heights[0] is the samples; the others share one block, which the caller frees.
static Result pack_heights(const ErrorWork *work, Jobs *jobs, const ErrorField *field, Heights *heights,
                           float **block) {
    size_t entries = 2 * ROW_PAD;
    for (int k = 1; k < field->plane_count; k++)
        entries += ((size_t)field->planes[k].width + ROW_PAD) * (size_t)field->planes[k].height;
    float *next = *block = malloc(sizeof *next * entries);
    if (!next)
        return RESULT_MEMORY;
    next += ROW_PAD;
    heights[0] = (Heights){work->input->height_m, (size_t)work->width, work->width, work->height};
    for (int k = 1; k < field->plane_count; k++) {
        const ErrorPlane *plane = &field->planes[k];
        heights[k] = (Heights){next, (size_t)plane->width + ROW_PAD, plane->width, plane->height};
        Packing packing = {&heights[k - 1], &heights[k], next};
        jobs_run(jobs, plane->height, 64, pack_task, &packing);
        next += heights[k].stride * (size_t)plane->height;
    }
    return RESULT_OK;
}

SIMD_CLONES
static void own_horizontal(const float *restrict here, float sag, int width, uint16_t *restrict own) {
    for (int i = 0; i < width; i++)
        own[i] = error_field_encode(error_midpoint(here[i], here[i - 1], here[i + 1]) + sag);
}

SIMD_CLONES
static void own_vertical(const float *restrict above, const float *restrict here, const float *restrict below,
                         float sag, int width, uint16_t *restrict own) {
    for (int i = 0; i < width; i++)
        own[i] = error_field_encode(error_midpoint(here[i], above[i], below[i]) + sag);
}

// Odd entries of row j; the hypotenuse turns with i/2 + j/2.
SIMD_CLONES
static void own_diagonal(const float *restrict above, const float *restrict here, const float *restrict below,
                         float sag, int j, int width, uint16_t *restrict own) {
    int turn = j >> 1;
    for (int i = 0; i < width; i++) {
        float falling = error_midpoint(here[i], above[i - 1], below[i + 1]);
        float rising = error_midpoint(here[i], above[i + 1], below[i - 1]);
        own[i] = error_field_encode((((i >> 1) + turn) & 1 ? rising : falling) + sag);
    }
}

// Where `before` and `after` are the heights at the ends of the hypotenuses, `apex` and `opposite` those across.
SIMD_CLONES
static void bound_edges(const float *restrict here, const float *restrict before, const float *restrict after,
                        const float *restrict apex, const float *restrict opposite, const uint16_t *restrict children,
                        float drift, float sag, int width, uint16_t *restrict own) {
    for (int i = 0; i < width; i++) {
        float range = error_range(before[i], after[i], apex[i], opposite[i]);
        own[i] = error_bound(error_midpoint(here[i], before[i], after[i]), children[i], range, drift, sag);
    }
}

// Odd entries of row j; `children`: the largest of the edge midpoints around.
SIMD_CLONES
static void bound_diagonal(const float *restrict above, const float *restrict here, const float *restrict below,
                           const uint16_t *restrict children, float drift, float sag, int j, int width,
                           uint16_t *restrict own) {
    int turn = j >> 1;
    for (int i = 0; i < width; i++) {
        float falling = error_midpoint(here[i], above[i - 1], below[i + 1]);
        float rising = error_midpoint(here[i], above[i + 1], below[i - 1]);
        float range = error_range(above[i - 1], above[i + 1], below[i - 1], below[i + 1]);
        own[i] = error_bound(((i >> 1) + turn) & 1 ? rising : falling, children[i], range, drift, sag);
    }
}

static inline uint16_t larger(uint16_t a, uint16_t b) {
    return a > b ? a : b;
}

// Edge midpoints: children are the finer plane's centres. `up` and `down` are rows of the finer plane; as pairs of
// entries, pair i holds in its upper half the centre at column (i + 1/2).
SIMD_CLONES
static void fold_centres(const Pair *restrict up, const Pair *restrict down, int width, uint16_t *restrict folded) {
    for (int i = 0; i < width; i++) {
        uint16_t west = larger((uint16_t)(up[i - 1] >> 16), (uint16_t)(down[i - 1] >> 16));
        uint16_t east = larger((uint16_t)(up[i] >> 16), (uint16_t)(down[i] >> 16));
        folded[i] = larger(west, east);
    }
}

SIMD_CLONES
static void reach_centres(const float *restrict here, const float *restrict upper, const float *restrict lower,
                          const Pair *restrict up, const Pair *restrict down, float reach2, int width,
                          uint16_t *restrict reach) {
    for (int i = 0; i < width; i++) {
        float h = here[i];
        float a = error_reach(h, upper[i - 1], reach2, (uint16_t)(up[i - 1] >> 16));
        float b = error_reach(h, upper[i], reach2, (uint16_t)(up[i] >> 16));
        float c = error_reach(h, lower[i - 1], reach2, (uint16_t)(down[i - 1] >> 16));
        float d = error_reach(h, lower[i], reach2, (uint16_t)(down[i] >> 16));
        float ab = a > b ? a : b, cd = c > d ? c : d;
        reach[i] = error_field_encode(ab > cd ? ab : cd);
    }
}

// Centres: children are the edge midpoints above, below, west and east.
SIMD_CLONES
static void fold_edges(const uint16_t *restrict above, const uint16_t *restrict below, const uint16_t *restrict here,
                       int width, uint16_t *restrict folded) {
    for (int i = 0; i < width; i++)
        folded[i] = larger(larger(above[i], below[i]), larger(here[i - 1], here[i + 1]));
}

// Keeps the larger of own and children where (i & 1) == odd; forced entries (already infinite) stay.
SIMD_CLONES
static void store_edges(const uint16_t *restrict own, const uint16_t *restrict children, const uint16_t *restrict reach,
                        int odd, int width, uint16_t *restrict delta, uint16_t *restrict radius) {
    for (int i = 0; i < width; i++) {
        uint16_t mask = (uint16_t) - ((i & 1) == odd);
        uint16_t most = larger(larger(own[i], children[i]), delta[i]);
        delta[i] = (uint16_t)((most & mask) | (delta[i] & (uint16_t)~mask));
        radius[i] = (uint16_t)(reach[i] & mask & (uint16_t) - (most != ERROR_FIELD_ALWAYS));
    }
}

SIMD_CLONES
static void store_centres(const float *restrict above, const float *restrict here, const float *restrict below,
                          const uint16_t *restrict own, const uint16_t *restrict delta_above,
                          const uint16_t *restrict delta_below, const uint16_t *restrict radius_above,
                          const uint16_t *restrict radius_below, const uint16_t *restrict delta_here,
                          const uint16_t *restrict radius_here, float reach2, int width, uint16_t *restrict delta,
                          uint16_t *restrict radius) {
    for (int i = 0; i < width; i++) {
        uint16_t most = larger(larger(delta_above[i], delta_below[i]), larger(delta_here[i - 1], delta_here[i + 1]));
        float h = here[i];
        float a = error_reach(h, above[i], reach2, radius_above[i]);
        float b = error_reach(h, below[i], reach2, radius_below[i]);
        float c = error_reach(h, here[i - 1], reach2, radius_here[i - 1]);
        float d = error_reach(h, here[i + 1], reach2, radius_here[i + 1]);
        float ab = a > b ? a : b, cd = c > d ? c : d;
        uint16_t mask = (uint16_t) - (i & 1);
        most = larger(larger(own[i], most), delta_here[i]);
        uint16_t reach = (uint16_t)(error_field_encode(ab > cd ? ab : cd) & (uint16_t) - (most != ERROR_FIELD_ALWAYS));
        delta[i] = (uint16_t)((most & mask) | (delta_here[i] & (uint16_t)~mask));
        radius[i] = (uint16_t)((reach & mask) | (radius_here[i] & (uint16_t)~mask));
    }
}

static const Pair *pairs(const uint16_t *row) {
    return (const Pair *)__builtin_assume_aligned((const void *)row, 4);
}

static void fold_finer(const Pass *pass, int j, const float *here, Rows *rows) {
    const ErrorPlane *finer = pass->finer;
    int width = pass->plane->width, up = 2 * j - 1, down = 2 * j + 1;
    bool has_up = up >= 0, has_down = down < finer->height;
    size_t stride = finer->stride;
    fold_centres(pairs(has_up ? finer->delta + (size_t)up * stride : pass->zero_row),
                 pairs(has_down ? finer->delta + (size_t)down * stride : pass->zero_row), width, rows->children);
    // Past a border there is no child: the children opposite are taken twice.
    up = has_up ? up : down;
    down = has_down ? down : up;
    load_centre_heights(pass->finer_heights, up, width, rows->upper);
    load_centre_heights(pass->finer_heights, down, width, rows->lower);
    reach_centres(here, rows->upper, rows->lower, pairs(finer->radius + (size_t)up * stride),
                  pairs(finer->radius + (size_t)down * stride), pass->terms[j].edge_reach2, width, rows->reach);
}

// A row whose heights stand in for those of a row that is not there: the midpoints' own.
static const float *row_or(const Heights *heights, int j, float *buffer, const float *otherwise) {
    return j < 0 || j >= heights->height ? otherwise : height_row(heights, j, buffer);
}

static void bound_edge_row(const Pass *pass, int j, const float *here, Rows *rows) {
    const ErrorTerms *terms = &pass->terms[j];
    const float *above = row_or(pass->heights, j - 1, rows->above, here);
    const float *below = row_or(pass->heights, j + 1, rows->below, here);
    const float *west = here - 1, *east = here + 1;
    int width = pass->plane->width;
    if (j & 1)
        bound_edges(here, above, below, west, east, rows->children, terms->edge_drift, terms->edge_sag, width,
                    rows->own);
    else
        bound_edges(here, west, east, above, below, rows->children, terms->edge_drift, terms->edge_sag, width,
                    rows->own);
}

// After the children are folded.
static void edge_own(const Pass *pass, int j, const float *here, Rows *rows) {
    const ErrorPlane *plane = pass->plane;
    int width = plane->width, last = plane->height - 1;
    if (error_is_bounded(pass->work->input, plane->step)) {
        bound_edge_row(pass, j, here, rows);
    } else if (pass->work->input->kind == TERRAIN_ERROR_TOTAL) {
        memcpy(rows->own, plane->delta + (size_t)j * plane->stride, sizeof *rows->own * (size_t)width);
    } else if (j & 1) {
        const float *above = height_row(pass->heights, j - 1, rows->above);
        const float *below = height_row(pass->heights, j < last ? j + 1 : j - 1, rows->below);
        own_vertical(above, here, below, pass->terms[j].edge_sag, width, rows->own);
    } else {
        own_horizontal(here, pass->terms[j].edge_sag, width, rows->own);
    }
}

static void edge_row(const Pass *pass, int j, Rows *rows) {
    ErrorPlane *plane = pass->plane;
    const float *here = height_row(pass->heights, j, rows->here);
    if (pass->finer)
        fold_finer(pass, j, here, rows); // else the folded codes stay 0
    edge_own(pass, j, here, rows);
    size_t at = (size_t)j * plane->stride;
    store_edges(rows->own, rows->children, rows->reach, !(j & 1), plane->width, plane->delta + at, plane->radius + at);
}

// The neighbours' codes are those of the plane, the row's own a copy.
static void centre_own(const Pass *pass, int j, const float *const heights[3], const uint16_t *const codes[2],
                       Rows *rows) {
    const ErrorTerms *terms = &pass->terms[j];
    int width = pass->plane->width;
    if (error_is_bounded(pass->work->input, pass->plane->step)) {
        fold_edges(codes[0], codes[1], rows->delta, width, rows->children);
        bound_diagonal(heights[0], heights[1], heights[2], rows->children, terms->centre_drift, terms->centre_sag, j,
                       width, rows->own);
    } else if (pass->work->input->kind == TERRAIN_ERROR_TOTAL) {
        memset(rows->own, 0, sizeof *rows->own * (size_t)width);
    } else {
        own_diagonal(heights[0], heights[1], heights[2], terms->centre_sag, j, width, rows->own);
    }
}

static void centre_row(const Pass *pass, int j, Rows *rows) {
    ErrorPlane *plane = pass->plane;
    int width = plane->width;
    size_t at = (size_t)j * plane->stride, up = at - plane->stride;
    bool has_below = j + 1 < plane->height;
    size_t down = has_below ? at + plane->stride : up;
    const float *above = height_row(pass->heights, j - 1, rows->above);
    const float *here = height_row(pass->heights, j, rows->here);
    const float *below = height_row(pass->heights, has_below ? j + 1 : j - 1, rows->below);
    // The row is copied: its edge midpoints are read at i - 1 and i + 1 while its centres are written.
    memcpy(rows->delta - 1, plane->delta + at - 1, sizeof *rows->delta * ((size_t)width + 2));
    memcpy(rows->radius - 1, plane->radius + at - 1, sizeof *rows->radius * ((size_t)width + 2));
    const float *const heights[3] = {above, here, below};
    const uint16_t *const codes[2] = {plane->delta + up, plane->delta + down};
    centre_own(pass, j, heights, codes, rows);
    store_centres(above, here, below, rows->own, plane->delta + up, plane->delta + down, plane->radius + up,
                  plane->radius + down, rows->delta, rows->radius, pass->terms[j].centre_reach2, width,
                  plane->delta + at, plane->radius + at);
}

// Rows are worked on in blocks that stay in the cache: first a block's edge midpoints, then those of its centres whose
// rows above and below lie in the block. The last centre row of a block waits for the edge midpoints of the next.
static void block_task(void *user, int64_t begin, int64_t end, int worker) {
    const Pass *pass = user;
    Rows *rows = &pass->rows[worker];
    for (int64_t block = begin; block < end; block++) {
        int first = (int)block * BLOCK_ROWS, last = first + BLOCK_ROWS, height = pass->plane->height;
        if (last > height)
            last = height;
        for (int j = first; j < last; j++)
            edge_row(pass, j, rows);
        for (int j = first + 1; j + 1 < last || (j < last && last == height); j += 2)
            centre_row(pass, j, rows);
    }
}

static void seam_task(void *user, int64_t begin, int64_t end, int worker) {
    const Pass *pass = user;
    for (int64_t block = begin; block < end; block++)
        centre_row(pass, (int)(block + 1) * BLOCK_ROWS - 1, &pass->rows[worker]);
}

static void cut_rows(unsigned char *memory, size_t entries, Rows *rows) {
    float **floats[] = {&rows->above, &rows->here, &rows->below, &rows->upper, &rows->lower};
    uint16_t **shorts[] = {&rows->own, &rows->children, &rows->reach, &rows->delta, &rows->radius};
    for (size_t i = 0; i < COUNT_OF(floats); i++, memory += entries * sizeof(float))
        *floats[i] = (float *)(void *)memory + ROW_PAD;
    for (size_t i = 0; i < COUNT_OF(shorts); i++, memory += entries * sizeof(uint16_t))
        *shorts[i] = (uint16_t *)(void *)memory + ROW_PAD;
}

Result error_nest_parallel(const ErrorWork *work, Jobs *jobs, ErrorField *field) {
    size_t entries = ((size_t)work->width + 2 * ROW_PAD + 31) & ~(size_t)31;
    size_t row_bytes = entries * (5 * sizeof(float) + 5 * sizeof(uint16_t));
    int workers = jobs_worker_count(jobs);
    Heights heights[FOREST_LEVEL_MAX];
    float *packed = NULL;
    unsigned char *memory = calloc((size_t)workers, row_bytes);
    uint16_t *zeros = calloc(entries, sizeof *zeros);
    Rows *rows = calloc((size_t)workers, sizeof *rows);
    Result result = memory && zeros && rows ? pack_heights(work, jobs, field, heights, &packed) : RESULT_MEMORY;
    for (int i = 0; i < workers && result == RESULT_OK; i++)
        cut_rows(memory + (size_t)i * row_bytes, entries, &rows[i]);
    for (int k = 0; k < field->plane_count && result == RESULT_OK; k++) {
        Pass pass = {.work = work, .plane = &field->planes[k], .heights = &heights[k]};
        pass.finer = k ? &field->planes[k - 1] : NULL;
        pass.finer_heights = k ? &heights[k - 1] : NULL;
        pass.zero_row = zeros + ROW_PAD;
        pass.terms = work->terms[k];
        pass.rows = rows;
        int blocks = (pass.plane->height + BLOCK_ROWS - 1) / BLOCK_ROWS;
        jobs_run(jobs, blocks, 1, block_task, &pass);
        jobs_run(jobs, blocks - 1, 4, seam_task, &pass);
    }
    free(packed);
    free(rows);
    free(zeros);
    free(memory);
    return result;
}
