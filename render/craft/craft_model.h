// render/craft/craft_model.h: a whole aircraft as triangles, and how its parts move.
// Body axes: x ahead, y right, z down; metres, radians.
// A CraftModel owns its mesh; values of it may be read by any thread.
#pragma once
#include "render/craft/craft_parts.h"

// What is drawn together: a range of the mesh's indices.
typedef enum CraftRange {
    CRAFT_RANGE_AIRFRAME,
    CRAFT_RANGE_GEAR, // empty where the gear does not fold: it is airframe
    CRAFT_RANGE_BLADES,
    CRAFT_RANGE_DISC,
    CRAFT_RANGE_COUNT
} CraftRange;

typedef struct CraftModel {
    CraftMesh mesh;
    CraftHinge hinges[CRAFT_JOINT_COUNT];
    double fold_rad[CRAFT_JOINT_COUNT]; // of legs, from down to up
    int first[CRAFT_RANGE_COUNT], count[CRAFT_RANGE_COUNT];
    double radius_m; // of a sphere about the origin that holds all
    Vec3d low, high; // and of a box, gear down, with controls straight
} CraftModel;

// Less than 20,000 triangles. The same shape gives the same bytes. MEMORY.
MUST_USE Result craft_model_create(const CraftShape *shape, CraftModel *model);
void craft_model_free(CraftModel *model);

// All that is painted: the shape's marks and the seams of its controls; how many.
int craft_list_marks(const CraftShape *shape, CraftMark marks[CRAFT_MARKS_MAX]);

// How the moving parts stand. Signs are those of what the aircraft does.
typedef struct CraftPose {
    double aileron_rad;   // > 0 rolls to the right: the right one's trailing edge up, the left one's down
    double elevator_rad;  // > 0 pitches up: trailing edges up
    double rudder_rad;    // > 0 yaws to the right: trailing edge right
    double flaps_rad;     // > 0 down
    double gear;          // 0 up .. 1 down
    double propeller_rad; // > 0 clockwise seen from behind
    double rpm;           // turns a minute
} CraftPose;

// By how much a joint turns about its hinge.
double craft_joint_angle_rad(const CraftModel *model, CraftJoint joint, const CraftPose *pose);

// What is seen of a turning propeller: how opaque its disc is, 0: blades alone.
double craft_disc_share(const CraftPose *pose);
bool craft_shows_range(const CraftModel *model, CraftRange range, const CraftPose *pose);

// From a joint's vertices to metres from the eye along the axes of ECEF: rows of three columns and an offset. The
// offset is computed in double: near the craft it is exact to a float's rounding of that distance, not of the Earth's.
typedef struct CraftPlacement {
    float rows[3][4];
} CraftPlacement;
CraftPlacement craft_place_joint(const CraftModel *model, CraftJoint joint, const CraftPose *pose, Quatd ecef_from_body,
                                 Vec3d craft_from_eye_m);
