// What a predicate reads of the view, and its constants; the twin of DiamondViewBlock in render/diamond/diamond_gpu.c.
// Units: metres from the model's origin.
layout(std140, binding = 7) uniform DiamondViewBlock {
    vec4 eye;           // w: nu, 1 / rad
    vec4 lens;          // slack, m; pixels per radian; tau, px
    vec4 planes[5];     // unit normals of half spaces through the eye, inwards
    vec4 constants[64]; // of the program
} view;

float constant(int n) {
    return view.constants[n >> 2][n & 3];
}
