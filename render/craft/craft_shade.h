// render/craft/craft_shade.h: an aircraft as the land's shaders see it from the sun: which share of each texel it
// covers, and how deep, in mipmaps, so that a penumbra of any width is a few texels.
// Metres from the eye along the axes of ECEF; map coordinates as in render/craft/craft_shadow.h.
// A CraftShade owns its program, textures, framebuffer and buffer; thread of the context.
#pragma once
#include "base/base.h"
#include "base/vec.h"

// As shaders/craft_shade.glsl has them.
#define CRAFT_SHADE_UNIT 15
#define CRAFT_SHADE_BLOCK_BINDING 4

// std140; the twin of shaders/craft_shade.glsl.
typedef struct CraftShadeBlock {
    float map_rows[3][4]; // of craft_shadow_project
} CraftShadeBlock;
_Static_assert(sizeof(CraftShadeBlock) == 3 * 16, "as shaders/craft_shade.glsl has it");

typedef struct CraftShade CraftShade;

// DEVICE, NOT_FOUND, MEMORY.
MUST_USE Result craft_shade_create(CraftShade **out);
void craft_shade_destroy(CraftShade **shade);

// What is drawn between goes to the map, which covers `across_m` metres and has texels of `texel_m` or less, as far as
// there are; its vertices are transformed as by shaders/craft_shadow.vert. Leaves the framebuffer and the viewport
// changed. The end makes the mipmaps and binds map and block.
void craft_shade_begin(CraftShade *shade, double across_m, double texel_m);
void craft_shade_end(CraftShade *shade, const float map_rows[3][4]);
