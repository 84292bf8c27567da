#version 450 core
// Table: light scattered more than once, per unit of scattering, by height and the sun's zenith angle.
// Bindings: transmittance 0. In: the texel. Out: rgb.
#include "march.glsl"

layout(binding = 0) uniform sampler2D transmittance;
layout(location = 0) in vec2 at_clip;
layout(location = 0) out vec4 table;

const vec3 GROUND_ALBEDO = vec3(0.2);

void main() {
    vec2 uv = (gl_FragCoord.xy - 0.5) / (MULTIPLE_SIZE - 1.0);
    float mu_sun = uv.x * 2.0 - 1.0, h = max(uv.y * uv.y * AIR_TOP_KM, 0.001);
    vec3 light = vec3(0.0), share = vec3(0.0);
    const int SIDE = 8; // directions over the sphere, equal solid angles
    for (int i = 0; i < SIDE * SIDE; i++) {
        float mu = (float(i / SIDE) + 0.5) / float(SIDE) * 2.0 - 1.0;
        float azimuth = (float(i % SIDE) + 0.5) / float(SIDE) * 2.0 * PI;
        float cos_sun = mu * mu_sun + cos(azimuth) * sqrt((1.0 - mu * mu) * (1.0 - mu_sun * mu_sun));
        vec3 part = air_interval(h, mu);
        March march = march_ray(transmittance, transmittance, 0.0, h, mu, part.x, part.y, cos_sun, mu_sun, 16);
        light += march.light;
        share += march.share;
        if (part.z > 0.5) {
            float mu_ground = clamp((mu_sun * (EARTH_KM + h) + cos_sun * part.y) / EARTH_KM, -1.0, 1.0);
            light += march.transmittance * GROUND_ALBEDO / PI * max(mu_ground, 0.0) *
                     sun_light(transmittance, 0.0, mu_ground);
        }
    }
    light /= float(SIDE * SIDE);
    share /= float(SIDE * SIDE);
    table = vec4(light / (1.0 - min(share, vec3(0.95))), 1.0); // the sum of all orders
}
