// app/recording/recording_chunk.h: some steps of a flight, and the bytes they are in a file: a header and a zstd frame.
// Steps count from the flight's begin.
// A RecordingCodec owns its buffers; one thread at a time uses it. Same chunk, same bytes.
#pragma once
#include "app/recording/recording_header.h"

#define RECORDING_CHUNK_HEADER_BYTES 20
#define RECORDING_SYNC UINT32_C(0xC35B9E1F) // no text, no zstd magic number

typedef enum RecordingChunkKind { RECORDING_CHUNK_FLIGHT = 1, RECORDING_CHUNK_END = 2 } RecordingChunkKind;
#define RECORDING_CHUNK_KEYFRAME 1u // it begins with the whole state
#define RECORDING_CHUNK_RESTART 2u  // that state does not follow from the steps before: it was set

typedef struct RecordingChunkHeader {
    uint8_t kind;     // RecordingChunkKind
    uint8_t flags;    // RECORDING_CHUNK_KEYFRAME, _RESTART
    uint16_t count;   // steps, 0..RECORDING_CHUNK_STEPS_MAX
    uint32_t first;   // step; of an end the number of steps
    uint32_t payload; // bytes of the frame that follows
} RecordingChunkHeader;

// Its contents in memory.
typedef struct RecordingChunk {
    uint32_t first;
    int count;
    bool keyframe, restart;
    uint64_t hash_before; // the running hash before the first step; only with a keyframe
    uint64_t hash_after;  // the running hash after the last step
    int event_count;
    RecordingEvent events[RECORDING_CHUNK_EVENTS_MAX]; // first <= step <= first + count, in order
    ControlsCode codes[RECORDING_CHUNK_STEPS_MAX];
    uint16_t hashes[RECORDING_CHUNK_STEPS_MAX]; // recording_hash_short after each step
    uint8_t *state; // state_bytes, before the first step: a keyframe's. The owner of the chunk owns it
} RecordingChunk;

typedef struct RecordingCodec RecordingCodec;
// Borrows nothing of the header. `crc`: the file header's. MEMORY.
MUST_USE Result recording_codec_create(const RecordingHeader *header, uint32_t crc, RecordingCodec **out);
void recording_codec_destroy(RecordingCodec **codec);
// Of header and frame together, at most.
size_t recording_codec_bound(const RecordingCodec *codec);

// Header and frame; 0 when the compression failed.
size_t recording_chunk_encode(RecordingCodec *codec, const RecordingChunk *chunk, uint8_t *out, size_t capacity);
// The record that ends a file in good order: so many steps.
void recording_chunk_encode_end(const RecordingCodec *codec, uint32_t steps, uint8_t out[RECORDING_CHUNK_HEADER_BYTES]);

// False: no header, or a damaged one. The payload is not larger than a chunk's may be.
bool recording_chunk_decode_header(const RecordingCodec *codec, const uint8_t bytes[RECORDING_CHUNK_HEADER_BYTES],
                                   RecordingChunkHeader *out);
// `frame`: header->payload bytes. False: damaged, and `chunk` is not to be used. chunk->state has room.
bool recording_chunk_decode(RecordingCodec *codec, const RecordingChunkHeader *header, const uint8_t *frame,
                            RecordingChunk *chunk);
