// app/replay/replay_scene.h: what a recorded flight is flown over again, and with.
// No units.
// The world is the caller's. Main thread.
#pragma once
#include "app/scene_load.h"
#include "config/options.h"

// What the command line names after the track, or after a conversion's two files; else, of a recording, what it was
// flown over: as it was named, where it lay then, or beside the recording; else the default scene. The elevation of a
// recording is read as it was then, but for what the command line says. Errors of world_check_inputs and world_load;
// those of a recording's header; FORMAT, logged: it was read in a way that is not known here.
MUST_USE Result replay_check_scene(const Options *options, const char *track);
MUST_USE Result replay_load_scene(const Options *options, const char *track, World *out);
// As world_visit_files, of what those would load.
MUST_USE Result replay_visit_files(const Options *options, const char *track, WorldVisit *visit, void *user);
// The aircraft that the command line names instead of a recording's own, borrowed from the options; NULL: none. One in
// a file of settings is for flights of one's own.
const char *replay_aircraft(const Options *options);
