// Yalcin, Weiss, De Floriani 2011, section 5: the total error of every diamond, depth by depth, the largest deviation
// of the samples in its own triangles. Where the paper has one thread a sample and an atomic maximum at the diamond's
// vertex, a worker here scans the rows of a diamond; large diamonds are cut into bands of rows, so that all workers
// share them. A maximum does not mind the order: the bits are the same. Our own: the terms that make the error bound
// |P - Q| on the curved Earth.
#include "terrain/diamond/diamond_internal.h"
#include "terrain/diamond/diamond_rules.h"

#include "base/clock.h"
#include "base/log.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#define BAND_ROWS 64

typedef struct Scan {
    DiamondModel *model;
    int plane, step;
    bool centres;           // or edge midpoints
    int bands;              // a diamond
    _Atomic uint32_t *most; // by entry within the plane: largest deviation so far, as bits; NULL where bands is 1
} Scan;

// The heights of one diamond and the planes of its triangles; those that are missing at the rim have no plane.
typedef struct Diamond {
    DiamondPoint v;
    const float *h; // at the vertex
    DiamondPlane before, after;
    bool has_before, has_after;
    float range_m;
} Diamond;

// The largest deviation of samples h[x], x in [0, count), which are `dx` + x samples east of the vertex and `dy` south.
SIMD_CLONES
static uint32_t row_deviation(const float *restrict h, DiamondPlane plane, int dx, int dy, int count) {
    uint32_t most = 0;
    for (int x = 0; x < count; x++) {
        uint32_t bits = diamond_deviation(h[x], plane, (float)(dx + x), (float)dy);
        most = bits > most ? bits : most;
    }
    return most;
}

static uint32_t larger(uint32_t a, uint32_t b) {
    return a > b ? a : b;
}

static float height_at(const Scan *scan, DiamondPoint p) {
    return scan->model->height_m[diamond_sample(&scan->model->layout, p)];
}

// ---- edge midpoints ----

static Diamond edge_diamond(const Scan *scan, DiamondPoint v, int slot) {
    const DiamondLayout *layout = &scan->model->layout;
    DiamondCorners c = diamond_corners(slot, v, scan->step);
    float a = height_at(scan, c.ends[0]), b = height_at(scan, c.ends[1]), inverse_step = 1.0f / (float)scan->step;
    float low = fminf(a, b), high = fmaxf(a, b);
    bool horizontal = diamond_is_horizontal(slot);
    Diamond d = {.v = v, .h = scan->model->height_m + diamond_sample(layout, v)};
    d.has_before = diamond_is_inside(layout, c.parents[0]);
    d.has_after = diamond_is_inside(layout, c.parents[1]);
    if (d.has_before) {
        float apex = height_at(scan, c.parents[0]);
        d.before = diamond_edge_plane(a, b, apex, -1.0f, inverse_step, horizontal);
        low = fminf(low, apex), high = fmaxf(high, apex);
    }
    if (d.has_after) {
        float apex = height_at(scan, c.parents[1]);
        d.after = diamond_edge_plane(a, b, apex, 1.0f, inverse_step, horizontal);
        low = fminf(low, apex), high = fmaxf(high, apex);
    }
    d.range_m = high - low;
    return d;
}

static uint32_t horizontal_row(const Scan *scan, const Diamond *d, int dy) {
    int reach = scan->step - abs(dy);
    const float *h = d->h + (ptrdiff_t)dy * scan->model->layout.width - reach;
    uint32_t most = 0;
    if (d->has_before && dy <= 0)
        most = row_deviation(h, d->before, -reach, dy, 2 * reach + 1);
    if (d->has_after && dy >= 0)
        most = larger(most, row_deviation(h, d->after, -reach, dy, 2 * reach + 1));
    return most;
}

static uint32_t vertical_row(const Scan *scan, const Diamond *d, int dy) {
    int reach = scan->step - abs(dy);
    const float *h = d->h + (ptrdiff_t)dy * scan->model->layout.width;
    uint32_t most = 0;
    if (d->has_before)
        most = row_deviation(h - reach, d->before, -reach, dy, reach + 1);
    if (d->has_after)
        most = larger(most, row_deviation(h, d->after, 0, dy, reach + 1));
    return most;
}

static uint32_t scan_edge(const Scan *scan, const Diamond *d, bool horizontal, int begin, int end) {
    uint32_t most = 0;
    for (int dy = begin; dy < end; dy++)
        most = larger(most, horizontal ? horizontal_row(scan, d, dy) : vertical_row(scan, d, dy));
    return most;
}

// ---- centres ----

static Diamond centre_diamond(const Scan *scan, DiamondPoint v, int slot) {
    const DiamondLayout *layout = &scan->model->layout;
    int s = scan->step;
    const float *h = scan->model->height_m + diamond_sample(layout, v);
    const float *north = h - (ptrdiff_t)s * layout->width, *south = h + (ptrdiff_t)s * layout->width;
    float nw = north[-s], ne = north[s], sw = south[-s], se = south[s], inverse_step = 1.0f / (float)s;
    bool rising = diamond_is_rising(slot);
    return (Diamond){.v = v,
                     .h = h,
                     .before = diamond_west_plane(nw, ne, sw, se, inverse_step, rising),
                     .after = diamond_east_plane(nw, ne, sw, se, inverse_step, rising),
                     .has_before = true,
                     .has_after = true,
                     .range_m = fmaxf(fmaxf(nw, ne), fmaxf(sw, se)) - fminf(fminf(nw, ne), fminf(sw, se))};
}

static uint32_t scan_centre(const Scan *scan, const Diamond *d, bool rising, int begin, int end) {
    int s = scan->step;
    uint32_t most = 0;
    for (int dy = begin; dy < end; dy++) {
        int cross = rising ? -dy : dy; // where the hypotenuse passes
        const float *h = d->h + (ptrdiff_t)dy * scan->model->layout.width;
        most = larger(most, row_deviation(h - s, d->before, -s, dy, s + cross + 1));
        most = larger(most, row_deviation(h + cross, d->after, cross, dy, s - cross + 1));
    }
    return most;
}

// ---- a depth ----

static void raise_to(_Atomic uint32_t *slot, uint32_t value) {
    uint32_t seen = atomic_load_explicit(slot, memory_order_relaxed);
    while (value > seen &&
           !atomic_compare_exchange_weak_explicit(slot, &seen, value, memory_order_relaxed, memory_order_relaxed)) {
    }
}

static float error_of(const Scan *scan, const Diamond *d, uint32_t deviation) {
    const DiamondLayout *layout = &scan->model->layout;
    const DiamondTerms *t = &scan->model->terms[layout->row_offset[scan->plane] + ((uint32_t)d->v.row >> scan->plane)];
    return diamond_error(diamond_bits_float(deviation), d->range_m, scan->centres ? t->centre_drift : t->edge_drift,
                         scan->centres ? t->centre_sag_m : t->edge_sag_m);
}

static Diamond diamond_of(const Scan *scan, DiamondPoint v, int slot) {
    return scan->centres ? centre_diamond(scan, v, slot) : edge_diamond(scan, v, slot);
}

// One diamond's share of a band of its rows. Shares of several bands are joined by finish_entry.
static void scan_entry(const Scan *scan, uint32_t word, int slot, DiamondPoint v, int band) {
    const DiamondLayout *layout = &scan->model->layout;
    Diamond d = diamond_of(scan, v, slot);
    int begin = -scan->step + band * BAND_ROWS;
    int end = begin + BAND_ROWS <= scan->step ? begin + BAND_ROWS : scan->step + 1;
    uint32_t most = scan->centres ? scan_centre(scan, &d, diamond_is_rising(slot), begin, end)
                                  : scan_edge(scan, &d, diamond_is_horizontal(slot), begin, end);
    if (scan->most)
        raise_to(&scan->most[(word - layout->offset[scan->plane]) * DIAMOND_SLOTS + (uint32_t)slot], most);
    else
        scan->model->error_m[diamond_entry(layout, slot, word)] = error_of(scan, &d, most);
}

typedef void EntryTask(const Scan *scan, uint32_t word, int slot, DiamondPoint v, int band);

// Calls `task` for the diamonds of one super-square that have an error: those inside that are not always split.
static void for_each_entry(const Scan *scan, uint32_t i, uint32_t j, int band, EntryTask *task) {
    const DiamondModel *model = scan->model;
    const DiamondLayout *layout = &model->layout;
    uint32_t word = layout->offset[scan->plane] + j * layout->across[scan->plane] + i;
    int first = scan->centres ? 0 : DIAMOND_CENTRE_SLOTS, last = scan->centres ? DIAMOND_CENTRE_SLOTS : DIAMOND_SLOTS;
    for (int slot = first; slot < last; slot++)
        if ((model->valid[word] & ~model->always[word]) >> diamond_slot_bit(slot) & 1)
            task(scan, word, slot, diamond_vertex(scan->plane, i, j, slot), band);
}

static void scan_task(void *user, int64_t begin, int64_t end, int worker) {
    const Scan *scan = user;
    uint32_t across = scan->model->layout.across[scan->plane];
    (void)worker;
    for (int64_t item = begin; item < end; item++)
        for (uint32_t i = 0; i < across; i++)
            for_each_entry(scan, i, (uint32_t)(item / scan->bands), (int)(item % scan->bands), scan_entry);
}

static void finish_entry(const Scan *scan, uint32_t word, int slot, DiamondPoint v, int band) {
    const DiamondLayout *layout = &scan->model->layout;
    Diamond d = diamond_of(scan, v, slot);
    uint32_t most = scan->most[(word - layout->offset[scan->plane]) * DIAMOND_SLOTS + (uint32_t)slot];
    (void)band;
    scan->model->error_m[diamond_entry(layout, slot, word)] = error_of(scan, &d, most);
}

static void finish_plane(const Scan *scan) {
    for (uint32_t j = 0; j < scan->model->layout.down[scan->plane]; j++)
        for (uint32_t i = 0; i < scan->model->layout.across[scan->plane]; i++)
            for_each_entry(scan, i, j, 0, finish_entry);
}

static Result generate_depth(DiamondModel *model, int plane, bool centres, Jobs *jobs) {
    Scan scan = {.model = model, .plane = plane, .step = 1 << plane, .centres = centres};
    scan.bands = (2 * scan.step + 1 + BAND_ROWS - 1) / BAND_ROWS;
    if (scan.bands > 1) {
        scan.most = calloc((size_t)diamond_plane_words(&model->layout, plane) * DIAMOND_SLOTS, sizeof *scan.most);
        if (!scan.most)
            return RESULT_MEMORY;
    }
    int64_t grain = scan.bands > 1 ? 1 : 64 / model->layout.across[plane] + 1;
    jobs_run(jobs, (int64_t)model->layout.down[plane] * scan.bands, grain, scan_task, &scan);
    if (scan.most)
        finish_plane(&scan);
    free(scan.most);
    return RESULT_OK;
}

// ---- all depths ----

static void set_forced(DiamondModel *model) {
    for (int slot = 0; slot < DIAMOND_SLOTS; slot++)
        for (uint32_t word = 0; word < model->layout.word_count; word++)
            model->error_m[diamond_entry(&model->layout, slot, word)] =
                model->always[word] >> diamond_slot_bit(slot) & 1 ? INFINITY : 0.0f;
}

Result diamond_generate_errors(DiamondModel *model, Jobs *jobs, int64_t *depth_ns) {
    if (!model->error_m)
        model->error_m = malloc(sizeof(float) * DIAMOND_SLOTS * (size_t)model->layout.word_count);
    if (!model->error_m)
        goto fail;
    set_forced(model);
    int depths = 2 * model->layout.level_count;
    Progress progress = progress_begin("diamonds");
    for (int depth = 0; depth < depths; depth++) {
        int64_t begin = clock_now_ns();
        progress_update(&progress, (double)depth / depths); // every depth scans every sample
        if (generate_depth(model, model->layout.level_count - 1 - depth / 2, depth % 2 == 0, jobs) != RESULT_OK)
            goto fail;
        if (depth_ns)
            depth_ns[depth] = clock_now_ns() - begin;
    }
    progress_end(&progress);
    if (diamond_runs_create(model, jobs) != RESULT_OK)
        goto fail;
    return RESULT_OK;
fail:
    log_error("diamonds: not enough memory for the errors of %d x %d samples", model->layout.width,
              model->layout.height);
    return RESULT_MEMORY;
}
