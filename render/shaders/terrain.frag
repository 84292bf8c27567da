#version 450 core
// Terrain patches: the land and its water under sun and sky, through the air. In: see terrain.vert.
// Out: the picture as displayed. Bindings: blocks 0, 1, 4; textures 0-4 (ground.glsl), 8-9 (aerial.glsl), 10 the drape,
// 15 the aircraft's shadow.
// Defines: SEA (the globe around is sea, not land), HOLES (voids are not drawn), DRAPE (an image lies on the land),
// WATER (there may be some), SHADED (an aircraft throws a shadow).
#include "frame.glsl"
#include "ground.glsl"
#include "aerial.glsl"
#include "land.glsl"
#include "water.glsl"
#include "tone.glsl"
#include "drape.glsl"
#include "craft_shade.glsl"

layout(location = 0) in vec3 at_m;
layout(location = 1) in vec4 at_ground;
layout(location = 2) flat in vec3 tint;

layout(location = 0) out vec4 colour;

struct Local { // unit vectors in ECEF
    vec3 east, north, up;
};

Local local_frame(vec3 eye_to_point) {
    // The direction of the sphere's radius in round space, stretched once more, is the ellipsoid's normal.
    vec3 radius = frame.eye_up.xyz * (EARTH_KM + frame.eye_up.w) * 1e3 + eye_to_point * ROUND;
    Local local;
    local.up = normalize(radius * ROUND);
    local.east = normalize(vec3(-local.up.y, local.up.x + 1e-9, 0.0));
    local.north = cross(local.up, local.east);
    return local;
}

vec3 to_local(Local local, vec3 v) {
    return vec3(dot(local.east, v), dot(local.north, v), dot(local.up, v));
}

// 1 in the sun, 0 in the shadow of the ground further off.
float sun_visible(vec2 uv, vec3 sun) {
    float root = texture(shade_map, uv).r;
    float tangent = 2.0 * root * root, sun_tangent = sun.z / max(length(sun.xy), 1e-3);
    return smoothstep(tangent - 0.035, tangent + 0.035, sun_tangent);
}

#if !defined(SEA) && !defined(DRAPE)
#define EDGE
#endif

// 0 at the edge of the data, 1 some pixels inside: seen from high above, the land runs out into the globe's.
float known_share(vec2 uv, float spread) {
    vec2 cells = min(uv, 1.0 - uv) * ground.noise.zw;
    float wide = clamp(48.0 * (spread - 1.0), 1.0, 0.04 * min(ground.noise.z, ground.noise.w));
    return smoothstep(0.0, wide, min(cells.x, cells.y));
}

void main() {
#ifdef HOLES
    if (texture(hole_map, at_ground.xy * ground.texel.xy + ground.texel.zw).r > 0.5)
        discard;
#endif
    vec2 uv = at_ground.xy * ground.texel.xy + ground.texel.zw;
    vec4 cell = texture(surface_map, uv);
    float h_m = texture(height_map, uv).r * ground.height.x + ground.height.y;
    vec4 coarse = texture(noise_map, at_ground.zw);
    vec4 middle = texture(noise_map, NOISE_MIDDLE * at_ground.zw);
    vec4 fine = texture(noise_map, NOISE_FINE * at_ground.zw);

    vec3 round_m = at_m * ROUND;
    float metres = length(round_m);
    float spread = 1.0 + 0.5 * metres / (frame.ray_right.w * ground.height.z);

    Local local = local_frame(at_m);
    vec3 sun = to_local(local, frame.sun.xyz);
    vec3 normal = decode_normal(cell.rg);
    Land land = land_at(h_m, 1.0 - normal.z, normal.y, cell.b, land_lines_m(local.up.z), coarse, middle, fine,
                        spread);
#ifdef DRAPE
    land.albedo = drape_over(land.albedo, at_ground.xy, middle.r + fine.r - 1.0);
#endif
#ifdef EDGE
    float known = known_share(uv, spread);
    land.albedo = mix(0.5 * (ANY_MEADOW + ANY_WOODS), land.albedo, known);
    normal.xy *= known;
#endif
    if (frame.mode.x != COLOUR_LAND)
        land.albedo = tint;

    vec2 bump = (middle.gb * 2.0 - 1.0) * 0.16 + (fine.gb * 2.0 - 1.0) * 0.22;
    vec3 lit_normal = normalize(normal + vec3(bump.x, -bump.y, 0.0) * land.rough * normal.z);

    float high = clamp(h_m / 4000.0, 0.0, 1.5);
    vec3 sun_light = mix(frame.light_sun[0].rgb, frame.light_sun[1].rgb, high);
    vec3 sky_light = mix(frame.light_sky[0].rgb, frame.light_sky[1].rgb, high) * SHADOW_FILL;
    float lit = sun_visible(uv, sun) * smoothstep(-0.03, 0.03, sun.z);
#ifdef SHADED
    lit *= craft_passes(at_m);
#endif
    float open_sky = cell.b * (0.5 + 0.5 * lit_normal.z);
    vec3 direct = sun_light * max(dot(lit_normal, sun), 0.0) * lit;
    // Light from the ground around, as bright as the ground itself on average.
    vec3 bounced = land.albedo * (sun_light * max(sun.z, 0.0) + sky_light) * (1.0 - 0.8 * cell.b) * 0.8;
    vec3 radiance = land.albedo / PI * (direct + sky_light * open_sky + bounced);

    vec3 direction = round_m / metres;
#ifdef WATER
#ifdef EDGE
    cell.a *= known;
#endif
    float water = frame.mode.x == COLOUR_LAND ? smoothstep(0.40, 0.60, cell.a) : 0.0;
    if (water > 0.0) {
        vec3 to_eye = -to_local(local, normalize(at_m));
        vec3 up_direction = reflect(direction, normalize(local.up * ROUND));
        vec3 mirrored = textureLod(sky_radiance, sky_coordinates(up_direction), 0.0).rgb;
        float shallow = 1.0 - smoothstep(0.5, 1.0, textureLod(surface_map, uv, 3.0).a);
        Waves waves = waves_at(middle, fine, metres / (frame.ray_right.w * max(to_eye.z, 0.02)));
        vec3 light = water_light(waves, to_eye, sun, mirrored, sun_light * lit, sky_light, shallow);
        radiance = mix(radiance, light, water);
    }
#endif
    Aerial aerial = aerial_to(direction, metres, height_km(round_m));
    colour = display(radiance * aerial.passes + aerial.light);
    if (frame.mode.y != 0 && frame.mode.x != COLOUR_LAND)
        colour = vec4(land.albedo, 1.0);
}
