// render/terrain_pass.h: draws the items of a cut from the patch cache with one multi-draw.
// Units as in render/frame.h.
// A TerrainPass owns its programs and buffers; thread of the context.
#pragma once
#include "render/frame.h"
#include "render/ground/ground.h"
#include "render/patch_cache.h"

typedef struct TerrainPass TerrainPass;

// `noise_repeats`: of the ground's noise, per column and per row.
MUST_USE Result terrain_pass_create(const double noise_repeats[2], TerrainPass **out);
void terrain_pass_destroy(TerrainPass **pass);

// Brings the packet's patches into the cache and lists those that can be seen, nearest first. When the cut does not
// fit into the cache, only what is in view is brought there; when even that does not fit, the last cut that did is
// listed again, unless another pass used the cache since; then the nearest that fit. A warning says so once. MEMORY:
// nothing is listed.
MUST_USE Result terrain_pass_prepare(TerrainPass *pass, PatchCache *cache, const Frame *frame, const Ground *ground,
                                     const LodCut *cut);

typedef enum TerrainPart {
    TERRAIN_DRY, // patches without water: a program that knows none is enough
    TERRAIN_WET, // the others
    TERRAIN_ALL,
} TerrainPart;
// Draws a part of the list with the program that is bound.
void terrain_pass_draw(TerrainPass *pass, const PatchCache *cache, TerrainPart part);
// Only what comes near a sphere.
void terrain_pass_draw_near(TerrainPass *pass, const PatchCache *cache, TerrainPart part, Vec3d centre_ecef,
                            double radius_m);
void terrain_pass_count(const TerrainPass *pass, RenderCutStats *stats);
