// terrain/roam/roam_heap.h: a queue by priority, the highest first.
// Priorities in pixels, or their negatives.
// A RoamHeap owns its memory and keeps it from frame to frame; one thread at a time.
#pragma once
#include "base/base.h"

typedef struct RoamRanked {
    double priority;
    int32_t triangle;
} RoamRanked;

typedef struct RoamHeap {
    RoamRanked *ranked;
    int32_t count, capacity;
} RoamHeap;

void roam_heap_destroy(RoamHeap *heap);
// False when memory is out. Equal priorities: the smaller triangle first.
MUST_USE bool roam_heap_push(RoamHeap *heap, double priority, int32_t triangle);
void roam_heap_pop(RoamHeap *heap); // not empty; the first is ranked[0]
