// app/flight/flight_recorder.h: a flight as it is flown, recorded step by step: the last ten minutes always, all of it
// in a file where one was asked for; and a simulation for recordings that are flown again.
// Steps of FLIGHT_STEP_S.
// A FlightRecorder owns its writer; it borrows nothing for longer than a call. One thread.
#pragma once
#include "app/dynamics/flight_model.h"
#include "app/recording/recording_header.h"
#include "app/recording/recording_replay.h"
#include "app/recording/recording_writer.h"
#include "app/scene_load.h"
#include "config/options.h"

// Of FlightState, as flight_state_pack has it: another number where its bytes or the model change their meaning, so
// that older recordings are told and not flown wrong.
#define FLIGHT_STATE_LAYOUT UINT64_C(1)
#define RECORDER_MESSAGE_BYTES 160

typedef struct FlightRecorder FlightRecorder;

// What is flown.
typedef struct RecordedFlight {
    const Flight *flight;
    const char *aircraft; // what aircraft_load finds it by
} RecordedFlight;

// What a replay needs to know of where and what is flown.
void flight_recording_header(const World *world, const RecordedFlight *flown, RecordingHeader *out);

uint64_t flight_recording_aircraft_hash(const Aircraft *aircraft);
// The wind that a recording was flown in; none where it says nothing.
void flight_recording_weather(const RecordingHeader *header, Flight *flight);

// Whether there is a recording in a file already, and the name that it is kept under when another is written: with a ~.
bool recorder_keeps(const char *path, char out[PATHS_BYTES_MAX]);
// --record: the file, what was in it being kept; else memory only. Borrows nothing afterwards. IO, logged: it cannot be
// kept; errors of recording_writer_create.
MUST_USE Result recorder_create(const World *world, const Options *options, const RecordedFlight *flown,
                                FlightRecorder **out);
// Finishes the file. IO: not all of the flight is in it; logged.
MUST_USE Result recorder_close(FlightRecorder **recorder);

// One step, flown with what the recording keeps of the controls: so that it can be flown again exactly.
void recorder_fly(FlightRecorder *recorder, Flight *flight, const Controls *controls);
// The state was set, not flown.
void recorder_restart(FlightRecorder *recorder, RecordingEventKind why, const Flight *flight);
// What happened between two steps beside the controls; `data` may be NULL for no bytes.
void recorder_event(FlightRecorder *recorder, RecordingEventKind kind, const void *data, size_t bytes);
// The last ten minutes to a new file in the folder for recordings; says in `message` where, or why not.
void recorder_save(FlightRecorder *recorder, char message[RECORDER_MESSAGE_BYTES]);
// What a person should know since the last call: the file is written, or cannot be; "" else.
void recorder_news(FlightRecorder *recorder, char message[RECORDER_MESSAGE_BYTES]);
// Where frames do not wait for the clock, after each: a disk that is too slow is waited for before what it has not
// taken yet leaves the memory.
void recorder_wait(FlightRecorder *recorder);
const char *recorder_path(const FlightRecorder *recorder); // of --record; NULL
uint32_t recorder_steps(const FlightRecorder *recorder);
uint64_t recorder_hash(const FlightRecorder *recorder); // running, as replays compare it

// The simulation of a flight for RecordingSim: `flight` has its aircraft and ground, and gets the states.
RecordingSim flight_sim(Flight *flight);
