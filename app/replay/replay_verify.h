// app/replay/replay_verify.h: whether a recording, flown again here, is the same flight, step by step.
// Steps of the recording.
// Borrows its options. Main thread.
#pragma once
#include "app/json.h"
#include "app/replay/playback.h"
#include "config/options.h"

// Flies the whole recording again without drawing, and prints what came of it, as JSON with --json. FORMAT where a step
// differs; USAGE: no recording; errors of replay_load_scene and playback_open.
MUST_USE Result replay_verify(const Options *options, const char *track);
