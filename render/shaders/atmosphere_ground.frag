#version 450 core
// Table: light on level ground by the sun's zenith angle (x, cosine -0.2 .. 1) and height (y, 0 .. 8 km).
// Bindings: transmittance 0, multiple scattering 1. Out: the sun's irradiance across its rays; the sky's irradiance.
#include "march.glsl"

layout(binding = 0) uniform sampler2D transmittance;
layout(binding = 1) uniform sampler2D multiple;
layout(location = 0) in vec2 at_clip;
layout(location = 0) out vec4 sun;
layout(location = 1) out vec4 sky;

void main() {
    vec2 uv = (gl_FragCoord.xy - 0.5) / (vec2(GROUND_LIGHT_WIDTH, GROUND_LIGHT_HEIGHT) - 1.0);
    float mu_sun = mix(-0.2, 1.0, uv.x), h = uv.y * 8.0 + 0.001;
    vec3 light = vec3(0.0);
    const int RINGS = 6, SECTORS = 8; // equal parts of the cosine-weighted hemisphere
    for (int i = 0; i < RINGS * SECTORS; i++) {
        float mu = sqrt((float(i / SECTORS) + 0.5) / float(RINGS));
        float azimuth = (float(i % SECTORS) + 0.5) / float(SECTORS) * 2.0 * PI;
        float cos_sun = mu * mu_sun + cos(azimuth) * sqrt((1.0 - mu * mu) * (1.0 - mu_sun * mu_sun));
        vec3 part = air_interval(h, mu);
        light += march_ray(transmittance, multiple, 1.0, h, mu, part.x, part.y, cos_sun, mu_sun, 16).light;
    }
    sun = vec4(sun_light(transmittance, h, mu_sun), 1.0);
    sky = vec4(light * PI / float(RINGS * SECTORS) + night_light(mu_sun), 1.0);
}
