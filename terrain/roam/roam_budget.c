// terrain/roam/roam_budget.c: Duchaineau et al. 1997, section 5. Priorities are nested like the errors that they are
// made of: a vertex's is below those of the vertices it needs, so what a split forces never has less priority than it.
#include "terrain/roam/roam_budget.h"

#include <math.h>

// From frame to frame the border between what is split and what is not moves little: only priorities about the last one
// are queued, at first.
#define WINDOW 1.05

typedef struct Balance {
    RoamBudget *budget;
    RoamRefiner *refiner;
    double tau_px;
    double lowest_px, highest_px; // splits above the one are queued, and merges below the other
    bool failed;
} Balance;

void roam_budget_destroy(RoamBudget *budget) {
    roam_heap_destroy(&budget->splits);
    roam_heap_destroy(&budget->merges);
}

// The tolerance at which the vertex becomes active, in pixels: lambda delta / (distance - radius), infinite inside the
// sphere. On the side of tau_px that its activity says, whatever the rounding.
static double priority_of(Balance *b, const RoamTriangle *t) {
    RoamRefiner *r = b->refiner;
    const RoamVertex *v = roam_split_vertex(r, t);
    if (!v)
        return 0.0;
    double gap = roam_vertex_gap(&r->field->patches[t->square], v, &r->view);
    double reach = r->view.nu * GRID_LATTICE_PER_M * (double)error_field_decode(v->delta);
    double beyond = reach - gap; // distance - radius
    double priority = beyond > 0.0 && reach < INFINITY ? b->tau_px * reach / beyond : INFINITY;
    r->evaluated++;
    if (gap > 0.0)
        return fmax(priority, nextafter(b->tau_px, INFINITY));
    return fmin(priority, b->tau_px);
}

static bool stays_split(Balance *b, const RoamTriangle *t) {
    const RoamVertex *v = roam_split_vertex(b->refiner, t);
    return !v || v->delta == ERROR_FIELD_ALWAYS;
}

// ---- the two queues: entries whose triangle is no longer what it was are left in, and passed over ----

static void rank_leaf(Balance *b, int32_t t) {
    const RoamTriangle *triangle = &b->refiner->mesh->triangles[t];
    if (roam_is_finest(b->refiner, triangle))
        return;
    double priority = priority_of(b, triangle);
    if (priority > b->lowest_px && !roam_heap_push(&b->budget->splits, priority, t))
        b->failed = true;
}

// Of a diamond's two triangles the one with the smaller index is ranked.
static void rank_diamond(Balance *b, int32_t t) {
    const RoamMesh *mesh = b->refiner->mesh;
    int32_t partner;
    if (t < 0 || !roam_mesh_can_merge(mesh, t, &partner))
        return;
    t = partner >= 0 && partner < t ? partner : t;
    const RoamTriangle *triangle = &mesh->triangles[t];
    if (stays_split(b, triangle))
        return;
    double priority = priority_of(b, triangle);
    if (priority <= b->highest_px && !roam_heap_push(&b->budget->merges, -priority, t))
        b->failed = true;
}

static bool first_split(Balance *b, RoamRanked *out) {
    RoamHeap *heap = &b->budget->splits;
    for (; heap->count; roam_heap_pop(heap)) {
        *out = heap->ranked[0];
        const RoamTriangle *t = &b->refiner->mesh->triangles[out->triangle];
        if (!roam_is_gone(t) && roam_is_leaf(t) && !roam_is_finest(b->refiner, t) && priority_of(b, t) == out->priority)
            return true;
    }
    return false;
}

static bool first_merge(Balance *b, RoamRanked *out) {
    RoamHeap *heap = &b->budget->merges;
    for (; heap->count; roam_heap_pop(heap)) {
        *out = heap->ranked[0];
        int32_t partner;
        const RoamTriangle *t = &b->refiner->mesh->triangles[out->triangle];
        if (!roam_is_gone(t) && roam_mesh_can_merge(b->refiner->mesh, out->triangle, &partner) &&
            -priority_of(b, t) == out->priority)
            return true;
    }
    return false;
}

// ---- steps ----

static void split(Balance *b, int32_t triangle) {
    RoamMesh *mesh = b->refiner->mesh;
    if (!roam_mesh_split(mesh, triangle)) {
        b->failed = true;
        return;
    }
    for (int i = 0; i < mesh->journal_count; i++) {
        int32_t child = mesh->triangles[mesh->journal[i]].child;
        for (int half = 0; half < 2; half++)
            if (roam_is_leaf(&mesh->triangles[child + half]))
                rank_leaf(b, child + half);
        rank_diamond(b, mesh->journal[i]);
    }
}

static void merge(Balance *b, int32_t triangle) {
    RoamMesh *mesh = b->refiner->mesh;
    int32_t partner;
    roam_mesh_can_merge(mesh, triangle, &partner);
    roam_mesh_merge(mesh, triangle, partner);
    rank_leaf(b, triangle);
    rank_diamond(b, mesh->triangles[triangle].parent);
    if (partner < 0)
        return;
    rank_leaf(b, partner);
    rank_diamond(b, mesh->triangles[partner].parent);
}

static void rank_all(Balance *b) {
    const RoamMesh *mesh = b->refiner->mesh;
    b->budget->splits.count = b->budget->merges.count = 0;
    for (int32_t t = 0; t < mesh->used && !b->failed; t++) {
        if (roam_is_gone(&mesh->triangles[t]))
            continue;
        int32_t partner;
        if (roam_is_leaf(&mesh->triangles[t]))
            rank_leaf(b, t);
        else if (roam_mesh_can_merge(mesh, t, &partner) && (partner < 0 || t < partner))
            rank_diamond(b, t);
    }
}

// Whether the queues held too little to go on with; they hold more now.
static bool widen(Balance *b, bool can_merge, bool too_coarse) {
    bool splits_lack = !too_coarse && b->lowest_px > b->tau_px, merges_lack = !can_merge && b->highest_px < INFINITY;
    if (!splits_lack && !merges_lack)
        return false;
    if (splits_lack)
        b->lowest_px = fmax(b->tau_px, b->lowest_px / (WINDOW * WINDOW));
    if (merges_lack)
        b->highest_px = INFINITY;
    rank_all(b);
    return true;
}

// One split or merge. False: neither helps; *too_coarse, *coarse: what is left to split.
static bool step(Balance *b, bool *too_coarse, RoamRanked *coarse) {
    RoamRanked fine = {0};
    bool can_merge = first_merge(b, &fine), is_inactive = can_merge && -fine.priority <= b->tau_px;
    *too_coarse = first_split(b, coarse);
    if (is_inactive)
        merge(b, fine.triangle);
    else if (*too_coarse && roam_mesh_has_room(b->refiner->mesh, coarse->triangle))
        split(b, coarse->triangle);
    else if (*too_coarse && can_merge && -fine.priority < coarse->priority)
        merge(b, fine.triangle);
    else
        return widen(b, can_merge || !*too_coarse, *too_coarse);
    return true;
}

RoamStop roam_budget_balance(RoamBudget *budget, RoamRefiner *refiner, double tau_px, double *reached_px) {
    double expected = budget->reached_px < INFINITY ? budget->reached_px : 0.0;
    Balance b = {budget, refiner, tau_px, fmax(tau_px, expected / WINDOW), INFINITY, false};
    if (expected > tau_px)
        b.highest_px = expected * WINDOW;
    rank_all(&b);
    RoamRanked coarse = {0};
    bool too_coarse = false;
    while (!b.failed && !refiner->failed && step(&b, &too_coarse, &coarse))
        continue;
    budget->reached_px = *reached_px = too_coarse ? coarse.priority : tau_px;
    return b.failed || refiner->failed ? ROAM_FAILED : ROAM_DONE;
}
