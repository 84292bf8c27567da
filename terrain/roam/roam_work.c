#include "terrain/roam/roam_work.h"

#include "base/log.h"
#include "terrain/lod/partition.h"
#include "terrain/patches/refine.h"
#include "terrain/terrain_parts.h"

#include <stdlib.h>
#include <string.h>

// In triangles, of 43 ns: what a square costs whatever is in it, and what each vertex costs that is fetched to be
// decided upon. Fitted to the times of 156 partitions over Tatra: half are predicted within 4 %.
#define SQUARE_WORK 1.0
#define VERTEX_WORK 0.07

static Vec3d place_of(const Terrain *terrain, int col, int row) {
    return grid_point_ecef(terrain_point(terrain, col, row));
}

Result roam_work_create(const RoamGround *ground, RoamWork *out) {
    size_t count = (size_t)ground->grid.count;
    *out = (RoamWork){.ground = ground,
                      .centres = malloc(count * sizeof *out->centres),
                      .turns = malloc(count * sizeof *out->turns),
                      .work = malloc(count * sizeof *out->work),
                      .order = malloc(count * sizeof *out->order),
                      .grouped = malloc(count * sizeof *out->grouped),
                      .partition_of = calloc(count, sizeof *out->partition_of)};
    if (!out->centres || !out->turns || !out->work || !out->order || !out->grouped || !out->partition_of) {
        log_error("roam: not enough memory to divide %zu squares", count);
        roam_work_destroy(out);
        return RESULT_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        const ForestTile *t = &ground->grid.squares[i];
        out->centres[i] = place_of(ground->terrain, t->col + t->side / 2, t->row + t->side / 2);
    }
    return RESULT_OK;
}

void roam_work_destroy(RoamWork *work) {
    free(work->centres);
    free(work->turns);
    free(work->work);
    free(work->order);
    free(work->grouped);
    free(work->partition_of);
    *work = (RoamWork){0};
}

// Of each step one vertex, a centre, stands for all: two triangles for each that is active.
static double estimate(const RoamWork *w, const ForestTile *square, const RefineView *view) {
    const Terrain *terrain = w->ground->terrain;
    double triangles = 2.0;
    for (int step = square->side / 2; step > 0; step /= 2) {
        int middle = square->side / 4 / step * 2 * step + step; // an odd multiple of the step, about the middle
        int col = square->col + middle, row = square->row + middle;
        ErrorCodes codes = error_field_at(&terrain->errors, col, row);
        if (!refine_is_active(view, place_of(terrain, col, row), error_field_decode(codes.delta),
                              error_field_decode(codes.radius)))
            break;
        triangles = 2.0 * ((double)square->side / step) * ((double)square->side / step);
    }
    return triangles;
}

static void predict(RoamWork *w, const LodView *view) {
    const RoamGround *ground = w->ground;
    RefineView refine = refine_view(view, view->tau_px);
    for (int32_t i = 0; i < ground->grid.count; i++) {
        double triangles =
            w->has_history ? ground->drawn[i].shape.index_count / 3.0 : estimate(w, &ground->grid.squares[i], &refine);
        double vertices = (double)ground->field.patches[i].across * ground->field.patches[i].across;
        w->work[i] = SQUARE_WORK + triangles + VERTEX_WORK * vertices;
    }
}

void roam_work_divide(RoamWork *w, const LodView *view, int partitions) {
    int32_t count = w->ground->grid.count, next[LOD_PARTITIONS_MAX];
    double borders[LOD_PARTITIONS_MAX];
    ObserverLine line = partition_observer_line(view->eye_ecef, view->forward_ecef);
    predict(w, view);
    for (int32_t i = 0; i < count; i++)
        w->turns[i] = partition_turn(&line, w->centres[i]);
    partition_borders(partitions, w->turns, w->work, count, w->order, borders);
    memset(w->begins, 0, sizeof w->begins);
    for (int32_t i = 0; i < count; i++) {
        w->partition_of[i] = (uint16_t)partition_of(borders, partitions, w->turns[i]);
        w->begins[w->partition_of[i] + 1]++;
    }
    for (int p = 0; p < partitions; p++) {
        w->begins[p + 1] += w->begins[p];
        next[p] = w->begins[p];
    }
    for (int32_t i = 0; i < count; i++)
        w->grouped[next[w->partition_of[i]]++] = i;
}
