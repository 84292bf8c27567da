#version 450 core
// The Earth around the data: a sphere (in round space) as high as their rim. In: sky.vert. Out: the picture as
// displayed. Bindings: blocks 0-2; textures 3 (noise), 8-9 (aerial.glsl), 10 the drape.
// Defines: DRAPE (an image lies on the globe where it reaches).
#include "aerial.glsl"
#include "drape.glsl"
#include "frame.glsl"
#include "ground.glsl"
#include "tone.glsl"
#include "water.glsl"

layout(location = 0) in vec2 at_clip;
layout(location = 0) out vec4 colour;

vec3 globe_light(vec3 look, vec3 direction, float metres) {
    vec3 at = frame.eye_up.xyz * (EARTH_KM + frame.eye_up.w) + direction * metres * 1e-3; // round space, km
    vec3 up = normalize(at * ROUND), axis = abs(up);
    vec2 plane = axis.z > max(axis.x, axis.y) ? at.xy : axis.x > axis.y ? at.yz : at.xz;
    vec4 coarse = texture(noise_map, plane / 410.0), middle = texture(noise_map, plane / 37.0);
    vec4 fine = texture(noise_map, plane / 4.3);
    float sun_height = max(dot(up, frame.sun.xyz), 0.0);
    vec3 sun_light = frame.light_sun[0].rgb, sky_light = frame.light_sky[0].rgb * SHADOW_FILL;
    vec3 irradiance = (sun_light * sun_height + sky_light * 0.6) / PI;
    // Woods and meadows of no particular place, in the colours of the land.
    float border = 0.5 + metres * 1e-5; // from far away they run into each other
    float wooded = smoothstep(-border, border, (coarse.r + middle.r + fine.r) * 2.0 - 3.0);
    vec3 land = mix(vec3(0.105, 0.126, 0.046), vec3(0.034, 0.058, 0.020), wooded) * irradiance;
    land *= 0.85 + 0.3 * fine.r;
    vec3 deep = vec3(0.006, 0.022, 0.038) * irradiance;
    vec3 mirrored = textureLod(sky_radiance, sky_coordinates(reflect(direction, normalize(up * ROUND))), 0.0).rgb;
    vec3 side = normalize(vec3(-up.y, up.x + 1e-9, 0.0)), ahead = cross(up, side);
    vec3 waves = normalize(vec3((middle.gb - 0.5) * 0.05, 1.0));
    vec3 to_eye = -vec3(dot(side, look), dot(ahead, look), dot(up, look));
    vec3 sun = vec3(dot(side, frame.sun.xyz), dot(ahead, frame.sun.xyz), dot(up, frame.sun.xyz));
    vec3 sea = water_light(waves, to_eye, sun, deep, mirrored, sun_light, 0.6);
    vec3 light = mix(land, sea, ground.globe.y);
#ifdef DRAPE
    vec4 image = drape_on_globe(at);
    light = mix(light, image.rgb * irradiance, image.a);
#endif
    return light;
}

void main() {
    vec3 look = normalize(frame.ray_ahead.xyz + at_clip.x * frame.ray_right.xyz + at_clip.y * frame.ray_up.xyz);
    vec3 direction = normalize(look * ROUND);
    vec2 hit_km = ray_sphere(frame.eye_up.w, dot(direction, frame.eye_up.xyz), frame.air.w);
    float metres = max(hit_km.x, 0.0) * 1e3;
    Aerial aerial = aerial_to(direction, metres, frame.air.w);
    vec3 light = globe_light(look, direction, metres);
    if (hit_km.y < hit_km.x || hit_km.x <= 0.0)
        discard; // the sky is there already
    colour = display(light * aerial.passes + aerial.light);
}
