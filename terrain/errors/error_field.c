#define _DEFAULT_SOURCE // madvise
#include "terrain/errors/error_field.h"

#include "base/log.h"
#include "base/pages.h"
#include "terrain/errors/error_rows.h"
#include "terrain/geodesy.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#define HUGE_PAGE (1 << 21) // bytes
#define PAD 16              // zero entries west of a row and at least as many east of it: neighbours need no test
// Two roundings to the lattice move a distance by less than this; the rest is slack for double rounding.
#define NESTING_SLACK_M 0.002f
// A drawn vertex is at most sqrt(3)/2 lattice units from its exact place.
#define LATTICE_SLACK_M (0.8661f / GRID_LATTICE_PER_M)
// Roundings of float heights: two additions and a sample itself.
#define HEIGHT_SLACK (4.0f * FLT_EPSILON)
#define GROW 1.0001f // covers the float arithmetic of a term

static int plane_count_of(const Forest *forest) {
    int side = 1, count = 0;
    for (int32_t i = 0; i < forest->tile_count; i++)
        if (forest->tiles[i].side > side)
            side = forest->tiles[i].side;
    while (1 << count < side)
        count++;
    return count;
}

static void layout_planes(ErrorField *field, int width, int height) {
    size_t entries = 0;
    for (int k = 0; k < field->plane_count; k++) {
        ErrorPlane *plane = &field->planes[k];
        plane->step = 1 << k;
        plane->width = ((width - 1) >> k) + 1;
        plane->height = ((height - 1) >> k) + 1;
        plane->stride = ((size_t)plane->width + 2 * PAD + 31) & ~(size_t)31;
        entries += plane->stride * (size_t)plane->height + PAD;
    }
    field->bytes = 2 * entries * sizeof(uint16_t);
}

// In huge pages where the system has them: a field is written once, and the faults of small pages would take a third of
// the time.
static void *allocate_zeros(size_t *bytes) {
    *bytes = (*bytes + HUGE_PAGE) & ~(size_t)(HUGE_PAGE - 1);
    void *memory = mmap(NULL, *bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED)
        return NULL;
#ifdef MADV_HUGEPAGE
    if (*bytes >= 16 * (size_t)HUGE_PAGE)
        (void)madvise(memory, *bytes, MADV_HUGEPAGE); // only a wish
#endif
    pages_own(memory, *bytes);
    return memory;
}

static Result allocate_planes(ErrorField *field, const Forest *forest) {
    field->plane_count = plane_count_of(forest);
    layout_planes(field, forest->width, forest->height);
    uint16_t *next = allocate_zeros(&field->bytes);
    if (!next)
        return RESULT_MEMORY;
    field->memory = next;
    for (int k = 0; k < field->plane_count; k++) {
        ErrorPlane *plane = &field->planes[k];
        size_t entries = plane->stride * (size_t)plane->height + PAD;
        plane->delta = next + PAD;
        plane->radius = next + entries + PAD;
        next += 2 * entries;
    }
    return RESULT_OK;
}

// Magnitudes compare like their bits, so this maximum can be vectorised without relaxed arithmetic.
SIMD_CLONES
float error_height_max(const float *height_m, size_t count) {
    union {
        float value;
        uint32_t bits;
    } most = {.bits = 0};
    for (size_t i = 0; i < count; i++) {
        union {
            float value;
            uint32_t bits;
        } h = {.value = height_m[i]};
        h.bits &= 0x7FFFFFFFu;
        most.bits = h.bits > most.bits ? h.bits : most.bits;
    }
    return most.value;
}

ErrorTerms error_terms_of_row(const Grid *grid, int row, int step, int height, float h_max) {
    int top = row - step < 0 ? 0 : row - step;
    int bottom = row + step > height - 1 ? height - 1 : row + step;
    GridBounds bounds = grid_bounds(grid, top, bottom, h_max);
    double across = bounds.across_m * step, down = bounds.down_m * step, diagonal = hypot(across, down);
    float edge_reach = (float)(0.5 * diagonal) * GROW + NESTING_SLACK_M;
    float centre_reach = (float)fmax(across, down) * GROW + NESTING_SLACK_M;
    float slack = h_max * HEIGHT_SLACK + LATTICE_SLACK_M;
    float bend = (float)(bounds.bend_m * step * step) * GROW;
    double radius = GEODESY_B_M * (1.0 - GEODESY_E2); // smaller than every radius of curvature
    return (ErrorTerms){
        .edge_reach2 = edge_reach * edge_reach,
        .centre_reach2 = centre_reach * centre_reach,
        // Circles around the triangles have radius `step` and sqrt(2) `step` cells.
        .edge_sag = 0.5f * bend + slack,
        .centre_sag = bend + slack,
        // Half the range of heights, times the longest side, over the Earth's radius.
        .edge_drift = (float)(fmax(across, down) / radius) * GROW,
        .centre_drift = (float)(diagonal / radius) * GROW,
    };
}

static Result prepare_terms(ErrorWork *work, const ErrorField *field) {
    float h_max = error_height_max(work->input->height_m, (size_t)work->width * (size_t)work->height);
    for (int k = 0; k < field->plane_count; k++) {
        const ErrorPlane *plane = &field->planes[k];
        work->terms[k] = malloc(sizeof **work->terms * (size_t)plane->height);
        if (!work->terms[k])
            return RESULT_MEMORY;
        for (int j = 0; j < plane->height; j++)
            work->terms[k][j] = error_terms_of_row(work->input->grid, j << k, plane->step, work->height, h_max);
    }
    return RESULT_OK;
}

static void visit_corners(const Forest *forest, int plane_count, ErrorForced **forced, int32_t *counts) {
    for (int32_t i = 0; i < forest->tile_count; i++) {
        const ForestTile *tile = &forest->tiles[i];
        for (int corner = 0; corner < 4; corner++) {
            int32_t col = tile->col + (corner & 1 ? tile->side : 0);
            int32_t row = tile->row + (corner & 2 ? tile->side : 0);
            int k = __builtin_ctz((unsigned)(col | row) | 1u << FOREST_LEVEL_MAX);
            if (k >= plane_count)
                continue;
            if (forced)
                forced[k][counts[k]] = (ErrorForced){col >> k, row >> k};
            counts[k]++;
        }
    }
}

static Result prepare_forced(ErrorWork *work, const ErrorField *field) {
    const Forest *forest = work->input->forest;
    visit_corners(forest, field->plane_count, NULL, work->forced_count);
    for (int k = 0; k < field->plane_count; k++) {
        work->forced[k] = malloc(sizeof **work->forced * (size_t)(work->forced_count[k] + 1));
        if (!work->forced[k])
            return RESULT_MEMORY;
        work->forced_count[k] = 0;
    }
    visit_corners(forest, field->plane_count, work->forced, work->forced_count);
    return RESULT_OK;
}

static void release_work(ErrorWork *work) {
    for (int k = 0; k < FOREST_LEVEL_MAX; k++) {
        free(work->terms[k]);
        free(work->forced[k]);
    }
}

// A patch whose middle has this step must fit into 32-bit offsets on the lattice; larger ones always split.
static bool too_large(const ErrorWork *work, const ErrorPlane *plane) {
    GridBounds bounds = grid_bounds(work->input->grid, 0, work->height - 1, 0.0);
    return 3.0 * plane->step * fmax(bounds.across_m, bounds.down_m) * GRID_LATTICE_PER_M > (double)INT32_MAX;
}

static void force_plane(ErrorPlane *plane) {
    for (int j = 0; j < plane->height; j++)
        for (int i = j & 1 ? 0 : 1; i < plane->width; i += j & 1 ? 1 : 2)
            plane->delta[(size_t)j * plane->stride + (size_t)i] = ERROR_FIELD_ALWAYS;
}

static void force_vertex(ErrorField *field, int col, int row) {
    int k = __builtin_ctz((unsigned)(col | row) | 1u << FOREST_LEVEL_MAX);
    if (k < field->plane_count)
        field->planes[k].delta[(size_t)(row >> k) * field->planes[k].stride + (size_t)(col >> k)] = ERROR_FIELD_ALWAYS;
}

static void force_around(const ErrorWork *work, ErrorField *field, int col, int row) {
    for (int j = row > 0 ? row - 1 : 0; j <= row + 1 && j < work->height; j++)
        for (int i = col > 0 ? col - 1 : 0; i <= col + 1 && i < work->width; i++)
            force_vertex(field, i, j);
}

static void mark_holes(const ErrorWork *work, ErrorField *field) {
    const uint8_t *bits = work->input->void_bits;
    size_t count = (size_t)work->width * (size_t)work->height;
    for (size_t byte = 0; bits && byte < (count + 7) / 8; byte++)
        for (size_t i = 8 * byte; bits[byte] && i < 8 * byte + 8 && i < count; i++)
            if (bits[byte] >> (i & 7) & 1)
                force_around(work, field, (int)(i % (size_t)work->width), (int)(i / (size_t)work->width));
}

static void mark_forced(const ErrorWork *work, ErrorField *field) {
    mark_holes(work, field);
    for (int k = 0; k < field->plane_count; k++) {
        ErrorPlane *plane = &field->planes[k];
        if (too_large(work, plane))
            force_plane(plane);
        for (int32_t i = 0; i < work->forced_count[k]; i++)
            plane->delta[(size_t)work->forced[k][i].j * plane->stride + (size_t)work->forced[k][i].i] =
                ERROR_FIELD_ALWAYS;
    }
}

Result error_field_create(const ErrorFieldInput *input, Jobs *jobs, ErrorField *out) {
    ErrorField field = {0};
    ErrorWork work = {.input = input, .width = input->forest->width, .height = input->forest->height};
    Result result = allocate_planes(&field, input->forest);
    if (result != RESULT_OK)
        goto fail;
    result = prepare_terms(&work, &field);
    if (result != RESULT_OK)
        goto fail;
    result = prepare_forced(&work, &field);
    if (result != RESULT_OK)
        goto fail;
    mark_forced(&work, &field);
    if (input->kind == TERRAIN_ERROR_TOTAL) {
        result = error_total_own(&work, jobs, &field);
        if (result != RESULT_OK)
            goto fail;
    }
    result = input->scheme == ERROR_SCHEME_RECURSIVE ? error_nest_recursive(&work, &field)
                                                     : error_nest_parallel(&work, jobs, &field);
    if (result != RESULT_OK)
        goto fail;
    release_work(&work);
    *out = field;
    return RESULT_OK;
fail:
    log_error("error field: not enough memory for %d x %d samples", work.width, work.height);
    release_work(&work);
    error_field_destroy(&field);
    return result;
}

void error_field_destroy(ErrorField *field) {
    if (field->memory)
        munmap(field->memory, field->bytes);
    *field = (ErrorField){0};
}

// FNV-1a over 64-bit pieces.
static uint64_t hash_row(uint64_t hash, const uint16_t *row, int count) {
    for (int i = 0; i < count; i++)
        hash = (hash ^ row[i]) * 1099511628211u;
    return hash;
}

uint64_t error_field_hash(const ErrorField *field) {
    uint64_t hash = 14695981039346656037u;
    for (int k = 0; k < field->plane_count; k++) {
        const ErrorPlane *plane = &field->planes[k];
        for (int j = 0; j < plane->height; j++) {
            hash = hash_row(hash, plane->delta + (size_t)j * plane->stride, plane->width);
            hash = hash_row(hash, plane->radius + (size_t)j * plane->stride, plane->width);
        }
    }
    return hash;
}
