// A map of the error of one frame: the ground in grey, lit from the north-west, under the colours of how much of the
// tolerance is used up.
#include "app/accuracy/accuracy_internal.h"
#include "app/track/track_ways.h"
#include "base/log.h"

#include <math.h>
#include <stdlib.h>

#define SIDE_MAX 720
#define SIDE_MIN 360  // smaller ones are enlarged
#define COLOURED 0.72 // so much of a pixel is the error's colour where all of the tolerance is used up
#define SUN_UP 0.707
#define SUN_SIDE 0.5
#define RELIEF_SHARE 0.06 // of the longer side: so high a relief is shown as it is, a lower one steeper
#define STEEPER_MAX 12.0
#define RING 7 // pixels: of the marks

typedef struct Rgb {
    double r, g, b;
} Rgb;

// 0, a quarter ... all of the tolerance; then more than that.
static const Rgb RAMP[] = {{40, 60, 120}, {30, 130, 160}, {60, 170, 110}, {225, 205, 60}, {235, 130, 40}};
static const Rgb BROKEN = {255, 0, 255}, UNCOVERED = {0, 0, 0}, EYE = {255, 255, 255}, WORST = {255, 40, 40};

static Rgb mixed(Rgb a, Rgb b, double share) {
    return (Rgb){a.r + share * (b.r - a.r), a.g + share * (b.g - a.g), a.b + share * (b.b - a.b)};
}

static Rgb ramp_at(double share) {
    double at = fmin(fmax(share, 0.0), 1.0) * (COUNT_OF(RAMP) - 1);
    int i = (int)fmin(at, COUNT_OF(RAMP) - 2);
    return mixed(RAMP[i], RAMP[i + 1], at - i);
}

typedef struct Heat {
    const Dem *dem;
    const float *error_px;
    double cell_m[2], steeper;
    double reached_px, step; // samples a pixel
    AccuracyHeat *out;
} Heat;

static double height_at(const Heat *h, int col, int row) {
    col = col < 0 ? 0 : col >= h->dem->width ? h->dem->width - 1 : col;
    row = row < 0 ? 0 : row >= h->dem->height ? h->dem->height - 1 : row;
    return h->dem->height_m[(size_t)row * (size_t)h->dem->width + (size_t)col];
}

// Lambert's law, a sun in the north-west half way up; flat DEMs are made as steep as the others.
static double shade_at(const Heat *h, int col, int row) {
    int reach = (int)fmax(h->step, 1.0);
    double across = (height_at(h, col + reach, row) - height_at(h, col - reach, row)) / (2.0 * reach * h->cell_m[0]);
    double down = (height_at(h, col, row + reach) - height_at(h, col, row - reach)) / (2.0 * reach * h->cell_m[1]);
    double light = (SUN_UP + h->steeper * SUN_SIDE * (across + down)) / hypot(1.0, h->steeper * hypot(across, down));
    return fmin(fmax(light, 0.12), 1.0);
}

// The greatest error of a pixel's samples; NaN where one is not covered.
static double error_of(const Heat *h, int x, int y) {
    int col0 = (int)fmin(x * h->step, h->dem->width - 1), row0 = (int)fmin(y * h->step, h->dem->height - 1);
    int col1 = (int)fmin(ceil((x + 1) * h->step), h->dem->width);
    int row1 = (int)fmin(ceil((y + 1) * h->step), h->dem->height);
    double most = 0.0;
    for (int row = row0; row < row1; row++)
        for (int col = col0; col < col1; col++) {
            double px = (double)h->error_px[(size_t)row * (size_t)h->dem->width + (size_t)col];
            if (isnan(px))
                return NAN;
            most = fmax(most, px);
        }
    return most;
}

static void put(const AccuracyHeat *heat, int x, int y, Rgb c) {
    if (x < 0 || y < 0 || x >= heat->width || y >= heat->height)
        return;
    uint8_t *rgb = heat->rgb + 3 * ((size_t)y * (size_t)heat->width + (size_t)x);
    rgb[0] = (uint8_t)lround(c.r);
    rgb[1] = (uint8_t)lround(c.g);
    rgb[2] = (uint8_t)lround(c.b);
}

static Rgb pixel(const Heat *h, int x, int y) {
    double px = error_of(h, x, y), light = 235.0 * shade_at(h, (int)(x * h->step), (int)(y * h->step));
    if (isnan(px))
        return UNCOVERED;
    if (px > h->reached_px)
        return BROKEN;
    double share = px / h->reached_px;
    Rgb lit = {light, light, light}, colour = ramp_at(share);
    double dim = light / 235.0 * 0.45 + 0.55;
    colour = (Rgb){colour.r * dim, colour.g * dim, colour.b * dim};
    return mixed(lit, colour, fmin(0.35 + COLOURED * share, 0.95));
}

// A ring with a dark rim, to be seen on anything.
static void mark(const Heat *h, double col, double row, Rgb colour) {
    int cx = (int)(col / h->step), cy = (int)(row / h->step);
    for (int y = -RING - 2; y <= RING + 2; y++)
        for (int x = -RING - 2; x <= RING + 2; x++) {
            double off = fabs(hypot(x, y) - RING);
            if (off < 1.2)
                put(h->out, cx + x, cy + y, colour);
            else if (off < 2.2)
                put(h->out, cx + x, cy + y, UNCOVERED);
        }
}

static double relief_of(const Dem *dem) {
    double least = INFINITY, most = -INFINITY;
    for (size_t i = 0; i < (size_t)dem->width * (size_t)dem->height; i++) {
        least = fmin(least, (double)dem->height_m[i]);
        most = fmax(most, (double)dem->height_m[i]);
    }
    return most - least;
}

Result accuracy_make_heat(const Terrain *terrain, const float *error_px, const AccuracyFrame *frame,
                          const Viewpoint *eye, AccuracyHeat *out) {
    const Dem *dem = terrain_dem(terrain);
    double longer = dem->width > dem->height ? dem->width : dem->height, col, row;
    Heat h = {.dem = dem, .error_px = error_px, .reached_px = frame->reached_px, .out = out};
    h.step = longer > SIDE_MAX ? longer / SIDE_MAX : 1.0 / fmax(floor(SIDE_MIN / longer), 1.0);
    track_cell_m(terrain, &h.cell_m[0], &h.cell_m[1]);
    h.steeper = fmin(fmax(RELIEF_SHARE * longer * h.cell_m[0] / fmax(relief_of(dem), 1.0), 1.0), STEEPER_MAX);
    free(out->rgb);
    *out = (AccuracyHeat){.width = (int)fmax(ceil(dem->width / h.step), 1.0),
                          .height = (int)fmax(ceil(dem->height / h.step), 1.0)};
    out->rgb = malloc((size_t)out->width * (size_t)out->height * 3);
    if (!out->rgb) {
        log_error("bench: no memory for a map of %d x %d", out->width, out->height);
        return RESULT_MEMORY;
    }
    for (int y = 0; y < out->height; y++)
        for (int x = 0; x < out->width; x++)
            put(out, x, y, pixel(&h, x, y));
    if (grid_from_geodetic(terrain_grid(terrain), eye->lat_deg, eye->lon_deg, &col, &row))
        mark(&h, col, row, EYE);
    mark(&h, frame->measure.worst_col, frame->measure.worst_row, WORST);
    return RESULT_OK;
}
