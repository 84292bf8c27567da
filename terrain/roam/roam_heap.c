#include "terrain/roam/roam_heap.h"

#include "base/log.h"

#include <stdlib.h>

void roam_heap_destroy(RoamHeap *heap) {
    free(heap->ranked);
    *heap = (RoamHeap){0};
}

static bool is_before(const RoamRanked *a, const RoamRanked *b) {
    return a->priority > b->priority || (a->priority == b->priority && a->triangle < b->triangle);
}

static bool grow(RoamHeap *heap) {
    int32_t larger = heap->capacity < INT32_MAX / 2 ? 2 * heap->capacity + 1024 : INT32_MAX;
    RoamRanked *grown = realloc(heap->ranked, sizeof *grown * (size_t)larger);
    if (!grown) {
        log_error("roam: not enough memory for a queue of %d triangles", larger);
        return false;
    }
    heap->ranked = grown;
    heap->capacity = larger;
    return true;
}

bool roam_heap_push(RoamHeap *heap, double priority, int32_t triangle) {
    if (heap->count == heap->capacity && !grow(heap))
        return false;
    RoamRanked added = {priority, triangle}, *all = heap->ranked;
    int32_t at = heap->count++;
    while (at > 0 && is_before(&added, &all[(at - 1) / 2])) {
        all[at] = all[(at - 1) / 2];
        at = (at - 1) / 2;
    }
    all[at] = added;
    return true;
}

void roam_heap_pop(RoamHeap *heap) {
    RoamRanked *all = heap->ranked, last = all[--heap->count];
    int64_t at = 0, count = heap->count;
    for (int64_t child = 1; child < count; child = 2 * at + 1) {
        child += child + 1 < count && is_before(&all[child + 1], &all[child]);
        if (!is_before(&all[child], &last))
            break;
        all[at] = all[child];
        at = child;
    }
    all[at] = last;
}
