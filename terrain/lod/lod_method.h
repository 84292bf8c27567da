// terrain/lod/lod_method.h: what a method of terrain/lod/lod.h has to provide.
// As terrain/lod/lod.h.
// A method's state belongs to the Lod that created it.
#pragma once
#include "terrain/lod/lod.h"

typedef struct LodCall {
    const LodView *view;
    Jobs *jobs;
    Arena *frame;      // for the cut
    uint64_t number;   // of this frame, from 1
    uint64_t released; // frames up to this one are no longer read
} LodCall;

// Ids of pages and revisions count up from here.
static inline uint64_t lod_first_id(const LodOptions *options) {
    return (uint64_t)options->serial << 40;
}

typedef struct LodOps {
    Result (*create)(const LodOptions *options, const Terrain *terrain, void **state);
    void (*destroy)(void *state);
    // Fills items, stats, reached_px and promises of `cut`.
    Result (*update)(void *state, const LodCall *call, LodCut *cut);
    void (*release)(void *state, uint64_t frame);
} LodOps;

extern const LodOps LOD_HYBRID_OPS;
extern const LodOps LOD_PATCH_OPS;
extern const LodOps LOD_ROAM_OPS;
extern const LodOps LOD_ROAM_PARALLEL_OPS;
extern const LodOps LOD_GEOMIPMAP_OPS;
extern const LodOps LOD_GEOMIPMAP_YE_OPS;
extern const LodOps LOD_DIAMOND_OPS;
extern const LodOps LOD_BRUTE_OPS;
