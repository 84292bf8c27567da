// app/recording/recording_disk.h: appending to a recording's file, and putting it aside whole.
// Bytes.
// A RecordingDisk owns its descriptor and the copy of its path; one thread at a time uses it. Its calls may wait long.
#pragma once
#include "base/base.h"

typedef struct RecordingDisk {
    char *path;
    int file;       // -1: none
    uint64_t bytes; // whole records so far
} RecordingDisk;

// A new, empty file. NOT_FOUND, IO, MEMORY; logged.
MUST_USE Result recording_disk_open(RecordingDisk *disk, const char *path);
// All or nothing, as far as the disk allows: a part is cut off again. False: errno tells why; nothing is logged.
bool recording_disk_append(RecordingDisk *disk, const void *bytes, size_t count);
// The contents are on the disk afterwards; what has no such thing (a pipe) is well.
bool recording_disk_sync(const RecordingDisk *disk);
bool recording_disk_close(RecordingDisk *disk);

// A whole file, under its name only when it is complete and on the disk. IO, MEMORY, NOT_FOUND; logged.
MUST_USE Result recording_disk_write_whole(const char *path, const void *bytes, size_t count);
