// tests/recording_wrap.h: makes checksums of damaged recordings right, so that what lies behind them is tried too.
// Bytes.
// Works in the caller's buffers.
#pragma once
#include "app/recording/recording_bytes.h"
#include "app/recording/recording_chunk.h"
#include "app/recording/recording_zstd.h"

#include <string.h>

#define WRAP_TEXT_AT 16 // of the file's header

// The header's checksum, and those of all chunks that begin with the sync word, in a file's bytes.
static inline void wrap_correct(uint8_t *bytes, size_t count) {
    if (count < WRAP_TEXT_AT + 4)
        return;
    size_t text = recording_get32(bytes + 12);
    if (text > count - WRAP_TEXT_AT - 4)
        return;
    uint32_t crc = recording_crc32(0, bytes, WRAP_TEXT_AT + text);
    recording_put32(bytes + WRAP_TEXT_AT + text, crc);
    for (size_t i = WRAP_TEXT_AT + text + 4; i + RECORDING_CHUNK_HEADER_BYTES <= count; i++)
        if (recording_get32(bytes + i) == RECORDING_SYNC)
            recording_put32(bytes + i + 16, recording_crc32(crc, bytes + i, 16));
}

// A chunk of any contents, rightly compressed; bytes written, or 0.
static inline size_t wrap_chunk(RecordingZstd *zstd, uint32_t crc, RecordingChunkHeader header, const uint8_t *content,
                                size_t count, uint8_t *out, size_t capacity) {
    size_t payload =
        capacity < RECORDING_CHUNK_HEADER_BYTES
            ? 0
            : recording_zstd_compress(zstd, &(RecordingSpan){content, count}, 1, out + RECORDING_CHUNK_HEADER_BYTES,
                                      capacity - RECORDING_CHUNK_HEADER_BYTES);
    if (payload == 0)
        return 0;
    recording_put32(out, RECORDING_SYNC);
    out[4] = header.kind;
    out[5] = header.flags;
    recording_put16(out + 6, header.count);
    recording_put32(out + 8, header.first);
    recording_put32(out + 12, (uint32_t)payload);
    recording_put32(out + 16, recording_crc32(crc, out, 16));
    return RECORDING_CHUNK_HEADER_BYTES + payload;
}
