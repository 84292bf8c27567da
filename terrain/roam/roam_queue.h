// terrain/roam/roam_queue.h: triangles waiting until the eye has flown far enough to matter to them.
// Keys in ticks of path flown, ROAM_TICKS_PER_M a metre; they count up.
// A RoamQueue owns its table; one thread at a time.
//
// Sources: Duchaineau et al. 1997, section 6.3 (deferred priorities); Ahuja et al. 1990 (radix heap: keys only grow, so
// each entry moves at most 32 times, whatever the number of entries).
#pragma once
#include "base/base.h"

#define ROAM_TICKS_PER_M 64
#define ROAM_TICKS_MAX (UINT32_C(1) << 31)
#define ROAM_QUEUE_BUCKETS 33

typedef struct RoamWaiting {
    int32_t next, previous; // in its bucket; `previous` of the first names the bucket
    uint32_t key;
} RoamWaiting;

typedef struct RoamQueue {
    uint32_t now;
    int32_t first[ROAM_QUEUE_BUCKETS]; // [0]: what is due; [b]: keys whose highest bit that differs from now's is b - 1
    RoamWaiting *waiting;              // [capacity], by triangle
    int32_t capacity;
} RoamQueue;

void roam_queue_destroy(RoamQueue *queue);
// Empties the queue, at tick 0.
void roam_queue_clear(RoamQueue *queue);
// Room for triangles 0 .. count - 1; what waits stays. MEMORY.
MUST_USE Result roam_queue_reserve(RoamQueue *queue, int32_t count);

// The triangle waits for `key` > now, and for nothing else any more.
void roam_queue_put(RoamQueue *queue, int32_t triangle, uint32_t key);
void roam_queue_drop(RoamQueue *queue, int32_t triangle); // waiting or not
void roam_queue_advance(RoamQueue *queue, uint32_t now);  // now: not less than before
// Some triangle whose key is not above now, which waits no longer; negative: none.
int32_t roam_queue_take(RoamQueue *queue);
