// terrain/roam/roam_base.h: the mesh that refinement begins with: two triangles a square, and what is active in every
// cut: corners where small squares meet a large one, and holes.
// As terrain/roam/roam_mesh.h.
// A RoamBase owns its mesh; constant after creation, any thread may read it.
//
// Source: Biedermann, Rivara, section 3: N square patches of two bintrees each, linked where they meet; section 4: the
// links across a cut removed.
#pragma once
#include "terrain/errors/error_field.h"
#include "terrain/roam/roam_mesh.h"
#include "terrain/squares/square_grid.h"

typedef struct RoamBase {
    RoamMesh mesh;
    int32_t *first;  // [squares + 1]: root 0 of a square, root 1 after it; all its triangles follow
    int32_t *leaves; // [squares]
} RoamBase;

MUST_USE Result roam_base_create(const SquareGrid *grid, const ErrorField *errors, RoamBase *out);
void roam_base_destroy(RoamBase *base);

// The whole base mesh. `roots`: [squares] root 0 of each. MEMORY.
MUST_USE Result roam_base_copy(const RoamBase *base, RoamMesh *mesh, int32_t *roots);
// Only the squares in `squares`, which are all of one partition, unlinked from those of others. Writes their `roots`
// and reads no others: parts may be copied side by side. MEMORY.
MUST_USE Result roam_base_copy_part(const RoamBase *base, const uint16_t *partition_of, const int32_t *squares,
                                    int32_t count, RoamMesh *mesh, int32_t *roots);
