// terrain/errors/error_rows.h: what the schemes that compute an error field share: the terms that depend on the row
// only, and the arithmetic of one vertex, so that every scheme gives the same bits. Metres; plane entries
// (error_field.h). An ErrorWork belongs to error_field_create and lives during that call.
#pragma once
#include "terrain/errors/error_field.h"

// Upper bounds for the vertices of one plane row.
typedef struct ErrorTerms {
    float edge_reach2, centre_reach2; // squared horizontal distance from a vertex to its children
    float edge_sag, centre_sag;       // by the Earth's and the map's curvature, by rounding of heights and positions
    float edge_drift, centre_drift;   // a metre of height range among the corners: the vertical turns over the diamond
} ErrorTerms;

typedef struct ErrorForced {
    int32_t i, j; // plane entry
} ErrorForced;

typedef struct ErrorWork {
    const ErrorFieldInput *input;
    int width, height;                     // samples
    ErrorTerms *terms[FOREST_LEVEL_MAX];   // [plane][row]
    ErrorForced *forced[FOREST_LEVEL_MAX]; // corners of base tiles
    int32_t forced_count[FOREST_LEVEL_MAX];
} ErrorWork;

static inline const float *error_height_row(const ErrorWork *work, int row) {
    return work->input->height_m + (size_t)row * (size_t)work->width;
}

static inline float error_midpoint(float h, float left, float right) {
    float d = h - 0.5f * (left + right);
    return d < 0.0f ? -d : d;
}

// Whether the plane's own errors are bounded from the children's, as its step is above the stride.
static inline bool error_is_bounded(const ErrorFieldInput *input, int step) {
    return input->kind == TERRAIN_ERROR_TOTAL && input->stride > 0 && step > input->stride;
}

#define ERROR_BOUND_GROW 1.000001f // covers the float arithmetic of a sum

// A bound of a diamond's deviation that looks at no sample inside: splitting it moves its surface by a tent as high as
// the midpoint's error, and what is left is the deviation of a child, `code` at most. `range`: of the corners' heights.
static inline uint16_t error_bound(float midpoint, uint16_t code, float range, float drift, float sag) {
    return error_field_encode((midpoint + error_field_decode(code) + (range * drift + sag)) * ERROR_BOUND_GROW);
}

static inline float error_range(float a, float b, float c, float d) {
    float ab_low = a < b ? a : b, cd_low = c < d ? c : d, ab_high = a > b ? a : b, cd_high = c > d ? c : d;
    return (ab_high > cd_high ? ab_high : cd_high) - (ab_low < cd_low ? ab_low : cd_low);
}

// The radius that a child at height `hc` with radius code `code` asks of its parent.
static inline float error_reach(float h, float hc, float reach2, uint16_t code) {
    float d = h - hc;
    return __builtin_sqrtf(reach2 + d * d) + error_field_decode(code);
}

// The terms of sample row `row` for diamonds of a step, in a grid of `height` rows whose heights are within `h_max`.
ErrorTerms error_terms_of_row(const Grid *grid, int row, int step, int height, float h_max);
// The largest |height|.
float error_height_max(const float *height_m, size_t count);

// Codes of own errors for TERRAIN_ERROR_TOTAL in the planes that are not bounded, written to delta, before nesting.
// Forced entries are left as they are.
MUST_USE Result error_total_own(const ErrorWork *work, Jobs *jobs, ErrorField *field);
// Fill delta and radius, finest plane first.
MUST_USE Result error_nest_parallel(const ErrorWork *work, Jobs *jobs, ErrorField *field);
MUST_USE Result error_nest_recursive(const ErrorWork *work, ErrorField *field);
