// Light from water. Units: radiance; the local frame is east, north, up.
#include "aerial.glsl"

// `normal`: with waves; `to_eye`, `sun`: unit, local; `body`: light from below the surface; `sky`: radiance the
// surface mirrors; `sun_light`: irradiance across the sun's rays; `rough`: 0 smooth .. 1.
vec3 water_light(vec3 normal, vec3 to_eye, vec3 sun, vec3 body, vec3 sky, vec3 sun_light, float rough) {
    float facing = max(dot(normal, to_eye), 0.02);
    float mirror = 0.02 + 0.98 * pow(1.0 - facing, 5.0) * (1.0 - 0.5 * rough);
    vec3 half_way = normalize(to_eye + sun);
    float exponent = mix(900.0, 120.0, rough);
    float glint = pow(max(dot(normal, half_way), 0.0), exponent) * (exponent + 8.0) * 0.025;
    float glint_mirror = 0.02 + 0.98 * pow(1.0 - max(dot(half_way, to_eye), 0.0), 5.0);
    return mix(body, sky, mirror) + sun_light * min(glint * glint_mirror, 2.5);
}
