// terrain/roam/roam_emit.h: the triangles of one square as indices into a page of it.
// Columns and rows in samples from the square's north-west corner.
// Memory is the caller's; pure but for it.
#pragma once
#include "terrain/roam/roam_field.h"
#include "terrain/roam/roam_mesh.h"

typedef struct RoamScratch {
    uint64_t *corners; // [leaves of a square at most]
    uint16_t *indices; // [3 * leaves]
    uint8_t *drawn;    // [vertices of a page at most]
} RoamScratch;
MUST_USE Result roam_scratch_create(int side_max, RoamScratch *out);
void roam_scratch_destroy(RoamScratch *scratch);

typedef struct RoamEmitted {
    int32_t index_count;
    int32_t vertex_count; // drawn
    int stride;           // the finest that the triangles need, samples
    int level;            // of the finest triangle
    uint8_t sides[4];     // vertices drawn inside the northern, eastern, southern, western side, corners not counted
} RoamEmitted;

// Triangles in depth-first order, counter-clockwise seen from above, into scratch->indices: they index the rows of a
// page of `stride`. The same mesh gives the same bytes, however it came about.
RoamEmitted roam_emit(const RoamMesh *mesh, int32_t root, const SquareGrid *grid, RoamScratch *scratch);
