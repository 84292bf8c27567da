// app/replay/replay_events.h: what happened in a recorded flight beside the controls: pauses, rates of time, demos.
// Seconds from the recording's begin.
// A ReplayEvents owns its list. One thread at a time.
#pragma once
#include "app/json.h"
#include "app/replay/playback.h"

typedef struct ReplayEvents {
    RecordingEvent *events; // in their order
    int count;
    uint32_t first_step; // of the recording
    int steps_per_s;
} ReplayEvents;

// None of a track. Errors of playback_events.
MUST_USE Result replay_events_read(Playback *playback, ReplayEvents *out);
void replay_events_clear(ReplayEvents *events);
// An array "events": step, time, what it was, and of a rate of time that.
void replay_events_add(const ReplayEvents *events, Json *parent);
// One line that begins with `label`; the first ones, where there are many; no line where there is none.
void replay_events_print(const ReplayEvents *events, const char *label);
