#include "render/ground/noise.h"

#include <math.h>

#define OCTAVES 4
#define FIRST_CELLS 10 // of the coarsest octave: features much smaller than the picture, so that its repeats don't show
#define MOSAIC_CELLS 18

static uint32_t hash(uint32_t x, uint32_t y, uint32_t seed) {
    uint32_t h = x * 0x9e3779b1u ^ y * 0x85ebca77u ^ seed * 0xc2b2ae3du;
    h ^= h >> 15;
    h *= 0x2c1b3c6du;
    h ^= h >> 12;
    h *= 0x297a2d39u;
    return h ^ h >> 15;
}

static float unit(uint32_t h) { // 0 .. 1
    return (float)(h >> 8) * (1.0f / 16777216.0f);
}

// Value noise on `cells` x `cells` that wrap around, with a fifth-degree blend.
static float value_noise(float x, float y, uint32_t cells, uint32_t seed) {
    uint32_t x0 = (uint32_t)x, y0 = (uint32_t)y;
    float fx = x - (float)x0, fy = y - (float)y0;
    float wx = fx * fx * fx * (fx * (fx * 6.0f - 15.0f) + 10.0f),
          wy = fy * fy * fy * (fy * (fy * 6.0f - 15.0f) + 10.0f);
    uint32_t xa = x0 % cells, xb = (x0 + 1) % cells, ya = y0 % cells, yb = (y0 + 1) % cells;
    float upper = unit(hash(xa, ya, seed)) * (1.0f - wx) + unit(hash(xb, ya, seed)) * wx;
    float lower = unit(hash(xa, yb, seed)) * (1.0f - wx) + unit(hash(xb, yb, seed)) * wx;
    return 2.0f * (upper * (1.0f - wy) + lower * wy) - 1.0f;
}

static float fractal(float u, float v) { // u, v: 0 .. 1
    float sum = 0.0f, weight = 0.5f;
    uint32_t cells = FIRST_CELLS;
    for (uint32_t octave = 0; octave < OCTAVES; octave++) {
        sum += weight * value_noise(u * (float)cells, v * (float)cells, cells, octave);
        weight *= 0.62f;
        cells *= 2;
    }
    return sum;
}

// Of the nearest of the mosaic's scattered points.
static float mosaic(float u, float v) {
    float x = u * MOSAIC_CELLS, y = v * MOSAIC_CELLS, best = 1e9f, value = 0.0f;
    for (int dy = -1; dy <= 1; dy++) {
        for (int dx = -1; dx <= 1; dx++) {
            int cx = (int)floorf(x) + dx, cy = (int)floorf(y) + dy;
            uint32_t wx = (uint32_t)(cx + MOSAIC_CELLS) % MOSAIC_CELLS,
                     wy = (uint32_t)(cy + MOSAIC_CELLS) % MOSAIC_CELLS;
            float px = (float)cx + unit(hash(wx, wy, 101)) - x, py = (float)cy + unit(hash(wx, wy, 102)) - y;
            float distance = fabsf(px) + fabsf(py); // straight-edged, as fields are
            if (distance < best) {
                best = distance;
                value = unit(hash(wx, wy, 103));
            }
        }
    }
    return value;
}

static uint8_t signed_byte(float value) {
    return (uint8_t)lrintf(128.0f + 127.0f * fminf(fmaxf(value, -1.0f), 1.0f));
}

void noise_fill(uint8_t *out) {
    const float texel = 1.0f / NOISE_SIDE, slope_scale = 0.06f / texel * 0.5f;
    for (int y = 0; y < NOISE_SIDE; y++) {
        for (int x = 0; x < NOISE_SIDE; x++) {
            float u = ((float)x + 1.0f) * texel,
                  v = ((float)y + 1.0f) * texel; // one texel in, so that neighbours are >= 0
            uint8_t *cell = out + ((size_t)y * NOISE_SIDE + (size_t)x) * 4;
            cell[0] = signed_byte(1.3f * fractal(u, v));
            cell[1] = signed_byte((fractal(u + texel, v) - fractal(u - texel, v)) * slope_scale);
            cell[2] = signed_byte((fractal(u, v + texel) - fractal(u, v - texel)) * slope_scale);
            cell[3] = (uint8_t)lrintf(255.0f * mosaic(u, v));
        }
    }
}
