#define _POSIX_C_SOURCE 200809L
#include "app/track/track_lines.h"

#include "base/log.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

Result track_lines_open(const char *path, TrackLines *out) {
    struct stat about;
    out->path = path;
    out->number = out->read_bytes = out->file_bytes = 0;
    out->at = out->filled = 0;
    out->cut = out->ended = false;
    out->progress = progress_begin("read the flight");
    out->file = fopen(path, "rb");
    if (!out->file) {
        log_error("%s: the flight cannot be opened: %s", path, strerror(errno));
        return errno == ENOENT ? RESULT_NOT_FOUND : RESULT_IO;
    }
    bool known = fstat(fileno(out->file), &about) == 0;
    out->file_bytes = known ? about.st_size : 0;
    if (!known || !S_ISDIR(about.st_mode))
        return RESULT_OK;
    log_error("%s: a folder; expected the file of a flight", path);
    track_lines_close(out);
    return RESULT_FORMAT;
}

void track_lines_close(TrackLines *lines) {
    progress_end(&lines->progress);
    if (lines->file)
        fclose(lines->file);
    lines->file = NULL;
}

Result track_lines_rewind(TrackLines *lines) {
    if (fseek(lines->file, 0, SEEK_SET) != 0) {
        log_error("%s: cannot be read twice: %s; save it as a file", lines->path, strerror(errno));
        return RESULT_IO;
    }
    lines->number = lines->read_bytes = 0;
    lines->at = lines->filled = 0;
    return RESULT_OK;
}

static bool fill(TrackLines *lines) {
    lines->at = 0;
    lines->filled = fread(lines->block, 1, sizeof lines->block, lines->file);
    lines->read_bytes += (int64_t)lines->filled;
    if (lines->file_bytes > 0)
        progress_update(&lines->progress, fmin((double)lines->read_bytes / (double)lines->file_bytes, 1.0));
    if (ferror(lines->file))
        log_error("%s:%lld: reading failed: %s", lines->path, (long long)lines->number, strerror(errno));
    return lines->filled > 0;
}

// What fits of `count` bytes.
static void take(TrackLines *lines, size_t *length, size_t count) {
    size_t room = TRACK_LINE_BYTES - 1 - *length, fits = count < room ? count : room;
    memcpy(lines->text + *length, lines->block + lines->at, fits);
    *length += fits;
    lines->cut |= fits < count;
}

static void finish(TrackLines *lines, size_t length) {
    if (length > 0 && lines->text[length - 1] == '\r')
        length--;
    lines->text[length] = '\0';
    lines->cut |= memchr(lines->text, '\0', length) != NULL;
    if (lines->number == 1 && strncmp(lines->text, "\xEF\xBB\xBF", 3) == 0)
        memmove(lines->text, lines->text + 3, length - 2);
}

bool track_lines_next(TrackLines *lines) {
    size_t length = 0;
    if (lines->at == lines->filled && !fill(lines))
        return false;
    lines->number++;
    lines->cut = lines->ended = false;
    do {
        char *end = memchr(lines->block + lines->at, '\n', lines->filled - lines->at);
        size_t count = end ? (size_t)(end - lines->block) - lines->at : lines->filled - lines->at;
        take(lines, &length, count);
        lines->at += count + (end != NULL);
        lines->ended = end != NULL;
    } while (!lines->ended && fill(lines));
    finish(lines, length);
    return !ferror(lines->file);
}

bool track_lines_failed(const TrackLines *lines) {
    return ferror(lines->file) != 0;
}
