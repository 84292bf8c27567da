#version 450 core
// Triangles of diamonds, by index row * width + column. In: exact positions. Out: as terrain.vert.
// Bindings: frame block 0, ground block 1, diamond_draw.glsl 7.
#include "frame.glsl"
#include "ground.glsl"
#include "lattice.glsl"
#include "tint.glsl"
#include "diamond_draw.glsl"

layout(location = 0) in int vertex_x; // lattice units from the model's origin
layout(location = 1) in int vertex_y;
layout(location = 2) in int vertex_z;

layout(location = 0) out vec3 at_m;       // from the eye, ECEF axes
layout(location = 1) out vec4 at_ground;  // xy: column, row of the DEM; zw: repeats of the noise
layout(location = 2) flat out vec3 tint;

invariant gl_Position;

void main() {
    ivec3 vertex = ivec3(vertex_x, vertex_y, vertex_z);
    at_m = lattice_to_eye_m(vertex, draw.origin_lo.xyz, draw.origin_hi.xyz, frame.eye_rest_m.xyz);
    int row = gl_VertexID / draw.origin_lo.w;
    vec2 at = vec2(gl_VertexID - row * draw.origin_lo.w, row);
    at_ground = vec4(at, at * ground.noise.xy);
    tint = tint_of(uint(draw.origin_hi.w));
    gl_Position = frame.clip_from_eye * vec4(at_m, 1.0);
}
