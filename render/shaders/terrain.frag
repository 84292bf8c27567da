#version 450 core
// Terrain patches. In: see terrain.vert. Out: the picture, display-referred.
#include "frame.glsl"

layout(location = 0) in vec3 at_m;
layout(location = 1) in vec2 at_sample;
layout(location = 2) flat in uint info;

layout(location = 0) out vec4 colour;

void main() {
    vec3 normal = normalize(cross(dFdx(at_m), dFdy(at_m)));
    float level = float(info & 0xffu);
    vec3 tint = 0.5 + 0.5 * cos(6.2832 * (level * 0.618 + vec3(0.0, 0.33, 0.67)));
    colour = vec4(tint * (0.4 + 0.6 * abs(normal.z)), 1.0);
}
