// terrain/roam/roam_track.c: Duchaineau et al. 1997, sections 5 and 6.3: incremental splits and merges, with deferred
// priorities. With nested errors the order of splits and merges does not matter: they end at the one mesh that has all
// active vertices and no others.
#include "terrain/roam/roam_track.h"

#include "base/log.h"

#include <math.h>
#include <stdlib.h>

// Rounding of a distance in double, and then some.
#define SLACK_M 1e-6

void roam_track_destroy(RoamTrack *track) {
    roam_queue_destroy(&track->queue);
    free(track->work);
    *track = (RoamTrack){0};
}

typedef struct Pass {
    RoamTrack *track;
    RoamRefiner *refiner;
    RoamStop stop;
} Pass;

static void push_work(Pass *p, int32_t triangle) {
    RoamTrack *track = p->track;
    if (track->work_count == track->work_capacity) {
        int32_t larger = 2 * track->work_capacity + 1024;
        int32_t *grown = realloc(track->work, sizeof *grown * (size_t)larger);
        if (!grown) {
            log_error("roam: not enough memory for %d triangles to look at", larger);
            p->stop = ROAM_FAILED;
            return;
        }
        track->work = grown;
        track->work_capacity = larger;
    }
    track->work[track->work_count++] = triangle;
}

// The triangle is looked at again once the eye has flown as far as the gap.
static void wait_for(Pass *p, int32_t triangle, double gap) {
    RoamQueue *queue = &p->track->queue;
    double ticks = (fabs(gap) * GRID_LATTICE_M - SLACK_M) * ROAM_TICKS_PER_M;
    if (ticks >= (double)ROAM_TICKS_MAX) // before that all are looked at anew
        return roam_queue_drop(queue, triangle);
    uint32_t wait = ticks >= 1.0 ? (uint32_t)ticks : 1;
    roam_queue_put(queue, triangle, queue->now + wait);
}

static void split(Pass *p, int32_t triangle) {
    RoamMesh *mesh = p->refiner->mesh;
    if (!roam_mesh_has_room(mesh, triangle)) {
        p->stop = ROAM_FULL;
        return;
    }
    if (!roam_mesh_split(mesh, triangle) || roam_queue_reserve(&p->track->queue, mesh->capacity) != RESULT_OK) {
        p->stop = ROAM_FAILED;
        return;
    }
    for (int i = 0; i < mesh->journal_count; i++) { // the halves are looked at first
        int32_t t = mesh->journal[i], child = mesh->triangles[t].child;
        roam_queue_drop(&p->track->queue, t);
        push_work(p, t);
        push_work(p, child + 1);
        push_work(p, child);
    }
}

static void leave_whole(Pass *p, int32_t triangle, int32_t child, double gap) {
    RoamMesh *mesh = p->refiner->mesh;
    roam_queue_drop(&p->track->queue, child);
    roam_queue_drop(&p->track->queue, child + 1);
    wait_for(p, triangle, gap);
    if (mesh->triangles[triangle].parent >= 0)
        push_work(p, mesh->triangles[triangle].parent);
}

static void merge(Pass *p, int32_t triangle, int32_t partner, double gap) {
    RoamMesh *mesh = p->refiner->mesh;
    int32_t child = mesh->triangles[triangle].child, across = partner < 0 ? 0 : mesh->triangles[partner].child;
    roam_mesh_merge(mesh, triangle, partner);
    leave_whole(p, triangle, child, gap);
    if (partner >= 0)
        leave_whole(p, partner, across, gap);
}

static void look_at_leaf(Pass *p, int32_t triangle) {
    const RoamTriangle *t = &p->refiner->mesh->triangles[triangle];
    if (roam_is_finest(p->refiner, t))
        return;
    double gap = roam_gap(p->refiner, t);
    if (gap > 0.0)
        split(p, triangle);
    else
        wait_for(p, triangle, gap);
}

// Of a diamond's two triangles the one with the smaller index waits.
static void look_at_split(Pass *p, int32_t triangle) {
    RoamMesh *mesh = p->refiner->mesh;
    int32_t partner;
    if (!roam_mesh_can_merge(mesh, triangle, &partner))
        return;
    double gap = roam_gap(p->refiner, &mesh->triangles[triangle]);
    if (!(gap > 0.0) && !p->refiner->failed)
        merge(p, triangle, partner, gap);
    else
        wait_for(p, partner >= 0 && partner < triangle ? partner : triangle, gap);
}

// Any triangle may be looked at, any number of times.
static void look_at(Pass *p, int32_t triangle) {
    push_work(p, triangle);
    RoamTrack *track = p->track;
    while (track->work_count && p->stop == ROAM_DONE) {
        int32_t t = track->work[--track->work_count];
        const RoamTriangle *at = &p->refiner->mesh->triangles[t];
        if (roam_is_gone(at))
            continue;
        if (roam_is_leaf(at))
            look_at_leaf(p, t);
        else
            look_at_split(p, t);
    }
}

static void look_at_all(Pass *p) {
    RoamQueue *queue = &p->track->queue;
    roam_queue_clear(queue);
    if (roam_queue_reserve(queue, p->refiner->mesh->capacity) != RESULT_OK)
        p->stop = ROAM_FAILED;
    for (int32_t t = 0; t < p->refiner->mesh->used && p->stop == ROAM_DONE; t++)
        look_at(p, t);
}

static void look_at_due(Pass *p, uint32_t ticks) {
    RoamQueue *queue = &p->track->queue;
    roam_queue_advance(queue, queue->now + ticks);
    for (int32_t t = roam_queue_take(queue); t >= 0 && p->stop == ROAM_DONE; t = roam_queue_take(queue))
        look_at(p, t);
}

static double distance_between(const RefineView *a, const RefineView *b) {
    return vec3d_distance(vec3d(a->eye[0], a->eye[1], a->eye[2]), vec3d(b->eye[0], b->eye[1], b->eye[2]));
}

RoamStop roam_track_update(RoamTrack *track, RoamRefiner *refiner) {
    Pass pass = {track, refiner, ROAM_DONE};
    double flown_m = distance_between(&track->view, &refiner->view) * GRID_LATTICE_M;
    double ticks = ceil((flown_m + SLACK_M) * ROAM_TICKS_PER_M);
    track->work_count = 0;
    if (!track->holds || track->view.nu != refiner->view.nu || ticks + track->queue.now >= (double)ROAM_TICKS_MAX)
        look_at_all(&pass);
    else if (flown_m > 0.0)
        look_at_due(&pass, (uint32_t)ticks);
    if (refiner->failed)
        pass.stop = ROAM_FAILED;
    track->holds = pass.stop == ROAM_DONE;
    track->view = refiner->view;
    return pass.stop;
}
