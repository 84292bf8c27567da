// render/frame.h: one frame's view as the shaders see it, and the arithmetic that keeps vertices exact.
// ECEF metres; lattice units (terrain/grid.h); clip space with depth 1 at the near plane and 0 at infinity.
// Values; nothing owned. The C twin of shaders/frame.glsl.
#pragma once
#include "base/vec.h"
#include "render/render.h"

#define FRAME_NEAR_M 0.5
#define FRAME_BLOCK_BINDING 0

// std140; every member is 16 bytes or a multiple. "Round space" is ECEF with z stretched so that the ellipsoid is a
// sphere: heights and horizons there are exact, distances within 0.4 %.
typedef struct FrameBlock {
    float clip_from_eye[4][4]; // columns; from metres relative to the eye, ECEF axes
    float eye_rest_m[4];       // the eye minus its lattice point, metres, below half a lattice unit
    float ray_right[4];        // a pixel looks along ahead + clip.x right + clip.y up, ECEF axes; w: pixels per radian
    float ray_up[4];           // w: unused
    float ray_ahead[4];        // w: unused
    float sun[4];              // towards the sun, ECEF; w: exposure
    float eye_up[4];           // up at the eye, round space; w: its height, km
    float sun_side[4];         // horizontal unit vector towards the sun, round space; w: cosine of its zenith angle
    float air[4];              // density of air and of haze at the eye, 1 at sea level; z: cosine of the horizon's
                               // zenith angle; w: height of the globe around the data, km
    float light_sun[2][4];     // irradiance at the data's middle, at sea level and at FRAME_LIGHT_M
    float light_sky[2][4];
    float wave_east[4]; // repeats of the waves = dot(xyz, metres from the eye, ECEF axes) + w
    float wave_north[4];
    int32_t mode[4]; // RenderColouring; 1: flat colours, for tests: no dithering, and tints without light
                     // and air
} FrameBlock;
_Static_assert(sizeof(FrameBlock) == 64 + 15 * 16, "as shaders/frame.glsl has it");

#define FRAME_LIGHT_M 4000.0
#define FRAME_WAVES_M 2400.0 // a repeat of the waves

typedef struct Frame {
    FrameBlock block;
    GridPoint eye; // rounded to the lattice
    Vec3d eye_ecef;
    Vec3d planes[4]; // inward unit normals of the sides of the view, through the eye: left, right, bottom, top
    Vec3d forward;   // unit
    double eye_h_m;  // above the ellipsoid, in round space
    double globe_m;  // height of the globe
    double mu_sun;   // cosine of the sun's zenith angle at the eye, round space
} Frame;

Frame frame_make(const RenderCamera *camera, int width, int height);
// The parts of the block that tell of sun and air.
void frame_set_sun(Frame *frame, Vec3d sun_ecef);
// What surrounds the data: a globe as high as their rim, but always below the eye.
void frame_set_globe(Frame *frame, double height_m);
// Ties the waves of the sea to the plane that touches the Earth at a point, metres ECEF.
void frame_set_waves(Frame *frame, Vec3d middle_ecef);
// Into round space.
Vec3d frame_round(Vec3d ecef);

// Whether a sphere may be seen.
bool frame_sees_sphere(const Frame *frame, Vec3d centre_ecef, double radius_m);

// page->origin - eye, split as value = hi * 2^32 + lo with lo unsigned; the vertex shader adds the vertex to it.
typedef struct FrameOffset {
    int32_t lo[3], hi[3];
} FrameOffset;
FrameOffset frame_offset(const Frame *frame, GridPoint origin);
