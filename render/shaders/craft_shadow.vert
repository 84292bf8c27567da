#version 450 core
// An aircraft seen from the sun, for a map of depths. In: a CraftVertex. Out: map coordinates; depth 1 nearest to the
// sun. Bindings: craft block 3.
#include "craft.glsl"

layout(location = 0) in vec3 position; // body axes, metres, before its joint turns
layout(location = 2) in uvec3 kind;    // finish, joint, surface

void main() {
    vec3 at_map = craft_to_map(craft_to_eye_m(position, kind.y));
    gl_Position = vec4(2.0 * at_map.xy - 1.0, at_map.z, 1.0);
}
