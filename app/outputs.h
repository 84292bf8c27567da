// app/outputs.h: that nothing is written over what a command reads.
// Files are compared by device and inode, whatever their names.
// Owns nothing. Main thread.
#pragma once
#include "config/options.h"

// Before anything is written: whether `file`, which need not be there, is one that the command reads: a flight, a demo,
// a scene and what it names, elevation, the picture over it, the geoid, an aircraft, and what a recording was flown
// over. `what` is what asks for the file in messages ("--screenshot"). USAGE, logged; errors of reading a scene or a
// recording's header.
MUST_USE Result outputs_check(const Options *options, const char *what, const char *file);
// The same of all the files of a folder whose names begin with one of `begins`, which ends with NULL.
MUST_USE Result outputs_check_folder(const Options *options, const char *what, const char *folder,
                                     const char *const *begins);
