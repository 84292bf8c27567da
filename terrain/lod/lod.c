#include "terrain/lod/lod.h"

#include "base/log.h"
#include "terrain/lod/lod_method.h"

#include <math.h>
#include <stdlib.h>

static const LodOps *const METHODS[LOD_METHOD_COUNT] = {
    [LOD_HYBRID] = &LOD_HYBRID_OPS,
    [LOD_PATCH] = &LOD_PATCH_OPS,
    [LOD_ROAM] = &LOD_ROAM_OPS,
    [LOD_ROAM_PARALLEL] = &LOD_ROAM_PARALLEL_OPS,
    [LOD_GEOMIPMAP] = &LOD_GEOMIPMAP_OPS,
    [LOD_GEOMIPMAP_YE] = &LOD_GEOMIPMAP_YE_OPS,
    [LOD_DIAMOND] = &LOD_DIAMOND_OPS,
    [LOD_BRUTE] = &LOD_BRUTE_OPS,
};

struct Lod {
    const LodOps *ops;
    void *state;
    uint64_t frame, released;
};

const char *lod_method_name(LodMethod method) {
    static const char *const names[LOD_METHOD_COUNT] = {
#define LOD_METHOD_NAME(id, name, source) name,
        LOD_METHOD_TABLE(LOD_METHOD_NAME)
#undef LOD_METHOD_NAME
    };
    return names[method];
}

const char *lod_method_source(LodMethod method) {
    static const char *const sources[LOD_METHOD_COUNT] = {
#define LOD_METHOD_SOURCE(id, name, source) source,
        LOD_METHOD_TABLE(LOD_METHOD_SOURCE)
#undef LOD_METHOD_SOURCE
    };
    return sources[method];
}

LodOptions lod_default_options(void) {
    return (LodOptions){.method = LOD_HYBRID,
                        .max_triangles = 4000000,
                        .page_bytes_max = (size_t)256 << 20,
                        .reuse = true,
                        .bound = LOD_BOUND_PUBLISHED,
                        .tile_side = 33};
}

Result lod_create(const LodOptions *options, const Terrain *terrain, Lod **out) {
    if (options->partitions < 0 || options->partitions > LOD_PARTITIONS_MAX || options->max_triangles < 1) {
        log_error(
            "level of detail: %d partitions, %lld triangles at most: give 0 to %d partitions, and a triangle or more",
            options->partitions, (long long)options->max_triangles, LOD_PARTITIONS_MAX);
        return RESULT_RANGE;
    }
    if (!METHODS[options->method]) {
        log_error("level of detail: %s is not part of this program", lod_method_name(options->method));
        return RESULT_NOT_FOUND;
    }
    Lod *lod = calloc(1, sizeof *lod);
    if (!lod)
        return RESULT_MEMORY;
    lod->ops = METHODS[options->method];
    Result result = lod->ops->create(options, terrain, &lod->state);
    if (result != RESULT_OK) {
        if (result == RESULT_MEMORY) // the method has told anything else
            log_error("level of detail: %s: not enough memory", lod_method_name(options->method));
        free(lod);
        return result;
    }
    *out = lod;
    return RESULT_OK;
}

void lod_destroy(Lod **lod) {
    if (!*lod)
        return;
    (*lod)->ops->destroy((*lod)->state);
    free(*lod);
    *lod = NULL;
}

static bool is_positive(double value) {
    return isfinite(value) && value > 0.0;
}

static Result check_view(const LodView *view) {
    if (isfinite(view->eye_ecef.x) && isfinite(view->eye_ecef.y) && isfinite(view->eye_ecef.z) &&
        is_positive(view->px_per_rad) && is_positive(view->tau_px))
        return RESULT_OK;
    log_error(
        "level of detail: a view with eye (%g, %g, %g), %g px/rad, tolerance %g px: all must be finite, the last two "
        "positive",
        view->eye_ecef.x, view->eye_ecef.y, view->eye_ecef.z, view->px_per_rad, view->tau_px);
    return RESULT_RANGE;
}

Result lod_update(Lod *lod, const LodView *view, Jobs *jobs, Arena *frame, LodCut *cut) {
    Result result = check_view(view);
    if (result != RESULT_OK)
        return result;
    LodCall call = {view, jobs, frame, ++lod->frame, lod->released};
    *cut = (LodCut){.frame = lod->frame, .view = *view, .reached_px = view->tau_px};
    return lod->ops->update(lod->state, &call, cut);
}

void lod_release(Lod *lod, uint64_t frame) {
    if (frame <= lod->released)
        return;
    lod->released = frame;
    lod->ops->release(lod->state, frame);
}
