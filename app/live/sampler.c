#include "app/live/sampler.h"

#include "app/live/pace.h"
#include "base/arena.h"
#include "base/clock.h"
#include "base/log.h"
#include "render/frame.h"

#include <stdlib.h>

#define TRIANGLES_MOST 2000000
#define PAGE_BYTES_MOST ((size_t)64 << 20)
#define ARENA_BLOCK ((size_t)256 << 10)
#define MS_PER_NS 1e-6

struct Sampler {
    Lod *lod;
    LodMethod method;
    Arena *arena;
};

// What a flight keeps from frame to frame is not what a sample asks for.
static LodOptions options_of_sample(const LodOptions *flown, LodMethod method) {
    LodOptions options = *flown;
    options.method = method;
    options.reuse = false;
    options.resident = false;
    options.partitions = 1;
    options.max_triangles = flown->max_triangles < TRIANGLES_MOST ? flown->max_triangles : TRIANGLES_MOST;
    options.page_bytes_max = flown->page_bytes_max < PAGE_BYTES_MOST ? flown->page_bytes_max : PAGE_BYTES_MOST;
    return options;
}

Result sampler_create(const LodOptions *lod, LodMethod method, const Terrain *terrain, Sampler **out) {
    const LodOptions options = options_of_sample(lod, method);
    Sampler *sampler = calloc(1, sizeof *sampler);
    if (!sampler) {
        log_error("no memory for samples of other tolerances");
        return RESULT_MEMORY;
    }
    sampler->method = method;
    Result result = arena_create(ARENA_BLOCK, &sampler->arena);
    if (result == RESULT_OK)
        result = lod_create(&options, terrain, &sampler->lod);
    if (result == RESULT_OK)
        *out = sampler;
    else
        sampler_destroy(&sampler);
    return result;
}

void sampler_destroy(Sampler **sampler) {
    if (!*sampler)
        return;
    lod_destroy(&(*sampler)->lod);
    if ((*sampler)->arena)
        arena_destroy(&(*sampler)->arena);
    free(*sampler);
    *sampler = NULL;
}

LodMethod sampler_method(const Sampler *sampler) {
    return sampler->method;
}

// As the renderer culls.
static double triangles_in_view(const LodCut *cut, const SamplerView *view) {
    const Frame frame = frame_make(&view->camera, view->width, view->height);
    int64_t indices = 0;
    for (int32_t i = 0; i < cut->item_count; i++)
        if (frame_sees_sphere(&frame, cut->items[i].centre_ecef, cut->items[i].radius_m))
            indices += cut->items[i].index_count;
    return (double)(indices / 3);
}

Result sampler_take(Sampler *sampler, const SamplerView *view, double tau_px, Jobs *jobs, CurveSample *out) {
    LodView lod_view = view->lod;
    LodCut cut;
    lod_view.tau_px = tau_px;
    arena_reset(sampler->arena);
    int64_t begin_ns = pace_thread_ns(); // others have the processor in between
    Result result = lod_update(sampler->lod, &lod_view, jobs, sampler->arena, &cut);
    double refine_ms = (double)(pace_thread_ns() - begin_ns) * MS_PER_NS;
    if (result == RESULT_OK)
        *out = (CurveSample){.tau_px = tau_px,
                             .triangles = triangles_in_view(&cut, view),
                             .refine_ms = refine_ms,
                             .made_ns = clock_now_ns()};
    if (result == RESULT_OK || result == RESULT_BUDGET)
        lod_release(sampler->lod, cut.frame);
    return result;
}
