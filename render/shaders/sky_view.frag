#version 450 core
// Table: the sky around one eye (sky_view_uv). Bindings: transmittance 0, multiple scattering 1.
// Uniforms: location 0: eye height in km and the cosine of the sun's zenith angle.
// Out: radiance of the whole ray; the same per unit of what the ray lost, from which a part of the ray is made.
#include "march.glsl"

layout(binding = 0) uniform sampler2D transmittance;
layout(binding = 1) uniform sampler2D multiple;
layout(location = 0) uniform vec2 eye_and_sun;
layout(location = 0) in vec2 at_clip;
layout(location = 0) out vec4 radiance;
layout(location = 1) out vec4 source;

void main() {
    float h = max(eye_and_sun.x, 0.001), mu_sun = eye_and_sun.y;
    vec2 direction = sky_view_direction(gl_FragCoord.xy / SKY_VIEW_SIZE, horizon_mu(h));
    float mu = clamp(direction.x, -1.0, 1.0);
    float cos_sun = mu * mu_sun + direction.y * sqrt(max((1.0 - mu * mu) * (1.0 - mu_sun * mu_sun), 0.0));
    vec3 part = air_interval(h, mu);
    March march = march_ray(transmittance, multiple, 1.0, h, mu, part.x, max(part.x, part.y), cos_sun, mu_sun, 28);
    march.light += NIGHT_AIR * (1.0 - march.transmittance);
    radiance = vec4(march.light, dot(march.transmittance, vec3(1.0 / 3.0)));
    source = vec4(march.light / max(1.0 - march.transmittance, vec3(1e-4)), 1.0);
}
