// terrain/dem/dem_voids.h: samples without data. Private to terrain/dem_*.c.
// Metres; NaN is a void. Bit i & 7 of byte i >> 3 is set for a void sample i.
// The caller owns samples and bits.
#pragma once
#include "base/base.h"

// Bytes of a bit for each of `count` samples.
static inline size_t dem_voids_bytes(size_t count) {
    return (count + 7) / 8;
}

// Sets or clears the bit of every sample, and counts the set ones.
int64_t dem_voids_mark(const float *height_m, size_t count, uint8_t *bits);

// Replaces every NaN by a smooth surface through the rim of its void: the Laplace equation, solved approximately from
// coarse to fine, so that the time does not depend on how large voids are. Samples with data keep their bits. At
// least one sample must have data; `bits` are dem_voids_mark's. Takes 1.4 bytes a sample while it runs. MEMORY,
// without a message: the samples are then as they were.
MUST_USE Result dem_voids_fill(float *height_m, int width, int height, const uint8_t *bits);
