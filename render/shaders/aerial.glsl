// What the air does between the eye and a point. Units: metres and kilometres as named; round space.
// Needs the tables of the sky: bindings 8 (radiance of whole rays) and 9 (per unit of what they lost).
#include "atmosphere.glsl"
#include "frame.glsl"

layout(binding = 8) uniform sampler2D sky_radiance;
layout(binding = 9) uniform sampler2D sky_source;

// `direction`: unit, round space.
vec2 sky_coordinates(vec3 direction) {
    float mu = dot(direction, frame.eye_up.xyz);
    float level = sqrt(max(1.0 - mu * mu, 1e-6));
    return sky_view_uv(mu, frame.air.z, dot(direction, frame.sun_side.xyz) / level);
}

// Mean of exp(-h / fall) over a stretch between two heights whose densities are given.
float mean_density(float a, float b, float drop_km, float fall_km) {
    return abs(drop_km) > 0.02 * fall_km ? (a - b) * fall_km / drop_km : 0.5 * (a + b);
}

// Eyes adapt to haze and cameras are filtered: near land is shown somewhat clearer than the air leaves it.
const float CLEARER = 0.55;

struct Aerial {
    vec3 passes; // share of the point's light that arrives
    vec3 light;  // added by the air
};

// To a point `metres` away, h_km high.
Aerial aerial_to(vec3 direction, float metres, float h_km) {
    float drop_km = h_km - frame.eye_up.w, km = metres * 1e-3 * CLEARER;
    float rayleigh = mean_density(frame.air.x, exp(-h_km / RAYLEIGH_FALL_KM), drop_km, RAYLEIGH_FALL_KM);
    float haze = mean_density(frame.air.y, exp(-h_km / MIE_FALL_KM), drop_km, MIE_FALL_KM);
    Aerial aerial;
    aerial.passes = exp(-km * (RAYLEIGH * rayleigh + (MIE + MIE_ABSORBED) * haze));
    aerial.light = textureLod(sky_source, sky_coordinates(direction), 0.0).rgb * (1.0 - aerial.passes);
    return aerial;
}

// Of a point relative to the eye, round space, km above the ellipsoid; exact for far points.
float height_km(vec3 round_m) {
    float metres2 = dot(round_m, round_m), rise = dot(round_m, frame.eye_up.xyz);
    float r = EARTH_KM * 1e3 + frame.eye_up.w * 1e3;
    float more = 2.0 * r * rise + metres2;
    return frame.eye_up.w + more / (sqrt(max(r * r + more, 0.0)) + r) * 1e-3;
}
