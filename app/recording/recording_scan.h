// app/recording/recording_scan.h: a file's bytes through a window of bounded size.
// Bytes from the file's begin.
// A RecordingScan owns its descriptor and its window; one thread at a time uses it.
#pragma once
#include "base/base.h"

#define RECORDING_WINDOW_BYTES 262144

typedef struct RecordingScan {
    const char *path; // borrowed
    int file;
    uint64_t bytes; // of the file, when it was opened
    uint64_t window_at;
    size_t window_count;
    uint8_t *window;
    int error; // errno of the first read that failed; 0
} RecordingScan;

// A regular file. NOT_FOUND, IO, UNSUPPORTED (a folder, a pipe), MEMORY; logged.
MUST_USE Result recording_scan_open(const char *path, RecordingScan *out);
void recording_scan_close(RecordingScan *scan);

// `count` bytes at `at`, count <= RECORDING_WINDOW_BYTES, until the next call; NULL where the file has not so many.
const uint8_t *recording_scan_bytes(RecordingScan *scan, uint64_t at, size_t count);
// Where the four bytes of `sync`, least first, come next, at `at` or later; the file's size when nowhere.
uint64_t recording_scan_find(RecordingScan *scan, uint64_t at, uint32_t sync);
