// Super-squares of diamonds; the twin of terrain/diamond/diamond_layout.h and of DiamondBlock in
// render/diamond/diamond_gpu.c.
// Units: samples; steps are powers of two, plane k holds step 1 << k. A super-square's word has bit dy * 4 + dx for the
// sample (4 I + dx, 4 J + dy) steps, not both even; set: split.
// Bindings: block 6; storage 0 the words of split bits.
layout(std140, binding = 6) uniform DiamondBlock {
    ivec4 size;       // samples across and down, planes, words in all planes
    ivec4 planes[16]; // offset of the first word, super-squares across, down; w: of the first DiamondTerms
} diamond;

layout(std430, binding = 0) coherent buffer DiamondBits {
    uint bits[];
};

const uint CENTRES = 0xA0A0u, EDGES_HORIZONTAL = 0x0A0Au, EDGES_VERTICAL = 0x5050u;
const uint EDGES = EDGES_HORIZONTAL | EDGES_VERTICAL;

struct SuperSquare {
    int plane, i, j;
};

// Groups lie in two dimensions because one holds 65535 of them at least.
int invocation() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    return int(group * gl_WorkGroupSize.x + gl_LocalInvocationIndex);
}

// `word` counts from the first word of `plane`.
SuperSquare super_square_in(int plane, int word) {
    int across = diamond.planes[plane].y, j = word / across;
    return SuperSquare(plane, word - j * across, j);
}

// Of all planes; most words are the finest one's.
SuperSquare super_square_at(int word) {
    int plane = 0;
    while (plane + 1 < diamond.size.z && word >= diamond.planes[plane + 1].x)
        plane++;
    return super_square_in(plane, word - diamond.planes[plane].x);
}

// Outside the DEM nothing is split.
uint bits_at(SuperSquare at) {
    ivec4 plane = diamond.planes[at.plane];
    bool inside = at.i >= 0 && at.j >= 0 && at.i < plane.y && at.j < plane.z;
    return inside ? bits[plane.x + at.j * plane.y + at.i] : 0u;
}

// The samples up to a column and row of the super-square.
uint mask_up_to(ivec2 last) {
    if (last.x < 0 || last.y < 0)
        return 0u;
    uint columns = last.x >= 3 ? 0xFu : (2u << last.x) - 1u;
    uint rows = last.y >= 3 ? 0x1111u : 0x1111u & (1u << 4 * last.y + 1) - 1u;
    return columns * rows & (CENTRES | EDGES);
}

// The DEM's last column and row, counted from the super-square's first.
ivec2 last_inside(SuperSquare at) {
    return (diamond.size.xy - 1 >> at.plane) - 4 * ivec2(at.i, at.j);
}

// The samples of a super-square that lie in the DEM.
uint inside_mask(SuperSquare at) {
    return at.i < 0 || at.j < 0 ? 0u : mask_up_to(last_inside(at));
}
