#version 450 core
// How broad a triangle appears, so that edges fade where they would cover everything. In: terrain.vert.
// Out: the triangle as it came, and the strength of its edges.
#include "frame.glsl"

layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;

layout(location = 0) in vec3 at_m[];
layout(location = 0) flat out float strength; // 0 .. 1

const float NO_EDGES_PX = 1.5, FULL_EDGES_PX = 6.0;

// The height over the longest side, for triangles small against their distance; near ones are broad enough anyway.
float breadth_px() {
    vec3 middle = (at_m[0] + at_m[1] + at_m[2]) / 3.0;
    float metres = max(length(middle), 1e-3);
    vec3 look = middle / metres, a = at_m[1] - at_m[0], b = at_m[2] - at_m[0];
    a -= look * dot(look, a);
    b -= look * dot(look, b);
    float longest = max(max(length(a), length(b)), length(b - a));
    return length(cross(a, b)) / max(longest, 1e-6) * frame.ray_right.w / metres;
}

void main() {
    float kept = smoothstep(NO_EDGES_PX, FULL_EDGES_PX, breadth_px());
    for (int i = 0; i < 3; i++) {
        gl_Position = gl_in[i].gl_Position;
        strength = kept;
        EmitVertex();
    }
    EndPrimitive();
}
