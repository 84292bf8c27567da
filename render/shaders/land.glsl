// What grows and lies where: the colour of land. Units: metres above the geoid; linear albedo.
// Borders wander with noise of several scales, so that no line of equal height shows as one.

struct Land {
    vec3 albedo;
    float rough; // how much small relief shows in the light
};

// Above which trees end and snow stays, by latitude; fits to the well-known values of the Earth's mountains.
vec2 land_lines_m(float sin_lat) {
    float s = sin_lat * sin_lat;
    float trees = mix(3300.0, -900.0, smoothstep(0.02, 0.98, s));
    float snow = 5000.0 - 5200.0 * s * sqrt(s) - 350.0 * s;
    return vec2(trees, max(snow, trees * 0.2 + 250.0));
}

// coarse, middle, fine: texels of the noise (see render/noise.h) at falling scales; steep: 1 - normal.z.
Land land_at(float h_m, float steep, float north, float open_sky, vec2 lines_m, vec4 coarse, vec4 middle, vec4 fine) {
    float large = coarse.r * 2.0 - 1.0, mid = middle.r * 2.0 - 1.0, small = fine.r * 2.0 - 1.0;
    float wander_m = large * 220.0 + mid * 130.0 + small * 40.0;

    // Lowland: meadow and fields where level, woods on the slopes and in patches.
    vec3 meadow = mix(vec3(0.110, 0.140, 0.042), vec3(0.165, 0.165, 0.062), 0.5 + 0.5 * large);
    vec3 field = mix(vec3(0.085, 0.130, 0.038), vec3(0.235, 0.205, 0.100), middle.a);
    vec3 open_land = mix(meadow, field, 0.55 * smoothstep(0.012, 0.002, steep)) * (1.0 + 0.18 * mid + 0.12 * small);
    vec3 woods = mix(vec3(0.034, 0.058, 0.022), vec3(0.050, 0.078, 0.028), 0.5 + 0.5 * mid) * (1.0 + 0.35 * small);
    float wooded = smoothstep(-0.10, 0.10, (steep - 0.028) * 3.0 + large * 0.16 + mid * 0.12 + small * 0.05);
    float tree_share = smoothstep(90.0, -90.0, h_m - lines_m.x + wander_m) * smoothstep(0.42, 0.30, steep);
    vec3 albedo = mix(open_land, woods, wooded * tree_share);

    // Above the trees: grass that thins out to scree and rock.
    float alpine = smoothstep(-60.0, 160.0, h_m - lines_m.x + wander_m * 0.8);
    vec3 grass = mix(vec3(0.115, 0.125, 0.050), vec3(0.150, 0.135, 0.070), 0.5 + 0.5 * mid) * (1.0 + 0.15 * small);
    albedo = mix(albedo, grass, alpine);
    vec3 rock = mix(vec3(0.155, 0.143, 0.130), vec3(0.235, 0.220, 0.200), 0.5 + 0.5 * (0.6 * mid + 0.6 * small));
    float above = clamp((h_m - lines_m.x + wander_m) / max(lines_m.y - lines_m.x, 300.0), 0.0, 1.0);
    float bare = smoothstep(-0.05, 0.05, steep - mix(0.24, 0.07, above) + mid * 0.035 + small * 0.03);
    bare = max(bare, smoothstep(0.55, 1.0, above + 0.25 * mid));
    albedo = mix(albedo, rock, bare);

    // Snow lies where it is high, not steep, and in the hollows.
    float snow_m = h_m - lines_m.y + wander_m * 0.8 + north * 220.0 + (0.72 - open_sky) * 500.0 - steep * 900.0;
    float snow = smoothstep(-90.0, 110.0, snow_m) * smoothstep(0.62, 0.40, steep + 0.08 * small);
    albedo = mix(albedo, vec3(0.78, 0.81, 0.86), snow);

    return Land(albedo, mix(0.8 + 0.6 * bare, 0.25, snow));
}
