#version 450 core
// The edges of triangles, over the land. In: wire.geom. Out: the picture as displayed.
layout(location = 0) flat in float strength;

layout(location = 0) out vec4 colour;

void main() {
    colour = vec4(vec3(0.05, 0.06, 0.07), 0.7 * strength);
}
