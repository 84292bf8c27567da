// Pull-push (Gortler et al., The Lumigraph, 1996, section 3.4) gives each level its first guess, relaxation smooths it.
#include "terrain/dem/dem_voids.h"

#include <math.h>
#include <stdlib.h>

#define LEVELS_MAX 24 // sides up to 2^23
#define SWEEPS 8      // of relaxation on each level; the coarser ones have covered the distance already

typedef struct Level {
    float *value;        // [height][width], NaN: void
    const uint8_t *bits; // void at first
    int width, height;
} Level;

int64_t dem_voids_mark(const float *height_m, size_t count, uint8_t *bits) {
    int64_t voids = 0;
    for (size_t i = 0; i < count; i += 8) {
        unsigned byte = 0;
        for (size_t k = 0; k < 8 && i + k < count; k++)
            byte |= isnan(height_m[i + k]) ? 1u << k : 0u;
        bits[i >> 3] = (uint8_t)byte;
        voids += __builtin_popcount(byte);
    }
    return voids;
}

static float at(const Level *level, int col, int row) {
    return level->value[(size_t)row * (size_t)level->width + (size_t)col];
}

// The mean of those of the four samples under a coarser one that have data.
static float pull_one(const Level *fine, int col, int row) {
    float sum = 0.0f;
    int count = 0;
    for (int y = row; y < row + 2 && y < fine->height; y++)
        for (int x = col; x < col + 2 && x < fine->width; x++)
            if (!isnan(at(fine, x, y))) {
                sum += at(fine, x, y);
                count++;
            }
    return count ? sum / (float)count : NAN;
}

// Bilinear between the centres of coarse samples, each of which lies amid four fine ones.
static float push_one(const Level *coarse, int col, int row) {
    int x0 = col / 2, y0 = row / 2;
    int x1 = col & 1 ? x0 + 1 : x0 - 1, y1 = row & 1 ? y0 + 1 : y0 - 1;
    x1 = x1 < 0 || x1 >= coarse->width ? x0 : x1;
    y1 = y1 < 0 || y1 >= coarse->height ? y0 : y1;
    return 0.5625f * at(coarse, x0, y0) + 0.1875f * (at(coarse, x1, y0) + at(coarse, x0, y1)) +
           0.0625f * at(coarse, x1, y1);
}

// A void sample becomes the mean of its neighbours.
static float relax_one(const Level *level, int col, int row) {
    float sum = 0.0f;
    int count = 0;
    if (col > 0)
        sum += at(level, col - 1, row), count++;
    if (col + 1 < level->width)
        sum += at(level, col + 1, row), count++;
    if (row > 0)
        sum += at(level, col, row - 1), count++;
    if (row + 1 < level->height)
        sum += at(level, col, row + 1), count++;
    return sum / (float)count;
}

// Gives each void sample push_one's value (with a coarser level), or relax_one's (without), in row order.
static void visit_voids(const Level *level, const Level *coarse) {
    size_t count = (size_t)level->width * (size_t)level->height, width = (size_t)level->width;
    for (size_t byte = 0; byte < dem_voids_bytes(count); byte++)
        for (unsigned rest = level->bits[byte]; rest; rest &= rest - 1) {
            size_t i = byte * 8 + (size_t)__builtin_ctz(rest);
            int col = (int)(i % width), row = (int)(i / width);
            level->value[i] = coarse ? push_one(coarse, col, row) : relax_one(level, col, row);
        }
}

static void pull(const Level *fine, const Level *coarse) {
    for (int row = 0; row < coarse->height; row++)
        for (int col = 0; col < coarse->width; col++)
            coarse->value[(size_t)row * (size_t)coarse->width + (size_t)col] = pull_one(fine, 2 * col, 2 * row);
}

// Fills `level`, which has voids, with the help of a level of half the side.
static Result fill(const Level *level, int depth) {
    Level coarse = {.width = (level->width + 1) / 2, .height = (level->height + 1) / 2};
    size_t count = (size_t)coarse.width * (size_t)coarse.height;
    uint8_t *bits = malloc(dem_voids_bytes(count));
    coarse.value = malloc(count * sizeof *coarse.value);
    coarse.bits = bits;
    Result result = bits && coarse.value && depth < LEVELS_MAX ? RESULT_OK : RESULT_MEMORY;
    if (result == RESULT_OK) {
        pull(level, &coarse);
        if (dem_voids_mark(coarse.value, count, bits) > 0)
            result = fill(&coarse, depth + 1);
    }
    if (result == RESULT_OK) {
        visit_voids(level, &coarse);
        for (int sweep = 0; sweep < SWEEPS; sweep++)
            visit_voids(level, NULL);
    }
    free(coarse.value);
    free(bits);
    return result;
}

Result dem_voids_fill(float *height_m, int width, int height, const uint8_t *bits) {
    Level level = {.value = height_m, .bits = bits, .width = width, .height = height};
    return fill(&level, 0);
}
