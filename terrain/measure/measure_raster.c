#include "terrain/measure/measure_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

// One edge function: a * col + b * row + c, >= 0 on the triangle's side, 0 on the edge itself. The three of a triangle
// add up to its doubled area, and are its barycentric coordinates once divided by it.
typedef struct EdgeFunction {
    int64_t a, b, c;
} EdgeFunction;

typedef struct Raster {
    EdgeFunction edge[3]; // opposite vertex 0, 1, 2
    int64_t col_min, col_max, row_min, row_max;
} Raster;

static EdgeFunction edge_function(const MeasureTriangle *t, int from, int to) {
    EdgeFunction e = {t->row[to] - t->row[from], t->col[from] - t->col[to], 0};
    e.c = -(e.a * t->col[from] + e.b * t->row[from]);
    return e;
}

static int64_t min3(const int64_t v[3]) {
    int64_t m = v[0] < v[1] ? v[0] : v[1];
    return m < v[2] ? m : v[2];
}

static int64_t max3(const int64_t v[3]) {
    int64_t m = v[0] > v[1] ? v[0] : v[1];
    return m > v[2] ? m : v[2];
}

static Raster raster_of(const MeasureTriangle *t) {
    return (Raster){.edge = {edge_function(t, 1, 2), edge_function(t, 2, 0), edge_function(t, 0, 1)},
                    .col_min = min3(t->col),
                    .col_max = max3(t->col),
                    .row_min = min3(t->row),
                    .row_max = max3(t->row)};
}

// ---- samples ----

// Rounded up, so that an error above a tolerance stays above it. What is not a number is beyond any tolerance.
static uint32_t error_bits(double px) {
    float rounded = INFINITY;
    if (isfinite(px) && px <= FLT_MAX) {
        rounded = (float)px;
        if ((double)rounded < px)
            rounded = nextafterf(rounded, INFINITY);
    }
    uint32_t bits;
    memcpy(&bits, &rounded, sizeof bits);
    return bits;
}

// The bits of floats >= 0 are in the order of the floats.
static void keep_largest(_Atomic uint32_t *place, uint32_t bits) {
    uint32_t old = atomic_load_explicit(place, memory_order_relaxed);
    while ((old == MEASURE_NOT_COVERED || old < bits) &&
           !atomic_compare_exchange_weak_explicit(place, &old, bits, memory_order_relaxed, memory_order_relaxed)) {
    }
}

static void keep_worst(MeasureWorker *worker, double px, int64_t sample) {
    if (isnan(px))
        px = INFINITY;
    if (px > worker->max_px || (px == worker->max_px && sample < worker->worst)) {
        worker->max_px = px;
        worker->worst = sample;
    }
}

static void keep_highest(_Atomic uint32_t *place, double rise_m) {
    uint32_t key = measure_key((float)rise_m), old = atomic_load_explicit(place, memory_order_relaxed);
    while (old < key &&
           !atomic_compare_exchange_weak_explicit(place, &old, key, memory_order_relaxed, memory_order_relaxed)) {
    }
}

static double error_px(double px_per_rad, Vec3d exact, Vec3d off) {
    double off_m = vec3d_length(off), away_m = vec3d_length(exact);
    if (away_m > 0.0)
        return px_per_rad * (off_m / away_m);
    return off_m > 0.0 ? INFINITY : 0.0;
}

// `drawn` is relative to the eye.
static double look_at_sample(MeasureRun *run, int64_t col, int64_t row, int64_t sample, Vec3d drawn) {
    double h_m = (double)run->dem->height_m[sample];
    if (!isfinite(h_m))
        return INFINITY;
    Vec3d base, up;
    grid_base(run->grid, (int)col, (int)row, &base, &up);
    Vec3d exact = vec3d_sub(vec3d_mad(base, up, h_m), run->cut->view.eye_ecef), off = vec3d_sub(drawn, exact);
    double rise_m = vec3d_dot(off, up);
    if (run->rises && isfinite(rise_m))
        keep_highest(&run->rises[sample], rise_m);
    return error_px(run->cut->view.px_per_rad, exact, off);
}

static void measure_sample(MeasureRun *run, MeasureWorker *worker, int64_t col, int64_t row, Vec3d drawn) {
    int64_t sample = row * run->dem->width + col;
    double px = look_at_sample(run, col, row, sample, drawn);
    if (run->touched)
        return;
    keep_largest(&run->errors[sample], error_bits(px));
    keep_worst(worker, px, sample);
}

static bool is_wanted(const MeasureRun *run, int64_t sample) {
    return !run->touched || atomic_load_explicit(&run->touched->samples[sample], memory_order_relaxed);
}

static void rasterise_samples(MeasureRun *run, MeasureWorker *worker, const Raster *r, const Vec3d corners[3],
                              double per_area) {
    for (int64_t row = r->row_min; row <= r->row_max; row++) {
        int64_t w[3];
        for (int i = 0; i < 3; i++)
            w[i] = r->edge[i].a * r->col_min + r->edge[i].b * row + r->edge[i].c;
        for (int64_t col = r->col_min; col <= r->col_max; col++) {
            if ((w[0] | w[1] | w[2]) >= 0 && is_wanted(run, row * run->dem->width + col)) { // none is negative
                Vec3d sum = vec3d_scale(corners[0], (double)w[0] * per_area);
                sum = vec3d_mad(sum, corners[1], (double)w[1] * per_area);
                sum = vec3d_mad(sum, corners[2], (double)w[2] * per_area);
                measure_sample(run, worker, col, row, sum);
            }
            for (int i = 0; i < 3; i++)
                w[i] += r->edge[i].a;
        }
    }
}

// ---- cells ----

// A point on an edge belongs to the triangle on one side only: the one whose edge function grows eastwards, or, along a
// row, southwards. Of the two triangles at an edge, exactly one is.
static int64_t tie(const EdgeFunction *e) {
    return e->a > 0 || (e->a == 0 && e->b > 0) ? 0 : 1;
}

static void cover(_Atomic uint8_t *cell, uint8_t once, uint8_t twice) {
    if (atomic_fetch_or_explicit(cell, once, memory_order_relaxed) & once)
        atomic_fetch_or_explicit(cell, twice, memory_order_relaxed);
}

// In quarter cells: the points are (4 col + 2, 4 row + 1) and (4 col + 2, 4 row + 3).
static void rasterise_cells(MeasureRun *run, const Raster *r) {
    int64_t row_length = run->dem->width - 1;
    for (int64_t row = r->row_min; row < r->row_max; row++)
        for (int64_t col = r->col_min; col < r->col_max; col++) {
            int64_t north = 0, south = 0;
            for (int i = 0; i < 3; i++) {
                const EdgeFunction *e = &r->edge[i];
                int64_t w = e->a * (4 * col + 2) + e->b * (4 * row + 1) + 4 * e->c - tie(e);
                north |= w;
                south |= w + 2 * e->b;
            }
            if (north >= 0)
                cover(&run->cells[row * row_length + col], MEASURE_NORTH, MEASURE_NORTH_TWICE);
            if (south >= 0)
                cover(&run->cells[row * row_length + col], MEASURE_SOUTH, MEASURE_SOUTH_TWICE);
        }
}

// ---- items ----

static void rasterise_surface(MeasureRun *run, MeasureWorker *worker, const LodPage *page, const MeasureTriangle *t,
                              const Raster *raster) {
    Vec3d corners[3];
    for (int i = 0; i < 3; i++)
        corners[i] = vec3d_sub(grid_point_ecef(measure_drawn(page, t->vertex[i])), run->cut->view.eye_ecef);
    rasterise_samples(run, worker, raster, corners, 1.0 / (double)t->area2);
}

static void rasterise_triangle(MeasureRun *run, MeasureWorker *worker, const LodPage *page, const MeasureTriangle *t) {
    Raster raster = raster_of(t);
    rasterise_surface(run, worker, page, t, &raster);
    rasterise_cells(run, &raster);
    worker->area2 += t->area2;
}

void measure_rasterise(MeasureRun *run, MeasureWorker *worker, int64_t begin, int64_t end) {
    MeasureTriangle t;
    for (int64_t i = begin; i < end && measure_goes_on(run); i++) {
        const LodItem *item = &run->cut->items[i];
        int64_t before = worker->area2;
        for (int64_t k = 0; k < item->index_count / 3; k++) {
            if (measure_triangle(run, item, k, &t))
                rasterise_triangle(run, worker, item->page, &t);
            else
                worker->unsound++;
        }
        atomic_fetch_add_explicit(&run->done_area2, worker->area2 - before, memory_order_relaxed);
        keep_largest(&run->done_max, error_bits(fmax(worker->max_px, 0.0)));
    }
}

// ---- samples looked at again ----

static void touch(const MeasureTouched *touched, int64_t width, int64_t col, int64_t row) {
    int64_t block = (row >> MEASURE_BLOCK_SHIFT) * touched->block_cols + (col >> MEASURE_BLOCK_SHIFT);
    atomic_store_explicit(&touched->samples[row * width + col], 1, memory_order_relaxed);
    atomic_store_explicit(&touched->blocks[block], 1, memory_order_relaxed);
}

static void touch_triangle(const MeasureRun *run, const Raster *r, const MeasureTouched *touched) {
    for (int64_t row = r->row_min; row <= r->row_max; row++)
        for (int64_t col = r->col_min; col <= r->col_max; col++) {
            int64_t w = 0;
            for (int i = 0; i < 3; i++)
                w |= r->edge[i].a * col + r->edge[i].b * row + r->edge[i].c;
            if (w >= 0) // none is negative
                touch(touched, run->dem->width, col, row);
        }
}

void measure_touch(const MeasureRun *run, const LodItem *item, const MeasureTouched *touched) {
    MeasureTriangle t;
    for (int64_t k = 0; k < item->index_count / 3; k++)
        if (measure_triangle(run, item, k, &t)) {
            Raster raster = raster_of(&t);
            touch_triangle(run, &raster, touched);
        }
}

static bool is_near_touched(const MeasureTouched *touched, const Raster *r) {
    for (int64_t row = r->row_min >> MEASURE_BLOCK_SHIFT; row <= r->row_max >> MEASURE_BLOCK_SHIFT; row++)
        for (int64_t col = r->col_min >> MEASURE_BLOCK_SHIFT; col <= r->col_max >> MEASURE_BLOCK_SHIFT; col++)
            if (atomic_load_explicit(&touched->blocks[row * touched->block_cols + col], memory_order_relaxed))
                return true;
    return false;
}

void measure_rasterise_touched(MeasureRun *run, const LodItem *item) {
    MeasureTriangle t;
    for (int64_t k = 0; k < item->index_count / 3; k++) {
        if (!measure_triangle(run, item, k, &t))
            continue;
        Raster raster = raster_of(&t);
        if (is_near_touched(run->touched, &raster))
            rasterise_surface(run, NULL, item->page, &t, &raster);
    }
}
