#include "terrain/lod/lod.h"

#include "base/log.h"
#include "terrain/lod/lod_method.h"

#include <math.h>
#include <stdlib.h>

// clang-format off
static const struct {
    const LodOps *ops;
    const char *name, *source;
} METHODS[LOD_METHOD_COUNT] = {
#define LOD_METHOD_ROW(id, name, source) [LOD_##id] = {&LOD_##id##_OPS, name, source},
    LOD_METHOD_TABLE(LOD_METHOD_ROW)
#undef LOD_METHOD_ROW
};
// clang-format on

struct Lod {
    const LodOps *ops;
    void *state;
    uint64_t frame, released;
};

const char *lod_method_name(LodMethod method) {
    return METHODS[method].name;
}

const char *lod_method_source(LodMethod method) {
    return METHODS[method].source;
}

LodOptions lod_default_options(void) {
    return (LodOptions){.method = LOD_HYBRID,
                        .max_triangles = 4000000,
                        .page_bytes_max = (size_t)256 << 20,
                        .reuse = true,
                        .bound = LOD_BOUND_PUBLISHED,
                        .unit_m = 1.0,
                        .tile_side = 33};
}

static Result check_options(const LodOptions *options) {
    int cells = options->tile_side - 1;
    if ((unsigned)options->method >= LOD_METHOD_COUNT || options->partitions < 0 ||
        options->partitions > LOD_PARTITIONS_MAX || options->max_triangles < 1) {
        log_error("level of detail: method %d, %d partitions, %lld triangles at most: give one of %d methods, 0 to %d "
                  "partitions, and a triangle or more",
                  (int)options->method, options->partitions, (long long)options->max_triangles, LOD_METHOD_COUNT,
                  LOD_PARTITIONS_MAX);
        return RESULT_RANGE;
    }
    if (!isfinite(options->unit_m) || options->unit_m <= 0.0) {
        log_error("level of detail: a unit of %g m: give a positive one", options->unit_m);
        return RESULT_RANGE;
    }
    if (cells < 2 || cells > 128 || (cells & (cells - 1)) != 0) {
        log_error("level of detail: tiles of %d samples a side: give 3, 5, 9 ... 129", options->tile_side);
        return RESULT_RANGE;
    }
    return RESULT_OK;
}

Result lod_create(const LodOptions *options, const Terrain *terrain, Lod **out) {
    Result result = check_options(options);
    if (result != RESULT_OK)
        return result;
    Lod *lod = calloc(1, sizeof *lod);
    if (!lod)
        return RESULT_MEMORY;
    lod->ops = METHODS[options->method].ops;
    result = lod->ops->create(options, terrain, &lod->state);
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
