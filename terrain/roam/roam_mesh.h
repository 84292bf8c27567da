// terrain/roam/roam_mesh.h: bintrees of triangles, linked to their neighbours, and their splits and merges.
// Columns and rows in samples from a square's north-west corner; triangles by their index in the pool.
// A RoamMesh owns its pool; one thread at a time. Meshes share nothing.
//
// Sources: Duchaineau et al. 1997, sections 3 and 4 (bintree, diamonds, forced splits); Rivara 1997 (longest-edge
// propagation path); Biedermann, Rivara, section 3 (square patches of two bintrees, the pool).
#pragma once
#include "base/base.h"

#define ROAM_NONE (-1)
#define ROAM_LEVEL_GONE 0xFF
#define ROAM_TRIANGLES_MAX (1 << 29) // leaves of a mesh: twice that fits an index
#define ROAM_PATH_MAX 32 // triangles on a longest-edge propagation path: each a level coarser than the one before

// Neighbours are leaves, and up to date only in leaves. (left, right) is the hypotenuse; seen from above apex, right,
// left run counter-clockwise.
typedef struct RoamTriangle {
    int32_t base, left, right; // across the hypotenuse, apex-left, right-apex; ROAM_NONE: an edge of the mesh
    int32_t child;             // of its two halves the one at the left, the other follows; 0: a leaf
    int32_t parent;            // ROAM_NONE: a root
    int32_t square;
    uint8_t left_col, left_row, right_col, right_row, apex_col, apex_row;
    uint8_t level; // bisections from the roots of the largest squares; ROAM_LEVEL_GONE: in no mesh any more
    uint8_t spare;
} RoamTriangle;

typedef struct RoamMesh {
    RoamTriangle *triangles; // the pool: [capacity], of which `used` were ever taken
    int32_t used, capacity;
    int32_t triangles_max; // leaves that the pool may come to hold
    int32_t leaf_count;
    int32_t free_pair; // chain through `child` of pairs that merges gave back; 0: none
    uint8_t *changed;  // [squares], borrowed: set to 1 where a triangle is split or merged; NULL: not asked for
    // Triangles split by the last roam_mesh_split: those forced first, the one asked for and its partner last.
    int32_t journal[2 * ROAM_PATH_MAX];
    int32_t journal_count;
    int64_t splits, forced_splits, merges; // of pairs of triangles, or single ones at an edge of the mesh
} RoamMesh;

void roam_mesh_destroy(RoamMesh *mesh);
// Empties the mesh and makes room for `count` triangles. MEMORY.
MUST_USE Result roam_mesh_reserve(RoamMesh *mesh, int32_t count);
// Two new triangles without contents, side by side; the pool must have room.
int32_t roam_mesh_take_pair(RoamMesh *mesh);

// Leaves that splitting this leaf adds, with all that it forces.
int roam_mesh_cost(const RoamMesh *mesh, int32_t triangle);
// Splits a leaf and its partner across the hypotenuse, after all that must be split before. False when memory is out,
// or when the pool must not grow: then nothing has changed. roam_mesh_has_room tells beforehand.
MUST_USE bool roam_mesh_split(RoamMesh *mesh, int32_t triangle);
bool roam_mesh_has_room(const RoamMesh *mesh, int32_t triangle);
// Whether a split triangle and its partner have leaves only; the partner, or ROAM_NONE at an edge of the mesh.
bool roam_mesh_can_merge(const RoamMesh *mesh, int32_t triangle, int32_t *partner);
// Undoes the split of a triangle that can merge.
void roam_mesh_merge(RoamMesh *mesh, int32_t triangle, int32_t partner);

static inline bool roam_is_leaf(const RoamTriangle *t) {
    return t->child == 0;
}
static inline bool roam_is_gone(const RoamTriangle *t) { // merged, or never there
    return t->level == ROAM_LEVEL_GONE;
}
