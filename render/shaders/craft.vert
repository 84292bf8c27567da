#version 450 core
// An aircraft. In: a CraftVertex. Out: clip position and, for the fragment shader, where on the aircraft it is.
// Bindings: frame block 0, craft block 3.
#include "frame.glsl"
#include "craft.glsl"

layout(location = 0) in vec3 position;  // body axes, metres, before its joint turns
layout(location = 1) in vec3 normal;
layout(location = 2) in uvec3 kind;     // finish, joint, surface

layout(location = 0) out vec3 at_m;     // from the eye, ECEF axes
layout(location = 1) out vec3 at_body;  // body axes, metres, before its joint turns
layout(location = 2) out vec3 at_normal; // ECEF axes
layout(location = 3) flat out uvec2 at_kind; // finish, surface

void main() {
    uint row = kind.y * 3u;
    at_m = craft_to_eye_m(position, kind.y);
    at_normal = vec3(dot(craft.rows[row].xyz, normal), dot(craft.rows[row + 1u].xyz, normal),
                     dot(craft.rows[row + 2u].xyz, normal));
    at_body = position;
    at_kind = kind.xz;
    gl_Position = frame.clip_from_eye * vec4(at_m, 1.0);
}
