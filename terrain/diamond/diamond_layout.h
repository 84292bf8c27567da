// terrain/diamond/diamond_layout.h: where the split bit of a vertex is: super-squares of diamonds, level by level.
// Columns and rows in samples; steps in samples, 1 << plane; slots 0..11 of a super-square.
// A DiamondLayout is a value; it owns nothing.
//
// Source: Yalcin, Weiss, De Floriani 2011, section 3: twelve edges, that is twelve diamonds, a super-square: four
// 0-diamonds (centres of squares) and eight 1-diamonds (midpoints of edges).
#pragma once
#include "base/base.h"
#include "terrain/forest.h"

#define DIAMOND_LEVEL_MAX FOREST_LEVEL_MAX
#define DIAMOND_SLOTS 12
#define DIAMOND_CENTRE_SLOTS 4 // the first ones; the others are edge midpoints

// Bits of a word: dy * 4 + dx, dx and dy in 0..3 and not both even.
#define DIAMOND_CENTRES UINT32_C(0xA0A0)
#define DIAMOND_EDGES UINT32_C(0x5A5A)

// Super-square (I, J) of plane k holds the samples (4 s I + s dx, 4 s J + s dy), s = 1 << k; its word is
// offset[k] + J across[k] + I. A plane's row j, at sample row j s, has the DiamondTerms row_offset[k] + j.
typedef struct DiamondLayout {
    int32_t width, height; // samples
    int32_t level_count;   // planes, at least one
    uint32_t offset[DIAMOND_LEVEL_MAX], across[DIAMOND_LEVEL_MAX], down[DIAMOND_LEVEL_MAX];
    uint32_t word_count;
    uint32_t row_offset[DIAMOND_LEVEL_MAX];
    uint32_t row_count;
} DiamondLayout;

// `planes`: of the error field; 0 counts as 1.
DiamondLayout diamond_layout(int width, int height, int planes);

// Bits of the slots: centres (1,1) (3,1) (1,3) (3,3), edge midpoints (1,0) (3,0) (0,1) (2,1) (1,2) (3,2) (0,3) (2,3).
static inline int diamond_slot_bit(int slot) {
    return (int)(UINT64_C(0xECB96431FD75) >> (4 * slot) & 15);
}

// A number for each vertex, as positions and errors have it, is at [slot * word_count + word].
static inline size_t diamond_entry(const DiamondLayout *layout, int slot, uint32_t word) {
    return (size_t)slot * layout->word_count + word;
}

typedef struct DiamondPlace {
    int32_t plane; // level_count or above: no diamond of this layout; always split
    uint32_t word;
    int bit;
} DiamondPlace;

// Of a sample inside the DEM.
static inline DiamondPlace diamond_place(const DiamondLayout *layout, int col, int row) {
    int k = __builtin_ctz((unsigned)(col | row) | 1u << 31);
    if (k >= layout->level_count)
        return (DiamondPlace){.plane = k};
    uint32_t i = (uint32_t)col >> k, j = (uint32_t)row >> k;
    return (DiamondPlace){k, layout->offset[k] + (j >> 2) * layout->across[k] + (i >> 2), (int)((j & 3) * 4 + (i & 3))};
}

// 0 for the centre of a base tile of the largest side, 1 for the midpoints of its edges, and so on.
static inline int diamond_level(const DiamondLayout *layout, int plane, int slot) {
    return 2 * (layout->level_count - 1 - plane) + (slot >= DIAMOND_CENTRE_SLOTS);
}
