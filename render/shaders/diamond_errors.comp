#version 450 core
// Errors of the diamonds of one depth (Yalcin et al. 2011, section 5): the largest deviation of a sample of the closed
// triangles from their planes of heights, and the terms of the row.
// In: heights. Out: errors. Bindings: see diamond.glsl; storage 2 errors, 3 heights, 4 terms, 6 super-squares.
// Uniforms: the plane, its first slot of this depth, and how many, bands of rows a diamond.
// Defines: BY_GROUP (a group of invocations shares a band of a large diamond) or not (one invocation, a whole diamond).
layout(local_size_x = 64) in;
#include "diamond.glsl"
#include "diamond_rules.glsl"
#include "diamond_squares.glsl"

layout(std430, binding = 2) coherent buffer DiamondErrors {
    uint error_bits[]; // of floats, which compare like them
};
layout(std430, binding = 3) readonly buffer DiamondHeights {
    float height_m[];
};
layout(std430, binding = 4) readonly buffer DiamondRows {
    vec4 terms[]; // sag of edges and centres, drift of edges and centres
};

layout(location = 0) uniform int plane;
layout(location = 1) uniform int first_slot;
layout(location = 2) uniform int slots;
layout(location = 3) uniform int bands;

const int BAND_ROWS = 32;
const uint INFINITE = 0x7F800000u;

shared uint group_most;

struct Task {
    int entry, step, band;
    bool always_split, inside, centre;
    ivec2 at; // the vertex
    int row;  // of the plane
};

Task task_at(int number) {
    int words = diamond.planes[plane].y * diamond.planes[plane].z;
    int local = number / bands, slot = first_slot + local / words, word = local % words;
    SuperSquare square = super_square_in(plane, word);
    int bit = SLOT_BITS[slot], at_word = diamond.planes[plane].x + word;
    ivec2 v = 4 * ivec2(square.i, square.j) + ivec2(bit & 3, bit >> 2);
    Task task;
    task.entry = slot * diamond.size.w + at_word;
    task.step = 1 << plane;
    task.band = number % bands;
    task.inside = (inside_mask(square) >> bit & 1u) != 0u;
    task.always_split = (always_split(at_word) >> bit & 1u) != 0u;
    task.centre = slot < 4;
    task.at = v << plane;
    task.row = v.y;
    return task;
}

float height_at(ivec2 at) {
    return height_m[at.y * diamond.size.x + at.x];
}

float inverse_of_step() { // exact, which a division need not be
    return uintBitsToFloat(uint(127 - plane) << 23);
}

// Of a diamond's two triangles; an absent one has `has` false.
struct Diamond {
    DiamondPlane first, second; // north or west; south or east
    bool has_first, has_second, horizontal, rising;
    float range_m;
};

Diamond edge_diamond(Task task) {
    Diamond d;
    int s = task.step;
    d.horizontal = (task.at.x & s) != 0;
    ivec2 along = d.horizontal ? ivec2(s, 0) : ivec2(0, s), across = s - along;
    float a = height_at(task.at - along), b = height_at(task.at + along), inverse_step = inverse_of_step();
    float least = a < b ? a : b, most = a > b ? a : b;
    ivec2 before = task.at - across, after = task.at + across;
    d.has_first = before.x >= 0 && before.y >= 0;
    d.has_second = after.x < diamond.size.x && after.y < diamond.size.y;
    if (d.has_first) {
        float apex = height_at(before);
        d.first = diamond_edge_plane(a, b, apex, -1.0, inverse_step, d.horizontal);
        least = apex < least ? apex : least;
        most = apex > most ? apex : most;
    }
    if (d.has_second) {
        float apex = height_at(after);
        d.second = diamond_edge_plane(a, b, apex, 1.0, inverse_step, d.horizontal);
        least = apex < least ? apex : least;
        most = apex > most ? apex : most;
    }
    precise float range_m = most - least;
    d.range_m = range_m;
    return d;
}

Diamond centre_diamond(Task task) {
    Diamond d;
    int s = task.step;
    float nw = height_at(task.at + ivec2(-s, -s)), ne = height_at(task.at + ivec2(s, -s));
    float sw = height_at(task.at + ivec2(-s, s)), se = height_at(task.at + ivec2(s, s));
    float inverse_step = inverse_of_step();
    d.rising = ((task.at.x >> plane + 1) + (task.at.y >> plane + 1) & 1) != 0;
    d.first = diamond_west_plane(nw, ne, sw, se, inverse_step, d.rising);
    d.second = diamond_east_plane(nw, ne, sw, se, inverse_step, d.rising);
    precise float range_m = max(max(nw, ne), max(sw, se)) - min(min(nw, ne), min(sw, se));
    d.range_m = range_m;
    return d;
}

// Which of the two closed triangles a sample is in.
bvec2 triangles_of(Task task, Diamond d, int x, int y) {
    if (task.centre) {
        int hypotenuse = d.rising ? -y : y;
        return bvec2(x <= hypotenuse, x >= hypotenuse);
    }
    int side = d.horizontal ? y : x;
    return bvec2(side <= 0 && d.has_first, side >= 0 && d.has_second);
}

uint deviation_at(Task task, Diamond d, int x, int y) {
    bvec2 within = triangles_of(task, d, x, y);
    if (!any(within))
        return 0u;
    float h = height_at(task.at + ivec2(x, y));
    uint first = within.x ? diamond_deviation(h, d.first, float(x), float(y)) : 0u;
    uint second = within.y ? diamond_deviation(h, d.second, float(x), float(y)) : 0u;
    return max(first, second);
}

// Of the band's rows, every `stride`-th sample from `lane`.
uint scan_band(Task task, Diamond d, int lane, int stride) {
    int begin = task.band * BAND_ROWS - task.step, end = task.step;
    if (bands > 1)
        end = min(begin + BAND_ROWS - 1, end);
    uint most = 0u;
    for (int y = begin; y <= end; y++) {
        int reach = task.centre ? task.step : task.step - abs(y);
        for (int x = lane - reach; x <= reach; x += stride)
            most = max(most, deviation_at(task, d, x, y));
    }
    return most;
}

void store_error(Task task, Diamond d, uint most) {
    vec4 row = terms[diamond.planes[plane].w + task.row];
    float sag = task.centre ? row.y : row.x, drift = task.centre ? row.w : row.z;
    uint value = floatBitsToUint(diamond_error(uintBitsToFloat(most), d.range_m, drift, sag));
    if (bands > 1)
        atomicMax(error_bits[task.entry], value);
    else
        error_bits[task.entry] = value;
}

Diamond diamond_of(Task task) {
    if (task.centre)
        return centre_diamond(task);
    return edge_diamond(task);
}

bool is_scanned(Task task) {
    if (task.inside && !task.always_split)
        return true;
    error_bits[task.entry] = task.inside ? INFINITE : 0u;
    return false;
}

int task_count() {
    return slots * diamond.planes[plane].y * diamond.planes[plane].z * bands;
}

#ifdef BY_GROUP
void diamond_generate_errors() {
    int number = int(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x);
    if (number >= task_count())
        return;
    Task task = task_at(number);
    if (!is_scanned(task))
        return;
    Diamond d = diamond_of(task);
    if (gl_LocalInvocationIndex == 0u)
        group_most = 0u;
    barrier();
    atomicMax(group_most, scan_band(task, d, int(gl_LocalInvocationIndex), int(gl_WorkGroupSize.x)));
    barrier();
    if (gl_LocalInvocationIndex == 0u)
        store_error(task, d, group_most);
}
#else
void diamond_generate_errors() {
    int number = invocation();
    if (number >= task_count())
        return;
    Task task = task_at(number);
    if (!is_scanned(task))
        return;
    Diamond d = diamond_of(task);
    store_error(task, d, scan_band(task, d, 0, 1));
}
#endif

void main() {
    diamond_generate_errors();
}
