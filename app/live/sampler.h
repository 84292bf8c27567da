// app/live/sampler.h: what other tolerances would give for the view that is flown, by a Lod of one's own.
// Pixels, milliseconds.
// A Sampler owns its Lod and borrows the terrain; one thread at a time.
#pragma once
#include "app/live/curve.h"
#include "base/base.h"
#include "render/render.h"
#include "terrain/lod/lod.h"

typedef struct SamplerView {
    LodView lod;
    RenderCamera camera;
    int width, height; // of the picture, or of half of it
} SamplerView;

typedef struct Sampler Sampler;
// Errors of lod_create.
MUST_USE Result sampler_create(const LodOptions *lod, LodMethod method, const Terrain *terrain, Sampler **out);
void sampler_destroy(Sampler **sampler);
LodMethod sampler_method(const Sampler *sampler);
// Refines the view from scratch with another tolerance and counts the triangles that are in view. BUDGET: it has more
// triangles than a sample may; there is no sample. `jobs` of one worker: times are of the calling thread.
MUST_USE Result sampler_take(Sampler *sampler, const SamplerView *view, double tau_px, Jobs *jobs, CurveSample *out);
