// app/recording/recording_reader.h: a recorded flight, read from its file and checked; what is damaged is known.
// Steps count from the flight's begin, bytes from the file's.
// A RecordingReader owns its file and its memory: 24 bytes a chunk and no more than a file of 100 hours needs. One
// thread at a time uses it.
#pragma once
#include "app/recording/recording_chunk.h"

#define RECORDING_DAMAGES_MAX 256 // that are listed

typedef enum RecordingDamageKind {
    RECORDING_DAMAGED,   // bytes that are no chunk, or fail their checksums
    RECORDING_MISSING,   // steps were never written: the disk was full
    RECORDING_STATELESS, // sound, but no state to begin from: after damage, up to the next keyframe
    RECORDING_CUT_OFF    // the file's last bytes are no whole chunk
} RecordingDamageKind;

typedef struct RecordingDamage {
    RecordingDamageKind kind;
    uint64_t offset, bytes;
    uint32_t first_step, steps; // that cannot be replayed because of it; 0 where nobody knows
} RecordingDamage;
const char *recording_damage_text(RecordingDamageKind kind);

// From a keyframe to the next one.
typedef struct RecordingSegment {
    uint32_t first, known_end; // steps first <= step < known_end can be simulated from the keyframe
    uint32_t end;              // known_end < end: a gap
    int chunk, chunk_end;      // those of the known steps
    bool restart;              // its state was set, not simulated
    bool follows;              // its state is the one after the segment before
} RecordingSegment;

typedef struct RecordingReader RecordingReader;

// Reads and checks the whole file. A damaged or cut-off file opens with what is left of it; what is lost is listed and
// logged (warnings). NOT_FOUND, IO, MEMORY; UNSUPPORTED: another version or kind; FORMAT: no recording, or not one
// keyframe is left. Logged, with file and offset.
MUST_USE Result recording_reader_open(const char *path, RecordingReader **out);
void recording_reader_close(RecordingReader **reader);

const char *recording_reader_path(const RecordingReader *reader);
const RecordingHeader *recording_reader_header(const RecordingReader *reader);
uint32_t recording_reader_first(const RecordingReader *reader);  // step, of the first keyframe
uint32_t recording_reader_end(const RecordingReader *reader);    // after the last step
bool recording_reader_was_closed(const RecordingReader *reader); // else the program was killed, or goes on
// How many there are; `out`: the first RECORDING_DAMAGES_MAX of them, the reader's.
int recording_reader_damages(const RecordingReader *reader, const RecordingDamage **out);

int recording_reader_segment_count(const RecordingReader *reader); // >= 1
const RecordingSegment *recording_reader_segment(const RecordingReader *reader, int index);
// The segment whose keyframe is the nearest at or before the step; 0 for steps before the first.
int recording_reader_segment_at(const RecordingReader *reader, uint32_t step);

// A chunk by its number in the file, decoded, until the next call. IO, FORMAT: the file was changed since; logged.
MUST_USE Result recording_reader_chunk(RecordingReader *reader, int index, const RecordingChunk **out);
// The chunk with this step; -1: lost, or beyond the flight.
int recording_reader_chunk_at(const RecordingReader *reader, uint32_t step);

// All events of the flight, in their order; `out` is to be freed, and NULL where there is none. MEMORY, logged; as
// recording_reader_chunk.
MUST_USE Result recording_reader_events(RecordingReader *reader, RecordingEvent **out, int *count);

typedef struct RecordingStep {
    ControlsCode code;
    uint16_t hash; // recording_hash_short after the step
    bool known;    // else lost; all zero
} RecordingStep;
// Steps first..first+count-1. As recording_reader_chunk.
MUST_USE Result recording_reader_steps(RecordingReader *reader, uint32_t first, uint32_t count, RecordingStep *out);
