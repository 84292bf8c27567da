#define _POSIX_C_SOURCE 200809L
// terrain/lod/lod_roam_parallel.c: Biedermann, Rivara, sections 3 and 4: square patches of two bintrees, divided along
// the observer line, unlinked across it, each part refined anew in each frame by a worker of its own with a pool of its
// own.
//
// Differences from the paper: errors are nested, so both sides of the cut split the same vertices without being told,
// and the parts together are the triangles of one mesh, no more. No part stops for its own pool: the parts count their
// triangles together, and above the budget all of them begin again at a common, larger tolerance.
#include "terrain/lod/budget.h"
#include "terrain/lod/lod_method.h"
#include "terrain/roam/roam_refine.h"
#include "terrain/roam/roam_seam.h"
#include "terrain/roam/roam_work.h"

#include "base/clock.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <time.h>

typedef struct Part {
    RoamMesh mesh;
    RoamScratch scratch;
    RoamStop stop;
    int64_t evaluated, time_ns;
} Part;

typedef struct RoamParallel {
    RoamGround ground;
    RoamWork work;
    RoamSeams seams;
    int32_t *roots; // [squares] in the pool of its partition
    Part parts[LOD_PARTITIONS_MAX];
    Budget budget;
} RoamParallel;

typedef struct Update {
    RoamParallel *roam;
    const LodCall *call;
    RefineView view;
    int partitions;
    int32_t triangles_max; // of all parts together
    atomic_int_least64_t triangles;
} Update;

// ---- one part ----

// Of this thread: what other programs take is no part of the balance.
static int64_t processor_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

// The others stop too, at the next square: whatever the order of things, more than the budget was asked for.
static bool is_over_budget(Update *u, int64_t added) {
    return atomic_fetch_add_explicit(&u->triangles, added, memory_order_relaxed) + added > u->triangles_max;
}

static RoamStop refine_squares(Update *u, Part *part, const int32_t *squares, int32_t count) {
    RoamParallel *roam = u->roam;
    RoamRefiner refiner = {.mesh = &part->mesh, .field = &roam->ground.field, .view = u->view};
    RoamStop stop = is_over_budget(u, part->mesh.leaf_count) ? ROAM_FULL : ROAM_DONE;
    for (int32_t i = 0; i < count && stop == ROAM_DONE; i++) {
        int64_t before = part->mesh.leaf_count;
        stop = roam_refine_square(&refiner, roam->roots[squares[i]]);
        if (is_over_budget(u, part->mesh.leaf_count - before) && stop == ROAM_DONE)
            stop = ROAM_FULL;
    }
    part->evaluated = refiner.evaluated;
    return stop;
}

static void refine_part(Update *u, int partition) {
    RoamParallel *roam = u->roam;
    Part *part = &roam->parts[partition];
    int64_t begin = processor_ns();
    const int32_t *squares = roam->work.grouped + roam->work.begins[partition];
    int32_t count = roam->work.begins[partition + 1] - roam->work.begins[partition];
    part->mesh.triangles_max = u->triangles_max;
    part->stop = roam_base_copy_part(&roam->ground.base, roam->work.partition_of, squares, count, &part->mesh,
                                     roam->roots) == RESULT_OK
                     ? refine_squares(u, part, squares, count)
                     : ROAM_FAILED;
    for (int32_t i = 0; i < count && part->stop == ROAM_DONE; i++)
        roam_ground_draw(&roam->ground, &part->mesh, roam->roots[squares[i]], squares[i], partition, &part->scratch);
    part->time_ns = processor_ns() - begin;
}

static void refine_parts(void *user, int64_t begin, int64_t end, int worker) {
    (void)worker;
    for (int p = (int)begin; p < (int)end; p++)
        refine_part(user, p);
}

// ---- all parts ----

static int partition_count(const RoamParallel *roam, const Jobs *jobs) {
    if (roam->ground.options.partitions)
        return roam->ground.options.partitions;
    int workers = jobs_worker_count(jobs);
    return workers == 1 ? 1 : workers < LOD_PARTITIONS_MAX / 2 ? 2 * workers : LOD_PARTITIONS_MAX;
}

static Result divide(RoamParallel *roam, const LodView *view, int partitions) {
    for (int p = 0; p < partitions; p++)
        if (!roam->parts[p].scratch.corners &&
            roam_scratch_create(roam->ground.grid.side_max, &roam->parts[p].scratch) != RESULT_OK)
            return RESULT_MEMORY;
    roam_work_divide(&roam->work, view, partitions);
    for (int32_t i = 0; i < roam->ground.grid.count; i++)
        roam->ground.drawn[i].partition = roam->work.partition_of[i];
    return RESULT_OK;
}

static void count_parts(const Update *u, LodStats *stats) {
    int64_t longest = 0, sum = 0;
    for (int p = 0; p < u->partitions; p++) {
        const Part *part = &u->roam->parts[p];
        stats->vertices_evaluated += part->evaluated;
        stats->splits += part->mesh.splits;
        stats->forced_splits += part->mesh.forced_splits;
        longest = part->time_ns > longest ? part->time_ns : longest;
        sum += part->time_ns;
    }
    stats->partitions = u->partitions;
    stats->balance = sum > 0 ? (double)longest * u->partitions / (double)sum : 0.0;
}

// All parts at one tolerance: as Budget asks.
static Result refine_at(void *user, double tau_px, LodStats *stats) {
    Update *u = user;
    *stats = (LodStats){0};
    u->view = refine_view(u->call->view, tau_px);
    u->triangles_max = ROAM_TRIANGLES_MAX;
    if (budget_may_give_up(&u->roam->budget, tau_px) && u->roam->ground.options.max_triangles < ROAM_TRIANGLES_MAX)
        u->triangles_max = (int32_t)u->roam->ground.options.max_triangles;
    atomic_store_explicit(&u->triangles, 0, memory_order_relaxed);
    jobs_run(u->call->jobs, u->partitions, 1, refine_parts, u);
    for (int p = 0; p < u->partitions; p++)
        if (u->roam->parts[p].stop == ROAM_FAILED)
            return RESULT_MEMORY;
    count_parts(u, stats);
    stats->triangles = atomic_load_explicit(&u->triangles, memory_order_relaxed);
    for (int p = 0; p < u->partitions; p++) // given up half way, perhaps at the very number
        if (u->roam->parts[p].stop == ROAM_FULL)
            stats->triangles = (int64_t)u->triangles_max + 1;
    return RESULT_OK;
}

static Result parallel_update(void *state, const LodCall *call, LodCut *cut) {
    RoamParallel *roam = state;
    int64_t begin = clock_now_ns();
    Update update = {.roam = roam, .call = call, .partitions = partition_count(roam, call->jobs)};
    Result result = divide(roam, call->view, update.partitions);
    int64_t divided = clock_now_ns();
    if (result == RESULT_OK)
        result = budget_refine(&roam->budget, refine_at, &update, cut);
    if (result == RESULT_OK || result == RESULT_BUDGET) {
        cut->stats.triangles = 0; // the items tell
        Result finished = roam_ground_finish(&roam->ground, call, cut);
        result = finished == RESULT_OK ? result : finished;
    }
    if (result != RESULT_OK && result != RESULT_BUDGET) { // the squares' next partitions have other pools
        roam_ground_abandon(&roam->ground);
        return result;
    }
    cut->stats.cut_vertices = roam_seams_count(&roam->seams, roam->ground.drawn);
    cut->stats.select_ns = divided - begin;
    cut->stats.refine_ns = clock_now_ns() - divided;
    roam->work.has_history = true;
    return result;
}

static void parallel_release(void *state, uint64_t frame) {
    RoamParallel *roam = state;
    roam_ground_release(&roam->ground, frame);
}

static void parallel_destroy(void *state) {
    RoamParallel *roam = state;
    for (int p = 0; p < LOD_PARTITIONS_MAX; p++) {
        roam_scratch_destroy(&roam->parts[p].scratch);
        roam_mesh_destroy(&roam->parts[p].mesh);
    }
    free(roam->roots);
    roam_seams_destroy(&roam->seams);
    roam_work_destroy(&roam->work);
    roam_ground_destroy(&roam->ground);
    free(roam);
}

static Result parallel_create(const LodOptions *options, const Terrain *terrain, void **state) {
    RoamParallel *roam = calloc(1, sizeof *roam);
    if (!roam)
        return RESULT_MEMORY;
    roam->budget.max_triangles = options->max_triangles;
    Result result = roam_ground_create(options, terrain, &roam->ground);
    if (result == RESULT_OK)
        result = roam_work_create(&roam->ground, &roam->work);
    if (result == RESULT_OK)
        result = roam_seams_create(&roam->ground.grid, &roam->seams);
    if (result == RESULT_OK) {
        roam->roots = malloc(sizeof *roam->roots * (size_t)roam->ground.grid.count);
        result = roam->roots ? RESULT_OK : RESULT_MEMORY;
    }
    if (result != RESULT_OK) {
        parallel_destroy(roam);
        return result;
    }
    *state = roam;
    return RESULT_OK;
}

const LodOps LOD_ROAM_PARALLEL_OPS = {
    .create = parallel_create,
    .destroy = parallel_destroy,
    .update = parallel_update,
    .release = parallel_release,
};
