#include "app/track/track_attitude.h"
#include "app/track/track_build.h"
#include "app/track/track_formats_internal.h"
#include "app/track/track_lines.h"
#include "base/log.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CELLS_MAX 256

enum { T, LAT, LON, ALT, HEADING, PITCH, BANK, GAP, DERIVED, UNIX, COLUMN_COUNT };

typedef struct Column {
    const char *name;
    double least, greatest;
} Column;
static const Column COLUMNS[COLUMN_COUNT] = {
    {"t_s", -1e12, 1e12},       {"lat_deg", -90, 90},
    {"lon_deg", -540, 540},     {"alt_m", TRACK_DEPTH_MIN_M, TRACK_HEIGHT_MAX_M},
    {"heading_deg", -720, 720}, {"pitch_deg", -90, 90},
    {"bank_deg", -720, 720},    {"gap", 0, 1},
    {"derived", 0, 1},          {"unix_s", -1e12, 1e12}};

typedef struct Reader {
    TrackBuild build;
    TrackLines lines;
    int place[COLUMN_COUNT]; // of the columns in a line; -1: not there
} Reader;

static Result refuse(const Reader *r, const char *expected) {
    log_error("%s:%lld: %s", r->lines.path, (long long)r->lines.number, expected);
    return RESULT_FORMAT;
}

static char *trimmed(char *text) {
    text += strspn(text, " \t\"");
    size_t length = strlen(text);
    while (length > 0 && strchr(" \t\r\n\"", text[length - 1]))
        text[--length] = '\0';
    return text;
}

// Whether the file breaks off in this line, which is then all that it costs.
static bool is_cut_off(Reader *r) {
    if (r->lines.ended || r->build.track->count == 0)
        return false;
    track_build_skip(&r->build, TRACK_SKIP_MALFORMED, r->lines.number);
    log_warn("%s:%lld: the file is cut off here; points before it, which are kept: %d", r->lines.path,
             (long long)r->lines.number, r->build.track->count);
    return true;
}

// The next line that is no comment and not empty; false at the end. FORMAT in `result`: longer than any should be.
static bool next_line(Reader *r, Result *result) {
    while (track_lines_next(&r->lines)) {
        if (r->lines.cut && is_cut_off(r))
            break;
        if (r->lines.cut) {
            *result = refuse(r, "a line of more than 4095 bytes, or with a zero byte; expected a line of numbers "
                                "separated by commas");
            return false;
        }
        const char *text = r->lines.text + strspn(r->lines.text, " \t\r");
        if (*text && *text != '#')
            return true;
    }
    *result = track_lines_failed(&r->lines) ? RESULT_IO : RESULT_OK;
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

#define FOUND_BYTES 160

// The cells as they were, as far as there is room.
static void join_cells(char *const *cells, int count, char out[FOUND_BYTES]) {
    int used = 0;
    out[0] = '\0';
    for (int i = 0; i < count && used < FOUND_BYTES; i++)
        used += snprintf(out + used, (size_t)(FOUND_BYTES - used), "%s%s", i ? "," : "", cells[i]);
    if (used >= FOUND_BYTES)
        memcpy(out + FOUND_BYTES - 4, "...", 4);
}

static Result refuse_names(const Reader *r, char *const *cells, int count) {
    char found[FOUND_BYTES];
    join_cells(cells, count, found);
    log_error(
        "%s:%lld: expected the columns t_s,lat_deg,lon_deg,alt_m, and heading_deg,pitch_deg or neither, and maybe "
        "bank_deg,gap,derived,unix_s; found %s",
        r->lines.path, (long long)r->lines.number, found);
    return RESULT_FORMAT;
}

static Result read_names(Reader *r) {
    char *cells[CELLS_MAX];
    int count = cut_cells(r->lines.text, cells);
    for (int c = 0; c < COLUMN_COUNT; c++) {
        r->place[c] = -1;
        for (int i = 0; i < count; i++)
            if (strcmp(cells[i], COLUMNS[c].name) == 0)
                r->place[c] = i;
    }
    bool whole = r->place[T] >= 0 && r->place[LAT] >= 0 && r->place[LON] >= 0 && r->place[ALT] >= 0;
    if (whole && (r->place[HEADING] >= 0) == (r->place[PITCH] >= 0))
        return RESULT_OK;
    return refuse_names(r, cells, count);
}

static bool read_number(const char *text, const Column *column, double *out) {
    return track_read_number(text, out) && *out >= column->least && *out <= column->greatest;
}

static Result refuse_cell(const Reader *r, int column, const char *found) {
    log_error("%s:%lld: %s: found '%s', expected a number from %g to %g", r->lines.path, (long long)r->lines.number,
              COLUMNS[column].name, found, COLUMNS[column].least, COLUMNS[column].greatest);
    return RESULT_FORMAT;
}

// The first column without a number of its own, whose cell is `found`, and whether it is the line's last, or is not
// there at all; -1: none.
static int read_cells(Reader *r, double numbers[COLUMN_COUNT], const char **found, bool *last) {
    char *cells[CELLS_MAX];
    int count = cut_cells(r->lines.text, cells);
    for (int c = 0; c < COLUMN_COUNT; c++) {
        numbers[c] = 0.0;
        *found = r->place[c] < 0 ? "0" : r->place[c] < count ? cells[r->place[c]] : "";
        *last = r->place[c] >= count - 1;
        if (!read_number(*found, &COLUMNS[c], &numbers[c]))
            return c;
    }
    return -1;
}

static Result add_point(Reader *r) {
    double n[COLUMN_COUNT];
    const char *found;
    bool last;
    int wrong = read_cells(r, n, &found, &last);
    if (wrong >= 0)
        return last && is_cut_off(r) ? RESULT_OK : refuse_cell(r, wrong, found);
    Track *track = r->build.track;
    if (track->count > 0 && n[T] <= track->points[track->count - 1].t_s) {
        log_error("%s:%lld: t_s: found %g after %g, expected time to go on", r->lines.path, (long long)r->lines.number,
                  n[T], track->points[track->count - 1].t_s);
        return RESULT_FORMAT;
    }
    if (track->count == 0 && r->place[UNIX] >= 0)
        track->start_unix_s = n[UNIX];
    bool gap = n[GAP] != 0.0 && track->count > 0, derived = n[DERIVED] != 0.0 && r->place[HEADING] >= 0;
    TrackPoint point = {.t_s = n[T],
                        .at = {n[LAT], n[LON], n[ALT], n[HEADING], n[PITCH]},
                        .bank_deg = n[BANK],
                        .flags = (gap ? TRACK_GAP : 0U) | (derived ? TRACK_DERIVED : 0U)};
    return track_build_add(&r->build, r->lines.number, &point);
}

static Result read_all(Reader *r) {
    Result result = RESULT_OK;
    if (!next_line(r, &result))
        return result != RESULT_OK ? result : refuse(r, "the file is empty; expected a line of column names");
    result = read_names(r);
    while (result == RESULT_OK && next_line(r, &result))
        result = add_point(r);
    if (result == RESULT_OK && r->build.track->count == 0)
        return refuse(r, "no points; expected a line of numbers for each");
    return result;
}

// `columns`: which there are. `out` is valid on success only.
static Result read_file(const char *path, Track *out, bool columns[COLUMN_COUNT]) {
    Reader reader = {.build = track_build_begin(path, out)};
    Result result = track_lines_open(path, &reader.lines);
    if (result != RESULT_OK)
        return result;
    result = read_all(&reader);
    track_lines_close(&reader.lines);
    for (int c = 0; c < COLUMN_COUNT; c++)
        columns[c] = reader.place[c] >= 0;
    out->format = "csv";
    if (result != RESULT_OK)
        track_clear(out);
    return result;
}

bool track_csv_recognise(const char *head) {
    return strstr(head, "t_s") && strstr(head, "lat_deg") && strstr(head, "lon_deg");
}

static void mark_derived(Track *track) {
    for (int i = 0; i < track->count; i++)
        track->points[i].flags |= TRACK_DERIVED;
}

// Where the file does not say so, attitude is derived, and what is no one flight is a gap.
Result track_csv_read(const char *path, const TrackReading *how, Track *out) {
    bool columns[COLUMN_COUNT];
    (void)how;
    Result result = read_file(path, out, columns);
    if (result != RESULT_OK)
        return result;
    if (!columns[GAP])
        track_mark_gaps(out);
    if (columns[HEADING])
        return RESULT_OK;
    mark_derived(out);
    result = track_derive_attitude(out);
    if (result != RESULT_OK)
        track_clear(out);
    return result;
}

// ---- writing ----

typedef struct Columns {
    bool bank, gap, derived, unix_s;
} Columns;

static Columns columns_of(const Track *track) {
    Columns columns = {.unix_s = isfinite(track->start_unix_s), .derived = track_is_derived(track)};
    columns.gap = track_gap_count(track) > 0;
    for (int i = 0; i < track->count; i++)
        columns.bank |= track->points[i].bank_deg != 0.0;
    return columns;
}

static void write_point(const Track *track, int i, Columns columns, FILE *to) {
    const TrackPoint *p = &track->points[i];
    fprintf(to, "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g", p->t_s, p->at.lat_deg, p->at.lon_deg, p->at.alt_m,
            p->at.heading_deg, p->at.pitch_deg);
    if (columns.bank)
        fprintf(to, ",%.17g", p->bank_deg);
    if (columns.gap)
        fprintf(to, ",%d", (p->flags & TRACK_GAP) != 0);
    if (columns.derived)
        fprintf(to, ",%d", (p->flags & TRACK_DERIVED) != 0);
    if (columns.unix_s)
        fprintf(to, ",%.17g", track_utc(track, i));
    fputs("\r\n", to);
}

bool track_write(const Track *track, FILE *to) {
    Columns columns = columns_of(track);
    fprintf(to, "t_s,lat_deg,lon_deg,alt_m,heading_deg,pitch_deg%s%s%s%s\r\n", columns.bank ? ",bank_deg" : "",
            columns.gap ? ",gap" : "", columns.derived ? ",derived" : "", columns.unix_s ? ",unix_s" : "");
    for (int i = 0; i < track->count && !ferror(to); i++)
        write_point(track, i, columns, to);
    return !ferror(to);
}

void track_csv_write(const Track *track, const Geoid *geoid, FILE *to) {
    (void)geoid;
    track_write(track, to);
}
