#version 450 core
// All that is not terrain: the sky with its sun, and the Earth around the data. In: fullscreen.vert.
// Out: the picture as displayed. Bindings: blocks 0, 1; textures 3 (noise), 8-9 (aerial.glsl), 10 the drape.
// Defines: DRAPE (an image lies on the globe where it reaches).
#include "frame.glsl"
#include "ground.glsl"
#include "aerial.glsl"
#include "water.glsl"
#include "tone.glsl"
#include "drape.glsl"

layout(location = 0) in vec2 at_clip;
layout(location = 0) out vec4 colour;

const float SUN_COS = 0.9999890;  // 0.27 degrees
const float SUN_DISC = 60.0;      // far below the true 15000: enough to be white

vec3 sun_disc(vec3 look, vec3 radiance, vec3 lost) {
    float cosine = dot(look, frame.sun.xyz);
    float edge = smoothstep(SUN_COS - 4e-6, SUN_COS + 2e-6, cosine);
    float glow = pow(max(cosine, 0.0), 3000.0) * 0.25 + pow(max(cosine, 0.0), 250.0) * 0.035;
    return (edge * SUN_DISC + glow) * frame.light_sun[0].rgb;
}

// The globe is as high as the rim of the data, but always below the eye.
float globe_km() {
    return min(ground.globe.x * 1e-3, frame.eye_up.w - 0.05);
}

vec3 globe_light(vec3 look, vec3 direction, float metres) {
    vec3 at = frame.eye_up.xyz * (EARTH_KM + frame.eye_up.w) + direction * metres * 1e-3; // round space, km
    vec3 up = normalize(at * ROUND), axis = abs(up);
    vec2 plane = axis.z > max(axis.x, axis.y) ? at.xy : axis.x > axis.y ? at.yz : at.xz;
    vec4 coarse = texture(noise_map, plane / 61.0), middle = texture(noise_map, plane / 7.3);
    float sun_height = max(dot(up, frame.sun.xyz), 0.0);
    vec3 sun_light = frame.light_sun[0].rgb, sky_light = frame.light_sky[0].rgb;
    vec3 irradiance = (sun_light * sun_height + sky_light) / PI;
    vec3 land = mix(vec3(0.060, 0.078, 0.036), vec3(0.130, 0.125, 0.070), coarse.r * 0.7 + middle.r * 0.3) * irradiance;
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
    float mu = dot(direction, frame.eye_up.xyz);
    vec2 hit_km = ray_sphere(frame.eye_up.w, mu, globe_km());
    if (hit_km.y >= hit_km.x && hit_km.x > 0.0) {
        float metres = hit_km.x * 1e3;
        Aerial aerial = aerial_to(direction, metres, globe_km());
        colour = display(globe_light(look, direction, metres) * aerial.passes + aerial.light);
    } else {
        vec4 whole = textureLod(sky_radiance, sky_coordinates(direction), 0.0);
        colour = display(whole.rgb + sun_disc(look, whole.rgb, vec3(0.0)) * whole.a);
    }
}
