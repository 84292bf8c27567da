// terrain/roam/roam_mesh.c: Duchaineau et al. 1997, sections 3 and 4; Biedermann, Rivara, sections 2.2 and 3: split,
// forced split along the longest-edge propagation path, merge, and the bounded pool.
#include "terrain/roam/roam_mesh.h"

#include "base/log.h"

#include <stdlib.h>

void roam_mesh_destroy(RoamMesh *mesh) {
    free(mesh->triangles);
    *mesh = (RoamMesh){0};
}

static bool grow(RoamMesh *mesh, int64_t count) {
    int64_t larger = (int64_t)mesh->capacity + mesh->capacity / 2;
    larger = larger < count ? count : larger;
    RoamTriangle *grown = larger <= INT32_MAX ? realloc(mesh->triangles, sizeof *grown * (size_t)larger) : NULL;
    if (!grown) {
        log_error("roam: not enough memory for %lld triangles; give a smaller --max-triangles", (long long)larger);
        return false;
    }
    mesh->triangles = grown;
    mesh->capacity = (int32_t)larger;
    return true;
}

Result roam_mesh_reserve(RoamMesh *mesh, int32_t count) {
    mesh->used = mesh->leaf_count = mesh->free_pair = mesh->journal_count = 0;
    mesh->splits = mesh->forced_splits = mesh->merges = 0;
    return mesh->capacity >= count || grow(mesh, count) ? RESULT_OK : RESULT_MEMORY;
}

int32_t roam_mesh_take_pair(RoamMesh *mesh) {
    int32_t pair = mesh->free_pair;
    if (pair) {
        mesh->free_pair = mesh->triangles[pair].child;
        return pair;
    }
    pair = mesh->used;
    mesh->used += 2;
    return pair;
}

static void give_back_pair(RoamMesh *mesh, int32_t pair) {
    mesh->triangles[pair].level = mesh->triangles[pair + 1].level = ROAM_LEVEL_GONE;
    mesh->triangles[pair].child = mesh->free_pair;
    mesh->free_pair = pair;
}

static void relink(RoamTriangle *triangles, int32_t neighbour, int32_t from, int32_t to) {
    if (neighbour < 0)
        return;
    RoamTriangle *n = &triangles[neighbour];
    if (n->base == from)
        n->base = to;
    else if (n->left == from)
        n->left = to;
    else
        n->right = to;
}

// The halves `c` of `t`, where the partner's halves are at `d`.
static void make_halves(RoamTriangle *triangles, int32_t t, int32_t c, int32_t d) {
    RoamTriangle *p = &triangles[t], *half = &triangles[c];
    uint8_t col = (uint8_t)((p->left_col + p->right_col) / 2), row = (uint8_t)((p->left_row + p->right_row) / 2);
    half[0] = (RoamTriangle){.base = p->left,
                             .left = c + 1,
                             .right = d < 0 ? ROAM_NONE : d + 1,
                             .parent = t,
                             .square = p->square,
                             .left_col = p->apex_col,
                             .left_row = p->apex_row,
                             .right_col = p->left_col,
                             .right_row = p->left_row,
                             .apex_col = col,
                             .apex_row = row,
                             .level = (uint8_t)(p->level + 1)};
    half[1] = (RoamTriangle){.base = p->right,
                             .left = d,
                             .right = c,
                             .parent = t,
                             .square = p->square,
                             .left_col = p->right_col,
                             .left_row = p->right_row,
                             .right_col = p->apex_col,
                             .right_row = p->apex_row,
                             .apex_col = col,
                             .apex_row = row,
                             .level = (uint8_t)(p->level + 1)};
    p->child = c;
    relink(triangles, p->left, t, c);
    relink(triangles, p->right, t, c + 1);
}

static void mark_changed(RoamMesh *mesh, const RoamTriangle *t) {
    if (mesh->changed)
        mesh->changed[t->square] = 1;
}

static void split_one(RoamMesh *mesh, int32_t t, int32_t c, int32_t d) {
    make_halves(mesh->triangles, t, c, d);
    mark_changed(mesh, &mesh->triangles[t]);
    mesh->journal[mesh->journal_count++] = t;
    mesh->leaf_count++;
}

static void split_pair(RoamMesh *mesh, int32_t t) {
    int32_t partner = mesh->triangles[t].base;
    int32_t c = roam_mesh_take_pair(mesh), d = partner < 0 ? ROAM_NONE : roam_mesh_take_pair(mesh);
    split_one(mesh, t, c, d);
    mesh->splits++;
    if (partner >= 0)
        split_one(mesh, partner, d, c);
}

// From a leaf to the first whose hypotenuse is its neighbour's too, or an edge of the mesh.
static int propagation_path(const RoamMesh *mesh, int32_t t, int32_t path[ROAM_PATH_MAX]) {
    int count = 0;
    path[count++] = t;
    for (;;) {
        int32_t base = mesh->triangles[t].base;
        if (base < 0 || mesh->triangles[base].base == t)
            return count;
        path[count++] = t = base;
    }
}

int roam_mesh_cost(const RoamMesh *mesh, int32_t triangle) {
    int32_t path[ROAM_PATH_MAX];
    int count = propagation_path(mesh, triangle, path);
    return 2 * count - (mesh->triangles[path[count - 1]].base < 0);
}

bool roam_mesh_has_room(const RoamMesh *mesh, int32_t triangle) {
    if (mesh->leaf_count <= mesh->triangles_max - 2 * ROAM_PATH_MAX)
        return true;
    return mesh->leaf_count + roam_mesh_cost(mesh, triangle) <= mesh->triangles_max;
}

bool roam_mesh_split(RoamMesh *mesh, int32_t triangle) {
    if (!roam_mesh_has_room(mesh, triangle))
        return false;
    if (mesh->used > mesh->capacity - 4 * ROAM_PATH_MAX && !grow(mesh, (int64_t)mesh->used + 4 * ROAM_PATH_MAX))
        return false;
    int32_t path[ROAM_PATH_MAX];
    int count = propagation_path(mesh, triangle, path);
    mesh->journal_count = 0;
    mesh->forced_splits += count - 1;
    while (count)
        split_pair(mesh, path[--count]);
    return true;
}

bool roam_mesh_can_merge(const RoamMesh *mesh, int32_t triangle, int32_t *partner) {
    const RoamTriangle *all = mesh->triangles, *t = &all[triangle];
    *partner = ROAM_NONE;
    if (roam_is_leaf(t) || !roam_is_leaf(&all[t->child]) || !roam_is_leaf(&all[t->child + 1]))
        return false;
    int32_t across = all[t->child].right;
    if (across < 0)
        return true;
    if (all[across].level != t->level + 1 || all[across].parent < 0) // a root: two smaller squares lie across
        return false;
    *partner = all[across].parent;
    int32_t pair = all[*partner].child;
    return roam_is_leaf(&all[pair]) && roam_is_leaf(&all[pair + 1]);
}

static void join_halves(RoamMesh *mesh, int32_t t, int32_t partner) {
    RoamTriangle *all = mesh->triangles, *p = &all[t];
    int32_t c = p->child;
    p->left = all[c].base;
    p->right = all[c + 1].base;
    p->base = partner;
    p->child = 0;
    relink(all, p->left, c, t);
    relink(all, p->right, c + 1, t);
    give_back_pair(mesh, c);
    mark_changed(mesh, p);
    mesh->leaf_count--;
}

void roam_mesh_merge(RoamMesh *mesh, int32_t triangle, int32_t partner) {
    join_halves(mesh, triangle, partner);
    if (partner >= 0)
        join_halves(mesh, partner, triangle);
    mesh->merges++;
}
