#version 450 core
// Which diamonds a predicate splits (Yalcin et al. 2011, section 6); always-split vertices whatever it says.
// In: the model. Out: split bits, not closed.
// Bindings: see diamond.glsl, diamond_view.glsl and diamond_ops.glsl; storage 2 errors, 3-5 positions, 6 super-squares.
// Includes what render/diamond/diamond_program.c makes of a DiamondProgram.
layout(local_size_x = 64) in;
#include "diamond.glsl"
#include "diamond_rules.glsl"
#include "diamond_squares.glsl"
#include "diamond_view.glsl"

layout(std430, binding = 2) readonly buffer DiamondErrors {
    float error_m[];
};
layout(std430, binding = 3) readonly buffer DiamondX {
    float x_m[];
};
layout(std430, binding = 4) readonly buffer DiamondY {
    float y_m[];
};
layout(std430, binding = 5) readonly buffer DiamondZ {
    float z_m[];
};

struct Vertex {
    vec3 at, v; // from the model's origin, from the eye
    float d2, e, r;
    int plane, level, entry;
};

#include "diamond_ops.glsl"
#include "diamond_program.glsl"

Vertex vertex_at(int plane, int word, int slot) {
    Vertex vertex;
    vertex.plane = plane;
    vertex.level = 2 * (diamond.size.z - 1 - plane) + (slot >= 4 ? 1 : 0);
    vertex.entry = slot * diamond.size.w + word;
    vertex.at = vec3(x_m[vertex.entry], y_m[vertex.entry], z_m[vertex.entry]);
    precise vec3 v = vertex.at - view.eye.xyz;
    vertex.v = v;
    vertex.d2 = diamond_distance2(v);
    vertex.e = error_m[vertex.entry];
    vertex.r = slot < 4 ? centre_reach_m(word) : edge_reach_m(word);
    return vertex;
}

void diamond_evaluate() {
    int word = invocation();
    if (word >= diamond.size.w)
        return;
    SuperSquare at = super_square_at(word);
    uint split = 0u;
    for (int slot = 0; slot < 12; slot++)
        split |= selects(vertex_at(at.plane, word, slot)) ? 1u << SLOT_BITS[slot] : 0u;
    bits[word] = split & inside_mask(at) | always_split(word);
}

void main() {
    diamond_evaluate();
}
