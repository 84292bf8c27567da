// app/track/track_lines.h: the lines of a text file, one after another, in memory that does not grow.
// Bytes; lines are counted from 1.
// A TrackLines owns its file; a line lives until the next one is read. One thread.
#pragma once
#include "base/base.h"
#include "base/log.h"

#include <stdio.h>

#define TRACK_LINE_BYTES 4096 // a line and its end

typedef struct TrackLines {
    const char *path; // borrowed
    FILE *file;
    int64_t number;              // of the line
    char text[TRACK_LINE_BYTES]; // without its end, LF or CR LF, and without a byte order mark
    bool cut;                    // the line was longer than fits, or holds a zero byte: this is its beginning
    bool ended;                  // with a line end, not with the file
    size_t at, filled;           // of the block
    int64_t read_bytes, file_bytes;
    Progress progress;
    char block[1 << 16];
} TrackLines;

// NOT_FOUND, IO; FORMAT for a folder. Logged.
MUST_USE Result track_lines_open(const char *path, TrackLines *out);
void track_lines_close(TrackLines *lines);
// To the first line again. IO: the file is a pipe.
MUST_USE Result track_lines_rewind(TrackLines *lines);
// False at the end, and when reading fails, which is logged and told by track_lines_failed.
bool track_lines_next(TrackLines *lines);
bool track_lines_failed(const TrackLines *lines);
