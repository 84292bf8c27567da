// app/picture_options.h: what `fly` and `snapshot` hand to the renderer, from the options and the scene.
// Pixels, degrees.
// Texts are borrowed from the options and the scene.
#pragma once
#include "app/scene_load.h"
#include "render/context/context.h"
#include "render/render.h"

ContextOptions picture_context_options(const Options *options);
// --size, --vram, --image and its bounds, else the scene's image.
RenderOptions picture_render_options(const Options *options, const World *world);
