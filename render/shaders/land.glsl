// What grows and lies where: the colour of land. Units: metres above the geoid; linear albedo.
// Borders wander with noise of several scales, so that no line of equal height shows as one.

struct Land {
    vec3 albedo;
    float rough; // how much small relief shows in the light
};

// Where nothing is known of the land.
const vec3 ANY_MEADOW = vec3(0.105, 0.126, 0.046), ANY_WOODS = vec3(0.034, 0.058, 0.020);

// Above which trees end and snow stays, by latitude; fits to the well-known values of the Earth's mountains.
vec2 land_lines_m(float sin_lat) {
    float s = sin_lat * sin_lat;
    float trees = clamp(4500.0 - 5000.0 * s, -200.0, 2700.0);
    float snow = min(5000.0, 5560.0 - 5600.0 * s);
    return vec2(trees, max(snow, trees + 300.0));
}

// coarse, middle, fine: texels of the noise (see render/ground/noise.h) at falling scales; steep: 1 - normal.z;
// spread: 1, and more where a pixel covers several cells, so that borders finer than a pixel become shares of both
// sides.
Land land_at(float h_m, float steep, float north, float open_sky, vec2 lines_m, vec4 coarse, vec4 middle, vec4 fine,
             float spread) {
    float large = coarse.r * 2.0 - 1.0, mid = middle.r * 2.0 - 1.0, small = fine.r * 2.0 - 1.0;
    float wander_m = large * 160.0 + mid * 120.0 + small * 40.0;

    // Lowland: meadow and fields where level, woods on the slopes and in patches.
    vec3 meadow = mix(vec3(0.080, 0.113, 0.036), vec3(0.130, 0.138, 0.056), 0.5 + 0.5 * large);
    vec3 field = mix(vec3(0.062, 0.102, 0.032), vec3(0.220, 0.187, 0.095), middle.a * middle.a);
    float tilled = smoothstep(0.010, 0.002, steep) * smoothstep(-0.35, 0.15, mid + 0.6 * large);
    vec3 open_land = mix(meadow, field, 0.75 * tilled) * (1.0 + 0.20 * mid + 0.14 * small);
    vec3 woods = mix(vec3(0.022, 0.044, 0.016), vec3(0.040, 0.066, 0.022), 0.5 + 0.5 * mid) * (1.0 + 0.30 * small);
    float shelter = (steep - 0.026) * 3.2 + large * 0.17 + mid * 0.13 + small * 0.05;
    float wooded = smoothstep(-0.07 * spread, 0.07 * spread, shelter);
    float tree_share = smoothstep(80.0 * spread, -80.0 * spread, h_m - lines_m.x + wander_m);
    tree_share *= smoothstep(0.46, 0.34, steep);
    vec3 albedo = mix(open_land, woods, wooded * tree_share);

    // Above the trees: grass that thins out to scree and rock.
    float alpine = smoothstep(50.0 - 110.0 * spread, 50.0 + 110.0 * spread, h_m - lines_m.x + wander_m * 0.8);
    vec3 grass = mix(vec3(0.085, 0.100, 0.034), vec3(0.135, 0.120, 0.056), 0.5 + 0.5 * mid) * (1.0 + 0.18 * small);
    albedo = mix(albedo, grass, alpine);
    vec3 rock = mix(vec3(0.086, 0.084, 0.070), vec3(0.158, 0.156, 0.134), 0.5 + 0.5 * (0.6 * mid + 0.6 * small));
    float above = clamp((h_m - lines_m.x + wander_m) / max(lines_m.y - lines_m.x, 300.0), 0.0, 1.0);
    float too_steep = steep - mix(0.25, 0.08, above) + mid * 0.035 + small * 0.03;
    float bare = smoothstep(-0.05 * spread, 0.05 * spread, too_steep);
    bare = max(bare, smoothstep(0.50, 0.95, above + 0.25 * mid));
    albedo = mix(albedo, rock, bare);

    // Snow lies where it is high, not steep, and in the hollows.
    float snow_m = h_m - lines_m.y + wander_m * 0.8 + north * 260.0 + (0.72 - open_sky) * 600.0 - steep * 900.0;
    float snow = smoothstep(10.0 - 100.0 * spread, 10.0 + 100.0 * spread, snow_m);
    snow *= smoothstep(0.62, 0.40, steep + 0.08 * small);
    albedo = mix(albedo, vec3(0.60, 0.63, 0.66), snow);

    return Land(albedo, mix(0.8 + 0.6 * bare, 0.25, snow));
}
