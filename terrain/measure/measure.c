#include "terrain/measure/measure.h"

#include "base/log.h"
#include "base/pages.h"
#include "terrain/measure/measure_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- memory ----

static void run_end(MeasureRun *run) {
    for (int i = 0; run->workers && i < run->worker_count; i++) {
        free(run->workers[i].table);
        free(run->workers[i].open);
        free(run->workers[i].used);
    }
    free(run->workers);
    free(run->first_ordinal);
    free((void *)run->cells);
    free((void *)run->rises);
    free((void *)run->errors);
    free((void *)run->vertices);
}

static Result number_vertices(MeasureRun *run) {
    int64_t ordinal = 1, indices = 32;
    for (int32_t i = 0; i < run->cut->item_count; i++) {
        const LodItem *item = &run->cut->items[i];
        run->first_ordinal[i] = ordinal;
        ordinal += item->page->vertex_count;
        indices = item->index_count > indices ? item->index_count : indices;
    }
    if (ordinal > MEASURE_ORDINAL) {
        log_error("measure: the cut has %lld vertices, at most %u can be measured", (long long)ordinal,
                  MEASURE_ORDINAL);
        return RESULT_RANGE;
    }
    for (run->table_size = 64; run->table_size < 2 * indices;)
        run->table_size *= 2;
    return RESULT_OK;
}

static Result create_workers(MeasureRun *run, int count) {
    run->workers = calloc((size_t)count, sizeof *run->workers);
    if (!run->workers)
        return RESULT_MEMORY;
    run->worker_count = count;
    for (int i = 0; i < count; i++) {
        MeasureWorker *worker = &run->workers[i];
        worker->max_px = -1.0;
        worker->table = malloc(sizeof *worker->table * (size_t)run->table_size);
        worker->used = malloc(UINT16_MAX + 1);
        if (!worker->table || !worker->used)
            return RESULT_MEMORY;
    }
    return RESULT_OK;
}

static void cover_nothing(MeasureRun *run) {
    size_t row_bytes = (size_t)run->dem->width * sizeof *run->errors;
    for (int64_t row = 0; row < run->dem->height && measure_goes_on(run); row++)
        memset((void *)(run->errors + row * run->dem->width), 0xff, row_bytes); // MEASURE_NOT_COVERED
}

static Result run_begin(MeasureRun *run, const MeasureMaps *maps, int workers) {
    const Dem *dem = run->dem;
    run->samples = (int64_t)dem->width * dem->height;
    run->cell_count = (int64_t)(dem->width - 1) * (dem->height - 1);
    run->vertices = calloc((size_t)run->samples, sizeof *run->vertices);
    run->errors = malloc((size_t)run->samples * sizeof *run->errors);
    run->cells = calloc((size_t)run->cell_count, sizeof *run->cells);
    run->first_ordinal = malloc(sizeof *run->first_ordinal * (size_t)(run->cut->item_count + 1));
    if (maps->rise_m)
        run->rises = calloc((size_t)run->samples, sizeof *run->rises); // MEASURE_NO_KEY
    if (!run->vertices || !run->errors || !run->cells || !run->first_ordinal || (maps->rise_m && !run->rises))
        return RESULT_MEMORY;
    if (run->rises)
        pages_own((void *)run->rises, (size_t)run->samples * sizeof *run->rises);
    cover_nothing(run);
    Result result = number_vertices(run);
    return result == RESULT_OK ? create_workers(run, workers) : result;
}

// ---- passes over the items ----

static void task_mark(void *user, int64_t begin, int64_t end, int worker) {
    MeasureRun *run = user;
    measure_mark_vertices(run, &run->workers[worker], begin, end);
}

static void task_measure(void *user, int64_t begin, int64_t end, int worker) {
    MeasureRun *run = user;
    measure_find_junctions(run, begin, end);
    measure_rasterise(run, &run->workers[worker], begin, end);
}

// ---- wholeness ----

static void count_vertices(MeasureRun *run, Measure *out) {
    const _Atomic uint32_t *vertex = run->vertices;
    for (int row = 0; row < run->dem->height && measure_goes_on(run); row++)
        for (int col = 0; col < run->dem->width; col++, vertex++) {
            uint32_t bits = atomic_load_explicit(vertex, memory_order_relaxed);
            out->holes += (bits & MEASURE_SPLIT) != 0;
            out->t_junctions += (bits & MEASURE_JUNCTION) != 0;
        }
}

static void count_cells(MeasureRun *run, Measure *out) {
    const uint8_t whole = MEASURE_NORTH | MEASURE_SOUTH, twice = MEASURE_NORTH_TWICE | MEASURE_SOUTH_TWICE;
    const _Atomic uint8_t *cell = run->cells;
    for (int row = 0; row < run->dem->height - 1 && measure_goes_on(run); row++)
        for (int col = 0; col < run->dem->width - 1; col++, cell++) {
            uint8_t bits = atomic_load_explicit(cell, memory_order_relaxed);
            out->holes += (bits & whole) != whole;
            out->overlaps += (bits & twice) != 0;
        }
}

// The areas add up, whatever the shapes of the triangles.
static void check_area(MeasureRun *run, Measure *out) {
    int64_t area2 = 0;
    for (int i = 0; i < run->worker_count; i++) {
        area2 += run->workers[i].area2;
        out->overlaps += run->workers[i].unsound;
    }
    out->holes += area2 < 2 * run->cell_count && !out->holes;
    out->overlaps += area2 > 2 * run->cell_count && !out->overlaps;
}

// ---- distance ----

static float float_from_bits(uint32_t bits) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

// As the errors are kept.
static double rounded_up(double px) {
    float rounded = (float)px;
    return (double)((double)rounded < px ? nextafterf(rounded, INFINITY) : rounded);
}

// Sums by rows, then over the rows: the order does not depend on who measured.
static void sum_samples(MeasureRun *run, Measure *out) {
    double sum = 0.0, tau_px = rounded_up(run->cut->view.tau_px);
    int64_t above = 0;
    for (int64_t row = 0, i = 0; row < run->dem->height && measure_goes_on(run); row++) {
        double row_sum = 0.0;
        for (int64_t col = 0; col < run->dem->width; col++, i++) {
            uint32_t bits = atomic_load_explicit(&run->errors[i], memory_order_relaxed);
            if (bits == MEASURE_NOT_COVERED) {
                out->holes++;
                continue;
            }
            double px = (double)float_from_bits(bits);
            row_sum += px * px;
            above += px > tau_px;
            out->samples++;
        }
        sum += row_sum;
    }
    out->rms_px = out->samples ? sqrt(sum / (double)out->samples) : 0.0;
    out->above_tau_share = out->samples ? (double)above / (double)out->samples : 0.0;
}

// Which value of the 16 bits above `shift` holds the rank-th smallest of the samples that have `prefix` above those;
// the rank becomes the one among them.
static uint32_t digit_of_rank(MeasureRun *run, int64_t *counts, uint32_t prefix, int shift, int64_t *rank) {
    const _Atomic uint32_t *error = run->errors;
    memset(counts, 0, sizeof *counts << 16);
    for (int row = 0; row < run->dem->height && measure_goes_on(run); row++)
        for (int col = 0; col < run->dem->width; col++, error++) {
            uint32_t bits = atomic_load_explicit(error, memory_order_relaxed);
            if (bits != MEASURE_NOT_COVERED && (shift == 16 || bits >> 16 == prefix))
                counts[bits >> shift & 0xffff]++;
        }
    uint32_t digit = 0;
    for (; digit < 0xffff && *rank >= counts[digit]; digit++)
        *rank -= counts[digit];
    return digit;
}

// The smallest error that at least `share` of the samples do not exceed: exact, by radix selection.
static Result percentile(MeasureRun *run, int64_t samples, double share, double *out) {
    int64_t *counts = malloc(sizeof *counts << 16);
    if (!counts)
        return RESULT_MEMORY;
    int64_t rank = (int64_t)ceil(share * (double)samples) - 1;
    uint32_t high = digit_of_rank(run, counts, 0, 16, &rank);
    uint32_t low = digit_of_rank(run, counts, high, 0, &rank);
    free(counts);
    *out = (double)float_from_bits(high << 16 | low);
    return RESULT_OK;
}

static void find_worst(MeasureRun *run, Measure *out) {
    double max_px = -1.0;
    int64_t worst = 0;
    for (int i = 0; i < run->worker_count; i++) {
        const MeasureWorker *worker = &run->workers[i];
        if (worker->max_px > max_px || (worker->max_px == max_px && worker->worst < worst)) {
            max_px = worker->max_px;
            worst = worker->worst;
        }
    }
    out->max_px = max_px < 0.0 ? 0.0 : max_px;
    out->worst_col = (int)(worst % run->dem->width);
    out->worst_row = (int)(worst / run->dem->width);
}

static Result find_percentiles(MeasureRun *run, Measure *out) {
    if (!out->samples)
        return RESULT_OK;
    Result result = percentile(run, out->samples, 0.999, &out->p999_px);
    if (result == RESULT_OK && measure_goes_on(run))
        result = percentile(run, out->samples, 0.99, &out->p99_px);
    // What is kept of each sample is rounded up; the largest is not.
    out->p999_px = fmin(out->p999_px, out->max_px);
    out->p99_px = fmin(out->p99_px, out->max_px);
    return result;
}

static Result join(MeasureRun *run, Measure *out) {
    void (*const passes[])(MeasureRun *, Measure *) = {count_vertices, count_cells, sum_samples, check_area,
                                                       find_worst};
    for (int i = 0; i < run->worker_count; i++)
        if (run->workers[i].out_of_memory)
            return RESULT_MEMORY;
    Result result = measure_join_edges(run, out);
    if (result != RESULT_OK)
        return result;
    for (size_t i = 0; i < COUNT_OF(passes) && measure_goes_on(run); i++)
        passes[i](run, out);
    if (measure_goes_on(run))
        result = find_percentiles(run, out);
    return result == RESULT_OK && atomic_load(&run->ended) ? RESULT_BUDGET : result;
}

// ---- maps ----

// MEASURE_NOT_COVERED is a NaN already.
static void fill_maps(const MeasureRun *run, const MeasureMaps *maps) {
    for (int64_t i = 0; i < run->samples && maps->error_px; i++)
        maps->error_px[i] = float_from_bits(atomic_load_explicit(&run->errors[i], memory_order_relaxed));
    for (int64_t i = 0; i < run->samples && maps->rise_m; i++) {
        uint32_t key = atomic_load_explicit(&run->rises[i], memory_order_relaxed);
        maps->rise_m[i] = key == MEASURE_NO_KEY ? NAN : measure_value_of_key(key);
    }
}

static MeasureSoFar so_far_of(MeasureRun *run) {
    double area2 = (double)atomic_load_explicit(&run->done_area2, memory_order_relaxed);
    uint32_t max = atomic_load_explicit(&run->done_max, memory_order_relaxed);
    return (MeasureSoFar){fmin(area2 / (2.0 * (double)run->cell_count), 1.0), (double)float_from_bits(max)};
}

bool measure_goes_on(MeasureRun *run) {
    if (!run->pace || atomic_load_explicit(&run->ended, memory_order_relaxed))
        return !run->pace;
    const MeasureSoFar so_far = so_far_of(run);
    if (!run->pace->go_on(run->pace->user, &so_far))
        atomic_store(&run->ended, true);
    return !atomic_load_explicit(&run->ended, memory_order_relaxed);
}

static Result measure(MeasureRun *run, Jobs *jobs, const MeasureMaps *maps, Measure *out) {
    Measure found = {0};
    Result result = run_begin(run, maps, jobs_worker_count(jobs));
    if (result == RESULT_OK) {
        jobs_run(jobs, run->cut->item_count, 1, task_mark, run);
        jobs_run(jobs, run->cut->item_count, 1, task_measure, run);
        result = join(run, &found);
    }
    if (result == RESULT_OK) {
        fill_maps(run, maps);
        *out = found;
    }
    run_end(run);
    if (result == RESULT_MEMORY)
        log_error("measure: no memory for %d x %d samples; measure a smaller DEM", run->dem->width, run->dem->height);
    return result;
}

Result measure_cut_of(const Dem *dem, const Grid *grid, const LodCut *cut, Jobs *jobs, Measure *out) {
    return measure_cut_paced(dem, grid, cut, jobs, NULL, out);
}

Result measure_cut(const Terrain *terrain, const LodCut *cut, Jobs *jobs, Measure *out) {
    return measure_cut_of(terrain_dem(terrain), terrain_grid(terrain), cut, jobs, out);
}

Result measure_cut_maps(const Terrain *terrain, const LodCut *cut, Jobs *jobs, const MeasureMaps *maps, Measure *out) {
    MeasureRun run = {.dem = terrain_dem(terrain), .grid = terrain_grid(terrain), .cut = cut};
    return measure(&run, jobs, maps, out);
}

Result measure_cut_paced(const Dem *dem, const Grid *grid, const LodCut *cut, Jobs *jobs, const MeasurePace *pace,
                         Measure *out) {
    MeasureRun run = {.dem = dem, .grid = grid, .cut = cut, .pace = pace};
    const MeasureMaps none = {0};
    return measure(&run, jobs, &none, out);
}
