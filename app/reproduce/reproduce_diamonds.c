#include "app/reproduce/reproduce_diamonds.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/statistics.h"

#include <stdlib.h>

static double ms_since(int64_t begin_ns) {
    return (double)(clock_now_ns() - begin_ns) * 1e-6;
}

DiamondView diamonds_view(const Diamonds *diamonds, int view) {
    Viewpoint at = circuit_at(diamonds->circuit, (double)view / diamonds->views);
    LodView lod = circuit_view(&at, diamonds->px_per_rad, diamonds->tau_px);
    return diamond_view(diamonds->model, &lod, diamonds->tau_px, &diamonds->lens);
}

void diamonds_summarize(double ms[DIAMONDS_PHASE_COUNT][DIAMONDS_VIEWS_MAX], int views, DiamondsTimes *out) {
    for (int i = 0; i < views; i++)
        ms[DIAMONDS_DYNAMIC][i] = ms[DIAMONDS_EVALUATION][i] + ms[DIAMONDS_CLOSURE][i] + ms[DIAMONDS_INDICES][i];
    for (int phase = 0; phase < DIAMONDS_PHASE_COUNT; phase++) {
        statistics_sort(ms[phase], views);
        out->p50_ms[phase] = statistics_percentile(ms[phase], views, 0.50);
        out->p99_ms[phase] = statistics_percentile(ms[phase], views, 0.99);
    }
}

// What the phases write to.
typedef struct Work {
    uint32_t *bits;
    DiamondIndices indices;
    double ms[DIAMONDS_PHASE_COUNT][DIAMONDS_VIEWS_MAX];
} Work;

static Result generate(Diamonds *d, DiamondsTimes *out) {
    int64_t depth_ns[2 * DIAMOND_LEVEL_MAX] = {0};
    int64_t begin = clock_now_ns();
    Result result = diamond_generate_errors(d->model, d->jobs, depth_ns);
    out->generation_ms = ms_since(begin);
    out->root_ms = (double)depth_ns[0] * 1e-6;
    out->deepest_ms = (double)depth_ns[2 * d->model->layout.level_count - 1] * 1e-6;
    return result;
}

static void close_all(Diamonds *d, Work *work, DiamondsTimes *out) {
    double ms[DIAMONDS_CLOSURES];
    for (int i = 0; i < DIAMONDS_CLOSURES; i++) {
        diamond_fill(d->model, work->bits);
        int64_t begin = clock_now_ns();
        diamond_close(d->model, d->jobs, work->bits);
        ms[i] = ms_since(begin);
    }
    statistics_sort(ms, DIAMONDS_CLOSURES);
    out->closure_max_ms = statistics_percentile(ms, DIAMONDS_CLOSURES, 0.5);
}

static Result refine_view(Diamonds *d, int i, Work *work) {
    DiamondView view = diamonds_view(d, i);
    int64_t begin = clock_now_ns();
    diamond_evaluate(d->model, &d->program, &view, d->jobs, work->bits);
    work->ms[DIAMONDS_EVALUATION][i] = ms_since(begin);
    begin = clock_now_ns();
    diamond_close(d->model, d->jobs, work->bits);
    work->ms[DIAMONDS_CLOSURE][i] = ms_since(begin);
    begin = clock_now_ns();
    Result result = diamond_generate_indices(d->model, work->bits, d->jobs, &work->indices);
    work->ms[DIAMONDS_INDICES][i] = ms_since(begin);
    return result;
}

static Result refine_views(Diamonds *d, Work *work, DiamondsTimes *out) {
    Result result = refine_view(d, 0, work); // makes the memory for indices
    for (int i = 0; i < d->views && result == RESULT_OK; i++) {
        result = refine_view(d, i, work);
        out->triangles += (double)(work->indices.count / 3) / d->views;
    }
    diamonds_summarize(work->ms, d->views, out);
    return result;
}

Result diamonds_time_workers(Diamonds *d, DiamondsTimes *out) {
    *out = (DiamondsTimes){0};
    Work *work = calloc(1, sizeof *work);
    if (work)
        work->bits = calloc(d->model->layout.word_count, sizeof *work->bits);
    Result result = work && work->bits ? generate(d, out) : RESULT_MEMORY;
    if (!work || !work->bits)
        log_error("no memory for the split bits of %u super-squares", d->model->layout.word_count);
    if (result == RESULT_OK) {
        close_all(d, work, out);
        result = refine_views(d, work, out);
    }
    if (work) {
        diamond_indices_destroy(&work->indices);
        free(work->bits);
    }
    free(work);
    return result;
}
