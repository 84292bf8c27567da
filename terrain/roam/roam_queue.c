#include "terrain/roam/roam_queue.h"

#include "base/log.h"

#include <stdlib.h>

#define NONE (-1)
#define BUCKET(b) (-2 - (b)) // as `previous` of the first; its own inverse

void roam_queue_destroy(RoamQueue *queue) {
    free(queue->waiting);
    *queue = (RoamQueue){0};
}

void roam_queue_clear(RoamQueue *queue) {
    queue->now = 0;
    for (int b = 0; b < ROAM_QUEUE_BUCKETS; b++)
        queue->first[b] = NONE;
    for (int32_t i = 0; i < queue->capacity; i++)
        queue->waiting[i].previous = NONE;
}

Result roam_queue_reserve(RoamQueue *queue, int32_t count) {
    if (count <= queue->capacity)
        return RESULT_OK;
    RoamWaiting *grown = realloc(queue->waiting, sizeof *grown * (size_t)count);
    if (!grown) {
        log_error("roam: not enough memory for the queue of %d triangles", count);
        return RESULT_MEMORY;
    }
    for (int32_t i = queue->capacity; i < count; i++)
        grown[i].previous = NONE;
    queue->waiting = grown;
    queue->capacity = count;
    return RESULT_OK;
}

static void insert(RoamQueue *queue, int bucket, int32_t triangle) {
    RoamWaiting *w = &queue->waiting[triangle];
    w->next = queue->first[bucket];
    w->previous = BUCKET(bucket);
    if (w->next >= 0)
        queue->waiting[w->next].previous = triangle;
    queue->first[bucket] = triangle;
}

static int bucket_of(const RoamQueue *queue, uint32_t key) {
    return key <= queue->now ? 0 : 32 - __builtin_clz(key ^ queue->now);
}

void roam_queue_drop(RoamQueue *queue, int32_t triangle) {
    if (triangle >= queue->capacity || queue->waiting[triangle].previous == NONE)
        return;
    RoamWaiting *w = &queue->waiting[triangle];
    if (w->previous >= 0)
        queue->waiting[w->previous].next = w->next;
    else
        queue->first[BUCKET(w->previous)] = w->next;
    if (w->next >= 0)
        queue->waiting[w->next].previous = w->previous;
    w->previous = NONE;
}

void roam_queue_put(RoamQueue *queue, int32_t triangle, uint32_t key) {
    roam_queue_drop(queue, triangle);
    queue->waiting[triangle].key = key;
    insert(queue, bucket_of(queue, key), triangle);
}

static void sort_again(RoamQueue *queue, int bucket) {
    int32_t triangle = queue->first[bucket];
    queue->first[bucket] = NONE;
    while (triangle >= 0) {
        int32_t next = queue->waiting[triangle].next;
        insert(queue, bucket_of(queue, queue->waiting[triangle].key), triangle);
        triangle = next;
    }
}

void roam_queue_advance(RoamQueue *queue, uint32_t now) {
    if (now == queue->now)
        return;
    int highest = 32 - __builtin_clz(now ^ queue->now); // buckets above keep their highest differing bit
    queue->now = now;
    for (int b = 1; b <= highest; b++)
        sort_again(queue, b);
}

int32_t roam_queue_take(RoamQueue *queue) {
    int32_t triangle = queue->first[0];
    if (triangle >= 0)
        roam_queue_drop(queue, triangle);
    return triangle;
}
