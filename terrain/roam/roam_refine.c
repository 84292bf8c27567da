#include "terrain/roam/roam_refine.h"

#define STACK_MAX (ROAM_LEVEL_MAX + 4) // depth first: one sibling waits on each level

// The bintree's order jumps about in a square's vertices: waiting for each was a third of the whole time.
static void fetch_vertices(const RoamPatch *patch) {
    const char *begin = (const char *)patch->vertices;
    size_t bytes = sizeof *patch->vertices * (size_t)patch->across * (size_t)patch->across;
    for (size_t at = 0; begin && at < bytes; at += 64)
        __builtin_prefetch(begin + at, 0, 2);
}

RoamStop roam_refine_square(RoamRefiner *r, int32_t root) {
    int32_t stack[STACK_MAX];
    int waiting = 0;
    fetch_vertices(&r->field->patches[r->mesh->triangles[root].square]);
    stack[waiting++] = root + 1;
    stack[waiting++] = root;
    while (waiting) {
        int32_t t = stack[--waiting];
        const RoamTriangle *triangle = &r->mesh->triangles[t];
        if (roam_is_leaf(triangle)) {
            if (!(roam_gap(r, triangle) > 0.0))
                continue;
            if (!roam_mesh_has_room(r->mesh, t))
                return ROAM_FULL;
            if (!roam_mesh_split(r->mesh, t))
                return ROAM_FAILED;
        }
        int32_t child = r->mesh->triangles[t].child;
        stack[waiting++] = child + 1;
        stack[waiting++] = child;
    }
    return r->failed ? ROAM_FAILED : ROAM_DONE;
}
