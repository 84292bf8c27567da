#version 450 core
// The Earth around the data: a sphere (in round space) as high as their rim. In: sky.vert. Out: the picture as
// displayed. Bindings: blocks 0-2, 4; textures 3 (noise), 8-9 (aerial.glsl), 10 the drape, 12-13 light on level ground,
// 15 the aircraft's shadow.
// Defines: DRAPE (an image lies on the globe where it reaches), SEA (it is sea, not land), SHADED (an aircraft throws a
// shadow).
#include "aerial.glsl"
#include "craft_shade.glsl"
#include "drape.glsl"
#include "frame.glsl"
#include "ground.glsl"
#include "land.glsl"
#include "tone.glsl"
#include "water.glsl"

layout(binding = 12) uniform sampler2D ground_sun; // irradiance: see atmosphere_ground.frag
layout(binding = 13) uniform sampler2D ground_sky;

layout(location = 0) in vec2 at_clip;
layout(location = 0) out vec4 colour;

struct Lights { // irradiance
    vec3 sun, sky;
};

// Of the place, not of the data: the globe has a night side.
Lights lights_at(vec3 up) {
    float mu = dot(up, normalize(frame.sun.xyz * ROUND));
    vec2 uv = texel_range(vec2((mu + 0.2) / 1.2, frame.air.w / 8.0), vec2(textureSize(ground_sun, 0)));
    return Lights(textureLod(ground_sun, uv, 0.0).rgb, textureLod(ground_sky, uv, 0.0).rgb * SHADOW_FILL);
}

vec3 irradiance_on(vec3 up, Lights lights) {
    return lights.sun * max(dot(up, frame.sun.xyz), 0.0) + lights.sky * 0.6;
}

#ifdef SEA
vec3 sea_light(vec3 up, Lights lights, vec3 look, vec3 direction, float metres) {
    vec3 mirrored = textureLod(sky_radiance, sky_coordinates(reflect(direction, normalize(up * ROUND))), 0.0).rgb;
    vec3 east = normalize(vec3(-up.y, up.x + 1e-9, 0.0)), north = cross(up, east);
    vec3 to_eye = -vec3(dot(east, look), dot(north, look), dot(up, look));
    vec3 sun = vec3(dot(east, frame.sun.xyz), dot(north, frame.sun.xyz), dot(up, frame.sun.xyz));
    vec3 sun_light = lights.sun * smoothstep(-0.03, 0.03, sun.z);
    vec3 at_m = direction * metres / ROUND;
    vec2 place = vec2(dot(frame.wave_east.xyz, at_m), dot(frame.wave_north.xyz, at_m)) +
                 vec2(frame.wave_east.w, frame.wave_north.w);
    vec4 middle = texture(noise_map, place), fine = texture(noise_map, mat2(15.0, 4.0, -4.0, 15.0) * place);
    Waves waves = waves_at(middle, fine, metres / (frame.ray_right.w * max(to_eye.z, 0.02)));
    return water_light(waves, to_eye, sun, mirrored, sun_light, lights.sky, 0.0);
}
#else
// Woods and meadows of no particular place, in the colours of the land.
vec3 land_light(vec3 at, vec3 up, Lights lights, float metres) {
    vec3 axis = abs(up);
    vec2 plane = axis.z > max(axis.x, axis.y) ? at.xy : axis.x > axis.y ? at.yz : at.xz;
    vec4 coarse = texture(noise_map, plane / 410.0), middle = texture(noise_map, plane / 37.0);
    vec4 fine = texture(noise_map, plane / 4.3);
    float border = 0.5 + metres * 1e-5; // from far away they run into each other
    float wooded = smoothstep(-border, border, (coarse.r + middle.r + fine.r) * 2.0 - 3.0);
    return mix(ANY_MEADOW, ANY_WOODS, wooded) * (0.85 + 0.3 * fine.r) * irradiance_on(up, lights) / PI;
}
#endif

vec3 globe_light(vec3 look, vec3 direction, float metres) {
    vec3 at = frame.eye_up.xyz * (EARTH_KM + frame.eye_up.w) + direction * metres * 1e-3; // round space, km
    vec3 up = normalize(at * ROUND);
    Lights lights = lights_at(normalize(at));
#ifdef SHADED
    lights.sun *= craft_passes(direction * metres / ROUND);
#endif
#ifdef SEA
    vec3 light = sea_light(up, lights, look, direction, metres);
#else
    vec3 light = land_light(at, up, lights, metres);
#endif
#ifdef DRAPE
    vec4 image = drape_on_globe(at);
    light = mix(light, image.rgb * irradiance_on(up, lights) / PI, image.a);
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
