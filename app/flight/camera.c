#include "app/flight/camera.h"

#include "app/flight/flight_contact.h"
#include "terrain/geodesy.h"

#include <math.h>

#define CHASE_BEHIND_M 45.0
#define CHASE_ABOVE_M 14.0
#define EYE_CLEARANCE_M 1.0

const char *camera_view_name(CameraView view) {
    static const char *const names[CAMERA_VIEW_COUNT] = {"cockpit", "chase", "right", "back", "left", "down"};
    return names[view];
}

static Mat3d rows(Vec3d right, Vec3d up, Vec3d back) {
    return (Mat3d){{{right.x, right.y, right.z}, {up.x, up.y, up.z}, {back.x, back.y, back.z}}};
}

// Directions to look along and up, in body axes.
static void view_axes(CameraView view, Vec3d *ahead, Vec3d *up) {
    static const Vec3d aheads[CAMERA_VIEW_COUNT] = {
        [CAMERA_COCKPIT] = {1, 0, 0}, [CAMERA_CHASE] = {1, 0, 0}, [CAMERA_RIGHT] = {0, 1, 0},
        [CAMERA_BACK] = {-1, 0, 0},   [CAMERA_LEFT] = {0, -1, 0}, [CAMERA_DOWN] = {0, 0, 1}};
    *ahead = aheads[view];
    *up = view == CAMERA_DOWN ? vec3d(1, 0, 0) : vec3d(0, 0, -1);
}

static Mat3d look_along(Vec3d ahead, Vec3d up) {
    return rows(vec3d_cross(ahead, up), up, vec3d_scale(ahead, -1.0));
}

static Vec3d above_ground(const Flight *flight, Vec3d eye, Vec3d up) {
    double above_m;
    if (flight_ground_below(&flight->ground, eye, &above_m) && above_m < EYE_CLEARANCE_M)
        return vec3d_mad(eye, up, EYE_CLEARANCE_M - above_m);
    return eye;
}

// Level whatever the bank; where the nose points straight up, the wing gives the direction.
static RenderCamera chase(const Flight *flight, Vec3d up) {
    Vec3d ahead = quatd_rotate(flight->state.ecef_from_body, vec3d(1, 0, 0));
    Vec3d level = vec3d_mad(ahead, up, -vec3d_dot(ahead, up));
    if (vec3d_length(level) < 0.05)
        level = vec3d_cross(quatd_rotate(flight->state.ecef_from_body, vec3d(0, -1, 0)), up);
    level = vec3d_normalize(level);
    Vec3d eye = vec3d_mad(vec3d_mad(flight->state.position_ecef, level, -CHASE_BEHIND_M), up, CHASE_ABOVE_M);
    double tilt = atan2(CHASE_ABOVE_M, 3.0 * CHASE_BEHIND_M);
    Vec3d look = vec3d_mad(vec3d_scale(level, cos(tilt)), up, -sin(tilt));
    Vec3d above = vec3d_mad(vec3d_scale(level, sin(tilt)), up, cos(tilt));
    return (RenderCamera){.eye_ecef = above_ground(flight, eye, up), .camera_from_ecef = look_along(look, above)};
}

double camera_px_per_rad(double fov_y_rad, double width, double height, bool corner) {
    double centre = height / (2.0 * tan(fov_y_rad / 2.0));
    return corner ? centre * (1.0 + (width * width + height * height) / (4.0 * centre * centre)) : centre;
}

RenderCamera camera_of_flight(const Flight *flight, CameraView view, double fov_y_rad) {
    Geodetic place = geodesy_from_ecef(flight->state.position_ecef);
    Vec3d local_up = geodesy_up(place.lat_rad, place.lon_rad);
    RenderCamera camera;
    if (view == CAMERA_CHASE) {
        camera = chase(flight, local_up);
    } else {
        Vec3d ahead, up;
        view_axes(view, &ahead, &up);
        camera.eye_ecef = above_ground(flight, flight->state.position_ecef, local_up);
        camera.camera_from_ecef = look_along(quatd_rotate(flight->state.ecef_from_body, ahead),
                                             quatd_rotate(flight->state.ecef_from_body, up));
    }
    camera.fov_y_rad = fov_y_rad;
    return camera;
}
