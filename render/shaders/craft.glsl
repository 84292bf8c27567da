// Uniforms of the aircraft; the twin of render/craft/craft_pass.c.
// Body axes: x ahead, y right, z down; metres.
const int CRAFT_JOINTS = 12, CRAFT_FINISHES = 10, CRAFT_MARKS = 32, CRAFT_SURFACES = 7;
const int CRAFT_GLASS = 3, CRAFT_DARK = 6, CRAFT_LINE = 7, CRAFT_DISC = 9; // as render/craft/craft_shape.h has them

layout(std140, binding = 3) uniform CraftBlock {
    vec4 rows[CRAFT_JOINTS * 3];      // from a joint's vertices to metres from the eye, ECEF axes
    vec4 finishes[CRAFT_FINISHES];    // linear albedo; w: gloss
    vec4 sides[CRAFT_MARKS * 3];      // distances from a quadrilateral's sides, outwards: x of the point, y, constant
    vec4 figures[CRAFT_MARKS];        // x: radius of the corners; y: width of the outline, 0: filled; z: strength
    ivec4 kinds[CRAFT_MARKS];         // x: 1 seen from above, not the side; y: finish
    ivec4 ranges[CRAFT_SURFACES];     // x: first mark of a surface; y: behind its last
    vec4 place;                       // the origin from the eye; w: its height, km
    vec4 disc;                        // radius; how opaque; z: unused; blades
    vec4 hub;
    vec4 map_rows[3];                 // from metres from the eye to the map of shadows and depth in it
    ivec4 shadow;                     // x: 1 where the map of shadows holds this aircraft
} craft;

// Of a vertex, by its joint; ECEF axes.
vec3 craft_to_eye_m(vec3 position, uint joint) {
    vec4 homogeneous = vec4(position, 1.0);
    uint row = joint * 3u;
    return vec3(dot(craft.rows[row], homogeneous), dot(craft.rows[row + 1u], homogeneous),
                dot(craft.rows[row + 2u], homogeneous));
}

vec3 craft_to_map(vec3 eye_m) {
    vec4 homogeneous = vec4(eye_m, 1.0);
    return vec3(dot(craft.map_rows[0], homogeneous), dot(craft.map_rows[1], homogeneous),
                dot(craft.map_rows[2], homogeneous));
}
