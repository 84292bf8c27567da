// render/scene.h: the picture of one terrain: land, sky, and the Earth around, into the bound framebuffer.
// Units as in render/frame.h.
// A Scene owns its programs, textures and passes, and borrows the Terrain; thread of the context.
#pragma once
#include "render/frame.h"
#include "render/render.h"

typedef struct Scene Scene;

MUST_USE Result scene_create(const RenderOptions *options, const Terrain *terrain, bool software, Scene **out);
void scene_destroy(Scene **scene);

// Uploads what the packet brings. MEMORY: the patches were not uploaded; the rest can still be drawn.
MUST_USE Result scene_prepare(Scene *scene, const RenderPacket *packet, int width, int height);
// Draws what was prepared. Sets all the state it needs; leaves it set.
void scene_draw(Scene *scene, const RenderPacket *packet, unsigned framebuffer, int width, int height);
void scene_count(const Scene *scene, RenderStats *stats);
