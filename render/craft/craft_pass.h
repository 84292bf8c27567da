// render/craft/craft_pass.h: draws an aircraft into the scene, in the same light and air as the land.
// Units as in render/frame.h.
// A CraftPass owns its program, buffers and models; thread of the context.
#pragma once
#include "render/frame.h"

typedef struct CraftPass CraftPass;

// Compiles the shaders. DEVICE, NOT_FOUND, MEMORY.
MUST_USE Result craft_pass_create(CraftPass **out);
void craft_pass_destroy(CraftPass **pass);

// Into the bound framebuffer, over what is there: the frame block and the tables of the air are bound. Builds the
// kind's model when it is first drawn. Scissors are on before and after. Sets the test
// of depth; leaves blending off. MEMORY:
// nothing is drawn.
MUST_USE Result craft_pass_draw(CraftPass *pass, const Frame *frame, const RenderCraft *craft);
