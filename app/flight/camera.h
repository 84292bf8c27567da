// app/flight/camera.h: from the aircraft's state to the camera of the picture.
// ECEF metres, radians.
// Values only.
#pragma once
#include "app/flight/flight_model.h"
#include "render/render.h"

typedef enum CameraView {
    CAMERA_COCKPIT,
    CAMERA_CHASE, // behind and above, the horizon level
    CAMERA_RIGHT,
    CAMERA_BACK,
    CAMERA_LEFT,
    CAMERA_DOWN,
    CAMERA_VIEW_COUNT
} CameraView;
const char *camera_view_name(CameraView view); // "cockpit"

// Pixels a radian at the centre of a picture, or at its corners, where a pixel sees less of the view: by 1 / cos^2 of
// their angle off the centre.
double camera_px_per_rad(double fov_y_rad, double width, double height, bool corner);
// The eye stays above the ground wherever the aircraft is.
RenderCamera camera_of_flight(const Flight *flight, CameraView view, double fov_y_rad);
