// The own part of the total error: for each diamond the largest deviation of a sample inside from its triangles'
// planes. Samples on the diamond's sides belong to its children as well, so only the inside is scanned here; nesting
// adds the rest. To it come bounds for what the planes of heights leave out: the map's curvature and the turning
// vertical. Large diamonds are cut into bands of rows, so that two workers share them; a maximum does not mind the
// order.
#include "terrain/errors/error_rows.h"

#include "base/log.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#define BAND_ROWS 32

// Non-negative floats compare like their bits, which lets maxima of any order be vectorised without relaxed arithmetic.
typedef union FloatBits {
    float value;
    int32_t bits;
} FloatBits;

typedef struct Scan {
    const ErrorWork *work;
    ErrorPlane *plane;
    const ErrorTerms *terms;
    _Atomic int32_t *most; // largest error so far, as bits; [height][width] of the plane; NULL where one band holds all
    int bands;             // per row of diamonds
} Scan;

// The largest |h[x] - (base + slope x)| for x in [0, count), as bits.
SIMD_CLONES
static int32_t deviation(const float *restrict h, float base, float slope, int count) {
    int32_t most = 0;
    for (int x = 0; x < count; x++) {
        FloatBits d = {.value = h[x] - (base + slope * (float)x)};
        int32_t bits = d.bits & 0x7FFFFFFF;
        most = bits > most ? bits : most;
    }
    return most;
}

static int32_t larger(int32_t a, int32_t b) {
    return a > b ? a : b;
}

static const float *sample(const Scan *scan, int col, int row) {
    return error_height_row(scan->work, row) + col;
}

// One diamond: its centre, step, and the heights that fix its planes.
typedef struct Diamond {
    int col, row, step;
    bool horizontal;     // of an edge midpoint
    float middle, along; // of the hypotenuse: height at its middle, rise a sample
    float before, after; // rise a sample towards the apex north or west, south or east
    bool has_before, has_after;
    int32_t range; // of the corners' heights, as bits
} Diamond;

static float apex_rise(const Scan *scan, const Diamond *d, int col, int row, float *least, float *most) {
    float h = *sample(scan, col, row);
    *least = h < *least ? h : *least;
    *most = h > *most ? h : *most;
    return (h - d->middle) / (float)d->step;
}

static Diamond edge_diamond(const Scan *scan, int col, int row, bool horizontal) {
    int s = scan->plane->step;
    int dx = horizontal ? s : 0, dy = horizontal ? 0 : s;
    float a = *sample(scan, col - dx, row - dy), b = *sample(scan, col + dx, row + dy);
    float least = a < b ? a : b, most = a > b ? a : b;
    Diamond d = {.col = col, .row = row, .step = s, .horizontal = horizontal};
    d.middle = 0.5f * (a + b);
    d.along = (b - a) / (2.0f * (float)s);
    d.has_before = col - dy >= 0 && row - dx >= 0;
    d.has_after = col + dy < scan->work->width && row + dx < scan->work->height;
    if (d.has_before)
        d.before = apex_rise(scan, &d, col - dy, row - dx, &least, &most);
    if (d.has_after)
        d.after = apex_rise(scan, &d, col + dy, row + dx, &least, &most);
    d.range = (FloatBits){.value = most - least}.bits;
    return d;
}

// Row `y` (relative to the centre) of a diamond whose hypotenuse is horizontal.
static int32_t scan_horizontal_row(const Scan *scan, const Diamond *d, int y) {
    int reach = d->step - 1 - abs(y);
    float rise = y < 0 ? d->before * (float)-y : d->after * (float)y;
    float base = d->middle + rise - d->along * (float)reach;
    return deviation(sample(scan, d->col - reach, d->row + y), base, d->along, 2 * reach + 1);
}

static int32_t scan_vertical_row(const Scan *scan, const Diamond *d, int y) {
    int reach = d->step - 1 - abs(y);
    float base = d->middle + d->along * (float)y;
    int32_t most = 0;
    if (d->has_before) {
        const float *h = sample(scan, d->col - reach, d->row + y);
        most = deviation(h, base + d->before * (float)reach, -d->before, reach + 1);
    }
    if (d->has_after)
        most = larger(most, deviation(sample(scan, d->col, d->row + y), base, d->after, reach + 1));
    return most;
}

static int32_t scan_edge(const Scan *scan, const Diamond *d, int y_begin, int y_end) {
    int first = d->horizontal && !d->has_before ? 0 : 1 - d->step;
    int last = d->horizontal && !d->has_after ? 0 : d->step - 1;
    int32_t most = 0;
    for (int y = y_begin > first ? y_begin : first; y < y_end && y <= last; y++)
        most = larger(most, d->horizontal ? scan_horizontal_row(scan, d, y) : scan_vertical_row(scan, d, y));
    return most;
}

// A centre: a square of side 2 s with two triangles. West plane: the corner on the west side off the hypotenuse.
typedef struct Square {
    int col, row, step;
    bool rising; // hypotenuse from south-west to north-east
    float middle;
    float west_x, west_y; // slopes a sample of the plane through the western apex
    float east_x, east_y;
    int32_t range;
} Square;

static Square centre_square(const Scan *scan, int col, int row) {
    int s = scan->plane->step;
    float nw = *sample(scan, col - s, row - s), ne = *sample(scan, col + s, row - s);
    float sw = *sample(scan, col - s, row + s), se = *sample(scan, col + s, row + s);
    float scale = 0.5f / (float)s;
    Square q = {.col = col, .row = row, .step = s, .rising = (col / (2 * s) + row / (2 * s)) & 1};
    q.middle = 0.5f * (q.rising ? sw + ne : nw + se);
    q.west_x = (q.rising ? ne - nw : se - sw) * scale;
    q.west_y = (sw - nw) * scale;
    q.east_x = (q.rising ? se - sw : ne - nw) * scale;
    q.east_y = (se - ne) * scale;
    float low = fminf(fminf(nw, ne), fminf(sw, se)), high = fmaxf(fmaxf(nw, ne), fmaxf(sw, se));
    q.range = (FloatBits){.value = high - low}.bits;
    return q;
}

static int32_t scan_square_row(const Scan *scan, const Square *q, int y) {
    int reach = q->step - 1, cross = q->rising ? -y : y; // the hypotenuse passes at x = cross
    float west = q->middle + q->west_y * (float)y - q->west_x * (float)reach;
    float east = q->middle + q->east_y * (float)y + q->east_x * (float)cross;
    int32_t most = deviation(sample(scan, q->col - reach, q->row + y), west, q->west_x, reach + cross + 1);
    return larger(most, deviation(sample(scan, q->col + cross, q->row + y), east, q->east_x, reach - cross + 1));
}

static int32_t scan_square(const Scan *scan, const Square *q, int y_begin, int y_end) {
    int32_t most = 0;
    for (int y = y_begin; y < y_end && y < q->step; y++)
        if (y > -q->step)
            most = larger(most, scan_square_row(scan, q, y));
    return most;
}

static void raise_to(_Atomic int32_t *slot, int32_t value) {
    int32_t seen = atomic_load_explicit(slot, memory_order_relaxed);
    while (value > seen &&
           !atomic_compare_exchange_weak_explicit(slot, &seen, value, memory_order_relaxed, memory_order_relaxed)) {
    }
}

// One diamond's share of a band; its bounds for curvature and drift come with it.
static float scan_diamond(const Scan *scan, int i, int j, int y_begin, int y_end) {
    const ErrorPlane *plane = scan->plane;
    FloatBits deviated, range;
    float drift, sag;
    if (i & j & 1) {
        Square q = centre_square(scan, i * plane->step, j * plane->step);
        deviated.bits = scan_square(scan, &q, y_begin, y_end);
        range.bits = q.range;
        drift = scan->terms[j].centre_drift;
        sag = scan->terms[j].centre_sag;
    } else {
        Diamond d = edge_diamond(scan, i * plane->step, j * plane->step, i & 1);
        deviated.bits = scan_edge(scan, &d, y_begin, y_end);
        range.bits = d.range;
        drift = scan->terms[j].edge_drift;
        sag = scan->terms[j].edge_sag;
    }
    return deviated.value + range.value * drift + sag;
}

static void scan_entry(const Scan *scan, int i, int j, int y_begin, int y_end) {
    uint16_t *delta = &scan->plane->delta[(size_t)j * scan->plane->stride + (size_t)i];
    if (*delta == ERROR_FIELD_ALWAYS)
        return;
    FloatBits error = {.value = scan_diamond(scan, i, j, y_begin, y_end)};
    if (scan->most)
        raise_to(&scan->most[(size_t)j * (size_t)scan->plane->width + (size_t)i], error.bits);
    else
        *delta = error_field_encode(error.value);
}

static void scan_task(void *user, int64_t begin, int64_t end, int worker) {
    const Scan *scan = user;
    (void)worker;
    for (int64_t item = begin; item < end; item++) {
        int j = (int)(item / scan->bands), band = (int)(item % scan->bands);
        int y_begin = 1 - scan->plane->step + band * BAND_ROWS;
        for (int i = j & 1 ? 0 : 1; i < scan->plane->width; i += j & 1 ? 1 : 2)
            scan_entry(scan, i, j, y_begin, y_begin + BAND_ROWS);
    }
}

static void store_task(void *user, int64_t begin, int64_t end, int worker) {
    const Scan *scan = user;
    ErrorPlane *plane = scan->plane;
    (void)worker;
    for (int64_t j = begin; j < end; j++) {
        for (int i = j & 1 ? 0 : 1; i < plane->width; i += j & 1 ? 1 : 2) {
            uint16_t *delta = &plane->delta[(size_t)j * plane->stride + (size_t)i];
            FloatBits most = {.bits = scan->most[(size_t)j * (size_t)plane->width + (size_t)i]};
            if (*delta != ERROR_FIELD_ALWAYS)
                *delta = error_field_encode(most.value);
        }
    }
}

Result error_total_own(const ErrorWork *work, Jobs *jobs, ErrorField *field) {
    Progress progress = progress_begin("error field");
    for (int k = 0; k < field->plane_count; k++) {
        progress_update(&progress, (double)k / field->plane_count); // every plane scans every sample, once or twice
        ErrorPlane *plane = &field->planes[k];
        if (error_is_bounded(work->input, plane->step))
            break; // and so are all coarser ones
        Scan scan = {.work = work, .plane = plane, .terms = work->terms[k]};
        scan.bands = (2 * plane->step - 1 + BAND_ROWS - 1) / BAND_ROWS;
        if (scan.bands > 1) {
            scan.most = calloc((size_t)plane->width * (size_t)plane->height, sizeof *scan.most);
            if (!scan.most) {
                progress_end(&progress);
                return RESULT_MEMORY;
            }
        }
        jobs_run(jobs, (int64_t)plane->height * scan.bands, plane->step < 16 ? 16 : 1, scan_task, &scan);
        if (scan.most)
            jobs_run(jobs, plane->height, 64, store_task, &scan);
        free(scan.most);
    }
    progress_end(&progress);
    return RESULT_OK;
}
