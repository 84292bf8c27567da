#include "render/ground/ground_shade.h"

#include "base/log.h"
#include "terrain/geodesy.h"

#include <stdlib.h>

#define LINES_A_PIECE 64

// A point that may hide what comes after it: distance from the line's begin, and height minus the Earth's fall.
typedef struct Point {
    float s_m, h_m;
} Point;

// Lines lead away from the sun. Along the major axis they take one cell a step, `slope` cells across it, so that every
// cell belongs to exactly one line.
typedef struct Sweep {
    const GroundSource *source;
    const float *samples;
    uint8_t *out;
    bool major_is_row;
    int count_major, count_minor; // cells
    int first, direction;         // along the major axis
    double slope;
    float step_m;
    int64_t line_begin; // index of the first line, <= 0
    Point *stacks;      // [workers][LINES_A_PIECE][count_major]
} Sweep;

static float sample_at(const Sweep *sweep, int major, int minor) {
    const Dem *dem = terrain_dem(sweep->source->terrain);
    size_t step = (size_t)sweep->source->step;
    size_t row = (size_t)(sweep->major_is_row ? major : minor), col = (size_t)(sweep->major_is_row ? minor : major);
    return sweep->samples[row * step * (size_t)dem->width + col * step];
}

static uint8_t *cell_at(const Sweep *sweep, int major, int minor) {
    int row = sweep->major_is_row ? major : minor, col = sweep->major_is_row ? minor : major;
    return sweep->out + (size_t)row * (size_t)sweep->source->width + (size_t)col;
}

// Where the line really passes, between two cells.
static float height_between(const Sweep *sweep, int major, int minor, float aside) {
    int beside = aside >= 0.0f ? minor + 1 : minor - 1;
    float h = sample_at(sweep, major, minor);
    if (beside < 0 || beside >= sweep->count_minor)
        return h;
    return h + (sample_at(sweep, major, beside) - h) * fabsf(aside);
}

static float rise(Point from, Point to) { // tangent; `to` is nearer the sun
    return (to.h_m - from.h_m) / (from.s_m - to.s_m);
}

// Adds a point to the convex hull of those before it; gives the tangent to the hull.
static float add_to_hull(Point *stack, int *count, Point point) {
    while (*count >= 2 && rise(point, stack[*count - 1]) <= rise(point, stack[*count - 2]))
        (*count)--;
    float tangent = *count ? rise(point, stack[*count - 1]) : -1.0f;
    stack[(*count)++] = point;
    return tangent;
}

static uint8_t byte_from_tangent(float tangent) {
    float share = tangent / (float)GROUND_SHADE_TAN_MAX;
    share = share < 0.0f ? 0.0f : share > 1.0f ? 1.0f : share;
    return (uint8_t)(255.0f * sqrtf(share) + 0.5f);
}

// Side by side, so that memory is read along rows: at most LINES_A_PIECE lines.
static void sweep_beside(const Sweep *sweep, int64_t begin, int64_t end, int worker) {
    Point *stacks = sweep->stacks + (size_t)worker * LINES_A_PIECE * (size_t)sweep->count_major;
    int counts[LINES_A_PIECE] = {0};
    for (int k = 0; k < sweep->count_major; k++) {
        int major = sweep->first + sweep->direction * k;
        double across = sweep->slope * k;
        int64_t shift = (int64_t)floor(across + 0.5);
        float aside = (float)(across - (double)shift), s_m = sweep->step_m * (float)k;
        for (int64_t line = begin; line < end; line++) {
            int64_t minor = line + sweep->line_begin + shift;
            if (minor < 0 || minor >= sweep->count_minor)
                continue;
            float fall_m = s_m * s_m / (2.0f * (float)GEODESY_A_M);
            Point point = {s_m, height_between(sweep, major, (int)minor, aside) - fall_m};
            float tangent = add_to_hull(stacks + (line - begin) * sweep->count_major, &counts[line - begin], point);
            *cell_at(sweep, major, (int)minor) = byte_from_tangent(tangent - s_m / (float)GEODESY_A_M);
        }
    }
}

static void sweep_lines(void *user, int64_t begin, int64_t end, int worker) {
    for (int64_t line = begin; line < end; line += LINES_A_PIECE)
        sweep_beside(user, line, line + LINES_A_PIECE < end ? line + LINES_A_PIECE : end, worker);
}

static Sweep plan_sweep(const GroundSource *source, double azimuth_rad) {
    Sweep sweep = {.source = source, .samples = terrain_dem(source->terrain)->height_m};
    GroundJacobian j = ground_source_jacobian(source, source->width / 2, source->height / 2);
    double east = -sin(azimuth_rad), north = -cos(azimuth_rad); // away from the sun
    double det = (double)j.east_col * j.north_row - (double)j.east_row * j.north_col;
    double col = (east * j.north_row - north * j.east_row) / det, row = (north * j.east_col - east * j.north_col) / det;
    sweep.major_is_row = fabs(row) >= fabs(col);
    double major = sweep.major_is_row ? row : col, minor = sweep.major_is_row ? col : row;
    sweep.count_major = sweep.major_is_row ? source->height : source->width;
    sweep.count_minor = sweep.major_is_row ? source->width : source->height;
    sweep.direction = major > 0.0 ? 1 : -1;
    sweep.first = major > 0.0 ? 0 : sweep.count_major - 1;
    sweep.slope = minor / fabs(major);
    sweep.step_m = (float)(1.0 / fabs(major)); // (col, row) is one metre long
    double reach = sweep.slope * (sweep.count_major - 1);
    sweep.line_begin = -(int64_t)ceil(fmax(reach, 0.0)) - 1;
    return sweep;
}

Result ground_shade_build(const GroundSource *source, double azimuth_rad, Jobs *jobs, uint8_t *out) {
    Sweep sweep = plan_sweep(source, azimuth_rad);
    sweep.out = out;
    sweep.stacks =
        malloc((size_t)jobs_worker_count(jobs) * LINES_A_PIECE * (size_t)sweep.count_major * sizeof *sweep.stacks);
    if (!sweep.stacks) {
        log_error("out of memory for the ground's shadows");
        return RESULT_MEMORY;
    }
    int64_t lines = sweep.count_minor + (int64_t)ceil(fabs(sweep.slope) * sweep.count_major) + 2;
    jobs_run(jobs, lines, LINES_A_PIECE, sweep_lines, &sweep);
    free(sweep.stacks);
    return RESULT_OK;
}
