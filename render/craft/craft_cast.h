// render/craft/craft_cast.h: where on the ground an aircraft's shadow falls, and which part of the picture that is.
// ECEF metres; pixels from the lower left corner of the view.
// Values only.
#pragma once
#include "render/frame.h"
#include "terrain/terrain.h"

#define CRAFT_SUN_TANGENT 0.0046532 // of the sun's mean angular radius, 959.63" at 1 au (IAU 1976); craft_shade.glsl

typedef struct CraftLand {
    const Terrain *terrain;
    double coarse_m, coarse_rad; // what is drawn is off by so much, and by so much of its distance
    int view_width, view_height; // pixels
} CraftLand;

typedef struct CraftBounds {
    double left, bottom, right, top; // of what is in the view -1 .. 1
} CraftBounds;

#define CRAFT_CAST_PARTS 10
#define CRAFT_CAST_BESIDE (2 * CRAFT_CAST_PARTS * (CRAFT_CAST_PARTS + 1))

typedef struct CraftPixels {
    int x, y, width, height;
} CraftPixels;

typedef struct CraftCast {
    bool falls;              // where the picture shows it; else the rest is not set
    bool on_globe;           // beside the terrain too
    double nearest_m, eye_m; // the shadow from the aircraft, along the sun's rays, and from the eye: so far at least
    Vec3d centre_ecef;       // a sphere that holds all of it
    double radius_m;
    CraftBounds clip;   // all of it is within, in the view's clip space
    double long_m;      // the ground it may fall on, along the sun's rays
    CraftPixels pixels; // and of the pixels, in these
    int beside_count;   // but not in these, which do not overlap
    CraftPixels beside[CRAFT_CAST_BESIDE];
} CraftCast;

// An aircraft, and a box that holds all of it; body axes.
typedef struct CraftBox {
    Vec3d position_ecef;
    Quatd ecef_from_body;
    Vec3d low, high;
    double gone_m; // so far from it no shadow is left
} CraftBox;

// Of an aircraft that lies within the box, and within `reach_m` of its position.
CraftCast craft_cast_find(const CraftLand *land, const Frame *frame, const CraftBox *box, double reach_m);
// Makes the pixels of one that falls fewer: those of boxes that hold all of the aircraft, CRAFT_CAST_PARTS at most.
// Each has its own position, in its middle.
void craft_cast_narrow(const CraftLand *land, const Frame *frame, const CraftBox *boxes, int count, CraftCast *cast);
