// render/scene.h: the picture of one terrain: land, sky, and the Earth around, into the bound framebuffer.
// Units as in render/frame.h.
// A Scene owns its programs, textures and passes, and borrows the Terrain; thread of the context.
#pragma once
#include "render/frame.h"
#include "render/render.h"

typedef struct Scene Scene;

// A cut and where in the picture it is drawn: all of it, or one of two halves.
typedef struct SceneView {
    const LodCut *cut;
    int index;            // 0; of the right half 1
    int x, width, height; // pixels from the left edge, and as high as the picture
} SceneView;

MUST_USE Result scene_create(const RenderOptions *options, const Terrain *terrain, bool software, Scene **out);
void scene_destroy(Scene **scene);

// Each view is prepared, drawn and counted before the next one is prepared; together they need not fit into the patch
// cache.
// Uploads what the view brings. MEMORY: the patches were not uploaded; the rest can still be drawn.
MUST_USE Result scene_prepare(Scene *scene, const RenderPacket *packet, const SceneView *view);
// Draws what was prepared into its part of the framebuffer, and nothing outside. Sets all the state it needs; leaves it
// set, but the scissor test, which is off then.
void scene_draw(Scene *scene, const RenderPacket *packet, const SceneView *view, unsigned framebuffer);
// Counts what scene_draw drew last; the times stay as they are.
void scene_count(const Scene *scene, const SceneView *view, RenderCutStats *stats);
// Between frames: the patch cache begins anew.
void scene_forget_patches(Scene *scene);
int64_t scene_vram_bytes(const Scene *scene);
