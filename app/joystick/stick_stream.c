#define _POSIX_C_SOURCE 200809L
#include "app/joystick/stick_stream.h"

#include "app/joystick/joystick_files.h"
#include "base/log.h"
#include "input/hid/hid_descriptor.h"
#include "input/mapper.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINE_BYTES 2048
#define REPORT_BYTES 64 // of a report, at most
#define TAIL_S 1.0      // after the last report
#define BLANKS " \t\r\n"

typedef struct Report {
    double t_s;
    uint8_t bytes[REPORT_BYTES];
    uint8_t count;
} Report;

struct StickStream {
    HidDescriptor descriptor;
    PadInfo info;
    PadProfile profile;
    bool has_profile;
    Report *reports;
    int count, capacity;
    // Of the flight.
    Mapper mapper;
    Keyboard keyboard; // that nobody touches
    PadState state;
    int next;
    double t_s;
};

typedef struct Reading {
    const char *path;
    int line;
    uint8_t descriptor[HID_DESCRIPTOR_BYTES_MAX];
    size_t descriptor_bytes;
    bool has_device;
} Reading;

static Result refuse(const Reading *reading, const char *expected) {
    log_error("%s:%d: expected %s", reading->path, reading->line, expected);
    return RESULT_FORMAT;
}

// Pairs of hexadecimal digits with blanks between them; false for anything else, and for more than `most`.
static bool read_bytes(const char *text, uint8_t *out, size_t most, size_t *count) {
    for (*count = 0; *(text += strspn(text, BLANKS)); text += 2) {
        if (!isxdigit((unsigned char)text[0]) || !isxdigit((unsigned char)text[1]) || *count == most)
            return false;
        char pair[3] = {text[0], text[1], '\0'};
        out[(*count)++] = (uint8_t)strtoul(pair, NULL, 16);
    }
    return *count > 0;
}

// ---- lines ----

static Result read_device(Reading *reading, StickStream *stream, const char *rest) {
    unsigned vendor, product;
    int length = 0;
    if (sscanf(rest, "%4x:%4x %n", &vendor, &product, &length) != 2 || length == 0)
        return refuse(reading, "'device VENDOR:PRODUCT NAME', as device 046d:c215 Logitech Extreme 3D");
    stream->info.vendor = (uint16_t)vendor;
    stream->info.product = (uint16_t)product;
    snprintf(stream->info.name, sizeof stream->info.name, "%.*s", (int)strcspn(rest + length, "\r\n"), rest + length);
    reading->has_device = true;
    return RESULT_OK;
}

static Result read_descriptor(Reading *reading, const char *rest) {
    size_t count;
    if (!read_bytes(rest, reading->descriptor + reading->descriptor_bytes,
                    sizeof reading->descriptor - reading->descriptor_bytes, &count))
        return refuse(reading, "'descriptor BYTES', in hexadecimal with blanks, at most 4096 in all");
    reading->descriptor_bytes += count;
    return RESULT_OK;
}

static bool reserve(StickStream *stream) {
    if (stream->count < stream->capacity)
        return true;
    int capacity = stream->capacity ? 2 * stream->capacity : 1024;
    Report *grown = realloc(stream->reports, (size_t)capacity * sizeof *grown);
    if (!grown)
        return false;
    stream->reports = grown;
    stream->capacity = capacity;
    return true;
}

static Result read_report(const Reading *reading, StickStream *stream, const char *line) {
    char *rest;
    Report report = {.t_s = strtod(line, &rest)};
    double before_s = stream->count ? stream->reports[stream->count - 1].t_s : 0.0;
    size_t count;
    if (rest == line || !isfinite(report.t_s) || report.t_s < before_s ||
        !read_bytes(rest, report.bytes, REPORT_BYTES, &count))
        return refuse(reading, "'SECONDS BYTES', no earlier than the line before, at most 64 bytes in hexadecimal");
    report.count = (uint8_t)count;
    if (stream->count == STICK_STREAM_REPORTS_MAX)
        return refuse(reading, "at most 1000000 reports");
    if (!reserve(stream)) {
        log_error("%s: no memory for %d reports", reading->path, stream->count);
        return RESULT_MEMORY;
    }
    stream->reports[stream->count++] = report;
    return RESULT_OK;
}

static Result read_line(Reading *reading, StickStream *stream, char *line) {
    line[strcspn(line, "#")] = '\0';
    line += strspn(line, BLANKS);
    if (*line == '\0')
        return RESULT_OK;
    if (strncmp(line, "device ", 7) == 0)
        return read_device(reading, stream, line + 7);
    if (strncmp(line, "descriptor ", 11) == 0)
        return read_descriptor(reading, line + 11);
    return read_report(reading, stream, line);
}

static Result read_lines(Reading *reading, FILE *file, StickStream *stream) {
    char line[LINE_BYTES];
    for (reading->line = 1; fgets(line, sizeof line, file); reading->line++) {
        bool whole = strchr(line, '\n') || feof(file);
        Result result = whole ? read_line(reading, stream, line) : refuse(reading, "a line of at most 2047 bytes");
        if (result != RESULT_OK)
            return result;
    }
    return ferror(file) ? RESULT_IO : RESULT_OK;
}

// ---- the whole ----

static Result complete(const Reading *reading, StickStream *stream) {
    char profile[PATHS_BYTES_MAX];
    if (!reading->has_device || reading->descriptor_bytes == 0 || stream->count == 0) {
        log_error("%s: expected a device, its descriptor, and reports; found %s", reading->path,
                  !reading->has_device         ? "no device"
                  : !reading->descriptor_bytes ? "no descriptor"
                                               : "no report");
        return RESULT_FORMAT;
    }
    Result result = hid_descriptor_parse(reading->descriptor, reading->descriptor_bytes, &stream->descriptor);
    if (result == RESULT_UNSUPPORTED) {
        log_error("%s: the descriptor is of no stick or gamepad", reading->path);
        return RESULT_FORMAT;
    }
    if (result != RESULT_OK)
        return result;
    hid_describe(&stream->descriptor, &stream->info);
    stream->has_profile = joystick_find_profile(&stream->info, &stream->profile, profile) == RESULT_OK;
    return RESULT_OK;
}

static Result read_file(const char *path, StickStream *stream) {
    FILE *file = fopen(path, "r");
    if (!file) {
        int error = errno;
        log_error("%s: cannot be opened: %s", path, strerror(error));
        return error == ENOENT ? RESULT_NOT_FOUND : RESULT_IO;
    }
    Reading *reading = calloc(1, sizeof *reading);
    Result result = reading ? RESULT_OK : RESULT_MEMORY;
    if (result == RESULT_OK) {
        reading->path = path;
        result = read_lines(reading, file, stream);
    }
    if (result == RESULT_IO)
        log_error("%s: cannot be read: %s", path, strerror(errno));
    if (result == RESULT_OK)
        result = complete(reading, stream);
    free(reading);
    fclose(file);
    return result;
}

Result stick_stream_read(const char *path, StickStream **out) {
    StickStream *stream = calloc(1, sizeof *stream);
    Result result = stream ? read_file(path, stream) : RESULT_MEMORY;
    if (result == RESULT_MEMORY)
        log_error("%s: no memory for the reports of a stick", path);
    if (result == RESULT_OK)
        *out = stream;
    else
        stick_stream_destroy(&stream);
    return result;
}

void stick_stream_destroy(StickStream **stream) {
    if (!*stream)
        return;
    free((*stream)->reports);
    free(*stream);
    *stream = NULL;
}

// ---- in flight ----

void stick_stream_begin(StickStream *stream, const Controls *controls) {
    stream->keyboard = keyboard_create(controls->throttle);
    stream->keyboard.controls = *controls;
    stream->state = pad_at_rest();
    stream->next = 0;
    stream->t_s = 0.0;
    mapper_init(&stream->mapper);
    mapper_connect(&stream->mapper, 0, &stream->info, stream->has_profile ? &stream->profile : NULL, NULL);
}

Controls stick_stream_sample(StickStream *stream, double dt_s) {
    for (; stream->next < stream->count && stream->reports[stream->next].t_s <= stream->t_s + 1e-9; stream->next++) {
        const Report *report = &stream->reports[stream->next];
        if (hid_report_decode(&stream->descriptor, report->bytes, report->count, &stream->state))
            mapper_report(&stream->mapper, 0, &stream->state, &stream->keyboard);
    }
    stream->t_s += dt_s;
    return mapper_sample(&stream->mapper, &stream->keyboard, dt_s);
}

double stick_stream_duration_s(const StickStream *stream) {
    return stream->reports[stream->count - 1].t_s + TAIL_S;
}

bool stick_stream_is_over(const StickStream *stream) {
    return stream->t_s >= stick_stream_duration_s(stream) - 1e-6;
}
