// render/craft/craft_pass.h: draws an aircraft, in the same light and air as the land, and its shadow for the land.
// Units as in render/frame.h.
// A CraftPass owns its programs, buffers and models; thread of the context.
#pragma once
#include "render/craft/craft_cast.h"
#include "render/frame.h"

typedef struct CraftPass CraftPass;

// Programs and models are made when they are first needed. MEMORY.
MUST_USE Result craft_pass_create(CraftPass **out);
void craft_pass_destroy(CraftPass **pass);

// Before the land is drawn: draws what the aircraft's own light needs, and, where its shadow falls on land that the
// view shows, the map for shaders/craft_shade.glsl, and binds it. The frame block is not needed. Builds the kind's
// model when it is first drawn. Leaves framebuffer, viewport and the scissor test changed. DEVICE, NOT_FOUND, MEMORY:
// nothing falls.
MUST_USE Result craft_pass_prepare(CraftPass *pass, const Frame *frame, const RenderCraft *craft, const CraftLand *land,
                                   CraftCast *cast);
// What was prepared, if it is shown, into the bound framebuffer, over what is there: the frame block and the tables of
// the air are bound. Sets the test of depth; leaves blending off.
void craft_pass_draw(CraftPass *pass, const RenderCraft *craft);
