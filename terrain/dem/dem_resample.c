// Separable cubic convolution (Keys 1981, a = -1/2), its kernel widened where samples become fewer.
#define _POSIX_C_SOURCE 200809L
#include "terrain/dem/dem_resample.h"

#include "base/log.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Along one axis: output i is the sum of weights[i * taps + k] times source first[i] + k, clamped to the rim.
typedef struct Kernel {
    int count, taps;
    int *first;
    double *weights;
} Kernel;

static double cubic(double x) {
    x = fabs(x);
    if (x < 1.0)
        return (1.5 * x - 2.5) * x * x + 1.0;
    return x < 2.0 ? ((-0.5 * x + 2.5) * x - 4.0) * x + 2.0 : 0.0;
}

static void kernel_fill(Kernel *kernel, int i, double at, double widening) {
    double *weights = kernel->weights + (size_t)i * (size_t)kernel->taps, sum = 0.0;
    kernel->first[i] = (int)floor(at - 2.0 * widening) + 1;
    for (int k = 0; k < kernel->taps; k++) {
        weights[k] = cubic((kernel->first[i] + k - at) / widening);
        sum += weights[k];
    }
    for (int k = 0; k < kernel->taps; k++)
        weights[k] /= sum;
}

static Result kernel_create(int from, int to, Kernel *out) {
    double step = (double)(from - 1) / (to - 1), widening = fmax(step, 1.0);
    *out = (Kernel){.count = to, .taps = (int)ceil(4.0 * widening)};
    out->first = malloc(sizeof *out->first * (size_t)to);
    out->weights = malloc(sizeof *out->weights * (size_t)to * (size_t)out->taps);
    if (!out->first || !out->weights)
        return RESULT_MEMORY;
    for (int i = 0; i < to; i++)
        kernel_fill(out, i, i * step, widening);
    return RESULT_OK;
}

static void kernel_clear(Kernel *kernel) {
    free(kernel->first);
    free(kernel->weights);
}

static int clamp(int i, int count) {
    return i < 0 ? 0 : i < count ? i : count - 1;
}

static void resample_row(const Kernel *kernel, const float *from, int from_count, float *to) {
    for (int i = 0; i < kernel->count; i++) {
        const double *weights = kernel->weights + (size_t)i * (size_t)kernel->taps;
        double sum = 0.0;
        for (int k = 0; k < kernel->taps; k++)
            sum += weights[k] * (double)from[clamp(kernel->first[i] + k, from_count)];
        to[i] = (float)sum;
    }
}

// Row `i` of the result, from rows that already have its width. `sums`: [width].
static void resample_column(const Kernel *kernel, int i, const float *rows, int row_count, int width, double *sums,
                            float *to) {
    memset(sums, 0, sizeof *sums * (size_t)width);
    for (int k = 0; k < kernel->taps; k++) {
        const float *row = rows + (size_t)clamp(kernel->first[i] + k, row_count) * (size_t)width;
        double weight = kernel->weights[(size_t)i * (size_t)kernel->taps + (size_t)k];
        for (int col = 0; col < width; col++)
            sums[col] += weight * (double)row[col];
    }
    for (int col = 0; col < width; col++)
        to[col] = (float)sums[col];
}

static Result resample_heights(const Dem *from, Dem *to) {
    Kernel across = {0}, down = {0};
    float *rows = malloc(sizeof *rows * (size_t)from->height * (size_t)to->width);
    double *sums = malloc(sizeof *sums * (size_t)to->width);
    Result result = rows && sums ? kernel_create(from->width, to->width, &across) : RESULT_MEMORY;
    if (result == RESULT_OK)
        result = kernel_create(from->height, to->height, &down);
    for (int row = 0; row < from->height && result == RESULT_OK; row++)
        resample_row(&across, from->height_m + (size_t)row * (size_t)from->width, from->width,
                     rows + (size_t)row * (size_t)to->width);
    for (int row = 0; row < to->height && result == RESULT_OK; row++)
        resample_column(&down, row, rows, from->height, to->width, sums,
                        to->height_m + (size_t)row * (size_t)to->width);
    kernel_clear(&across);
    kernel_clear(&down);
    free(sums);
    free(rows);
    return result;
}

static void find_range(Dem *dem) {
    size_t count = (size_t)dem->width * (size_t)dem->height;
    dem->min_m = dem->max_m = dem->height_m[0];
    for (size_t i = 1; i < count; i++) {
        dem->min_m = fminf(dem->min_m, dem->height_m[i]);
        dem->max_m = fmaxf(dem->max_m, dem->height_m[i]);
    }
}

static Result describe(const Dem *from, Dem *to) {
    to->datum_assumed = from->datum_assumed;
    to->pixel_is_area = from->pixel_is_area;
    to->georeferenced = from->georeferenced;
    memcpy(to->crs_name, from->crs_name, sizeof to->crs_name);
    snprintf(to->type, sizeof to->type, "float32");
    if (!from->file)
        return RESULT_OK;
    free(to->file);
    to->file = strdup(from->file);
    return to->file ? RESULT_OK : RESULT_MEMORY;
}

Result dem_resample(const Dem *dem, int width, int height, Dem **out) {
    if (width < 2 || height < 2 || width > DEM_SIDE_MAX || height > DEM_SIDE_MAX) {
        log_error("resampling to %d x %d samples: expected 2 to %d a side", width, height, DEM_SIDE_MAX);
        return RESULT_RANGE;
    }
    DemGeoref georef = dem->georef;
    georef.dx *= (double)(dem->width - 1) / (width - 1);
    georef.dy *= (double)(dem->height - 1) / (height - 1);
    Dem *made = NULL;
    Result result = dem_create(width, height, &georef, dem->datum, &made);
    if (result != RESULT_OK)
        return result;
    result = describe(dem, made);
    if (result == RESULT_OK)
        result = resample_heights(dem, made);
    if (result != RESULT_OK) {
        log_error("%s: no memory to resample it to %d x %d", dem->file ? dem->file : "terrain", width, height);
        dem_destroy(&made);
        return result;
    }
    find_range(made);
    *out = made;
    return RESULT_OK;
}
