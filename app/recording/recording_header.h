// app/recording/recording_header.h: what a recording says of itself before its steps: format, columns, environment.
// UTF-8 text, a line a key.
// Values; nothing owned. Any thread.
#pragma once
#include "app/recording/recording.h"

#define RECORDING_VALUE_BYTES 1024 // with the ending zero
#define RECORDING_TEXT_BYTES_MAX 16384
#define RECORDING_HEADER_BYTES_MAX (RECORDING_TEXT_BYTES_MAX + 20)

// X(identifier, key, what it tells): a replay elsewhere needs the same.
#define RECORDING_KEY_TABLE(X)                                                                                         \
    X(PROGRAM, "program", "name and version")                                                                          \
    X(START_UTC, "start_utc", "when the flight began, ISO 8601")                                                       \
    X(SCENE, "scene", "its file or name, or the elevation files, with | between")                                      \
    X(FOLDER, "folder", "where the program was started: what relative names start from")                               \
    X(DEM, "dem", "the elevation model's file")                                                                        \
    X(DEM_HASH, "dem_hash", "of its heights")                                                                          \
    X(DATUM, "datum", "what its heights were taken to be above, as --datum; empty: not known how it was read")         \
    X(VOIDS, "voids", "what became of samples without data, as --voids")                                               \
    X(SPACING, "spacing", "metres, as --spacing; empty: not given")                                                    \
    X(BOUNDS, "bounds", "degrees, as --bounds; empty: not given")                                                      \
    X(AIRCRAFT, "aircraft", "its file or name")                                                                        \
    X(AIRCRAFT_HASH, "aircraft_hash", "of its figures")                                                                \
    X(WEATHER, "weather", "wind, turbulence, air")

typedef enum RecordingKey {
#define RECORDING_KEY_ENUM(id, key, what) RECORDING_##id,
    RECORDING_KEY_TABLE(RECORDING_KEY_ENUM) RECORDING_KEY_COUNT
#undef RECORDING_KEY_ENUM
} RecordingKey;
const char *recording_key_name(RecordingKey key); // "dem_hash"

typedef struct RecordingHeader {
    int steps_per_s;       // 1..1000
    int chunk_steps;       // 1..RECORDING_CHUNK_STEPS_MAX: of a full chunk
    uint32_t state_bytes;  // 1..RECORDING_STATE_BYTES_MAX
    uint64_t state_layout; // whose bytes: differs where a simulation cannot load the states
    char environment[RECORDING_KEY_COUNT][RECORDING_VALUE_BYTES]; // "" where nothing is known
} RecordingHeader;

// For flights of this program. An empty environment.
RecordingHeader recording_header_create(uint32_t state_bytes, uint64_t state_layout);
// Control characters become spaces; what is too long ends in "...".
void recording_header_set(RecordingHeader *header, RecordingKey key, const char *format, ...) PRINTF_LIKE(3, 4);
// The first key from `from` on whose value differs; RECORDING_KEY_COUNT when there is none.
RecordingKey recording_header_difference(const RecordingHeader *a, const RecordingHeader *b, RecordingKey from);

// Whether a file that begins with these bytes is a recording, sound or not.
#define RECORDING_MAGIC_BYTES 8
bool recording_is_one(const uint8_t begin[RECORDING_MAGIC_BYTES]);
// The bytes a file begins with; their number. `crc`: the last four of them, which every chunk's checksum goes on from.
size_t recording_header_encode(const RecordingHeader *header, uint8_t out[RECORDING_HEADER_BYTES_MAX], uint32_t *crc);
// From the first `count` bytes of `file`, which names it in messages. FORMAT: no recording, damaged, or cut off;
// UNSUPPORTED: another version, or other columns. Logged.
MUST_USE Result recording_header_decode(const char *file, const uint8_t *bytes, size_t count, RecordingHeader *out,
                                        size_t *header_bytes, uint32_t *crc);
