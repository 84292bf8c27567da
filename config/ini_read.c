#include "config/ini_read.h"

#include "base/log.h"

#include <errno.h>
#include <ini.h>
#include <stdio.h>
#include <string.h>

// libinih does not tell its handler the line, so the reader counts. `broken_line`: too long, or holding a zero byte.
typedef struct Reading {
    FILE *stream;
    const char *path;
    int line, broken_line;
    bool refused;
    IniVisit *visit;
    void *user;
} Reading;

static char *read_line(char *buffer, int size, void *user) {
    Reading *reading = user;
    if (reading->broken_line || reading->refused || !fgets(buffer, size, reading->stream))
        return NULL;
    reading->line++;
    if (!strchr(buffer, '\n') && !feof(reading->stream))
        reading->broken_line = reading->line;
    return buffer;
}

static int visit_entry(void *user, const char *section, const char *name, const char *value) {
    Reading *reading = user;
    if (reading->refused || reading->broken_line)
        return 0;
    IniEntry entry = {reading->path, reading->line, section, name, value};
    reading->refused = !reading->visit(reading->user, &entry);
    return !reading->refused;
}

static Result report_broken(const Reading *reading, int first_bad_line) {
    if (reading->refused)
        return RESULT_FORMAT;
    if (reading->broken_line) {
        log_error("%s:%d: the line is too long or binary; expected 'name = value', a '[section]' or a '# comment'",
                  reading->path, reading->broken_line);
        return RESULT_FORMAT;
    }
    if (first_bad_line > 0) {
        log_error("%s:%d: expected 'name = value', a '[section]' or a '# comment'", reading->path, first_bad_line);
        return RESULT_FORMAT;
    }
    return first_bad_line < 0 ? RESULT_MEMORY : RESULT_OK;
}

Result ini_read(const char *path, IniVisit *visit, void *user) {
    FILE *stream = fopen(path, "r");
    if (!stream)
        return errno == ENOENT || errno == ENOTDIR ? RESULT_NOT_FOUND : RESULT_IO;
    Reading reading = {.stream = stream, .path = path, .visit = visit, .user = user};
    int first_bad_line = ini_parse_stream(read_line, &reading, visit_entry, &reading);
    Result result = ferror(stream) ? RESULT_IO : report_broken(&reading, first_bad_line);
    fclose(stream);
    return result;
}
