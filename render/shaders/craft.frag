#version 450 core
// An aircraft under sun and sky, through the air: painted metal, and glass that mirrors the sky. In: see craft.vert.
// Out: the picture as displayed; alpha below 1 for a turning propeller. Bindings: blocks 0, 3; textures 8-9
// (aerial.glsl), 14 depths seen from the sun.
#include "frame.glsl"
#include "aerial.glsl"
#include "craft.glsl"
#include "tone.glsl"

layout(binding = 14) uniform sampler2DShadow shadow_map;

layout(location = 0) in vec3 at_m;
layout(location = 1) in vec3 at_body;
layout(location = 2) in vec3 at_normal;
layout(location = 3) flat in uvec2 at_kind; // finish, surface

layout(location = 0) out vec4 colour;

const vec3 GROUND_ALBEDO = vec3(0.107, 0.111, 0.092); // of land seen from above, on average

struct Paint {
    vec3 albedo;
    float gloss;
    float glass; // share
};

// What a mark covers of a pixel that is `wide` metres across. A corner is where two sides' distances count together.
float mark_share(int i, vec2 p, float wide) {
    vec4 figure = craft.figures[i];
    vec4 sides = p.x * craft.sides[3 * i] + p.y * craft.sides[3 * i + 1] + craft.sides[3 * i + 2];
    float corner = max(figure.x, wide + figure.y); // inside, distances are known up to here
    float away = length(max(sides + corner, 0.0)) - corner;
    float outline = abs(away) - 0.5 * figure.y;
    float thin = figure.y > 0.0 ? min(figure.y / wide, 1.0) : 1.0; // finer than a pixel: a paler line
    return clamp(0.5 - (figure.y > 0.0 ? outline : away) / wide, 0.0, 1.0) * thin * figure.z;
}

Paint paint_here() {
    vec4 finish = craft.finishes[at_kind.x];
    Paint paint = Paint(finish.rgb, finish.a, int(at_kind.x) == CRAFT_GLASS ? 1.0 : 0.0);
    vec2 side = at_body.xz, above = vec2(at_body.x, abs(at_body.y));
    float side_wide = max(length(fwidth(side)), 1e-4), above_wide = max(length(fwidth(above)), 1e-4);
    int finish_at = int(at_kind.x);
    bool bare = finish_at == CRAFT_DARK || finish_at == CRAFT_LINE; // no paint in pipes and gaps
    ivec2 range = bare ? ivec2(0) : craft.ranges[at_kind.y].xy;
    for (int i = range.x; i < range.y; i++) {
        ivec4 kind = craft.kinds[i];
        bool top = kind.x != 0;
        float share = mark_share(i, top ? above : side, top ? above_wide : side_wide);
        vec4 over = craft.finishes[kind.y];
        paint.albedo = mix(paint.albedo, over.rgb, share);
        paint.gloss = mix(paint.gloss, over.a, share);
        paint.glass = mix(paint.glass, kind.y == CRAFT_GLASS ? 1.0 : 0.0, share);
    }
    return paint;
}

struct Light { // irradiance
    vec3 sun, sky, ground; // ground: reflected by the land below
    vec3 up;
};

// Eyes adapt to the sky's blue on what they know to be white; on land it is not noticed.
vec3 paler(vec3 light) {
    return mix(vec3(dot(light, vec3(0.2126, 0.7152, 0.0722))), light, 0.45);
}

Light light_here() {
    Light light;
    vec3 radius = frame.eye_up.xyz * (EARTH_KM + frame.eye_up.w) * 1e3 + at_m * ROUND;
    light.up = normalize(radius * ROUND);
    float high = clamp(craft.place.w / 4.0, 0.0, 1.5), rise = dot(light.up, frame.sun.xyz);
    light.sun = mix(frame.light_sun[0].rgb, frame.light_sun[1].rgb, high) * smoothstep(-0.03, 0.03, rise);
    light.sky = paler(mix(frame.light_sky[0].rgb, frame.light_sky[1].rgb, high)) * SHADOW_FILL;
    light.ground = GROUND_ALBEDO * (light.sun * max(rise, 0.0) + light.sky);
    return light;
}

// Share of the sun that other parts of the aircraft let through. The point is moved off its surface by some texels, so
// that no surface shades itself; the edge is as soft as the sun's disc makes it two metres away.
float sun_share(vec3 normal) {
    if (craft.shadow.x == 0)
        return 1.0;
    float texel = 1.0 / float(textureSize(shadow_map, 0).x);
    float metres = 1.0 / length(craft.map_rows[2].xyz); // across the map
    float grazing = 1.0 - clamp(dot(normal, frame.sun.xyz), 0.0, 1.0);
    vec3 at = craft_to_map(at_m + normal * ((1.0 + 2.5 * grazing) * texel * metres)) + vec3(0.0, 0.0, 1.5 * texel);
    float share = 0.0;
    for (int i = 0; i < 4; i++)
        share += texture(shadow_map, at + 1.1 * texel * vec3(i < 2 ? -1.0 : 1.0, i % 2 == 0 ? -1.0 : 1.0, 0.0));
    return 0.25 * share;
}

// Radiance from a direction: the sky, or the land below the horizon.
vec3 mirrored_light(vec3 look, Light light, float rough) {
    vec3 direction = normalize(look * ROUND);
    vec3 sky = textureLod(sky_radiance, sky_coordinates(direction), 0.0).rgb;
    float below = smoothstep(0.02 + rough, -0.02 - rough, dot(direction, frame.eye_up.xyz) - frame.air.z);
    return mix(sky, light.ground / PI + 0.5 * sky, below);
}

float fresnel(float facing, float straight) {
    return straight + (1.0 - straight) * pow(1.0 - facing, 5.0);
}

vec3 light_off(Paint paint, vec3 normal, vec3 to_eye, Light light) {
    float facing = max(dot(normal, to_eye), 0.0), sunny = max(dot(normal, frame.sun.xyz), 0.0);
    float upward = 0.5 + 0.5 * dot(normal, light.up);
    vec3 diffuse = paint.albedo / PI * (light.sun * sunny + mix(light.ground, light.sky, upward));
    float mirror = fresnel(facing, mix(0.035, 0.06, paint.glass)) * mix(0.75 * paint.gloss, 1.0, paint.glass);
    vec3 mirrored = mirrored_light(reflect(-to_eye, normal), light, mix(0.25, 0.02, paint.glass));
    vec3 half_way = normalize(to_eye + frame.sun.xyz);
    float exponent = mix(mix(12.0, 220.0, paint.gloss), 1500.0, paint.glass);
    float glint = pow(max(dot(normal, half_way), 0.0), exponent) * (exponent + 8.0) / (8.0 * PI) *
                  fresnel(max(dot(half_way, to_eye), 0.0), 0.04) * sunny * paint.gloss;
    return diffuse * (1.0 - mirror) + mirrored * mirror + light.sun * min(glint, 6.0);
}

// How much of what is behind it a turning propeller hides: blades smeared over a part of a turn, broad at the root.
float disc_share() {
    vec2 from_hub = at_body.yz - craft.hub.yz;
    float along = length(from_hub) / craft.disc.x, turn = atan(from_hub.x, -from_hub.y);
    float blade = pow(0.5 + 0.5 * cos(turn * craft.disc.w), 3.0);
    float rim = smoothstep(1.0, 0.96, along);
    float tip = smoothstep(0.90, 0.92, along) * 0.10;
    return craft.disc.y * rim * (mix(0.16, 0.04, along) + 0.08 * blade + tip);
}

void main() {
    vec3 to_eye = -normalize(at_m), normal = normalize(at_normal);
    bool disc = int(at_kind.x) == CRAFT_DISC;
    normal = dot(normal, to_eye) < 0.0 && disc ? -normal : normal;
    Light light = light_here();
    light.sun *= disc ? 1.0 : sun_share(normal);
    vec3 radiance = light_off(paint_here(), normal, to_eye, light);
    vec3 round_m = at_m * ROUND;
    float metres = length(round_m);
    Aerial aerial = aerial_to(round_m / metres, metres, height_km(round_m));
    colour = display(radiance * aerial.passes + aerial.light);
    colour.a = disc ? disc_share() : 1.0;
}
