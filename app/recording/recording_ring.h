// app/recording/recording_ring.h: the last chunks of a flight as the bytes they have in a file, in bounded memory.
// Bytes, steps.
// A RecordingRing owns a copy of each chunk. One thread at a time uses it: its user locks.
#pragma once
#include "app/recording/recording_chunk.h"

typedef struct RecordingRing RecordingRing;

typedef struct RecordingRingEntry {
    int64_t number; // of the chunk: 0, 1, 2 ...
    uint32_t first;
    int count;
    bool keyframe;
    size_t at, bytes; // in the ring
} RecordingRingEntry;

// Room for `bytes`, of which the largest chunk takes at most a quarter. MEMORY.
MUST_USE Result recording_ring_create(size_t bytes, RecordingRing **out);
void recording_ring_destroy(RecordingRing **ring);

// Forgets the oldest where there is no room.
void recording_ring_push(RecordingRing *ring, const RecordingChunk *chunk, const uint8_t *bytes, size_t count);
// Numbers kept: oldest <= number < end.
int64_t recording_ring_oldest(const RecordingRing *ring);
int64_t recording_ring_end(const RecordingRing *ring);
// A kept chunk; its bytes stay until the next push.
const RecordingRingEntry *recording_ring_entry(const RecordingRing *ring, int64_t number);
const uint8_t *recording_ring_bytes(const RecordingRing *ring, const RecordingRingEntry *entry);

// The latest chunk with a keyframe that begins `steps` before the end or earlier; else the oldest one with a keyframe;
// recording_ring_end when there is none.
int64_t recording_ring_find(const RecordingRing *ring, uint32_t steps);
