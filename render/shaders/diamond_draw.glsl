// What the triangles of a diamond model share; the twin of DiamondDrawBlock in render/diamond/diamond_pass.c.
// Lattice units; samples.
layout(std140, binding = 7) uniform DiamondDrawBlock {
    ivec4 origin_lo; // model's origin - eye, low words; w: samples a row
    ivec4 origin_hi; // high words; w: level | state << 8 | partition << 16, see tint.glsl
    ivec4 levels;    // x: of the smallest triangles
} draw;
