#version 450 core
// The colour of a triangle's level, which no vertex knows. In: diamond_terrain.vert. Out: the same with the tint.
#include "tint.glsl"
#include "diamond_draw.glsl"

layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;

layout(location = 0) in vec3 at_m_in[];
layout(location = 1) in vec4 at_ground_in[];
layout(location = 2) flat in vec3 tint_in[];

layout(location = 0) out vec3 at_m;
layout(location = 1) out vec4 at_ground;
layout(location = 2) flat out vec3 tint;

// Twice its area in cells is 1 for the smallest, and twice as much for each level up.
uint level() {
    vec2 a = at_ground_in[1].xy - at_ground_in[0].xy, b = at_ground_in[2].xy - at_ground_in[0].xy;
    int doubled = int(abs(a.x * b.y - a.y * b.x) + 0.5);
    return uint(max(draw.levels.x - findMSB(doubled), 0));
}

void main() {
    vec3 colour = tint_of(level());
    for (int i = 0; i < 3; i++) {
        gl_Position = gl_in[i].gl_Position;
        at_m = at_m_in[i];
        at_ground = at_ground_in[i];
        tint = colour;
        EmitVertex();
    }
    EndPrimitive();
}
