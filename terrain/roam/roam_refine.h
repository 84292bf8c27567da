// terrain/roam/roam_refine.h: split a mesh down to a tolerance.
// As terrain/roam/roam_mesh.h; gaps in lattice units.
// Borrows mesh and field; one thread at a time for each mesh.
//
// Sources: Biedermann, Rivara, section 3 (each bintree is traversed and refined where its error is above a tolerance by
// distance); the tolerance is that of Lindstrom, Pascucci 2002, nested, as in all of this program.
#pragma once
#include "terrain/roam/roam_field.h"
#include "terrain/roam/roam_mesh.h"

typedef enum RoamStop {
    ROAM_DONE,
    ROAM_FULL,   // the pool must not grow any more
    ROAM_FAILED, // memory is out
} RoamStop;

typedef struct RoamRefiner {
    RoamMesh *mesh;
    RoamField *field;
    RefineView view;
    int64_t evaluated; // activity decisions so far
    bool failed;       // memory was out at some decision
} RoamRefiner;

// The vertex that splits a triangle above its square's last level; NULL when memory is out, which `failed` says.
static inline const RoamVertex *roam_split_vertex(RoamRefiner *r, const RoamTriangle *t) {
    const RoamPatch *patch = &r->field->patches[t->square];
    if (t->level >= patch->level_end && roam_field_deepen(r->field, t->square, t->level) != RESULT_OK) {
        r->failed = true;
        return NULL;
    }
    int col = (t->left_col + t->right_col) >> (patch->shift + 1);
    int row = (t->left_row + t->right_row) >> (patch->shift + 1);
    return &patch->vertices[row * patch->across + col];
}

static inline bool roam_is_finest(const RoamRefiner *r, const RoamTriangle *t) {
    return t->level >= r->field->levels;
}

// roam_vertex_gap of the vertex that splits a triangle; -infinity below the last level.
static inline double roam_gap(RoamRefiner *r, const RoamTriangle *t) {
    if (roam_is_finest(r, t))
        return -INFINITY;
    const RoamVertex *v = roam_split_vertex(r, t);
    r->evaluated++;
    return v ? roam_vertex_gap(&r->field->patches[t->square], v, &r->view) : -INFINITY;
}

// Splits all active triangles of the bintrees at `root` and root + 1, and what that forces elsewhere.
RoamStop roam_refine_square(RoamRefiner *refiner, int32_t root);
