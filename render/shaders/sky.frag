#version 450 core
// The sky with its sun, around the Earth. In: sky.vert. Out: the picture as displayed.
// Bindings: block 0; textures 8-9 (aerial.glsl).
#include "aerial.glsl"
#include "frame.glsl"
#include "tone.glsl"

layout(location = 0) in vec2 at_clip;
layout(location = 0) out vec4 colour;

const float SUN_DISC = 60.0;      // far below the true 15000: enough to be white
const float SUN_EDGE = 1.1e-5;    // 1 - cosine of 0.27 degrees

vec3 sun_disc(vec3 look) {
    float away = 1.0 - dot(look, frame.sun.xyz); // half the squared angle
    float edge = 1.0 - smoothstep(SUN_EDGE * 0.8, SUN_EDGE * 1.4, away);
    float glow = exp(-4500.0 * away) * 0.25 + exp(-350.0 * away) * 0.035;
    return (edge * SUN_DISC + glow) * frame.light_sun[0].rgb;
}

void main() {
    vec3 look = normalize(frame.ray_ahead.xyz + at_clip.x * frame.ray_right.xyz + at_clip.y * frame.ray_up.xyz);
    vec4 whole = textureLod(sky_radiance, sky_coordinates(normalize(look * ROUND)), 0.0);
    colour = display(whole.rgb + sun_disc(look) * whole.a);
}
