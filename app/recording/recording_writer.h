// app/recording/recording_writer.h: records a flight as it goes: the last ten minutes in memory, all of it in a file.
// Steps count from the flight's begin.
// A RecordingWriter owns its memory, its file and the thread that writes. One thread, the simulation's, uses it; no
// function but _create, _wait and _close waits for a disk.
#pragma once
#include "app/recording/recording_header.h"

typedef struct RecordingWriter RecordingWriter;

// `path`: the file, written anew; NULL: memory only. `state`: state_bytes, before the first step. `header` is copied.
// RANGE: state_bytes; MEMORY; NOT_FOUND or IO: the file cannot be created or written, logged with the cause.
MUST_USE Result recording_writer_create(const RecordingHeader *header, const char *path, const void *state,
                                        RecordingWriter **out);
// Writes what is left and the end; waits for the disk. IO: not all of the flight is in the file (logged when it was
// noticed, and what is missing here). The writer is gone in any case.
MUST_USE Result recording_writer_close(RecordingWriter **writer);

// One fixed step: what the simulation was fed with, its state's hash and the state itself, after the step. The state is
// borrowed for the call, and may be NULL where recording_writer_wants_state says no. A chunk is compressed every
// RECORDING_CHUNK_STEPS; usually nothing is allocated. After RECORDING_STEPS_MAX nothing more is recorded (logged
// once).
void recording_writer_step(RecordingWriter *writer, ControlsCode code, uint64_t state_hash, const void *state);
// Whether the state after the coming step is a keyframe: every 10 s.
bool recording_writer_wants_state(const RecordingWriter *writer);
// Before the coming step; a replay gets it there again. Of one kind the last before a step counts. `bytes` <=
// RECORDING_EVENT_DATA_MAX; data may be NULL for none.
void recording_writer_event(RecordingWriter *writer, RecordingEventKind kind, const void *data, size_t bytes);
// The state was set, not simulated: a new start, another place. `kind` tells why; it follows the state in the file.
void recording_writer_restart(RecordingWriter *writer, RecordingEventKind kind, const void *state);

// The last ten minutes (up to 10 s more, or all there is) as a file of their own, beginning with a keyframe; written by
// the thread. It replaces what is there only when it is complete. BUDGET: the one before is not written yet; RANGE:
// nothing is recorded yet; MEMORY. Logged.
typedef enum RecordingSaving {
    RECORDING_SAVING_NOTHING,
    RECORDING_SAVING_GOES_ON,
    RECORDING_SAVING_DONE,
    RECORDING_SAVING_FAILED // logged with the cause
} RecordingSaving;
MUST_USE Result recording_writer_save(RecordingWriter *writer, const char *path);
RecordingSaving recording_writer_saving(RecordingWriter *writer); // what became of the last one

// Until all whole chunks are in the file, or it cannot be written. Who flies faster than time calls it every ten
// minutes of flight, as more than these may not be kept; who flies in time never does.
void recording_writer_wait(RecordingWriter *writer);
// True while the file cannot be written: for a message. What is not in the file yet is tried again with each chunk, and
// lost when it has left the memory.
bool recording_writer_failed(RecordingWriter *writer);
uint32_t recording_writer_steps(const RecordingWriter *writer); // so far
uint64_t recording_writer_hash(const RecordingWriter *writer);  // running, after the last step
uint64_t recording_writer_file_bytes(RecordingWriter *writer);  // written so far
