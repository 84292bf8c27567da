// terrain/roam/roam_field.h: what a vertex of a square is decided upon: its place on the lattice and its error codes.
// Lattice units (grid.h) from the square's origin; columns and rows in samples from the square's corner.
// A RoamField owns its tables and borrows grid and terrain. One thread at a time for each square.
#pragma once
#include "terrain/errors/error_field.h"
#include "terrain/patches/refine.h"
#include "terrain/squares/square_grid.h"
#include "terrain/terrain.h"

#define ROAM_SIDE_MAX 128 // cells of a square: an offset in it is one byte
#define ROAM_LEVEL_MAX 14 // bisections of the largest square down to single samples

typedef struct RoamVertex {
    int32_t x, y, z;
    uint16_t delta, radius; // error_field.h
} RoamVertex;

// A square's vertices down to some stride, in rows from its north-west corner.
typedef struct RoamPatch {
    RoamVertex *vertices; // NULL: none yet
    double origin[3];
    int16_t across;    // vertices a row
    uint8_t shift;     // log2 of the stride
    uint8_t level_end; // the vertices that split triangles of levels below it are there
} RoamPatch;

typedef struct RoamField {
    const SquareGrid *grid;
    const Terrain *terrain;
    RoamPatch *patches; // [grid->count]
    int levels;         // bisections of the largest squares down to single samples
} RoamField;

MUST_USE Result roam_field_create(const SquareGrid *grid, const Terrain *terrain, RoamField *out);
void roam_field_destroy(RoamField *field);

// Makes the vertices that split the square's triangles of `level` < levels, and all above. MEMORY.
MUST_USE Result roam_field_deepen(RoamField *field, int32_t square, int level);
// Forgets a square's vertices; they are made again when asked for.
void roam_field_drop(RoamField *field, int32_t square);
size_t roam_field_bytes(const RoamField *field); // of all vertices

// The step, in samples, of the vertices that split triangles of `level`, which is counted from the roots of the largest
// squares.
static inline int roam_level_step(int side_max, int level) {
    return side_max >> (level / 2 + 1);
}

// nu delta + radius - |position - eye|, lattice units: the vertex is active where that is above 0. The same
// expression as in refine.c, so the same bits.
static inline double roam_vertex_gap(const RoamPatch *patch, const RoamVertex *v, const RefineView *view) {
    double x = ((double)v->x + patch->origin[0]) - view->eye[0];
    double y = ((double)v->y + patch->origin[1]) - view->eye[1];
    double z = ((double)v->z + patch->origin[2]) - view->eye[2];
    double distance = sqrt(x * x + y * y + z * z);
    double reach = view->nu * GRID_LATTICE_PER_M * (double)error_field_decode(v->delta) +
                   GRID_LATTICE_PER_M * (double)error_field_decode(v->radius);
    return reach - distance;
}
