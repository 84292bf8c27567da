#version 450 core
// One triangle over the whole viewport, at infinity in reversed depth. No attributes. Out: the place in clip space.
layout(location = 0) out vec2 at_clip; // -1 .. 1

void main() {
    at_clip = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    gl_Position = vec4(at_clip, 0.0, 1.0);
}
