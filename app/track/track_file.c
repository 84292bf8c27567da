#define _POSIX_C_SOURCE 200809L
#include "app/track/track.h"

#include "base/log.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define LINE_BYTES 4096
#define CELLS_MAX 256

enum { T, LAT, LON, ALT, HEADING, PITCH, COLUMN_COUNT };

typedef struct Column {
    const char *name;
    double least, greatest;
} Column;
static const Column COLUMNS[COLUMN_COUNT] = {{"t_s", -1e12, 1e12},       {"lat_deg", -90, 90},
                                             {"lon_deg", -540, 540},     {"alt_m", -20000, 1e9},
                                             {"heading_deg", -720, 720}, {"pitch_deg", -90, 90}};

typedef struct Reader {
    const char *path;
    FILE *file;
    int64_t line;
    int place[COLUMN_COUNT]; // of the columns in a line; -1: not there
    Track *track;
    int capacity;
} Reader;

static Result refuse(const Reader *r, const char *expected) {
    log_error("%s:%lld: %s", r->path, (long long)r->line, expected);
    return RESULT_FORMAT;
}

static char *trimmed(char *text) {
    text += strspn(text, " \t\"");
    size_t length = strlen(text);
    while (length > 0 && strchr(" \t\r\n\"", text[length - 1]))
        text[--length] = '\0';
    return text;
}

// The next line that is no comment and not empty; false at the end. FORMAT in `result`: longer than any should be.
static bool next_line(Reader *r, char line[LINE_BYTES], Result *result) {
    while (fgets(line, LINE_BYTES, r->file)) {
        r->line++;
        if (!strchr(line, '\n') && !feof(r->file)) {
            *result = refuse(r, "a line of more than 4095 bytes; expected a line of numbers separated by commas");
            return false;
        }
        const char *text = line + strspn(line, " \t\r\n");
        if (*text && *text != '#')
            return true;
    }
    return false;
}

// Cuts the line at its commas.
static int cut_cells(char *line, char *cells[CELLS_MAX]) {
    int count = 0;
    for (char *next = line; next && count < CELLS_MAX; count++) {
        char *comma = strchr(next, ',');
        if (comma)
            *comma++ = '\0';
        cells[count] = trimmed(next);
        next = comma;
    }
    return count;
}

static Result read_names(Reader *r, char *line) {
    char *cells[CELLS_MAX];
    char *text = strncmp(line, "\xEF\xBB\xBF", 3) == 0 ? line + 3 : line; // the byte order mark of some editors
    int count = cut_cells(text, cells);
    for (int c = 0; c < COLUMN_COUNT; c++) {
        r->place[c] = -1;
        for (int i = 0; i < count; i++)
            if (strcmp(cells[i], COLUMNS[c].name) == 0)
                r->place[c] = i;
    }
    bool whole = r->place[T] >= 0 && r->place[LAT] >= 0 && r->place[LON] >= 0 && r->place[ALT] >= 0;
    if (whole && (r->place[HEADING] >= 0) == (r->place[PITCH] >= 0))
        return RESULT_OK;
    return refuse(r, "expected the columns t_s,lat_deg,lon_deg,alt_m, and heading_deg,pitch_deg or neither");
}

static bool read_number(const char *text, const Column *column, double *out) {
    char *end;
    *out = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(*out) && *out >= column->least && *out <= column->greatest;
}

static Result refuse_cell(const Reader *r, int column, const char *found) {
    log_error("%s:%lld: %s: found '%s', expected a number from %g to %g", r->path, (long long)r->line,
              COLUMNS[column].name, found, COLUMNS[column].least, COLUMNS[column].greatest);
    return RESULT_FORMAT;
}

static Result read_cells(const Reader *r, char *line, double numbers[COLUMN_COUNT]) {
    char *cells[CELLS_MAX];
    int count = cut_cells(line, cells);
    for (int c = 0; c < COLUMN_COUNT; c++) {
        numbers[c] = 0.0;
        const char *cell = r->place[c] < 0 ? "0" : r->place[c] < count ? cells[r->place[c]] : "";
        if (!read_number(cell, &COLUMNS[c], &numbers[c]))
            return refuse_cell(r, c, cell);
    }
    return RESULT_OK;
}

static Result grow(Reader *r) {
    if (r->track->count < r->capacity)
        return RESULT_OK;
    if (r->capacity >= TRACK_POINTS_MAX)
        return refuse(r, "more than 4000000 points; expected a shorter flight");
    int capacity = r->capacity ? 2 * r->capacity : 1024;
    capacity = capacity < TRACK_POINTS_MAX ? capacity : TRACK_POINTS_MAX;
    TrackPoint *points = realloc(r->track->points, sizeof *points * (size_t)capacity);
    if (!points) {
        log_error("%s: no memory for %d points", r->path, capacity);
        return RESULT_MEMORY;
    }
    r->track->points = points;
    r->capacity = capacity;
    return RESULT_OK;
}

static Result add_point(Reader *r, char *line) {
    double n[COLUMN_COUNT];
    Result result = read_cells(r, line, n);
    if (result != RESULT_OK)
        return result;
    Track *track = r->track;
    if (track->count > 0 && n[T] <= track->points[track->count - 1].t_s) {
        log_error("%s:%lld: t_s: found %g after %g, expected time to go on", r->path, (long long)r->line, n[T],
                  track->points[track->count - 1].t_s);
        return RESULT_FORMAT;
    }
    result = grow(r);
    if (result == RESULT_OK)
        track->points[track->count++] = (TrackPoint){n[T], {n[LAT], n[LON], n[ALT], n[HEADING], n[PITCH]}};
    return result;
}

// Where no directions are told: to the next point, and at the end as before.
static void look_along(Track *track) {
    for (int i = 0; i + 1 < track->count; i++)
        track_look(&track->points[i].at, &track->points[i + 1].at, &track->points[i].at.heading_deg,
                   &track->points[i].at.pitch_deg);
    if (track->count < 2)
        return;
    const Viewpoint *before = &track->points[track->count - 2].at;
    track->points[track->count - 1].at.heading_deg = before->heading_deg;
    track->points[track->count - 1].at.pitch_deg = before->pitch_deg;
}

static Result read_all(Reader *r) {
    char line[LINE_BYTES];
    Result result = RESULT_OK;
    if (!next_line(r, line, &result))
        return result != RESULT_OK ? result : refuse(r, "the file is empty; expected a line of column names");
    result = read_names(r, line);
    while (result == RESULT_OK && next_line(r, line, &result))
        result = add_point(r, line);
    if (result == RESULT_OK && ferror(r->file)) {
        log_error("%s: reading failed: %s", r->path, strerror(errno));
        return RESULT_IO;
    }
    if (result == RESULT_OK && r->track->count == 0)
        return refuse(r, "no points; expected a line of numbers for each");
    if (result == RESULT_OK && r->place[HEADING] < 0)
        look_along(r->track);
    return result;
}

static void name_after(const char *path, char out[TRACK_NAME_BYTES]) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    int length = dot && dot > name ? (int)(dot - name) : (int)strlen(name);
    snprintf(out, TRACK_NAME_BYTES, "%.*s", length, name);
}

Result track_read(const char *path, Track *out) {
    Track track = {0};
    Reader reader = {.path = path, .file = fopen(path, "r"), .track = &track};
    if (!reader.file) {
        log_error("%s: the flight cannot be opened: %s", path, strerror(errno));
        return errno == ENOENT ? RESULT_NOT_FOUND : RESULT_IO;
    }
    struct stat about;
    bool folder = fstat(fileno(reader.file), &about) == 0 && S_ISDIR(about.st_mode);
    if (folder)
        log_error("%s: a folder; expected a CSV file of a flight", path);
    Result result = folder ? RESULT_FORMAT : read_all(&reader);
    fclose(reader.file);
    if (result != RESULT_OK) {
        track_clear(&track);
        return result;
    }
    name_after(path, track.name);
    *out = track;
    return RESULT_OK;
}

bool track_write(const Track *track, FILE *to) {
    bool taken = fputs("t_s,lat_deg,lon_deg,alt_m,heading_deg,pitch_deg\r\n", to) >= 0;
    for (int i = 0; i < track->count && taken; i++) {
        const Viewpoint *at = &track->points[i].at;
        taken = fprintf(to, "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\r\n", track->points[i].t_s, at->lat_deg, at->lon_deg,
                        at->alt_m, at->heading_deg, at->pitch_deg) > 0;
    }
    return taken;
}
