#version 450 core
// Terrain patches. In: a LodVertex and, per patch, its place relative to the eye. Out: clip position and what the
// fragment shader needs to find the ground's texels. Bindings: frame block 0, ground block 1.
#include "frame.glsl"
#include "ground.glsl"
#include "lattice.glsl"
#include "tint.glsl"

layout(location = 0) in ivec3 vertex;     // lattice units from the page's origin
layout(location = 1) in uvec2 sample_at;  // column and row from the page's first
layout(location = 2) in ivec4 origin_lo;  // page origin - eye, low words; w: the page's first column
layout(location = 3) in ivec4 origin_hi;  // high words; w: the page's first row
layout(location = 4) in uint patch_info;  // level | state << 8 | partition << 16
layout(location = 5) in vec2 noise_phase; // of the page's first sample: repeats of the noise, 0 .. 1

layout(location = 0) out vec3 at_m;       // from the eye, ECEF axes
layout(location = 1) out vec4 at_ground;  // xy: column, row of the DEM; zw: repeats of the noise
layout(location = 2) flat out vec3 tint;  // of the patch, linear albedo

invariant gl_Position;

void main() {
    at_m = lattice_to_eye_m(vertex, origin_lo.xyz, origin_hi.xyz, frame.eye_rest_m.xyz);
    vec2 within = vec2(sample_at);
    at_ground = vec4(within + vec2(origin_lo.w, origin_hi.w), noise_phase + within * ground.noise.xy);
    tint = tint_of(patch_info);
    gl_Position = frame.clip_from_eye * vec4(at_m, 1.0);
}
