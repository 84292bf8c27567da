// Light from water. Units: radiance; the local frame is east, north, up.
#include "aerial.glsl"
#include "frame.glsl"
#include "ground.glsl"
#include "tone.glsl"

struct Waves {
    vec3 normal;    // of those that pixels can show
    float variance; // of the slopes, both axes together, of those that they can't
};

// The same for land's sea and the globe's, from noise that repeats after 2.4 km (`middle`) and 155 m (`fine`): land has
// such noise at hand, and that the patterns do not continue each other is not seen. `pixel_m`: its length on the water.
Waves waves_at(vec4 middle, vec4 fine, float pixel_m) {
    const float RIPPLES = 0.0100;        // too small for any pixel
    const vec2 SLOPE = vec2(0.10, 0.13); // of the noise's whole range; its root mean square is 0.3
    // Mipmap levels of both: the first blurs the smallest waves, the fourth all.
    float level = log2(pixel_m * (256.0 / 2400.0));
    vec2 kept = clamp(1.0 - vec2(level, level + 3.95) * 0.25, 0.0, 1.0);
    vec2 slope = (middle.gb - 0.5) * (SLOPE.x * kept.x) + (fine.gb - 0.5) * (SLOPE.y * kept.y);
    return Waves(normalize(vec3(slope, 1.0)), RIPPLES + dot(SLOPE * SLOPE * 0.18, 1.0 - kept * kept));
}

// `to_eye`, `sun`: unit, local; `sky`: radiance the surface mirrors; `sun_light`: irradiance across the sun's rays;
// `sky_light`: on level ground; `shallow`: 0 the open sea .. 1.
vec3 water_light(Waves waves, vec3 to_eye, vec3 sun, vec3 sky, vec3 sun_light, vec3 sky_light, float shallow) {
    vec3 deep = mix(vec3(0.006, 0.022, 0.038), vec3(0.020, 0.075, 0.075), shallow);
    vec3 body = deep * (sun_light * max(sun.z, 0.0) + sky_light) / PI;
    float facing = max(dot(waves.normal, to_eye), 0.02);
    float mirror = 0.02 + 0.98 * pow(1.0 - facing, 5.0) * 0.7; // waves hide each other's mirrors
    vec3 half_way = normalize(to_eye + sun);
    float exponent = 2.0 / waves.variance;
    float glint = pow(max(dot(waves.normal, half_way), 0.0), exponent) * (exponent + 2.0) * 0.025;
    float glint_mirror = 0.02 + 0.98 * pow(1.0 - max(dot(half_way, to_eye), 0.0), 5.0);
    return mix(body, sky, mirror) + sun_light * min(glint * glint_mirror, 2.5);
}
