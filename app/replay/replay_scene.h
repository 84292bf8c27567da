// app/replay/replay_scene.h: what a recorded flight is flown over again, and with.
// No units.
// The world is the caller's. Main thread.
#pragma once
#include "app/scene_load.h"
#include "config/options.h"

// What a replay's command line names after the track; else, of a recording, what it was flown over; else the default
// scene. Errors of world_check_inputs and world_load; those of a recording's header.
MUST_USE Result replay_check_scene(const Options *options, const char *track);
MUST_USE Result replay_load_scene(const Options *options, const char *track, World *out);
// As world_visit_files, of what those would load.
MUST_USE Result replay_visit_files(const Options *options, const char *track, WorldVisit *visit, void *user);
// The aircraft that the command line names instead of a recording's own, borrowed from the options; NULL: none. One in
// a file of settings is for flights of one's own.
const char *replay_aircraft(const Options *options);
