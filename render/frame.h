// render/frame.h: one frame's view as the shaders see it, and the arithmetic that keeps vertices exact.
// ECEF metres; lattice units (terrain/grid.h); clip space with depth 1 at the near plane and 0 at infinity.
// Values; nothing owned. The C twin of shaders/frame.glsl.
#pragma once
#include "base/vec.h"
#include "render/render.h"

#define FRAME_NEAR_M 0.5
#define FRAME_BLOCK_BINDING 0

// std140; every member is 16 bytes or a multiple.
typedef struct FrameBlock {
    float clip_from_eye[4][4]; // columns; from metres relative to the eye, ECEF axes
    float eye_rest_m[4];       // the eye minus its lattice point, metres, below half a lattice unit
    float viewport_px[4];      // width, height, 1 / width, 1 / height
} FrameBlock;
_Static_assert(sizeof(FrameBlock) == 64 + 2 * 16, "as shaders/frame.glsl has it");

typedef struct Frame {
    FrameBlock block;
    GridPoint eye;       // rounded to the lattice
    Vec3d eye_ecef;
    Vec3d planes[4];     // inward unit normals of the sides of the view, through the eye: left, right, bottom, top
    Vec3d forward;       // unit
} Frame;

Frame frame_make(const RenderCamera *camera, int width, int height);

// Whether a sphere may be seen.
bool frame_sees_sphere(const Frame *frame, Vec3d centre_ecef, double radius_m);

// page->origin - eye, split as value = hi * 2^32 + lo with lo unsigned; the vertex shader adds the vertex to it.
typedef struct FrameOffset {
    int32_t lo[3], hi[3];
} FrameOffset;
FrameOffset frame_offset(const Frame *frame, GridPoint origin);
