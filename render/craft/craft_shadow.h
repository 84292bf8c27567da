// render/craft/craft_shadow.h: which parts of an aircraft lie in the shadow of others: a map of depths seen from the
// sun. Metres from the eye along the axes of ECEF; map coordinates 0 .. 1, depth 1 nearest to the sun. A CraftShadow
// owns its program, texture and framebuffer; thread of the context.
#pragma once
#include "base/base.h"
#include "base/vec.h"

#define CRAFT_SHADOW_UNIT 14 // shaders/craft.frag

typedef struct CraftShadow CraftShadow;

// DEVICE, NOT_FOUND, MEMORY.
MUST_USE Result craft_shadow_create(CraftShadow **out);
void craft_shadow_destroy(CraftShadow **shadow);

// The map's axes in ECEF: to its right and its top.
void craft_shadow_axes(Vec3d sun_ecef, Vec3d *right, Vec3d *top);
// Rows of three columns and an offset, from metres from the eye to map coordinates and depth, for a sphere.
void craft_shadow_project(Vec3d sun_ecef, Vec3d centre_from_eye_m, double radius_m, float rows[3][4]);

// What is drawn between goes to the map; its vertices are transformed as by shaders/craft_shadow.vert. Leaves the
// framebuffer, the viewport and the scissor test changed. The end binds the map.
void craft_shadow_begin(CraftShadow *shadow);
void craft_shadow_end(CraftShadow *shadow);
