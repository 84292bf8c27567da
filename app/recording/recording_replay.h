// app/recording/recording_replay.h: flies a recording again: the simulation is fed with its inputs, and its states'
// hashes are compared with the recorded ones, step by step. Steps count from the flight's begin. The simulation is
// borrowed, through callbacks. Deterministic as far as it is. One thread.
#pragma once
#include "app/recording/recording_reader.h"

// A simulation. Its state is opaque: what recording_writer_step was given.
typedef struct RecordingSim {
    void *user;
    uint32_t state_bytes;
    uint64_t state_layout;
    bool (*load)(void *user, const void *state); // false: no state to fly on from (files may hold anything)
    void (*save)(void *user, void *state);       // as it was loaded, or is after the steps since
    void (*step)(void *user, const Controls *controls);
    uint64_t (*hash)(void *user);                           // of the state
    void (*event)(void *user, const RecordingEvent *event); // before a step; NULL: they change nothing
} RecordingSim;

typedef struct RecordingVerdict {
    uint32_t steps;                // simulated and compared
    uint32_t steps_missing;        // of the flight, because of damage
    uint64_t hash, expected_hash;  // running, after the last step
    bool equal;                    // no step differs
    int64_t first_difference_step; // -1: none
    double realtime_factor;        // seconds of flight in a second
} RecordingVerdict;

// Re-simulates everything that is known, from the first keyframe on. A gap and a restart begin anew from their state.
// UNSUPPORTED: recorded with states of another size or layout; FORMAT: a state was refused; IO. Logged; a difference is
// not an error.
MUST_USE Result recording_verify(RecordingReader *reader, const RecordingSim *sim, RecordingVerdict *out);

// ---- the steps of both, verification and player ----

MUST_USE Result recording_sim_check(const RecordingReader *reader, const RecordingSim *sim);

typedef struct RecordingRun {
    const RecordingSim *sim;
    uint64_t hash;            // running, of what is simulated
    int64_t first_difference; // the smallest step that differed; -1
} RecordingRun;

// Loads the state of a chunk with a keyframe. FORMAT: it was refused; logged.
MUST_USE Result recording_run_begin(RecordingRun *run, const RecordingReader *reader, const RecordingChunk *chunk);
// The chunk's step `k`, 0..count-1.
void recording_run_step(RecordingRun *run, const RecordingChunk *chunk, int k);
