#include "app/reproduce/reproduce_diamonds.h"
#include "base/log.h"
#include "base/statistics.h"
#include "render/diamond/diamond_gpu.h"

#include <stdlib.h>

#define TRIANGLES_MAX ((int64_t)1 << 25)

static void generate(const Diamonds *d, DiamondGpu *gpu, DiamondsTimes *out) {
    double depth_ms[2 * DIAMOND_LEVEL_MAX] = {0};
    diamond_gpu_generate_errors(gpu, depth_ms);
    out->generation_ms = diamond_gpu_ms(gpu, DIAMOND_PHASE_GENERATE);
    out->root_ms = depth_ms[0];
    out->deepest_ms = depth_ms[2 * d->model->layout.level_count - 1];
}

static Result close_all(const Diamonds *d, DiamondGpu *gpu, DiamondsTimes *out) {
    uint32_t *bits = calloc(d->model->layout.word_count, sizeof *bits);
    if (!bits) {
        log_error("no memory for the split bits of %u super-squares", d->model->layout.word_count);
        return RESULT_MEMORY;
    }
    double ms[DIAMONDS_CLOSURES];
    diamond_fill(d->model, bits);
    for (int i = 0; i < DIAMONDS_CLOSURES; i++) {
        diamond_gpu_fill(gpu, bits);
        diamond_gpu_close(gpu);
        ms[i] = diamond_gpu_ms(gpu, DIAMOND_PHASE_CLOSE);
    }
    statistics_sort(ms, DIAMONDS_CLOSURES);
    out->closure_max_ms = statistics_percentile(ms, DIAMONDS_CLOSURES, 0.5);
    free(bits);
    return RESULT_OK;
}

static Result refine_view(const Diamonds *d, DiamondGpu *gpu, int i,
                          double ms[DIAMONDS_PHASE_COUNT][DIAMONDS_VIEWS_MAX]) {
    DiamondView view = diamonds_view(d, i);
    Result result = diamond_gpu_evaluate(gpu, &d->program, &view);
    if (result != RESULT_OK)
        return result;
    diamond_gpu_close(gpu);
    diamond_gpu_generate_indices(gpu);
    ms[DIAMONDS_EVALUATION][i] = diamond_gpu_ms(gpu, DIAMOND_PHASE_EVALUATE);
    ms[DIAMONDS_CLOSURE][i] = diamond_gpu_ms(gpu, DIAMOND_PHASE_CLOSE);
    ms[DIAMONDS_INDICES][i] = diamond_gpu_ms(gpu, DIAMOND_PHASE_INDICES);
    return RESULT_OK;
}

static Result refine_views(const Diamonds *d, DiamondGpu *gpu, DiamondsTimes *out) {
    double ms[DIAMONDS_PHASE_COUNT][DIAMONDS_VIEWS_MAX];
    Result result = refine_view(d, gpu, 0, ms); // compiles the criterion
    for (int i = 0; i < d->views && result == RESULT_OK; i++) {
        result = refine_view(d, gpu, i, ms);
        out->triangles += (double)diamond_gpu_count_now(gpu) / d->views;
    }
    if (result == RESULT_OK)
        diamonds_summarize(ms, d->views, out);
    return result;
}

static Result time_phases(const Diamonds *d, bool software, DiamondsTimes *out) {
    DiamondGpu *gpu = NULL;
    Result result = diamond_gpu_create(d->model, TRIANGLES_MAX, software, true, &gpu);
    if (result != RESULT_OK)
        return result;
    generate(d, gpu, out);
    result = close_all(d, gpu, out);
    if (result == RESULT_OK)
        result = refine_views(d, gpu, out);
    diamond_gpu_destroy(&gpu);
    return result;
}

Result diamonds_time_gpu(Diamonds *d, Context *context, DiamondsTimes *out, const char **why) {
    *out = (DiamondsTimes){0};
    *why = NULL;
    Result result = context_make_current(context);
    if (result != RESULT_OK)
        return result;
    result = diamond_gpu_check(d->model->terrain, why);
    if (result == RESULT_OK)
        result = time_phases(d, context_is_software(context), out);
    context_release_current(context);
    return result;
}
