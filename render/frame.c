#include "render/frame.h"

#include "terrain/geodesy.h"

#include <string.h>

static int64_t round_to_lattice(double metres) {
    return (int64_t)llrint(metres * GRID_LATTICE_PER_M);
}

static Vec3d row_of(const Mat3d *m, int row) {
    return (Vec3d){m->m[row][0], m->m[row][1], m->m[row][2]};
}

// Reversed depth without a far plane: clip = (x fx, y fy, near, -z), so that depth is near / distance ahead.
static void fill_matrix(FrameBlock *block, const RenderCamera *camera, double fx, double fy) {
    for (int column = 0; column < 3; column++) {
        block->clip_from_eye[column][0] = (float)(fx * camera->camera_from_ecef.m[0][column]);
        block->clip_from_eye[column][1] = (float)(fy * camera->camera_from_ecef.m[1][column]);
        block->clip_from_eye[column][2] = 0.0f;
        block->clip_from_eye[column][3] = (float)-camera->camera_from_ecef.m[2][column];
    }
    block->clip_from_eye[3][0] = block->clip_from_eye[3][1] = block->clip_from_eye[3][3] = 0.0f;
    block->clip_from_eye[3][2] = (float)FRAME_NEAR_M;
}

// Each side plane holds the eye: its normal is ahead plus or minus the axis, weighted by the lens.
static void fill_planes(Frame *frame, const RenderCamera *camera, double fx, double fy) {
    Vec3d right = row_of(&camera->camera_from_ecef, 0), up = row_of(&camera->camera_from_ecef, 1);
    frame->forward = vec3d_scale(row_of(&camera->camera_from_ecef, 2), -1.0);
    frame->planes[0] = vec3d_normalize(vec3d_mad(frame->forward, right, fx));
    frame->planes[1] = vec3d_normalize(vec3d_mad(frame->forward, right, -fx));
    frame->planes[2] = vec3d_normalize(vec3d_mad(frame->forward, up, fy));
    frame->planes[3] = vec3d_normalize(vec3d_mad(frame->forward, up, -fy));
}

static void put(float out[4], Vec3d v, double w) {
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
    out[3] = (float)w;
}

static void fill_rays(Frame *frame, const RenderCamera *camera, double fx, double fy, int height) {
    put(frame->block.ray_right, vec3d_scale(row_of(&camera->camera_from_ecef, 0), 1.0 / fx), height * 0.5 * fy);
    put(frame->block.ray_up, vec3d_scale(row_of(&camera->camera_from_ecef, 1), 1.0 / fy), 0.0);
    put(frame->block.ray_ahead, frame->forward, 0.0);
}

Vec3d frame_round(Vec3d ecef) {
    return (Vec3d){ecef.x, ecef.y, ecef.z * (GEODESY_A_M / GEODESY_B_M)};
}

// As shaders/atmosphere.glsl has them.
#define RAYLEIGH_FALL_M 8000.0
#define MIE_FALL_M 1300.0

static void fill_air(Frame *frame) {
    Vec3d eye = frame_round(frame->eye_ecef);
    double radius = vec3d_length(eye);
    double h_m = radius - GEODESY_A_M, above_m = fmax(h_m, 0.0);
    frame->eye_h_m = h_m;
    put(frame->block.eye_up, vec3d_normalize(eye), h_m * 1e-3);
    put(frame->block.air,
        vec3d(exp(-h_m / RAYLEIGH_FALL_M), exp(-h_m / MIE_FALL_M),
              -sqrt(above_m * (2.0 * GEODESY_A_M + above_m)) / (GEODESY_A_M + above_m)),
        0.0);
}

#define GLOBE_BELOW_EYE_M 50.0

void frame_set_globe(Frame *frame, double height_m) {
    frame->globe_m = fmin(height_m, frame->eye_h_m - GLOBE_BELOW_EYE_M);
    frame->block.air[3] = (float)(frame->globe_m * 1e-3);
}

// What a camera would do about a low sun: open up, but less than the light fades.
static double exposure_for(double mu_sun) {
    double brightness = fmax(mu_sun + 0.10, 0.006) / 1.10;
    return 4.5 * pow(brightness, -0.42);
}

void frame_set_sun(Frame *frame, Vec3d sun_ecef) {
    Vec3d up = vec3d_normalize(frame_round(frame->eye_ecef)), sun = vec3d_normalize(frame_round(sun_ecef));
    frame->mu_sun = vec3d_dot(sun, up);
    Vec3d side = vec3d_mad(sun, up, -frame->mu_sun);
    // A sun in the zenith has no azimuth; any serves.
    side = vec3d_length(side) > 1e-6 ? vec3d_normalize(side) : vec3d_normalize(vec3d(-up.y, up.x, 1e-9));
    put(frame->block.sun, sun_ecef, exposure_for(frame->mu_sun));
    put(frame->block.sun_side, side, frame->mu_sun);
}

// Whole repeats are dropped here, in double, so that waves stay where they are while the eye moves.
static void put_repeats(float out[4], Vec3d axis, Vec3d from_middle) {
    double repeats = vec3d_dot(axis, from_middle) / FRAME_WAVES_M;
    put(out, vec3d_scale(axis, 1.0 / FRAME_WAVES_M), repeats - floor(repeats));
}

void frame_set_waves(Frame *frame, Vec3d middle_ecef) {
    Geodetic middle = geodesy_from_ecef(middle_ecef);
    Vec3d up = geodesy_up(middle.lat_rad, middle.lon_rad);
    Vec3d east = {-sin(middle.lon_rad), cos(middle.lon_rad), 0.0};
    Vec3d from_middle = vec3d_sub(frame->eye_ecef, middle_ecef);
    put_repeats(frame->block.wave_east, east, from_middle);
    put_repeats(frame->block.wave_north, vec3d_cross(up, east), from_middle);
}

Frame frame_make(const RenderCamera *camera, int width, int height) {
    Frame frame;
    memset(&frame, 0, sizeof frame);
    double fy = 1.0 / tan(camera->fov_y_rad * 0.5), fx = fy * height / width;
    Vec3d eye = camera->eye_ecef;
    frame.eye_ecef = eye;
    frame.eye = (GridPoint){round_to_lattice(eye.x), round_to_lattice(eye.y), round_to_lattice(eye.z)};
    Vec3d rest = vec3d_sub(eye, grid_point_ecef(frame.eye));
    frame.block.eye_rest_m[0] = (float)rest.x;
    frame.block.eye_rest_m[1] = (float)rest.y;
    frame.block.eye_rest_m[2] = (float)rest.z;
    fill_matrix(&frame.block, camera, fx, fy);
    fill_planes(&frame, camera, fx, fy);
    fill_rays(&frame, camera, fx, fy, height);
    fill_air(&frame);
    return frame;
}

bool frame_sees_sphere(const Frame *frame, Vec3d centre_ecef, double radius_m) {
    Vec3d to = vec3d_sub(centre_ecef, frame->eye_ecef);
    if (vec3d_dot(to, frame->forward) < -radius_m)
        return false;
    for (int i = 0; i < 4; i++)
        if (vec3d_dot(to, frame->planes[i]) < -radius_m)
            return false;
    return true;
}

static void split(int64_t value, int32_t *lo, int32_t *hi) {
    *lo = (int32_t)(uint32_t)((uint64_t)value & 0xffffffffu);
    *hi = (int32_t)(value >> 32);
}

FrameOffset frame_offset(const Frame *frame, GridPoint origin) {
    FrameOffset offset;
    split(origin.x - frame->eye.x, &offset.lo[0], &offset.hi[0]);
    split(origin.y - frame->eye.y, &offset.lo[1], &offset.hi[1]);
    split(origin.z - frame->eye.z, &offset.lo[2], &offset.hi[2]);
    return offset;
}
