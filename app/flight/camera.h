// app/flight/camera.h: from the aircraft's state to the camera of the picture.
// ECEF metres, radians, seconds.
// Values only.
#pragma once
#include "app/dynamics/flight_model.h"
#include "render/render.h"

typedef enum CameraView {
    CAMERA_COCKPIT,
    CAMERA_CHASE,  // behind and above, the horizon level
    CAMERA_FLY_BY, // from beside the way ahead, until the aircraft is past
    CAMERA_MAP,    // straight down from high above, north up
    CAMERA_FREE,   // where it is flown to; begins where the view before it was
    CAMERA_RIGHT,
    CAMERA_BACK,
    CAMERA_LEFT,
    CAMERA_DOWN,
    CAMERA_VIEW_COUNT
} CameraView;
const char *camera_view_name(CameraView view);            // "cockpit"
bool camera_view_find(const char *name, CameraView *out); // false: no such view
bool camera_is_outside(CameraView view);                  // the aircraft is seen from without, if it is in sight

// What the views that do not hang on the aircraft remember.
typedef struct CameraRig {
    CameraView view;            // that it was moved for last
    Vec3d eye_ecef;             // of fly-by and free
    double placed_m;            // fly-by: how far the aircraft was when the eye was put there
    double heading_rad;         // free: clockwise from north
    double pitch_rad;           // free: up
    double look_right, look_up; // in the cockpit: shares of all that a head turns, -1..1
} CameraRig;

// How a person flies the free camera: shares of its full speeds, -1..1.
typedef struct CameraMotion {
    double turn, tilt;   // right, up
    double ahead, aside; // along where it looks; to the right
} CameraMotion;

// Moves the rig on by `passed_s` for the view that is shown now.
void camera_rig_advance(CameraRig *rig, const Flight *flight, CameraView view, const CameraMotion *motion,
                        double passed_s);

// Pixels a radian at the centre of a picture, or at its corners, where a pixel sees less of the view: by 1 / cos^2 of
// their angle off the centre.
double camera_px_per_rad(double fov_y_rad, double width, double height, bool corner);
// The eye stays above the ground wherever the aircraft is.
RenderCamera camera_of_flight(const Flight *flight, const CameraRig *rig, CameraView view, double fov_y_rad);
