// tests/track_support.h: texts as files of tracks, for tests of their readers.
// As in app/track/track.h.
// Files are the process's own in its folder, and gone when the call returns; tracks are the caller's.
#pragma once
#include "app/track/track_format.h"

// As track_load of a file with this text and ending (".igc").
Result track_of_text(const char *text, size_t bytes, const char *ending, const TrackReading *how, Track *out);
// `track` written in this format, as text that the caller frees.
char *text_of_track(const Track *track, const char *ending, const Geoid *geoid, size_t *bytes);
// The program's own geoid; fails the test where it cannot be opened.
Geoid *track_geoid(void);

// An aircraft that turns, climbs, rolls and passes midnight: `count` points a second apart from 2023-12-31T23:59:30Z.
Track track_aerobatic(int count);
