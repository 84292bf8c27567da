#include "terrain/roam/roam_base.h"

#include "base/log.h"

#include <stdlib.h>
#include <string.h>

typedef struct Building {
    const SquareGrid *grid;
    const ErrorField *errors;
    RoamMesh *mesh;
} Building;

static bool is_always_active(const Building *b, const RoamTriangle *t) {
    const ForestTile *square = &b->grid->squares[t->square];
    if (t->level >= 2 * __builtin_ctz((unsigned)b->grid->side_max))
        return false;
    int col = square->col + (t->left_col + t->right_col) / 2, row = square->row + (t->left_row + t->right_row) / 2;
    return error_field_at(b->errors, col, row).delta == ERROR_FIELD_ALWAYS;
}

static bool has_room(RoamMesh *mesh) {
    if (mesh->used + 2 <= mesh->capacity)
        return true;
    int32_t larger = 2 * mesh->capacity + 256;
    RoamTriangle *grown = realloc(mesh->triangles, sizeof *grown * (size_t)larger);
    if (!grown)
        return false;
    mesh->triangles = grown;
    mesh->capacity = larger;
    return true;
}

static void make_half(RoamMesh *mesh, int32_t t, int half) {
    const RoamTriangle *p = &mesh->triangles[t];
    RoamTriangle h = {.base = ROAM_NONE, .left = ROAM_NONE, .right = ROAM_NONE, .parent = t, .square = p->square};
    h.left_col = half ? p->right_col : p->apex_col;
    h.left_row = half ? p->right_row : p->apex_row;
    h.right_col = half ? p->apex_col : p->left_col;
    h.right_row = half ? p->apex_row : p->left_row;
    h.apex_col = (uint8_t)((p->left_col + p->right_col) / 2);
    h.apex_row = (uint8_t)((p->left_row + p->right_row) / 2);
    h.level = (uint8_t)(p->level + 1);
    mesh->triangles[p->child + half] = h;
}

// Depth first, without links.
static bool split_always(const Building *b, int32_t t) {
    RoamMesh *mesh = b->mesh;
    if (!is_always_active(b, &mesh->triangles[t])) {
        mesh->leaf_count++;
        return true;
    }
    if (!has_room(mesh))
        return false;
    int32_t child = roam_mesh_take_pair(mesh);
    mesh->triangles[t].child = child;
    make_half(mesh, t, 0);
    make_half(mesh, t, 1);
    return split_always(b, child) && split_always(b, child + 1);
}

static RoamTriangle root_of(const SquareGrid *grid, int32_t square, int root) {
    const ForestTile *tile = &grid->squares[square];
    PatchTriangle t = square_root_triangle(tile, root);
    return (RoamTriangle){.base = ROAM_NONE,
                          .left = ROAM_NONE,
                          .right = ROAM_NONE,
                          .parent = ROAM_NONE,
                          .square = square,
                          .left_col = (uint8_t)(t.left.col - tile->col),
                          .left_row = (uint8_t)(t.left.row - tile->row),
                          .right_col = (uint8_t)(t.right.col - tile->col),
                          .right_row = (uint8_t)(t.right.row - tile->row),
                          .apex_col = (uint8_t)(t.apex.col - tile->col),
                          .apex_row = (uint8_t)(t.apex.row - tile->row),
                          .level = (uint8_t)(2 * __builtin_ctz((unsigned)(grid->side_max / tile->side)))};
}

static bool build_square(const Building *b, int32_t square, RoamBase *base) {
    RoamMesh *mesh = b->mesh;
    if (!has_room(mesh))
        return false;
    int32_t before = mesh->leaf_count, root = base->first[square] = roam_mesh_take_pair(mesh);
    mesh->triangles[root] = root_of(b->grid, square, 0);
    mesh->triangles[root + 1] = root_of(b->grid, square, 1);
    bool done = split_always(b, root) && split_always(b, root + 1);
    base->leaves[square] = mesh->leaf_count - before;
    return done;
}

// ---- links: an edge is known by its middle ----

typedef struct Edge {
    int32_t col, row; // of the ends, summed
    int32_t triangle;
    int side; // 0 base, 1 left, 2 right
} Edge;

static int by_middle(const void *a, const void *b) {
    const Edge *x = a, *y = b;
    if (x->row != y->row)
        return x->row < y->row ? -1 : 1;
    return x->col < y->col ? -1 : x->col > y->col;
}

static void edges_of(const SquareGrid *grid, const RoamMesh *mesh, int32_t triangle, Edge *out) {
    const RoamTriangle *t = &mesh->triangles[triangle];
    const ForestTile *square = &grid->squares[t->square];
    int col = 2 * square->col, row = 2 * square->row;
    out[0] = (Edge){col + t->left_col + t->right_col, row + t->left_row + t->right_row, triangle, 0};
    out[1] = (Edge){col + t->apex_col + t->left_col, row + t->apex_row + t->left_row, triangle, 1};
    out[2] = (Edge){col + t->right_col + t->apex_col, row + t->right_row + t->apex_row, triangle, 2};
}

static void link_to(RoamMesh *mesh, const Edge *edge, int32_t neighbour) {
    RoamTriangle *t = &mesh->triangles[edge->triangle];
    *(edge->side == 0 ? &t->base : edge->side == 1 ? &t->left : &t->right) = neighbour;
}

static Result link_leaves(const SquareGrid *grid, RoamMesh *mesh) {
    size_t count = 0;
    Edge *edges = malloc(sizeof *edges * 3 * (size_t)mesh->leaf_count);
    if (!edges)
        return RESULT_MEMORY;
    for (int32_t t = 0; t < mesh->used; t++) {
        if (!roam_is_leaf(&mesh->triangles[t]))
            continue;
        edges_of(grid, mesh, t, edges + count);
        count += 3;
    }
    qsort(edges, count, sizeof *edges, by_middle);
    for (size_t i = 0; i + 1 < count; i++) {
        if (by_middle(&edges[i], &edges[i + 1]) != 0)
            continue;
        link_to(mesh, &edges[i], edges[i + 1].triangle);
        link_to(mesh, &edges[i + 1], edges[i].triangle);
    }
    free(edges);
    return RESULT_OK;
}

Result roam_base_create(const SquareGrid *grid, const ErrorField *errors, RoamBase *out) {
    *out = (RoamBase){0};
    out->first = malloc(sizeof *out->first * ((size_t)grid->count + 1));
    out->leaves = malloc(sizeof *out->leaves * (size_t)grid->count);
    Building building = {grid, errors, &out->mesh};
    bool done = out->first && out->leaves;
    for (int32_t i = 0; i < grid->count && done; i++)
        done = build_square(&building, i, out);
    if (done) {
        out->first[grid->count] = out->mesh.used;
        done = link_leaves(grid, &out->mesh) == RESULT_OK;
    }
    if (done)
        return RESULT_OK;
    log_error("roam: not enough memory for the triangles of %d squares", grid->count);
    roam_base_destroy(out);
    return RESULT_MEMORY;
}

void roam_base_destroy(RoamBase *base) {
    roam_mesh_destroy(&base->mesh);
    free(base->first);
    free(base->leaves);
    *base = (RoamBase){0};
}

// ---- copies ----

Result roam_base_copy(const RoamBase *base, RoamMesh *mesh, int32_t *roots) {
    const RoamMesh *from = &base->mesh;
    Result result = roam_mesh_reserve(mesh, from->used);
    if (result != RESULT_OK)
        return result;
    memcpy(mesh->triangles, from->triangles, sizeof *from->triangles * (size_t)from->used);
    mesh->used = from->used;
    mesh->leaf_count = from->leaf_count;
    for (int32_t i = 0; base->first[i] < from->used; i++)
        roots[i] = base->first[i];
    return RESULT_OK;
}

typedef struct Copying {
    const RoamBase *base;
    const uint16_t *partition_of;
    const int32_t *roots;
    uint16_t partition;
} Copying;

// Where a triangle of the base mesh lies in the part; ROAM_NONE in another part.
static int32_t moved(const Copying *c, int32_t triangle) {
    if (triangle < 0)
        return ROAM_NONE;
    int32_t square = c->base->mesh.triangles[triangle].square;
    if (c->partition_of[square] != c->partition)
        return ROAM_NONE;
    return triangle - c->base->first[square] + c->roots[square];
}

static void copy_square(const Copying *c, int32_t square, RoamMesh *mesh) {
    int32_t first = c->base->first[square], end = c->base->first[square + 1], shift = c->roots[square] - first;
    for (int32_t i = first; i < end; i++) {
        RoamTriangle t = c->base->mesh.triangles[i];
        t.child = t.child ? t.child + shift : 0;
        t.parent = t.parent < 0 ? ROAM_NONE : t.parent + shift;
        t.base = moved(c, t.base);
        t.left = moved(c, t.left);
        t.right = moved(c, t.right);
        mesh->triangles[i + shift] = t;
    }
}

Result roam_base_copy_part(const RoamBase *base, const uint16_t *partition_of, const int32_t *squares, int32_t count,
                           RoamMesh *mesh, int32_t *roots) {
    int32_t used = 0, leaves = 0;
    for (int32_t i = 0; i < count; i++) {
        roots[squares[i]] = used;
        used += base->first[squares[i] + 1] - base->first[squares[i]];
        leaves += base->leaves[squares[i]];
    }
    Result result = roam_mesh_reserve(mesh, used);
    if (result != RESULT_OK)
        return result;
    mesh->used = used;
    mesh->leaf_count = leaves;
    Copying copying = {base, partition_of, roots, count ? partition_of[squares[0]] : 0};
    for (int32_t i = 0; i < count; i++)
        copy_square(&copying, squares[i], mesh);
    return RESULT_OK;
}
