#version 450 core
// Table: transmittance from a height to space. In: the texel. Out: rgb.
#include "atmosphere.glsl"

layout(location = 0) in vec2 at_clip;
layout(location = 0) out vec4 table;

void main() {
    vec2 uv = (gl_FragCoord.xy - 0.5) / (TRANSMITTANCE_SIZE - 1.0);
    float across = sqrt(AIR_TOP_KM * (2.0 * EARTH_KM + AIR_TOP_KM));
    float rho = uv.y * across;
    float r = sqrt(rho * rho + EARTH_KM * EARTH_KM), h = max(rho * rho / (r + EARTH_KM), 0.0);
    float nearest = AIR_TOP_KM - h, d = nearest + uv.x * (rho + across - nearest);
    float mu = d > 0.0 ? clamp((across * across - rho * rho - d * d) / (2.0 * r * d), -1.0, 1.0) : 1.0;
    vec3 depth = vec3(0.0);
    const int STEPS = 48;
    for (int i = 0; i < STEPS; i++) {
        float km = d * (float(i) + 0.5) / float(STEPS);
        depth += air_at(max(height_along(h, mu, km), 0.0)).extinction * (d / float(STEPS));
    }
    table = vec4(exp(-depth), 1.0);
}
