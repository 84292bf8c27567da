#version 450 core
// Transitive closure: the ancestors of what is split are split (Yalcin et al. 2011, section 7). Pulled, not pushed: an
// invocation owns the word it writes, so that nothing is atomic.
// Bindings: see diamond.glsl. Uniform 0: the plane. A barrier between planes, finest first.
// Defines: EDGES_OF_PLANE (edge midpoints of a plane, from the centres of the finer one) or CENTRES_OF_ALL (the centres
// of all planes, once their edge midpoints are final).
layout(local_size_x = 64) in;
#include "diamond.glsl"
#include "diamond_rules.glsl"

layout(location = 0) uniform int plane;

// The centres that a super-square's edge midpoints, and those east and south of it, need.
uint centres_at(SuperSquare at) {
    uint east = bits_at(SuperSquare(at.plane, at.i + 1, at.j)), south = bits_at(SuperSquare(at.plane, at.i, at.j + 1));
    return diamond_close_centres(bits_at(at), east, south) & inside_mask(at);
}

// The edge midpoints that centres of the finer plane need, from the 3 by 3 finer super-squares they lie in.
uint edges_at(SuperSquare at) {
    uint fine[9];
    for (int n = 0; n < 9; n++) {
        SuperSquare finer = SuperSquare(at.plane - 1, 2 * at.i - 1 + n % 3, 2 * at.j - 1 + n / 3);
        fine[n] = bits_at(finer) | centres_at(finer);
    }
    uint edges = diamond_close_edges(fine[4], fine[3], fine[1], 0, 0) |
                 diamond_close_edges(fine[5], fine[4], fine[2], 1, 0) |
                 diamond_close_edges(fine[7], fine[6], fine[4], 0, 1) |
                 diamond_close_edges(fine[8], fine[7], fine[5], 1, 1);
    return edges & inside_mask(at);
}

void diamond_close() {
    int word = invocation();
#ifdef EDGES_OF_PLANE
    ivec4 words = diamond.planes[plane];
    if (word < words.y * words.z)
        bits[words.x + word] |= edges_at(super_square_in(plane, word));
#else
    if (word < diamond.size.w)
        bits[word] |= centres_at(super_square_at(word));
#endif
}

void main() {
    diamond_close();
}
