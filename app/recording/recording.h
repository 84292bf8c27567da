// app/recording/recording.h: what a recording of a flight (.ofr) is made of: inputs as codes, events, running hashes.
// Steps count from the flight's begin; shares of full deflection, as in input/controls.h; docs/recording.md has bytes.
// Values; nothing owned. Any thread.
#pragma once
#include "base/base.h"
#include "input/controls.h"

#define RECORDING_VERSION 1
#define RECORDING_STEPS_PER_S 120
// Shorter than a second by the time that writing may take: a killed program loses at most the last second.
#define RECORDING_CHUNK_STEPS 100
#define RECORDING_KEYFRAME_STEPS 1200    // 10 s: a whole number of chunks
#define RECORDING_KEPT_STEPS (600 * 120) // 10 minutes, always in memory
#define RECORDING_STATE_BYTES_MAX 65536  // of one simulation state
#define RECORDING_STEPS_MAX 43200000     // 100 h; what lies beyond is not read
#define RECORDING_CHUNK_STEPS_MAX 1024   // in a file
#define RECORDING_EVENT_DATA_MAX 64      // bytes
#define RECORDING_CHUNK_EVENTS_MAX 32    // more begin another chunk

// X(field of Controls, field's name, least, greatest, codes per unit). 4096: twice as many positions as a sensor of 12
// bits tells, 0.006 degrees of an elevator that moves by 25. Powers of two: full deflection, centre and halves are
// exact. 240: so are halves, thirds, quarters, fifths.
#define RECORDING_WIDE_TABLE(X)                                                                                        \
    X(elevator, "elevator", -1.0, 1.0, 4096)                                                                           \
    X(aileron, "aileron", -1.0, 1.0, 4096)                                                                             \
    X(rudder, "rudder", -1.0, 1.0, 2048)                                                                               \
    X(throttle, "throttle", 0.0, 1.0, 2048)                                                                            \
    X(trim, "trim", -1.0, 1.0, 8192)
#define RECORDING_NARROW_TABLE(X)                                                                                      \
    X(flaps, "flaps", 0.0, 1.0, 240)                                                                                   \
    X(brake_left, "brake_left", 0.0, 1.0, 240)                                                                         \
    X(brake_right, "brake_right", 0.0, 1.0, 240)
#define RECORDING_WIDE_COUNT 5
#define RECORDING_NARROW_COUNT 4 // the last one is the bits

#define RECORDING_BIT_GEAR_UP 1u

// Controls as they are recorded, 14 bytes. The same code always gives the same controls, bit for bit.
typedef struct ControlsCode {
    int16_t elevator, aileron, rudder, throttle, trim;
    uint8_t flaps, brake_left, brake_right;
    uint8_t bits;
} ControlsCode;

// The nearest code; beyond the range its end, and what is no number is 0. A simulation that is to replay exactly must
// be fed with recording_controls of it, never with the controls themselves. The difference is at most half a code.
ControlsCode recording_quantise(const Controls *controls);
Controls recording_controls(ControlsCode code);

// X(identifier, code in the file, name): what happens between two steps. Data: of a time rate the rate, as the bits of
// a double; none of the others. 7 was of a wind, and never written.
#define RECORDING_EVENT_TABLE(X)                                                                                       \
    X(RESET, 1, "reset")                                                                                               \
    X(PAUSE, 2, "pause")                                                                                               \
    X(RESUME, 3, "resume")                                                                                             \
    X(TAKE_OVER, 4, "take-over")                                                                                       \
    X(DEMO_ON, 5, "demo-on")                                                                                           \
    X(DEMO_OFF, 6, "demo-off")                                                                                         \
    X(TIME_RATE, 8, "time-rate")

typedef enum RecordingEventKind {
#define RECORDING_EVENT_ENUM(id, code, name) RECORDING_EVENT_##id = (code),
    RECORDING_EVENT_TABLE(RECORDING_EVENT_ENUM)
#undef RECORDING_EVENT_ENUM
} RecordingEventKind;

typedef struct RecordingEvent {
    uint32_t step; // it happened before this step
    uint8_t kind;  // RecordingEventKind; others are of newer programs
    uint8_t bytes;
    uint8_t data[RECORDING_EVENT_DATA_MAX];
} RecordingEvent;
const char *recording_event_name(int kind); // "pause"; "unknown"

// The running hash after a step: of the one before and the state's own. For one state's hash it is a bijection of the
// running hash, so that a difference, once there, stays. mix: SplitMix64's, G. Steele, D. Lea, C. Flood, "Fast
// splittable pseudorandom number generators", OOPSLA 2014, figure 17, with Stafford's variant 13.
#define RECORDING_HASH_BEGIN UINT64_C(0x4F766572666C7921)
uint64_t recording_hash_next(uint64_t running, uint64_t state_hash);
// What is kept of it for each step.
uint16_t recording_hash_short(uint64_t running);

// "1:02:03" of steps.
#define RECORDING_TIME_BYTES 24
const char *recording_time_text(uint64_t steps, int steps_per_s, char out[RECORDING_TIME_BYTES]);
