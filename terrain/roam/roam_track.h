// terrain/roam/roam_track.h: keep a mesh what a build from scratch would give, frame after frame, by looking only at
// the triangles whose vertex the eye may have come near enough to change.
// As terrain/roam/roam_mesh.h.
// A RoamTrack owns its queue; one thread at a time.
//
// Source: Duchaineau et al. 1997, sections 5 and 6.3 (split and merge queues; priorities looked at only when they can
// have come to matter). Our own: the time to look again is a length of path flown, |nu delta + r - d|, in the manner of
// Loeffler's sphere of validity.
#pragma once
#include "terrain/roam/roam_queue.h"
#include "terrain/roam/roam_refine.h"

typedef struct RoamTrack {
    RoamQueue queue;
    bool holds; // the mesh is that of `view`, and all that can change waits in the queue
    RefineView view;
    int32_t *work; // [work_capacity] triangles to look at now
    int32_t work_count, work_capacity;
} RoamTrack;

void roam_track_destroy(RoamTrack *track);

// Splits what is active in refiner->view and merges what is not. FULL: the pool can not hold it; the mesh is sound, and
// its triangles are of no particular view. Unless DONE, `holds` is false.
RoamStop roam_track_update(RoamTrack *track, RoamRefiner *refiner);
