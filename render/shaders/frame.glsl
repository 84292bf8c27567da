// Uniforms of one frame, binding 0; the twin of render/frame.h.
layout(std140, binding = 0) uniform FrameBlock {
    mat4 clip_from_eye; // from metres relative to the eye, ECEF axes; depth 1 near .. 0 at infinity
    vec4 eye_rest_m;    // xyz: the eye minus its lattice point
    vec4 viewport_px;   // width, height and their inverses
} frame;
