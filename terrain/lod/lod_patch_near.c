// Branch and bound over the patch hierarchy: all samples below a vertex lie in its nested sphere (Lindstrom, Pascucci
// 2002, section 4).
#include "terrain/lod/lod_patch_near.h"

#include "terrain/terrain_parts.h"

#include <math.h>

typedef struct Near {
    const Terrain *terrain;
    Vec3d eye;
    const PatchTile *tile;
    double best_m;
} Near;

static void meet_sample(Near *n, PatchCorner c) {
    Vec3d position = grid_point_ecef(terrain_point(n->terrain, c.col, c.row));
    n->best_m = fmin(n->best_m, vec3d_distance(position, n->eye));
}

static void meet_finest(Near *n, const PatchTriangle *t) {
    const PatchTemplate *patch = &n->terrain->patches.templates[n->tile->template_index];
    for (int v = patch->level_begin[0]; v < patch->vertex_count; v++) {
        int i = patch->position[v][0], j = patch->position[v][1], side = patch->side;
        meet_sample(n, (PatchCorner){
                           t->apex.col + (i * (t->left.col - t->apex.col) + j * (t->right.col - t->apex.col)) / side,
                           t->apex.row + (i * (t->left.row - t->apex.row) + j * (t->right.row - t->apex.row)) / side,
                       });
    }
}

static double distance_of(const Near *n, const PatchTriangle *t) {
    return vec3d_distance(patch_forest_vertex(&n->terrain->patches, patch_triangle_middle(t))->position, n->eye);
}

static void descend(Near *n, const PatchTriangle *t, int level) {
    if (level == n->tile->levels) {
        meet_finest(n, t);
        return;
    }
    PatchCorner middle = patch_triangle_middle(t);
    const PatchVertex *vertex = patch_forest_vertex(&n->terrain->patches, middle);
    double distance = vec3d_distance(vertex->position, n->eye);
    if (isfinite(vertex->delta) && distance - (double)vertex->radius >= n->best_m) // forced ones have no radius
        return;
    n->best_m = fmin(n->best_m, distance);
    PatchTriangle halves[2] = {patch_triangle_half(t, middle, 0), patch_triangle_half(t, middle, 1)};
    int nearer = level + 1 < n->tile->levels && distance_of(n, &halves[1]) < distance_of(n, &halves[0]);
    descend(n, &halves[nearer], level + 1);
    descend(n, &halves[!nearer], level + 1);
}

double near_distance_m(const Terrain *terrain, Vec3d eye_ecef) {
    Near n = {.terrain = terrain, .eye = eye_ecef, .best_m = INFINITY};
    for (int32_t i = 0; i < terrain->patches.tile_count; i++) {
        n.tile = &terrain->patches.tiles[i];
        for (int root = 0; root < 2; root++) {
            PatchTriangle triangle = patch_forest_root(&n.tile->tile, root);
            descend(&n, &triangle, 0);
        }
    }
    return n.best_m;
}
