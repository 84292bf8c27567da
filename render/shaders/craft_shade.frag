#version 450 core
// An aircraft as it covers the sun, for the land: all of a texel, and how near to the sun. In: craft_shadow.vert.
// Out: share covered, depth times share; both may be averaged.
layout(location = 0) out vec2 covered;

void main() {
    covered = vec2(1.0, gl_FragCoord.z);
}
