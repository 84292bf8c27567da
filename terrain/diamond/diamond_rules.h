// terrain/diamond/diamond_rules.h: the arithmetic of one diamond and one super-square, to the bit as the compute
// shaders have it. Float metres; positions relative to the model's origin.
// Pure functions; any thread.
//
// GLSL twin: render/shaders/diamond_rules.glsl, under the same names. IEEE single precision, +, -, * and comparisons
// only, each operation rounded (no contraction; `precise` there), in the order written. Floats and their bits are
// exchanged as floatBitsToUint and uintBitsToFloat do.
#pragma once
#include "base/base.h"
#include "terrain/diamond/diamond_layout.h"

// Covers what rounding can take from the two sides of a comparison of squared distances: 16 roundings of 2^-24.
#define DIAMOND_GROW 1.00001f
#define DIAMOND_FAR 1e37f // squared metres; greater squares count as this, so that roots stay finite
#define DIAMOND_HUGE_PX 1e30f

static inline uint32_t diamond_float_bits(float value) {
    union {
        float value;
        uint32_t bits;
    } both = {.value = value};
    return both.bits;
}

static inline float diamond_bits_float(uint32_t bits) {
    union {
        uint32_t bits;
        float value;
    } both = {.bits = bits};
    return both.value;
}

// ---- generation ----

// The plane of heights of one triangle of a diamond: through (0, 0, middle), dx and dy samples from the vertex.
typedef struct DiamondPlane {
    float middle, rise_x, rise_y; // metres, metres a sample
} DiamondPlane;

// Edge midpoint: `a`, `b` the heights of the hypotenuse's ends, west or north first; `apex` of the triangle's third
// corner, on the side `side` (-1: north or west, 1: south or east). `inverse_step`: 1 / step, exact.
static inline DiamondPlane diamond_edge_plane(float a, float b, float apex, float side, float inverse_step,
                                              bool horizontal) {
    float middle = 0.5f * (a + b);
    float along = (b - a) * (0.5f * inverse_step);
    float away = (apex - middle) * (side * inverse_step);
    return (DiamondPlane){middle, horizontal ? along : away, horizontal ? away : along};
}

// Centre: of the western triangle, whose corners on the west side are both its own, and of the eastern one. `rising`:
// the hypotenuse runs from south-west to north-east.
static inline DiamondPlane diamond_west_plane(float nw, float ne, float sw, float se, float inverse_step, bool rising) {
    float scale = 0.5f * inverse_step;
    float middle = 0.5f * (rising ? sw + ne : nw + se);
    return (DiamondPlane){middle, (rising ? ne - nw : se - sw) * scale, (sw - nw) * scale};
}
static inline DiamondPlane diamond_east_plane(float nw, float ne, float sw, float se, float inverse_step, bool rising) {
    float scale = 0.5f * inverse_step;
    float middle = 0.5f * (rising ? sw + ne : nw + se);
    return (DiamondPlane){middle, (rising ? se - sw : ne - nw) * scale, (se - ne) * scale};
}

// |h - plane| as bits: non-negative floats compare like their bits, so a maximum of any order is the same.
static inline uint32_t diamond_deviation(float h, DiamondPlane plane, float dx, float dy) {
    float base = plane.middle + plane.rise_y * dy;
    return diamond_float_bits(h - (base + plane.rise_x * dx)) & UINT32_C(0x7FFFFFFF);
}

// `deviation_m` the largest of the closed triangles' samples, `range_m` of the corners' heights; drift and sag of the
// vertex's row (DiamondTerms).
static inline float diamond_error(float deviation_m, float range_m, float drift, float sag_m) {
    return (deviation_m + range_m * drift) + sag_m;
}

// ---- evaluation ----

static inline float diamond_distance2(float x, float y, float z) {
    return (x * x + y * y) + z * z;
}

// Greatest distance of anything the diamond's triangles may draw or ought to draw from its vertex.
static inline float diamond_reach(float error_m, float reach_m, float slack_m) {
    return error_m + (reach_m + slack_m);
}

// nu E + R > d. What is not so keeps tau at every sample of both triangles.
static inline bool diamond_tolerance(float error_m, float reach_m, float distance2, float nu, float slack_m) {
    float limit = nu * error_m + diamond_reach(error_m, reach_m, slack_m);
    return (limit * limit) * DIAMOND_GROW > distance2;
}

// Square root within 1e-6 of its value, from + - * alone: Newton's iteration for 1 / sqrt from a first guess by the
// exponent. 0 gives 0.
static inline float diamond_root(float square) {
    float x = square < DIAMOND_FAR ? square : DIAMOND_FAR;
    float half = 0.5f * x;
    float y = diamond_bits_float(UINT32_C(0x5F3759DF) - (diamond_float_bits(x) >> 1));
    y = y * (1.5f - (half * y) * y);
    y = y * (1.5f - (half * y) * y);
    y = y * (1.5f - (half * y) * y);
    y = y * (1.5f - (half * y) * y);
    return x * y;
}

// 1 / x within 1e-6, 1e-30 <= x <= 1e30.
static inline float diamond_reciprocal(float x) {
    float y = diamond_bits_float(UINT32_C(0x7EF311C7) - diamond_float_bits(x));
    y = y * (2.0f - x * y);
    y = y * (2.0f - x * y);
    y = y * (2.0f - x * y);
    return y * (2.0f - x * y);
}

// At most so many pixels can the error take, seen from the eye, whichever of the diamond's samples it is at;
// DIAMOND_HUGE_PX where the eye may touch them.
static inline float diamond_px(float error_m, float reach_m, float distance2, float px_per_rad, float slack_m) {
    float gap = diamond_root(distance2) * 0.99999f - diamond_reach(error_m, reach_m, slack_m);
    float least = gap > 0.001f ? gap : 0.001f;
    float px = (px_per_rad * error_m) * (diamond_reciprocal(least) * DIAMOND_GROW);
    return gap > 0.001f && px < DIAMOND_HUGE_PX ? px : DIAMOND_HUGE_PX;
}

// Whether the diamond may reach into the half spaces of the view. `plane` as DiamondView has it.
static inline bool diamond_inview(float x, float y, float z, float reach_m, float slack_m, const float plane[5][3]) {
    float room = (reach_m + slack_m) * DIAMOND_GROW;
    bool in = true;
    for (int i = 0; i < 5; i++) {
        float ahead = (plane[i][0] * x + plane[i][1] * y) + plane[i][2] * z;
        in = in && ahead >= -room;
    }
    return in;
}

// Whether the diamond may reach into a circle on the ground. c: the place, the unit vectors east and north there, its
// radius in metres.
static inline bool diamond_within(float x, float y, float z, float reach_m, float slack_m, const float c[10]) {
    float dx = x - c[0], dy = y - c[1], dz = z - c[2];
    float east = (c[3] * dx + c[4] * dy) + c[5] * dz;
    float north = (c[6] * dx + c[7] * dy) + c[8] * dz;
    float limit = c[9] + (reach_m + slack_m);
    return east * east + north * north <= (limit * limit) * DIAMOND_GROW;
}

// Whether the diamond may reach into a box. c: west, south, east, north in degrees from the model's middle; degrees
// east and north that a metre can be at most.
static inline bool diamond_box(float east_deg, float north_deg, float reach_m, const float c[6]) {
    float beside = reach_m * c[4], above = reach_m * c[5];
    return east_deg + beside >= c[0] && north_deg + above >= c[1] && east_deg - beside <= c[2] &&
           north_deg - above <= c[3];
}

// ---- closure ----

// The centres of a super-square that a split edge midpoint needs: its own edges' and those of the super-squares to the
// east and to the south.
static inline uint32_t diamond_close_centres(uint32_t own, uint32_t east, uint32_t south) {
    uint32_t nw = own >> 1 | own >> 4 | own >> 6 | own >> 9;       // (1,0) (0,1) (2,1) (1,2)
    uint32_t ne = own >> 3 | own >> 6 | own >> 11 | east >> 4;     // (3,0) (2,1) (3,2) east (0,1)
    uint32_t sw = own >> 9 | own >> 12 | own >> 14 | south >> 1;   // (1,2) (0,3) (2,3) south (1,0)
    uint32_t se = own >> 11 | own >> 14 | east >> 12 | south >> 3; // (3,2) (2,3) east (0,3) south (3,0)
    return (nw & 1) << 5 | (ne & 1) << 7 | (sw & 1) << 13 | (se & 1) << 15;
}

// The edge midpoints of the quarter (half_x, half_y) of a super-square that split centres of the finer plane need, in
// place. `fine` is the finer super-square that fills the quarter, `west` and `north` its neighbours.
//   (0,1) of the quarter: fine (1,1) (1,3), west (3,1) (3,3);  (1,0): fine (1,1) (3,1), north (1,3) (3,3)
static inline uint32_t diamond_close_edges(uint32_t fine, uint32_t west, uint32_t north, int half_x, int half_y) {
    uint32_t beside = fine >> 5 | fine >> 13 | west >> 7 | west >> 15;
    uint32_t above = fine >> 5 | fine >> 7 | north >> 13 | north >> 15;
    return ((beside & 1) << 4 | (above & 1) << 1) << (8 * half_y + 2 * half_x);
}
