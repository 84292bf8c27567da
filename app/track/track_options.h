// app/track/track_options.h: how the command line asks for a track to be read.
// As in app/track/track_format.h.
// A TrackReading borrows the options' texts and the geoid.
#pragma once
#include "app/track/track_format.h"
#include "config/options.h"

// What --igc-alt and --object say.
TrackReading track_reading_of(const Options *options, const Geoid *geoid);
// Warns of those that the command line has, but that change nothing of this file. `format` NULL: a recording.
void track_warn_of_unused(const Options *options, const char *path, const TrackFormat *format);
