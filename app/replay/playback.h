// app/replay/playback.h: a recorded flight, of whatever format, as states of an aircraft at any time of it.
// Seconds from the flight's begin; ECEF metres, radians.
// A Playback owns what it has read; one thread at a time.
#pragma once
#include "app/dynamics/flight_model.h"
#include "app/recording/recording_header.h"
#include "app/recording/recording_replay.h"
#include "app/track/track_format.h"
#include "input/controls.h"

typedef struct PlaybackMoment {
    FlightState state;
    bool only_path; // nothing but where it was and how it was turned
    bool in_gap;    // nothing is known of this time: what is shown is older
    bool derived;   // the attitude was worked out from the path
} PlaybackMoment;

typedef struct Playback Playback;

typedef struct PlaybackOptions {
    TrackReading how;     // its geoid is borrowed
    const char *aircraft; // instead of a recording's own; NULL: that; borrowed as long as the playback lives
    FlightGround ground;  // that recordings are flown over again
    uint64_t dem_hash;    // of that ground
} PlaybackOptions;

// Whether the file is a recording of this program (.ofr), by what it begins with; what cannot be read is not.
bool playback_is_recording(const char *path);
// What a recording says of itself. Errors of recording_reader_open.
MUST_USE Result playback_read_header(const char *path, RecordingHeader *out);

// Errors of track_load, or of recording_reader_open and aircraft_load. What differs from where it was recorded is
// warned of, and a track that is nowhere over the ground.
MUST_USE Result playback_open(const char *path, const PlaybackOptions *options, Playback **out);
void playback_close(Playback **playback);

// What the recording says of itself, the playback's; NULL: it is none.
const RecordingHeader *playback_header(const Playback *playback);
double playback_duration_s(const Playback *playback);
const char *playback_format(const Playback *playback);        // "igc"; "ofr" of recordings; static
const Aircraft *playback_aircraft(const Playback *playback);  // of a recording, the playback's; NULL else
const char *playback_aircraft_name(const Playback *playback); // what aircraft_load found that by; NULL else
Vec3d playback_wind(const Playback *playback);                // velocity of the air, m/s; of a track none
// Before the begin and after the end it stands still. A recording is flown again, to the bit, from at most 10 s before;
// between two steps it is shown in between, except over a jump: a new start.
PlaybackMoment playback_at(Playback *playback, double t_s);
// The same as a state to fly on from: of a recording the last whole step, in a gap of a track as fast as before it.
PlaybackMoment playback_at_step(Playback *playback, double t_s);
// As playback_at_step, for somebody who looks along the flight beside the one who watches it: what that keeps, and
// playback_first_difference, stay as they are.
PlaybackMoment playback_scout(Playback *playback, double t_s);
// What the pilot did in the step that follows, or at the end in the last one. False: no recording, or lost.
bool playback_controls(Playback *playback, double t_s, Controls *out);
// The first step seen so far that was flown otherwise than recorded; -1: none, or no recording.
int64_t playback_first_difference(const Playback *playback);
uint32_t playback_first_step(const Playback *playback); // of a recording, counted from the flight's begin; 0 else
// As recording_reader_events. UNSUPPORTED: no recording.
MUST_USE Result playback_events(Playback *playback, RecordingEvent **out, int *count);
// Flies the whole recording again. UNSUPPORTED: none; else as recording_verify.
MUST_USE Result playback_verify(Playback *playback, RecordingVerdict *out);
// A track of it with a point every `interval_s`, gaps where something is lost or where it begins anew; to be cleared.
// Warns where the flight differs. UNSUPPORTED: no recording; MEMORY; RANGE, logged: more points than tracks have.
MUST_USE Result playback_track(Playback *playback, double interval_s, Track *out);
// The same of a file, which is opened for it. As playback_open and playback_track.
MUST_USE Result playback_load_track(const char *path, const PlaybackOptions *options, double interval_s, Track *out);
