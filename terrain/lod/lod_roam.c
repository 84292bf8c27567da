// terrain/lod/lod_roam.c: ROAM (Duchaineau et al. 1997) over square patches, serial, in two forms. Built anew each
// frame as in Biedermann, Rivara, section 3; or kept from frame to frame, with splits and merges where the view asks
// for them.
#include "terrain/lod/lod_method.h"
#include "terrain/roam/roam_ground.h"
#include "terrain/roam/roam_refine.h"

#include "base/clock.h"

#include <stdlib.h>

typedef struct Roam {
    RoamGround ground;
    RoamMesh mesh;
    int32_t *roots; // [squares]
    RoamScratch scratch;
} Roam;

static RoamStop build_anew(Roam *roam, RoamRefiner *refiner) {
    if (roam_base_copy(&roam->ground.base, &roam->mesh, roam->roots) != RESULT_OK)
        return ROAM_FAILED;
    RoamStop stop = ROAM_DONE;
    for (int32_t i = 0; i < roam->ground.grid.count && stop == ROAM_DONE; i++)
        stop = roam_refine_square(refiner, roam->roots[i]);
    return stop;
}

static Result roam_update(void *state, const LodCall *call, LodCut *cut) {
    Roam *roam = state;
    RoamGround *ground = &roam->ground;
    int64_t begin = clock_now_ns();
    RoamRefiner refiner = {
        .mesh = &roam->mesh, .field = &ground->field, .view = refine_view(call->view, call->view->tau_px)};
    RoamStop stop = build_anew(roam, &refiner);
    if (stop == ROAM_FAILED)
        return RESULT_MEMORY;
    for (int32_t i = 0; i < ground->grid.count; i++)
        roam_ground_draw(ground, &roam->mesh, roam->roots[i], i, 0, &roam->scratch);
    Result result = roam_ground_finish(ground, call, cut);
    cut->stats.refine_ns = clock_now_ns() - begin;
    cut->stats.vertices_evaluated = refiner.evaluated;
    cut->stats.splits = roam->mesh.splits;
    cut->stats.forced_splits = roam->mesh.forced_splits;
    cut->stats.partitions = 1;
    return result;
}

static void roam_release(void *state, uint64_t frame) {
    Roam *roam = state;
    roam_ground_release(&roam->ground, frame);
}

static void roam_destroy(void *state) {
    Roam *roam = state;
    roam_scratch_destroy(&roam->scratch);
    free(roam->roots);
    roam_mesh_destroy(&roam->mesh);
    roam_ground_destroy(&roam->ground);
    free(roam);
}

static Result roam_create(const LodOptions *options, const Terrain *terrain, void **state) {
    Roam *roam = calloc(1, sizeof *roam);
    if (!roam)
        return RESULT_MEMORY;
    Result result = roam_ground_create(options, terrain, &roam->ground);
    if (result == RESULT_OK)
        result = roam_scratch_create(roam->ground.grid.side_max, &roam->scratch);
    if (result == RESULT_OK) {
        roam->roots = malloc(sizeof *roam->roots * (size_t)roam->ground.grid.count);
        result = roam->roots ? RESULT_OK : RESULT_MEMORY;
    }
    if (result != RESULT_OK) {
        roam_destroy(roam);
        return result;
    }
    int64_t most = options->max_triangles < ROAM_TRIANGLES_MAX ? options->max_triangles : ROAM_TRIANGLES_MAX;
    roam->mesh.triangles_max = (int32_t)most;
    *state = roam;
    return RESULT_OK;
}

const LodOps LOD_ROAM_OPS = {
    .create = roam_create,
    .destroy = roam_destroy,
    .update = roam_update,
    .release = roam_release,
};
