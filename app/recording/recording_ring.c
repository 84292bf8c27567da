#include "app/recording/recording_ring.h"

#include "base/log.h"

#include <stdlib.h>
#include <string.h>

#define ENTRIES 2048 // 28 minutes of full chunks; new starts make short ones

struct RecordingRing {
    RecordingRingEntry entries[ENTRIES]; // by number modulo ENTRIES
    int64_t oldest, end;
    size_t capacity, head; // head: where the next chunk goes
    uint8_t *bytes;
};

Result recording_ring_create(size_t bytes, RecordingRing **out) {
    RecordingRing *ring = calloc(1, sizeof *ring);
    if (ring)
        ring->bytes = malloc(bytes);
    if (!ring || !ring->bytes) {
        recording_ring_destroy(&ring);
        log_error("no memory for the last minutes of the flight, %zu bytes", bytes);
        return RESULT_MEMORY;
    }
    ring->capacity = bytes;
    *out = ring;
    return RESULT_OK;
}

void recording_ring_destroy(RecordingRing **ring) {
    if (!*ring)
        return;
    free((*ring)->bytes);
    free(*ring);
    *ring = NULL;
}

int64_t recording_ring_oldest(const RecordingRing *ring) {
    return ring->oldest;
}

int64_t recording_ring_end(const RecordingRing *ring) {
    return ring->end;
}

const RecordingRingEntry *recording_ring_entry(const RecordingRing *ring, int64_t number) {
    return &ring->entries[number % ENTRIES];
}

const uint8_t *recording_ring_bytes(const RecordingRing *ring, const RecordingRingEntry *entry) {
    return ring->bytes + entry->at;
}

static void forget_oldest(RecordingRing *ring) {
    ring->oldest++;
}

// The oldest chunks follow the head: those it runs into go.
static void make_room(RecordingRing *ring, size_t from, size_t to) {
    while (ring->oldest < ring->end) {
        const RecordingRingEntry *oldest = recording_ring_entry(ring, ring->oldest);
        if (oldest->at >= to || oldest->at + oldest->bytes <= from)
            return;
        forget_oldest(ring);
    }
}

void recording_ring_push(RecordingRing *ring, const RecordingChunk *chunk, const uint8_t *bytes, size_t count) {
    if (ring->head + count > ring->capacity) { // chunks are not split; the rest of the room stays empty
        make_room(ring, ring->head, ring->capacity);
        ring->head = 0;
    }
    make_room(ring, ring->head, ring->head + count);
    if (ring->end - ring->oldest == ENTRIES)
        forget_oldest(ring);
    ring->entries[ring->end % ENTRIES] = (RecordingRingEntry){.number = ring->end,
                                                              .first = chunk->first,
                                                              .count = chunk->count,
                                                              .keyframe = chunk->keyframe,
                                                              .at = ring->head,
                                                              .bytes = count};
    memcpy(ring->bytes + ring->head, bytes, count);
    ring->head += count;
    ring->end++;
}

int64_t recording_ring_find(const RecordingRing *ring, uint32_t steps) {
    int64_t found = ring->end;
    if (ring->oldest == ring->end)
        return found;
    const RecordingRingEntry *newest = recording_ring_entry(ring, ring->end - 1);
    uint32_t end = newest->first + (uint32_t)newest->count, wanted = end > steps ? end - steps : 0;
    for (int64_t i = ring->end - 1; i >= ring->oldest; i--) {
        const RecordingRingEntry *entry = recording_ring_entry(ring, i);
        if (!entry->keyframe)
            continue;
        found = i;
        if (entry->first <= wanted)
            break;
    }
    return found;
}
