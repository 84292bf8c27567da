// The ground's textures and uniforms; the twin of render/ground/ground.h.
// Units: metres above the geoid; DEM samples.
layout(std140, binding = 1) uniform GroundBlock {
    vec4 texel;  // coordinates = sample * xy + zw
    vec4 height; // m above the geoid = texture * x + y; z: metres a cell
    vec4 noise;  // xy: repeats of the noise per sample; zw: cells along x and y
    vec4 globe;  // what surrounds the data: x: its height, m; y: 1 where it is sea
} ground;

layout(binding = 0) uniform sampler2D surface_map; // normal east, normal north, open sky, water
layout(binding = 1) uniform sampler2D height_map;
layout(binding = 2) uniform sampler2D shade_map;   // sqrt(tangent of the ground's elevation towards the sun / 2)
layout(binding = 3) uniform sampler2D noise_map;   // fractal noise, its slopes, a mosaic
layout(binding = 4) uniform sampler2D hole_map;    // 1 where there are no data

// East, north, up.
vec3 decode_normal(vec2 bytes) {
    vec2 slope = bytes * (255.0 / 127.0) - 128.0 / 127.0;
    return vec3(slope, sqrt(max(1.0 - dot(slope, slope), 0.01)));
}

// From the coarse noise to finer ones, turned against it so that their repeats don't line up. Whole numbers: where the
// coarse one repeats, so do they.
const mat2 NOISE_MIDDLE = mat2(13.0, 5.0, -5.0, 13.0);      // 2.4 km a repeat
const mat2 NOISE_FINE = mat2(181.0, -108.0, 108.0, 181.0);  // 155 m
