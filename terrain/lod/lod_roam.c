// terrain/lod/lod_roam.c: ROAM (Duchaineau et al. 1997) over square patches, serial, in two forms. Built anew each
// frame as in Biedermann, Rivara, section 3; or kept from frame to frame, with splits and merges where the view asks
// for them.
#include "terrain/lod/budget.h"
#include "terrain/lod/lod_method.h"
#include "terrain/roam/roam_budget.h"
#include "terrain/roam/roam_ground.h"
#include "terrain/roam/roam_track.h"

#include "base/clock.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct Roam {
    RoamGround ground;
    RoamMesh mesh;
    int32_t *roots;   // [squares]
    uint8_t *changed; // [squares] since they were drawn
    RoamTrack track;
    RoamBudget budget;
    RoamScratch scratch;
    double nu;    // of the last frame
    bool holds;   // the mesh is that of the last frame
    bool is_full; // the budget was reached in the last frame
} Roam;

// ---- the mesh ----

static RoamStop refine_squares(Roam *roam, RoamRefiner *refiner) {
    RoamStop stop = ROAM_DONE;
    for (int32_t i = 0; i < roam->ground.grid.count && stop == ROAM_DONE; i++)
        stop = roam_refine_square(refiner, roam->roots[i]);
    return stop;
}

static RoamStop begin_anew(Roam *roam) {
    memset(roam->changed, 1, (size_t)roam->ground.grid.count);
    roam->track.holds = false;
    return roam_base_copy(&roam->ground.base, &roam->mesh, roam->roots) == RESULT_OK ? ROAM_DONE : ROAM_FAILED;
}

// What the budget allowed in the frame before is a good beginning.
static RoamStop begin_within_budget(Roam *roam, RoamRefiner *refiner, const LodView *view) {
    RoamRefiner coarse = *refiner;
    coarse.view = refine_view(view, fmin(roam->budget.reached_px, BUDGET_COARSEST_PX));
    RoamStop stop = refine_squares(roam, &coarse);
    refiner->evaluated = coarse.evaluated;
    return stop == ROAM_FAILED ? ROAM_FAILED : ROAM_FULL;
}

// With another tolerance or lens nothing is known of any vertex, and a mesh in the bintree's order is made sooner than
// an old one is gone through. Whoever zooms on and on does not pay for a queue that is never used.
static bool is_kept(const Roam *roam, const RoamRefiner *refiner) {
    return roam->ground.options.reuse && roam->holds && (roam->is_full || roam->nu == refiner->view.nu);
}

// Where the budget was reached in the frame before, it is likely to be again: priorities are compared from the start.
static RoamStop refine(Roam *roam, RoamRefiner *refiner, const LodView *view, double *reached_px) {
    bool kept = is_kept(roam, refiner);
    RoamStop stop = kept ? ROAM_DONE : begin_anew(roam);
    if (stop == ROAM_DONE && roam->is_full)
        stop = kept ? ROAM_FULL : begin_within_budget(roam, refiner, view);
    else if (stop == ROAM_DONE)
        stop = kept ? roam_track_update(&roam->track, refiner) : refine_squares(roam, refiner);
    roam->nu = refiner->view.nu;
    if (stop != ROAM_FULL)
        return stop;
    roam->track.holds = false;
    return roam_budget_balance(&roam->budget, refiner, view->tau_px, reached_px);
}

// ---- the cut ----

static void draw_changed(Roam *roam) {
    for (int32_t i = 0; i < roam->ground.grid.count; i++)
        if (roam->changed[i] || !roam->ground.options.reuse)
            roam_ground_draw(&roam->ground, &roam->mesh, roam->roots[i], i, 0, &roam->scratch);
    memset(roam->changed, 0, (size_t)roam->ground.grid.count);
}

static void count_work(Roam *roam, const RoamRefiner *refiner, LodStats *stats) {
    stats->vertices_evaluated = refiner->evaluated;
    stats->splits = roam->mesh.splits;
    stats->forced_splits = roam->mesh.forced_splits;
    stats->merges = roam->mesh.merges;
    stats->partitions = 1;
}

static Result draw(Roam *roam, const LodCall *call, LodCut *cut) {
    roam->is_full = cut->reached_px > call->view->tau_px;
    draw_changed(roam);
    return roam_ground_finish(&roam->ground, call, cut);
}

static Result roam_update(void *state, const LodCall *call, LodCut *cut) {
    Roam *roam = state;
    double tau = call->view->tau_px;
    int64_t begin = clock_now_ns();
    RoamRefiner refiner = {.mesh = &roam->mesh, .field = &roam->ground.field, .view = refine_view(call->view, tau)};
    roam->mesh.splits = roam->mesh.forced_splits = roam->mesh.merges = 0;
    bool refined = refine(roam, &refiner, call->view, &cut->reached_px) == ROAM_DONE;
    Result result = refined ? draw(roam, call, cut) : RESULT_MEMORY;
    roam->holds = result == RESULT_OK; // else some squares were not drawn as they are: the next frame begins anew
    if (!roam->holds)
        roam_ground_abandon(&roam->ground);
    cut->stats.refine_ns = clock_now_ns() - begin;
    count_work(roam, &refiner, &cut->stats);
    return result == RESULT_OK && roam->is_full ? RESULT_BUDGET : result;
}

static void roam_release(void *state, uint64_t frame) {
    Roam *roam = state;
    roam_ground_release(&roam->ground, frame);
}

static void roam_destroy(void *state) {
    Roam *roam = state;
    roam_scratch_destroy(&roam->scratch);
    roam_track_destroy(&roam->track);
    roam_budget_destroy(&roam->budget);
    free(roam->roots);
    free(roam->changed);
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
        roam->changed = malloc((size_t)roam->ground.grid.count);
        roam->mesh.changed = options->reuse ? roam->changed : NULL;
        result = roam->roots && roam->changed ? RESULT_OK : RESULT_MEMORY;
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
