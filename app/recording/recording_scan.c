#define _POSIX_C_SOURCE 200809L
#include "app/recording/recording_scan.h"

#include "app/recording/recording_bytes.h"
#include "base/log.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define SYNC_BYTES 4

static Result check_kind(RecordingScan *scan) {
    struct stat about;
    if (fstat(scan->file, &about) != 0) {
        log_error("%s: cannot be read: %s", scan->path, strerror(errno));
        return RESULT_IO;
    }
    if (!S_ISREG(about.st_mode)) {
        log_error("%s: a %s, expected a file; copy what it gives into one", scan->path,
                  S_ISDIR(about.st_mode) ? "folder" : "pipe or device");
        return RESULT_UNSUPPORTED;
    }
    scan->bytes = (uint64_t)about.st_size;
    return RESULT_OK;
}

Result recording_scan_open(const char *path, RecordingScan *out) {
    RecordingScan scan = {.path = path, .file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
    if (scan.file < 0) {
        int error = errno;
        log_error("%s: cannot be opened: %s", path, strerror(error));
        return error == ENOENT || error == ENOTDIR ? RESULT_NOT_FOUND : RESULT_IO;
    }
    scan.window = malloc(RECORDING_WINDOW_BYTES);
    Result result = scan.window ? check_kind(&scan) : RESULT_MEMORY;
    if (result == RESULT_OK)
        *out = scan;
    else
        recording_scan_close(&scan);
    return result;
}

void recording_scan_close(RecordingScan *scan) {
    if (scan->file >= 0)
        close(scan->file);
    free(scan->window);
    *scan = (RecordingScan){.file = -1};
}

static bool fill(RecordingScan *scan, uint64_t at) {
    scan->window_at = at;
    scan->window_count = 0;
    while (scan->window_count < RECORDING_WINDOW_BYTES) {
        ssize_t got = pread(scan->file, scan->window + scan->window_count, RECORDING_WINDOW_BYTES - scan->window_count,
                            (off_t)(at + scan->window_count));
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            scan->error = scan->error ? scan->error : errno;
        if (got <= 0)
            break;
        scan->window_count += (size_t)got;
    }
    return scan->window_count > 0;
}

const uint8_t *recording_scan_bytes(RecordingScan *scan, uint64_t at, size_t count) {
    if (at > scan->bytes || count > scan->bytes - at)
        return NULL;
    bool inside = at >= scan->window_at && at + count <= scan->window_at + scan->window_count;
    if (!inside && (!fill(scan, at) || scan->window_count < count))
        return NULL;
    return scan->window + (at - scan->window_at);
}

static size_t available(const RecordingScan *scan, uint64_t at) {
    return (size_t)(scan->window_at + scan->window_count - at);
}

uint64_t recording_scan_find(RecordingScan *scan, uint64_t at, uint32_t sync) {
    uint8_t first = (uint8_t)sync;
    for (;;) {
        const uint8_t *bytes = recording_scan_bytes(scan, at, SYNC_BYTES);
        if (!bytes)
            return scan->bytes;
        size_t places = available(scan, at) - (SYNC_BYTES - 1);
        const uint8_t *found = memchr(bytes, first, places);
        if (found && recording_get32(found) == sync)
            return at + (uint64_t)(found - bytes);
        at += found ? (uint64_t)(found - bytes) + 1 : places;
    }
}
