// Light scattered towards the eye along one ray. Units as in atmosphere.glsl.
#include "atmosphere.glsl"

struct March {
    vec3 light;         // scattered into the ray
    vec3 share;         // scattered into the ray if every point were lit by 1: for multiple scattering
    vec3 transmittance; // of the whole ray
};

// From h_km along mu over `km`, whose first point is `begin_km` away. cos_sun: between ray and sun; mu_sun: of the
// sun at the ray's origin. Points are dense near the eye, where the air is.
March march_ray(sampler2D transmittance, sampler2D multiple, float with_multiple, float h_km, float mu, float begin_km,
                float end_km, float cos_sun, float mu_sun, int steps) {
    March march = March(vec3(0.0), vec3(0.0), vec3(1.0));
    float length_km = end_km - begin_km, before = 0.0;
    float rayleigh = phase_rayleigh(cos_sun), mie = phase_mie(cos_sun);
    for (int i = 0; i < steps; i++) {
        float next = float(i + 1) / float(steps);
        next *= next;
        float km = begin_km + length_km * 0.5 * (before + next);
        float step_km = length_km * (next - before);
        before = next;
        float h = max(height_along(h_km, mu, km), 0.0);
        // The sun's zenith angle there: the up direction turns along the ray.
        float mu_sun_there = clamp((mu_sun * (EARTH_KM + h_km) + cos_sun * km) / (EARTH_KM + h), -1.0, 1.0);
        Air air = air_at(h);
        vec3 scattered = air.rayleigh * rayleigh + air.mie * mie;
        vec3 all = air.rayleigh + air.mie;
        vec3 light = sun_light(transmittance, h, mu_sun_there) * scattered;
        if (with_multiple > 0.0)
            light += with_multiple * multiple_light(multiple, h, mu_sun_there) * all;
        vec3 passes = exp(-air.extinction * step_km);
        // Light of the step that reaches the eye; where there is no air left, none is scattered either.
        vec3 kept = march.transmittance * (1.0 - passes) / max(air.extinction, vec3(1e-20));
        march.light += light * kept;
        march.share += all * kept;
        march.transmittance *= passes;
    }
    return march;
}

// The part of a ray that lies in the air and above the ground: x begin, y end; y <= x: none. z: 1 where it ends on
// the ground.
vec3 air_interval(float h_km, float mu) {
    vec2 top = ray_sphere(h_km, mu, AIR_TOP_KM);
    if (top.y <= 0.0 || top.y < top.x)
        return vec3(0.0);
    vec2 ground = ray_sphere(max(h_km, 0.001), mu, 0.0);
    bool hits = ground.y >= ground.x && ground.x > 0.0;
    return vec3(max(top.x, 0.0), hits ? ground.x : top.y, hits ? 1.0 : 0.0);
}
