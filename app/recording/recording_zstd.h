// app/recording/recording_zstd.h: zstd frames (RFC 8878) with checksum and content size.
// Bytes.
// A RecordingZstd owns its contexts; one thread at a time uses it.
#pragma once
#include "base/base.h"

typedef struct RecordingZstd RecordingZstd;
typedef struct RecordingSpan {
    const void *bytes;
    size_t count;
} RecordingSpan;

// `usual`: bytes of content of the largest frame among any hundred. Up to there compressing allocates nothing. MEMORY.
MUST_USE Result recording_zstd_create(size_t usual, RecordingZstd **out);
void recording_zstd_destroy(RecordingZstd **zstd);

// The most that a frame of `count` bytes in `spans` parts takes.
size_t recording_zstd_bound(size_t count, int spans);
// One frame of all spans; each is a block of its own, so that what cannot be compressed spoils no statistics of what
// can. The number of bytes written; 0: it did not fit, or the library failed.
size_t recording_zstd_compress(RecordingZstd *zstd, const RecordingSpan *spans, int count, void *out, size_t capacity);
// Exactly one frame, that says its content's size and has a checksum, which is verified. False otherwise, and when it
// is more than `capacity`; then `out` may have been written to. Memory does not depend on what the frame claims.
bool recording_zstd_decompress(RecordingZstd *zstd, const void *bytes, size_t count, void *out, size_t capacity,
                               size_t *out_count);
