// render/ground/noise.h: one picture of noise that repeats without a seam, for ground closer than its samples. No GL.
// Bytes; the value 128 is 0, 0 and 255 are -1 and 1 where signed.
// The caller owns the array. Always the same bytes.
#pragma once
#include "base/base.h"

#define NOISE_SIDE 256 // texels

// `out`: [NOISE_SIDE][NOISE_SIDE][4]: fractal noise; its slopes along x and y; a random value for each cell of an
// irregular mosaic.
void noise_fill(uint8_t *out);
