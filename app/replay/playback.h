// app/replay/playback.h: a recorded flight, of whatever format, as states of an aircraft at any time of it.
// Seconds from the flight's begin; ECEF metres, radians.
// A Playback owns what it has read; one thread at a time.
#pragma once
#include "app/flight/flight_model.h"
#include "app/track/track_format.h"
#include "input/controls.h"

typedef struct PlaybackMoment {
    FlightState state;
    bool only_path; // nothing but where it was and how it was turned
    bool in_gap;    // nothing is known of this time: what is shown is older
    bool derived;   // the attitude was worked out from the path
} PlaybackMoment;

typedef struct Playback Playback;

// Errors of track_load. `how` is borrowed for the call, its geoid as long as the Playback lives.
MUST_USE Result playback_open(const char *path, const TrackReading *how, Playback **out);
void playback_close(Playback **playback);

double playback_duration_s(const Playback *playback);
const char *playback_format(const Playback *playback); // "igc"; static
// Before the begin and after the end it stands still.
PlaybackMoment playback_at(Playback *playback, double t_s);
