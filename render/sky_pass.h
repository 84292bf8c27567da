// render/sky_pass.h: all that is not terrain: the sky, and the globe around the data.
// Units as in render/frame.h.
// A SkyPass owns its programs and buffers; thread of the context.
#pragma once
#include "render/craft/craft_cast.h"
#include "render/frame.h"

typedef struct SkyPass SkyPass;

// `defines`: those of the land's programs.
MUST_USE Result sky_pass_create(const char *defines, SkyPass **out);
void sky_pass_destroy(SkyPass **pass);
// Where depth is still that of infinity. The frame's block and textures are bound, and where an aircraft's shadow falls
// on the globe, what shaders/craft_shade.glsl needs. Changes the depth function.
void sky_pass_draw(SkyPass *pass, const Frame *frame, const CraftCast *cast);
