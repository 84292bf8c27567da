#version 450 core
// Tiles of the screen, at infinity in reversed depth. In: corners in clip space. Out: the same.
layout(location = 0) in vec2 corner; // -1 .. 1

layout(location = 0) out vec2 at_clip;

void main() {
    at_clip = corner;
    gl_Position = vec4(corner, 0.0, 1.0);
}
