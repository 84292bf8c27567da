// render/craft/craft_parts.h: the parts of an aircraft as solids: wings, bodies, struts, legs, propellers.
// Body axes, metres.
// Each adds whole pieces to the builder; nothing owned.
#pragma once
#include "render/craft/craft_mesh.h"

// Where a joint turns: about `axis`, a unit vector, through `at`. Right-handed turns by positive angles move trailing
// edges down, a rudder's to the right.
typedef struct CraftHinge {
    Vec3d at, axis;
} CraftHinge;

// The right half, or with `mirror` the left one, with its controls' hinges into `hinges` (by CraftJoint).
void craft_add_wing(CraftBuilder *builder, const CraftWing *wing, CraftSurface surface, bool mirror,
                    CraftHinge *hinges);
void craft_add_fin(CraftBuilder *builder, const CraftWing *fin, CraftHinge *hinges);
// Lines where controls meet the wing: drawn, because gaps finer than a pixel would flicker. At most `room`; how many.
int craft_mark_seams(const CraftWing *wing, CraftSurface surface, int room, CraftMark *marks);
void craft_add_body(CraftBuilder *builder, const CraftBody *body, bool mirror);
void craft_add_strut(CraftBuilder *builder, const CraftStrut *strut, bool mirror);
void craft_add_leg(CraftBuilder *builder, const CraftLeg *leg, CraftJoint joint, bool mirror);
// Blades as solids; hub at CraftPropeller.hub, the first blade up.
void craft_add_blades(CraftBuilder *builder, const CraftPropeller *propeller);
// What is seen of them when they turn fast: a sheet.
void craft_add_disc(CraftBuilder *builder, const CraftPropeller *propeller);
