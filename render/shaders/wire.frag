#version 450 core
// The edges of triangles, over the land. In: terrain.vert. Out: the picture as displayed.
#include "frame.glsl"

layout(location = 0) in vec3 at_m;
layout(location = 1) in vec4 at_ground;
layout(location = 2) flat in vec3 tint;

layout(location = 0) out vec4 colour;

void main() {
    float fade = exp(-length(at_m) * 2e-5);
    colour = vec4(vec3(0.05, 0.06, 0.07), 0.25 + 0.5 * fade);
}
