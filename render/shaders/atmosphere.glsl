// The air: what it scatters and absorbs, and the tables of light in it.
// Units: kilometres; radiance relative to the sun's irradiance outside the air. Directions and heights are those of
// the space that is scaled along the Earth's axis so that the ellipsoid is a sphere.
// After S. Hillaire, "A Scalable and Production Ready Sky and Atmosphere Rendering Technique", EGSR 2020; the
// coefficients of air and ozone are Bruneton's (2017), the haze is ours.
const float PI = 3.14159265;
const float EARTH_KM = 6378.137;
const float AIR_TOP_KM = 100.0;

const vec3 RAYLEIGH = vec3(5.802e-3, 13.558e-3, 33.1e-3); // scattered, per km at sea level
const float RAYLEIGH_FALL_KM = 8.0;                       // height over which it falls to 1 / e
const float MIE = 5.0e-3;                                 // a clear day: some 100 km of sight
const float MIE_ABSORBED = 0.6e-3;
const float MIE_FALL_KM = 1.3;
const float MIE_FORWARD = 0.76;
const vec3 OZONE = vec3(0.650e-3, 1.881e-3, 0.085e-3); // absorbed, per km at 25 km

struct Air {
    vec3 rayleigh; // scattered, per km
    float mie;
    vec3 extinction;
};

Air air_at(float h_km) {
    Air air;
    air.rayleigh = RAYLEIGH * exp(-h_km / RAYLEIGH_FALL_KM);
    float haze = exp(-h_km / MIE_FALL_KM);
    air.mie = MIE * haze;
    air.extinction = air.rayleigh + (MIE + MIE_ABSORBED) * haze + OZONE * max(0.0, 1.0 - abs(h_km - 25.0) / 15.0);
    return air;
}

float phase_rayleigh(float cosine) {
    return 3.0 / (16.0 * PI) * (1.0 + cosine * cosine);
}

float phase_mie(float cosine) { // Cornette and Shanks
    const float g = MIE_FORWARD, g2 = g * g;
    return 3.0 / (8.0 * PI) * ((1.0 - g2) * (1.0 + cosine * cosine)) /
           ((2.0 + g2) * pow(1.0 + g2 - 2.0 * g * cosine, 1.5));
}

// Height after `km` along a ray; exact, without the difference of two Earth radii.
float height_along(float h_km, float mu, float km) {
    float r = EARTH_KM + h_km;
    float rise = km * (2.0 * r * mu + km);
    return h_km + rise / (sqrt(max(r * r + rise, 0.0)) + r);
}

// Cosine of the zenith angle of the horizon.
float horizon_mu(float h_km) {
    float h = max(h_km, 0.0);
    return -sqrt(h * (2.0 * EARTH_KM + h)) / (EARTH_KM + h);
}

// Distances to a sphere `sphere_km` above the ellipsoid: x near, y far; y < x where the ray misses.
vec2 ray_sphere(float h_km, float mu, float sphere_km) {
    float b = (EARTH_KM + h_km) * mu;
    float c = (h_km - sphere_km) * (2.0 * EARTH_KM + h_km + sphere_km);
    float d = b * b - c;
    if (d < 0.0)
        return vec2(1.0, -1.0);
    float root = sqrt(d);
    // The larger of the two magnitudes first, the other from their product.
    float far = b < 0.0 ? root - b : -root - b;
    float other = abs(far) > 0.0 ? c / far : 0.0;
    return vec2(min(far, other), max(far, other));
}

// --- night: enough to tell land from sky; far more than stars give

// Irradiance on level ground, by the cosine of the sun's zenith angle.
vec3 night_light(float mu_sun) {
    return vec3(0.009, 0.013, 0.022) * smoothstep(0.2, -0.1, mu_sun);
}

const vec3 NIGHT_AIR = vec3(0.0004, 0.0006, 0.0010); // radiance of much air

// --- tables

// Transmittance from a height to space: x from straight up to the horizon, y from the ground to the top.
vec2 transmittance_uv(float h_km, float mu) {
    float r = EARTH_KM + h_km, top = EARTH_KM + AIR_TOP_KM;
    float across = sqrt(top * top - EARTH_KM * EARTH_KM);
    float rho = sqrt(max(h_km * (2.0 * EARTH_KM + h_km), 0.0));
    float d = -r * mu + sqrt(max(r * r * (mu * mu - 1.0) + top * top, 0.0));
    float nearest = AIR_TOP_KM - h_km, farthest = rho + across;
    return vec2((d - nearest) / (farthest - nearest), rho / across);
}

// As the texture's centres have it: the first and last texel hold the ends of the range.
vec2 texel_range(vec2 uv, vec2 size) {
    return (clamp(uv, 0.0, 1.0) * (size - 1.0) + 0.5) / size;
}

const vec2 TRANSMITTANCE_SIZE = vec2(256.0, 64.0);
const vec2 MULTIPLE_SIZE = vec2(32.0, 32.0);
const vec2 SKY_VIEW_SIZE = vec2(64.0, 128.0);

// The sun's light at a height, dimmed by the air and cut off by the horizon.
vec3 sun_light(sampler2D transmittance, float h_km, float mu_sun) {
    float below = horizon_mu(h_km);
    float disc = smoothstep(below - 0.0047, below + 0.0047, mu_sun); // the sun's radius, 0.27 degrees
    return disc * textureLod(transmittance, texel_range(transmittance_uv(h_km, mu_sun), TRANSMITTANCE_SIZE), 0.0).rgb;
}

vec3 multiple_light(sampler2D multiple, float h_km, float mu_sun) {
    vec2 uv = vec2(mu_sun * 0.5 + 0.5, sqrt(clamp(h_km / AIR_TOP_KM, 0.0, 1.0)));
    return textureLod(multiple, texel_range(uv, MULTIPLE_SIZE), 0.0).rgb;
}

// The table of the sky around one eye: x from the sun's azimuth to the opposite one, y from the nadir (0) to the
// horizon (0.5 on either side) to the zenith (1), dense at the horizon.
vec2 sky_view_uv(float mu, float mu_horizon, float cos_azimuth) {
    float x = sqrt(clamp(0.5 - 0.5 * cos_azimuth, 0.0, 1.0));
    float above = mu - mu_horizon;
    float y = sqrt(clamp(abs(above) / (above >= 0.0 ? 1.0 - mu_horizon : 1.0 + mu_horizon), 0.0, 1.0));
    // Half a texel away from the horizon, so that neither side blends into the other.
    float margin = 0.5 / SKY_VIEW_SIZE.y;
    y = above >= 0.0 ? 0.5 + margin + y * (0.5 - 2.0 * margin) : 0.5 - margin - y * (0.5 - 2.0 * margin);
    return vec2((x * (SKY_VIEW_SIZE.x - 1.0) + 0.5) / SKY_VIEW_SIZE.x, y);
}

// Its inverse at a texel: mu and the cosine of the azimuth from the sun.
vec2 sky_view_direction(vec2 uv, float mu_horizon) {
    float x = (uv.x * SKY_VIEW_SIZE.x - 0.5) / (SKY_VIEW_SIZE.x - 1.0);
    float margin = 0.5 / SKY_VIEW_SIZE.y;
    float y = (abs(uv.y - 0.5) - margin) / (0.5 - 2.0 * margin);
    float mu = uv.y >= 0.5 ? mu_horizon + y * y * (1.0 - mu_horizon) : mu_horizon - y * y * (1.0 + mu_horizon);
    return vec2(mu, 1.0 - 2.0 * x * x);
}
