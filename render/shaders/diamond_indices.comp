#version 450 core
// Triangles of the closed split bits (Yalcin et al. 2011, section 8): an unsplit diamond draws one for each of its
// parents that is split, a split edge midpoint of the finest plane its halves. Compacted: no degenerate triangles.
// In: closed bits. Out: indices row * width + column, counter-clockwise seen from above, and the draw command.
// Bindings: see diamond.glsl; storage 6 the indices, 7 the command.
layout(local_size_x = 64) in;
#include "diamond.glsl"

layout(std430, binding = 6) writeonly buffer DiamondIndices {
    uint indices[];
};
layout(std430, binding = 7) coherent buffer DiamondCommand { // as glDrawElementsIndirect reads it, and what was wanted
    uint index_count, instance_count, first_index;
    int base_vertex;
    uint base_instance, triangles, triangles_max;
} command;

shared uint group_count, group_first;

// The triangles of a super-square, by the bits of their diamonds. Of a diamond at v, with f and a from shape_of: side A
// is (v + f, v - f, v + a), side B is (v - f, v + f, v - a).
struct Triangles {
    uint side_a, side_b;                     // whole
    uint half_af, half_ab, half_bf, half_bb; // of split ones: beside v + f and v - f
};

struct Shape {
    ivec2 f, a;
};

Shape shape_of(int bit, ivec2 v) {
    if ((1u << bit & EDGES_HORIZONTAL) != 0u)
        return Shape(ivec2(-1, 0), ivec2(0, -1));
    if ((1u << bit & EDGES_VERTICAL) != 0u)
        return Shape(ivec2(0, 1), ivec2(-1, 0));
    return ((v.x >> 1) + (v.y >> 1) & 1) == 0 ? Shape(ivec2(-1, -1), ivec2(1, -1)) : Shape(ivec2(-1, 1), ivec2(-1, -1));
}

// `v`: in steps of the plane; no step there is larger than the one of its bit.
bool is_split(int plane, ivec2 v) {
    if (plane >= diamond.size.z)
        return true; // corners of base tiles
    return (bits_at(SuperSquare(plane, v.x >> 2, v.y >> 2)) >> (v.y & 3) * 4 + (v.x & 3) & 1u) != 0u;
}

// Which edge midpoints have a split parent to the north or west, and to the south or east.
uvec2 split_beside_edges(SuperSquare at, uint own) {
    uint left = bits_at(SuperSquare(at.plane, at.i - 1, at.j)), up = bits_at(SuperSquare(at.plane, at.i, at.j - 1));
    uint first = (own & 0x2020u) << 1 | (left & 0x8080u) >> 3 | (own & 0x00A0u) << 4 | (up & 0xA000u) >> 12;
    return uvec2(first, (own & CENTRES) >> 1 | (own & CENTRES) >> 4);
}

uvec2 split_around_centres(SuperSquare at, uint unsplit) {
    uvec2 sides = uvec2(0u);
    for (uint rest = unsplit & CENTRES; rest != 0u; rest &= rest - 1u) {
        int bit = findLSB(rest);
        ivec2 v = 4 * ivec2(at.i, at.j) + ivec2(bit & 3, bit >> 2);
        Shape shape = shape_of(bit, v);
        sides.x |= is_split(at.plane + 1, v + shape.a >> 1) ? 1u << bit : 0u;
        sides.y |= is_split(at.plane + 1, v - shape.a >> 1) ? 1u << bit : 0u;
    }
    return sides;
}

void find_halves(SuperSquare at, uint split, inout Triangles found) {
    ivec2 last = last_inside(at);
    uint north = at.j > 0 ? 0xFFFFu : 0xFFF0u, west = at.i > 0 ? 0xFFFFu : 0xEEEEu;
    uint south = mask_up_to(ivec2(3, last.y - 1)), east = mask_up_to(ivec2(last.x - 1, 3));
    uint h = split & EDGES_HORIZONTAL, v = split & EDGES_VERTICAL;
    found.half_af = h & north | v & west & south;
    found.half_ab = h & north & east | v & west;
    found.half_bf = h & south | v & east & south;
    found.half_bb = h & south & east | v & east;
}

Triangles find_triangles(SuperSquare at) {
    uint own = bits_at(at), inside = inside_mask(at), unsplit = ~own & inside;
    uvec2 sides = split_beside_edges(at, own);
    uvec2 around = split_around_centres(at, unsplit);
    Triangles found = Triangles(unsplit & sides.x | around.x, unsplit & sides.y | around.y, 0u, 0u, 0u, 0u);
    if (at.plane == 0)
        find_halves(at, own & inside, found);
    return found;
}

int count_triangles(Triangles found) {
    return bitCount(found.side_a) + bitCount(found.side_b) + bitCount(found.half_af) + bitCount(found.half_ab) +
           bitCount(found.half_bf) + bitCount(found.half_bb);
}

// What the corners of a triangle are, in multiples of f (x) and a (y).
struct Corners {
    ivec2 first, second, third;
};
const Corners SIDE_A = Corners(ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1));
const Corners SIDE_B = Corners(ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1));
const Corners HALF_AF = Corners(ivec2(1, 0), ivec2(0, 0), ivec2(0, 1));
const Corners HALF_AB = Corners(ivec2(0, 0), ivec2(-1, 0), ivec2(0, 1));
const Corners HALF_BF = Corners(ivec2(0, 0), ivec2(1, 0), ivec2(0, -1));
const Corners HALF_BB = Corners(ivec2(-1, 0), ivec2(0, 0), ivec2(0, -1));

uint index_of(ivec2 v, Shape shape, ivec2 corner, int plane) {
    ivec2 steps = v + corner.x * shape.f + corner.y * shape.a << plane;
    return uint(steps.y * diamond.size.x + steps.x);
}

// Above the budget nothing is written; the count tells.
void write_triangles(SuperSquare at, uint mask, Corners corners, inout uint next) {
    for (uint room = command.triangles_max; mask != 0u && next < room; mask &= mask - 1u, next++) {
        int bit = findLSB(mask);
        ivec2 v = 4 * ivec2(at.i, at.j) + ivec2(bit & 3, bit >> 2);
        Shape shape = shape_of(bit, v);
        indices[3u * next] = index_of(v, shape, corners.first, at.plane);
        indices[3u * next + 1u] = index_of(v, shape, corners.second, at.plane);
        indices[3u * next + 2u] = index_of(v, shape, corners.third, at.plane);
    }
}

// Takes room for the whole group at once. Returns where this invocation's part begins.
uint take_room(uint count) {
    if (gl_LocalInvocationIndex == 0u)
        group_count = 0u;
    barrier();
    uint before = atomicAdd(group_count, count);
    barrier();
    if (gl_LocalInvocationIndex == 0u && group_count != 0u) {
        group_first = atomicAdd(command.triangles, group_count);
        atomicMax(command.index_count, 3u * min(group_first + group_count, command.triangles_max));
    }
    barrier();
    return group_first + before;
}

void diamond_generate_indices() {
    int word = invocation();
    SuperSquare at = super_square_at(min(word, diamond.size.w - 1));
    Triangles found = Triangles(0u, 0u, 0u, 0u, 0u, 0u);
    if (word < diamond.size.w)
        found = find_triangles(at);
    uint next = take_room(uint(count_triangles(found)));
    write_triangles(at, found.side_a, SIDE_A, next);
    write_triangles(at, found.side_b, SIDE_B, next);
    if (at.plane > 0)
        return;
    write_triangles(at, found.half_af, HALF_AF, next);
    write_triangles(at, found.half_ab, HALF_AB, next);
    write_triangles(at, found.half_bf, HALF_BF, next);
    write_triangles(at, found.half_bb, HALF_BB, next);
}

void main() {
    diamond_generate_indices();
}
