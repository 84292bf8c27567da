// terrain/errors/error_field.h: the nested error and radius of every vertex of the longest-edge bisection.
// Metres. A vertex is known by its column and row; its step s is the lowest set bit of (col | row). With s its
// diamond is an edge midpoint where (col/s + row/s) is odd: hypotenuse (+-s, 0) where col/s is odd, (0, +-s) otherwise;
// and a centre where both are odd: hypotenuse (-s,-s)-(s,s) where (col/2s + row/2s) is even, (s,-s)-(-s,s) otherwise.
// An ErrorField owns its planes; constant after creation, any thread may read it.
//
// Sources: Loeffler, Schwanke, Schumann 2010, section 3 (level by level, all diamonds of a level in parallel);
// Lindstrom, Pascucci 2002, section 4 (nested errors and radii). Our own: packed planes, 16 bits rounded up, the total
// error, exact or bounded.
#pragma once
#include "base/base.h"
#include "terrain/forest.h"
#include "terrain/grid.h"
#include "terrain/jobs.h"
#include "terrain/terrain.h"

// Stored numbers are the upper 16 bits of a non-negative float without its sign: 8 bits of exponent, 8 of
// mantissa, rounded up: at most 0.4 % above. Their order is that of the values.
#define ERROR_FIELD_ALWAYS 0xFF00u // infinity: the vertex is active in every cut

static inline float error_field_decode(uint16_t code) {
    union {
        uint32_t bits;
        float value;
    } both = {.bits = (uint32_t)code << 15};
    return both.value;
}

static inline uint16_t error_field_encode(float value) { // value >= 0
    union {
        float value;
        uint32_t bits;
    } both = {.value = value};
    return (uint16_t)((both.bits + 0x7FFFu) >> 15);
}

// All vertices of one step, packed: entry (i, j) is the vertex (i s, j s). Entries with i and j both even belong
// to a coarser plane and are 0.
typedef struct ErrorPlane {
    int step;
    int width, height; // entries
    size_t stride;     // entries from row to row
    uint16_t *delta, *radius;
} ErrorPlane;

typedef struct ErrorField {
    int plane_count; // steps 1, 2, 4 ... up to half the largest tile's side
    ErrorPlane planes[FOREST_LEVEL_MAX];
    size_t bytes;
    void *memory;
} ErrorField;

typedef enum ErrorScheme {
    ERROR_SCHEME_PARALLEL,  // level by level
    ERROR_SCHEME_RECURSIVE, // the papers' baseline: bintree traversals, one for each level
} ErrorScheme;

typedef struct ErrorFieldInput {
    const float *height_m; // [height][width], above the ellipsoid
    const Grid *grid;
    const Forest *forest;
    TerrainErrorKind kind;
    int stride;         // TERRAIN_ERROR_TOTAL: as TerrainOptions.error_stride
    ErrorScheme scheme; // the same bits either way
    // As Dem.void_bits, or NULL: samples that are to stay holes. They and their neighbours are always active, so that
    // a hole has its samples' shape in every cut.
    const uint8_t *void_bits;
} ErrorFieldInput;

// Nested: for each child c of a vertex v, delta(v) >= delta(c) and radius(v) >= |p(v) - p(c)| + radius(c), p on the
// lattice, with more slack than double rounding can use up. With TERRAIN_ERROR_TOTAL, moreover, delta(v) is at least
// the distance |P - Q| for each sample P in v's two triangles and the point Q of the drawn triangle at the same column
// and row. Corners of base tiles, and their ancestors where a smaller tile meets a larger one, are ERROR_FIELD_ALWAYS,
// with radius 0. The same bytes for any number of workers.
MUST_USE Result error_field_create(const ErrorFieldInput *input, Jobs *jobs, ErrorField *out);
void error_field_destroy(ErrorField *field);

// A hash of all entries, to compare fields by.
uint64_t error_field_hash(const ErrorField *field);

typedef struct ErrorCodes {
    uint16_t delta, radius;
} ErrorCodes;

static inline ErrorCodes error_field_at(const ErrorField *field, int col, int row) {
    int plane = __builtin_ctz((unsigned)(col | row) | 1u << FOREST_LEVEL_MAX);
    if (plane >= field->plane_count)
        return (ErrorCodes){ERROR_FIELD_ALWAYS, 0};
    const ErrorPlane *p = &field->planes[plane];
    size_t i = (size_t)(row >> plane) * p->stride + (size_t)(col >> plane);
    return (ErrorCodes){p->delta[i], p->radius[i]};
}
