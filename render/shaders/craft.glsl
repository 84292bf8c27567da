// Uniforms of the aircraft; the twin of render/craft/craft_pass.c.
// Body axes: x ahead, y right, z down; metres.
const int CRAFT_JOINTS = 12, CRAFT_FINISHES = 10, CRAFT_MARKS = 32;
const int CRAFT_GLASS = 3, CRAFT_DARK = 6, CRAFT_LINE = 7, CRAFT_DISC = 9; // as render/craft/craft_shape.h has them

layout(std140, binding = 3) uniform CraftBlock {
    vec4 rows[CRAFT_JOINTS * 3];      // from a joint's vertices to metres from the eye, ECEF axes
    vec4 finishes[CRAFT_FINISHES];    // linear albedo; w: gloss
    vec4 corners[CRAFT_MARKS * 2];    // of a painted quadrilateral, two corners each
    vec4 figures[CRAFT_MARKS];        // x: grown by so much; y: width of the outline, 0: filled; z: strength
    ivec4 kinds[CRAFT_MARKS];         // x: surfaces, bits; y: seen from above, not the side; z: finish
    vec4 place;                       // the origin from the eye; w: its height, km
    vec4 disc;                        // radius; how opaque; z: unused; blades
    vec4 hub;
    ivec4 counts;                     // marks
} craft;
