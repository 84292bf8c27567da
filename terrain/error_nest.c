// The level-parallel scheme: plane by plane, finest first; within a plane first all edge midpoints, whose children are
// the centres of the finer plane, then all centres, whose children are edge midpoints of the same plane.
// Rows are worked on whole, in vectors: half the lanes of a row belong to the other kind of vertex and are masked out.
#include "terrain/error_rows.h"

#include <stdlib.h>
#include <string.h>

#define ROWS_AT_A_TIME 16
#define ROW_PAD 16 // entries before and after each row buffer

typedef uint32_t __attribute__((may_alias)) Pair; // two neighbouring 16-bit codes

typedef struct Rows { // one worker's buffers, each ROW_PAD + width + ROW_PAD long; pointers are past the pad
    float *above, *here, *below;     // heights of the plane's rows j - 1, j, j + 1
    float *upper, *lower;            // heights of the finer plane's centres, entry i at column (i + 1/2) step
    uint16_t *own;                   // codes of own errors
    uint16_t *children, *reach;      // folded codes
} Rows;

typedef struct Pass {
    const ErrorWork *work;
    ErrorPlane *plane;
    const ErrorPlane *finer; // NULL for the finest plane
    const uint16_t *zero_row;
    const ErrorTerms *terms;
    Rows *rows; // [worker]
} Pass;

static void load_heights(const Pass *pass, int j, float *out) {
    int step = pass->plane->step, width = pass->plane->width;
    int rows = pass->plane->height;
    const float *in = error_height_row(pass->work, (j < 0 ? 0 : j >= rows ? rows - 1 : j) * step);
    if (step == 1)
        memcpy(out, in, sizeof *out * (size_t)width);
    else
        for (int i = 0; i < width; i++)
            out[i] = in[(size_t)i * (size_t)step];
    out[-1] = out[0];
    out[width] = out[width - 1];
}

// Heights of the finer centres on sample row `row`, columns (i + 1/2) step for i in -1 .. width - 1.
static void load_centre_heights(const Pass *pass, int row, float *out) {
    int step = pass->plane->step, width = pass->plane->width;
    int last = pass->work->height - 1;
    const float *in = error_height_row(pass->work, row < 0 ? 0 : row > last ? last : row) + step / 2;
    for (int i = 0; i < width - 1; i++)
        out[i] = in[(size_t)i * (size_t)step];
    out[width - 1] = width > 1 ? out[width - 2] : in[-(step / 2)];
    if ((width - 1) * step + step / 2 < pass->work->width)
        out[width - 1] = in[(size_t)(width - 1) * (size_t)step];
    out[-1] = out[0];
}

SIMD_CLONES
static void own_horizontal(const float *restrict here, float sag, int width, uint16_t *restrict own) {
    for (int i = 0; i < width; i++)
        own[i] = error_field_encode(error_midpoint(here[i], here[i - 1], here[i + 1]) + sag);
}

SIMD_CLONES
static void own_vertical(const float *restrict above, const float *restrict here, const float *restrict below, float sag,
                         int width, uint16_t *restrict own) {
    for (int i = 0; i < width; i++)
        own[i] = error_field_encode(error_midpoint(here[i], above[i], below[i]) + sag);
}

// Odd entries of row j; the hypotenuse turns with i/2 + j/2.
SIMD_CLONES
static void own_diagonal(const float *restrict above, const float *restrict here, const float *restrict below, float sag,
                         int j, int width, uint16_t *restrict own) {
    int turn = j >> 1;
    for (int i = 0; i < width; i++) {
        float falling = error_midpoint(here[i], above[i - 1], below[i + 1]);
        float rising = error_midpoint(here[i], above[i + 1], below[i - 1]);
        own[i] = error_field_encode((((i >> 1) + turn) & 1 ? rising : falling) + sag);
    }
}

static inline uint16_t larger(uint16_t a, uint16_t b) {
    return a > b ? a : b;
}

// Edge midpoints: children are the finer plane's centres. `up` and `down` are rows of the finer plane; as pairs of entries,
// pair i holds in its upper half the centre at column (i + 1/2).
SIMD_CLONES
static void fold_centres(const Pair *restrict up, const Pair *restrict down, int width,
                         uint16_t *restrict folded) {
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

// Keeps the larger of own and children where (i & 1) == odd; forced entries (already infinite) stay.
SIMD_CLONES
static void store_edges(const uint16_t *restrict own, const uint16_t *restrict children, const uint16_t *restrict reach,
                        int odd, int width, uint16_t *restrict delta, uint16_t *restrict radius) {
    for (int i = 0; i < width; i++) {
        uint16_t mask = (uint16_t)-((i & 1) == odd);
        uint16_t most = larger(larger(own[i], children[i]), delta[i]);
        delta[i] = (uint16_t)((most & mask) | (delta[i] & (uint16_t)~mask));
        radius[i] = (uint16_t)(reach[i] & mask & (uint16_t)-(most != ERROR_FIELD_ALWAYS));
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
        uint16_t mask = (uint16_t)-(i & 1);
        most = larger(larger(own[i], most), delta_here[i]);
        uint16_t reach = (uint16_t)(error_field_encode(ab > cd ? ab : cd) & (uint16_t)-(most != ERROR_FIELD_ALWAYS));
        delta[i] = (uint16_t)((most & mask) | (delta_here[i] & (uint16_t)~mask));
        radius[i] = (uint16_t)((reach & mask) | (radius_here[i] & (uint16_t)~mask));
    }
}

static const Pair *pairs(const uint16_t *row) {
    return (const Pair *)__builtin_assume_aligned((const void *)row, 4);
}

static void fold_finer(const Pass *pass, int j, Rows *rows) {
    const ErrorPlane *finer = pass->finer;
    int width = pass->plane->width, up = 2 * j - 1, down = 2 * j + 1;
    bool has_up = up >= 0, has_down = down < finer->height;
    size_t stride = finer->stride;
    fold_centres(pairs(has_up ? finer->delta + (size_t)up * stride : pass->zero_row),
                 pairs(has_down ? finer->delta + (size_t)down * stride : pass->zero_row), width, rows->children);
    load_centre_heights(pass, up * finer->step, rows->upper);
    load_centre_heights(pass, down * finer->step, rows->lower);
    const uint16_t *radius_up = finer->radius + (size_t)up * stride, *radius_down = finer->radius + (size_t)down * stride;
    // Past a border there is no child: a repeated height asks for nothing that the child opposite does not.
    reach_centres(rows->here, has_up ? rows->upper : rows->lower, has_down ? rows->lower : rows->upper,
                  pairs(has_up ? radius_up : radius_down), pairs(has_down ? radius_down : radius_up),
                  pass->terms[j].edge_reach2, width, rows->reach);
}

static void edge_row(const Pass *pass, int j, Rows *rows) {
    ErrorPlane *plane = pass->plane;
    int width = plane->width;
    bool vertical = j & 1;
    load_heights(pass, j, rows->here);
    if (pass->work->input->kind == TERRAIN_ERROR_TOTAL) {
        memcpy(rows->own, plane->delta + (size_t)j * plane->stride, sizeof *rows->own * (size_t)width);
    } else if (vertical) {
        load_heights(pass, j - 1, rows->above);
        load_heights(pass, j + 1, rows->below);
        own_vertical(rows->above, rows->here, rows->below, pass->terms[j].edge_sag, width, rows->own);
    } else {
        own_horizontal(rows->here, pass->terms[j].edge_sag, width, rows->own);
    }
    if (pass->finer) {
        fold_finer(pass, j, rows);
    } else {
        memset(rows->children, 0, sizeof *rows->children * (size_t)width);
        memset(rows->reach, 0, sizeof *rows->reach * (size_t)width);
    }
    size_t at = (size_t)j * plane->stride;
    store_edges(rows->own, rows->children, rows->reach, !vertical, width, plane->delta + at, plane->radius + at);
}

static void centre_row(const Pass *pass, int j, Rows *rows) {
    ErrorPlane *plane = pass->plane;
    int width = plane->width;
    size_t at = (size_t)j * plane->stride, up = at - plane->stride;
    bool has_below = j + 1 < plane->height;
    size_t down = has_below ? at + plane->stride : up;
    load_heights(pass, j - 1, rows->above);
    load_heights(pass, j, rows->here);
    load_heights(pass, has_below ? j + 1 : j - 1, rows->below);
    if (pass->work->input->kind == TERRAIN_ERROR_TOTAL)
        memset(rows->own, 0, sizeof *rows->own * (size_t)width);
    else
        own_diagonal(rows->above, rows->here, rows->below, pass->terms[j].centre_sag, j, width, rows->own);
    // The row is copied: its edge midpoints are read at i - 1 and i + 1 while its centres are written.
    memcpy(rows->children - 1, plane->delta + at - 1, sizeof *rows->children * ((size_t)width + 2));
    memcpy(rows->reach - 1, plane->radius + at - 1, sizeof *rows->reach * ((size_t)width + 2));
    store_centres(rows->above, rows->here, rows->below, rows->own, plane->delta + up, plane->delta + down,
                  plane->radius + up, plane->radius + down, rows->children, rows->reach, pass->terms[j].centre_reach2, width,
                  plane->delta + at, plane->radius + at);
}

static void edge_task(void *user, int64_t begin, int64_t end, int worker) {
    const Pass *pass = user;
    for (int64_t j = begin; j < end; j++)
        edge_row(pass, (int)j, &pass->rows[worker]);
}

static void centre_task(void *user, int64_t begin, int64_t end, int worker) {
    const Pass *pass = user;
    for (int64_t k = begin; k < end; k++)
        centre_row(pass, 2 * (int)k + 1, &pass->rows[worker]);
}

static void cut_rows(unsigned char *memory, size_t entries, Rows *rows) {
    float **floats[] = {&rows->above, &rows->here, &rows->below, &rows->upper, &rows->lower};
    uint16_t **shorts[] = {&rows->own, &rows->children, &rows->reach};
    for (size_t i = 0; i < COUNT_OF(floats); i++, memory += entries * sizeof(float))
        *floats[i] = (float *)(void *)memory + ROW_PAD;
    for (size_t i = 0; i < COUNT_OF(shorts); i++, memory += entries * sizeof(uint16_t))
        *shorts[i] = (uint16_t *)(void *)memory + ROW_PAD;
}

Result error_nest_parallel(const ErrorWork *work, Jobs *jobs, ErrorField *field) {
    size_t entries = ((size_t)work->width + 2 * ROW_PAD + 31) & ~(size_t)31;
    size_t row_bytes = entries * (5 * sizeof(float) + 3 * sizeof(uint16_t));
    int workers = jobs_worker_count(jobs);
    unsigned char *memory = calloc((size_t)workers, row_bytes);
    uint16_t *zeros = calloc(entries, sizeof *zeros);
    Rows *rows = calloc((size_t)workers, sizeof *rows);
    Result result = memory && zeros && rows ? RESULT_OK : RESULT_MEMORY;
    for (int i = 0; i < workers && result == RESULT_OK; i++)
        cut_rows(memory + (size_t)i * row_bytes, entries, &rows[i]);
    for (int k = 0; k < field->plane_count && result == RESULT_OK; k++) {
        Pass pass = {work, &field->planes[k], k ? &field->planes[k - 1] : NULL, zeros + ROW_PAD, work->terms[k], rows};
        jobs_run(jobs, pass.plane->height, ROWS_AT_A_TIME, edge_task, &pass);
        jobs_run(jobs, pass.plane->height / 2, ROWS_AT_A_TIME / 2, centre_task, &pass);
    }
    free(rows);
    free(zeros);
    free(memory);
    return result;
}
