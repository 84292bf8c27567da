#include "app/flight/camera.h"

#include "app/dynamics/flight_contact.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <string.h>

#define CHASE_BEHIND_M 26.0
#define CHASE_ABOVE_M 7.0
#define EYE_CLEARANCE_M 1.0
#define LOOK_RIGHT_RAD 2.1
#define LOOK_UP_RAD 1.0
#define FLY_BY_AHEAD_S 3.0 // of flight: where the eye waits,
#define FLY_BY_AHEAD_MIN_M 60.0
#define FLY_BY_AHEAD_MAX_M 500.0
#define FLY_BY_ASIDE 0.18 // of that way, to the right of it
#define FLY_BY_ABOVE_M 3.0
#define FLY_BY_PAST 1.3      // times as far as it was when the eye was placed: the next place
#define FLY_BY_SPAN_M 11.0   // of an aircraft, which takes
#define FLY_BY_SHARE 0.22    // of the picture's height, about,
#define FLY_BY_LENS_RAD 0.16 // with no longer a lens than this
#define MAP_HEIGHT_MIN_M 4000.0
#define MAP_HEIGHT 4.0      // times the height above the ground
#define FREE_TURN_RATE 0.9  // rad/s
#define FREE_PITCH_MAX 1.55 // rad
#define FREE_SPEED_MIN 15.0 // m/s
#define FREE_SPEED 0.6      // of the height above the ground, a second
#define FREE_FAR_M 1.0e6    // above the ground, at most

const char *camera_view_name(CameraView view) {
    static const char *const names[CAMERA_VIEW_COUNT] = {"cockpit", "chase", "fly-by", "map", "free",
                                                         "right",   "back",  "left",   "down"};
    return names[view];
}

bool camera_view_find(const char *name, CameraView *out) {
    for (int i = 0; i < CAMERA_VIEW_COUNT; i++)
        if (strcmp(camera_view_name((CameraView)i), name) == 0) {
            *out = (CameraView)i;
            return true;
        }
    return false;
}

bool camera_is_outside(CameraView view) {
    return view == CAMERA_CHASE || view == CAMERA_FLY_BY || view == CAMERA_MAP || view == CAMERA_FREE;
}

static Mat3d rows(Vec3d right, Vec3d up, Vec3d back) {
    return (Mat3d){{{right.x, right.y, right.z}, {up.x, up.y, up.z}, {back.x, back.y, back.z}}};
}

// Directions to look along and up, in body axes.
static void view_axes(CameraView view, Vec3d *ahead, Vec3d *up) {
    static const Vec3d aheads[CAMERA_VIEW_COUNT] = {[CAMERA_COCKPIT] = {1, 0, 0},
                                                    [CAMERA_RIGHT] = {0, 1, 0},
                                                    [CAMERA_BACK] = {-1, 0, 0},
                                                    [CAMERA_LEFT] = {0, -1, 0},
                                                    [CAMERA_DOWN] = {0, 0, 1}};
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

// ---- views that stand still, or fly by themselves ----

static Vec3d up_at(Vec3d position_ecef) {
    Geodetic place = geodesy_from_ecef(position_ecef);
    return geodesy_up(place.lat_rad, place.lon_rad);
}

// Beside the path, so that the aircraft comes by on the left.
static void place_fly_by(CameraRig *rig, const Flight *flight) {
    const FlightState *state = &flight->state;
    Vec3d up = up_at(state->position_ecef), way = state->velocity_ecef;
    double speed = vec3d_length(way);
    if (speed < 1.0)
        way = quatd_rotate(state->ecef_from_body, vec3d(1, 0, 0));
    way = vec3d_normalize(way);
    double ahead_m = fmin(fmax(speed * FLY_BY_AHEAD_S, FLY_BY_AHEAD_MIN_M), FLY_BY_AHEAD_MAX_M);
    Vec3d aside = vec3d_cross(way, up);
    if (vec3d_length(aside) < 0.05)
        aside = quatd_rotate(state->ecef_from_body, vec3d(0, 1, 0));
    Vec3d eye = vec3d_mad(state->position_ecef, way, ahead_m);
    eye = vec3d_mad(eye, vec3d_normalize(aside), FLY_BY_ASIDE * ahead_m);
    rig->eye_ecef = above_ground(flight, vec3d_mad(eye, up, FLY_BY_ABOVE_M), up);
    rig->placed_m = vec3d_length(vec3d_sub(state->position_ecef, rig->eye_ecef));
}

static void advance_fly_by(CameraRig *rig, const Flight *flight) {
    double away_m = vec3d_length(vec3d_sub(flight->state.position_ecef, rig->eye_ecef));
    if (rig->view != CAMERA_FLY_BY || away_m > FLY_BY_PAST * rig->placed_m)
        place_fly_by(rig, flight);
}

static Mat3d axes_of(Vec3d eye_ecef) {
    Geodetic place = geodesy_from_ecef(eye_ecef);
    return geodesy_enu_from_ecef(place.lat_rad, place.lon_rad);
}

// Where a camera looks, in its own place's east, north and up.
static void take_direction(CameraRig *rig, const RenderCamera *camera) {
    const double *back = camera->camera_from_ecef.m[2];
    Mat3d enu = axes_of(camera->eye_ecef);
    Vec3d look = mat3d_mul_vec(&enu, vec3d(-back[0], -back[1], -back[2]));
    const double *up = camera->camera_from_ecef.m[1]; // where it looks straight down, its top tells the heading
    Vec3d top = mat3d_mul_vec(&enu, vec3d(up[0], up[1], up[2]));
    bool steep = hypot(look.x, look.y) < 0.01;
    rig->heading_rad = steep ? atan2(top.x, top.y) : atan2(look.x, look.y);
    rig->pitch_rad = fmin(fmax(asin(fmin(fmax(look.z, -1.0), 1.0)), -FREE_PITCH_MAX), FREE_PITCH_MAX);
}

static void begin_free(CameraRig *rig, const Flight *flight) {
    // From on board the eye would be inside the aircraft.
    CameraView from = camera_is_outside(rig->view) ? rig->view : CAMERA_CHASE;
    const RenderCamera before = camera_of_flight(flight, rig, from, 1.0);
    rig->eye_ecef = before.eye_ecef;
    take_direction(rig, &before);
}

// Right, ahead and up of the free camera, ECEF.
static void free_axes(const CameraRig *rig, Vec3d *right, Vec3d *ahead, Vec3d *up) {
    Mat3d enu = axes_of(rig->eye_ecef);
    double sh = sin(rig->heading_rad), ch = cos(rig->heading_rad), sp = sin(rig->pitch_rad), cp = cos(rig->pitch_rad);
    *right = mat3d_mul_vec_transposed(&enu, vec3d(ch, -sh, 0.0));
    *ahead = mat3d_mul_vec_transposed(&enu, vec3d(sh * cp, ch * cp, sp));
    *up = mat3d_mul_vec_transposed(&enu, vec3d(-sh * sp, -ch * sp, cp));
}

static void advance_free(CameraRig *rig, const Flight *flight, const CameraMotion *motion, double passed_s) {
    Vec3d right, ahead, up, local_up = up_at(rig->eye_ecef);
    double above_m = 0.0;
    rig->heading_rad = remainder(rig->heading_rad + motion->turn * FREE_TURN_RATE * passed_s, 2.0 * GEODESY_PI);
    rig->pitch_rad =
        fmin(fmax(rig->pitch_rad + motion->tilt * FREE_TURN_RATE * passed_s, -FREE_PITCH_MAX), FREE_PITCH_MAX);
    free_axes(rig, &right, &ahead, &up);
    if (!flight_ground_below(&flight->ground, rig->eye_ecef, &above_m))
        above_m = fmax(geodesy_from_ecef(rig->eye_ecef).h_m, 0.0);
    double way_m = fmax(FREE_SPEED_MIN, FREE_SPEED * above_m) * passed_s;
    Vec3d eye = vec3d_mad(vec3d_mad(rig->eye_ecef, ahead, motion->ahead * way_m), right, motion->aside * way_m);
    if (geodesy_from_ecef(eye).h_m < FREE_FAR_M)
        rig->eye_ecef = above_ground(flight, eye, local_up);
}

void camera_rig_advance(CameraRig *rig, const Flight *flight, CameraView view, const CameraMotion *motion,
                        double passed_s) {
    if (view == CAMERA_FLY_BY)
        advance_fly_by(rig, flight);
    if (view == CAMERA_FREE && rig->view != CAMERA_FREE)
        begin_free(rig, flight);
    if (view == CAMERA_FREE)
        advance_free(rig, flight, motion, passed_s);
    rig->view = view;
}

static RenderCamera fly_by(const Flight *flight, const CameraRig *rig) {
    Vec3d local_up = up_at(rig->eye_ecef), to = vec3d_sub(flight->state.position_ecef, rig->eye_ecef);
    Vec3d ahead =
        vec3d_length(to) > 0.1 ? vec3d_normalize(to) : quatd_rotate(flight->state.ecef_from_body, vec3d(1, 0, 0));
    Vec3d right = vec3d_cross(ahead, local_up);
    if (vec3d_length(right) < 1e-3) // straight above
        right = quatd_rotate(flight->state.ecef_from_body, vec3d(0, 1, 0));
    right = vec3d_normalize(vec3d_mad(right, ahead, -vec3d_dot(right, ahead)));
    return (RenderCamera){.eye_ecef = rig->eye_ecef, .camera_from_ecef = look_along(ahead, vec3d_cross(right, ahead))};
}

static RenderCamera map(const Flight *flight, Vec3d local_up) {
    Mat3d enu = axes_of(flight->state.position_ecef);
    Vec3d north = mat3d_mul_vec_transposed(&enu, vec3d(0, 1, 0));
    double above_m = 0.0;
    (void)flight_ground_below(&flight->ground, flight->state.position_ecef, &above_m);
    double height_m = fmax(MAP_HEIGHT_MIN_M, MAP_HEIGHT * above_m);
    return (RenderCamera){.eye_ecef = vec3d_mad(flight->state.position_ecef, local_up, height_m),
                          .camera_from_ecef = look_along(vec3d_scale(local_up, -1.0), north)};
}

static RenderCamera free_camera(const CameraRig *rig) {
    Vec3d right, ahead, up;
    free_axes(rig, &right, &ahead, &up);
    return (RenderCamera){.eye_ecef = rig->eye_ecef, .camera_from_ecef = rows(right, up, vec3d_scale(ahead, -1.0))};
}

// As a head turns: about the body's vertical, then up or down.
static void turn_head(const CameraRig *rig, Vec3d *ahead, Vec3d *up) {
    Quatd turn = quatd_from_axis_angle(vec3d(0, 0, 1), rig->look_right * LOOK_RIGHT_RAD);
    Quatd tilt = quatd_from_axis_angle(vec3d(0, 1, 0), rig->look_up * LOOK_UP_RAD);
    Quatd both = quatd_mul(turn, tilt);
    *ahead = quatd_rotate(both, *ahead);
    *up = quatd_rotate(both, *up);
}

static RenderCamera on_board(const Flight *flight, const CameraRig *rig, CameraView view, Vec3d local_up) {
    Vec3d ahead, up;
    view_axes(view, &ahead, &up);
    if (view == CAMERA_COCKPIT && (rig->look_right != 0.0 || rig->look_up != 0.0))
        turn_head(rig, &ahead, &up);
    Quatd attitude = flight->state.ecef_from_body;
    return (RenderCamera){.eye_ecef = above_ground(flight, flight->state.position_ecef, local_up),
                          .camera_from_ecef = look_along(quatd_rotate(attitude, ahead), quatd_rotate(attitude, up))};
}

double camera_px_per_rad(double fov_y_rad, double width, double height, bool corner) {
    double centre = height / (2.0 * tan(fov_y_rad / 2.0));
    return corner ? centre * (1.0 + (width * width + height * height) / (4.0 * centre * centre)) : centre;
}

// A long lens for what is far, as long as the person's own is not longer.
static double fly_by_lens(const Flight *flight, const CameraRig *rig, double fov_y_rad) {
    double away_m = fmax(vec3d_length(vec3d_sub(flight->state.position_ecef, rig->eye_ecef)), 1.0);
    double wanted_rad = fmax(FLY_BY_SPAN_M / (FLY_BY_SHARE * away_m), FLY_BY_LENS_RAD);
    return fmin(fov_y_rad, wanted_rad);
}

static RenderCamera camera_of_view(const Flight *flight, const CameraRig *rig, CameraView view) {
    Vec3d local_up = up_at(flight->state.position_ecef);
    switch (view) {
    case CAMERA_CHASE:
        return chase(flight, local_up);
    case CAMERA_FLY_BY:
        return fly_by(flight, rig);
    case CAMERA_MAP:
        return map(flight, local_up);
    case CAMERA_FREE:
        return free_camera(rig);
    default:
        return on_board(flight, rig, view, local_up);
    }
}

RenderCamera camera_of_flight(const Flight *flight, const CameraRig *rig, CameraView view, double fov_y_rad) {
    // A view that the rig was not moved for yet is seen from on board.
    bool ready = (view != CAMERA_FLY_BY && view != CAMERA_FREE) || rig->view == view;
    RenderCamera camera = camera_of_view(flight, rig, ready ? view : CAMERA_CHASE);
    camera.fov_y_rad = ready && view == CAMERA_FLY_BY ? fly_by_lens(flight, rig, fov_y_rad) : fov_y_rad;
    return camera;
}
