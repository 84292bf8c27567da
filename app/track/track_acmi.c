// Tacview ACMI 2.x as text: "Technical Reference - ACMI Flight Recordings 2.2", Raia Software.
#include "app/track/track_build.h"
#include "app/track/track_formats_internal.h"
#include "app/track/track_lines.h"
#include "app/track/track_time.h"
#include "base/log.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define ID_BYTES 24
#define FIELDS_MAX 9

// In the order of the fullest form of T: lon|lat|alt|roll|pitch|yaw|u|v|heading.
enum { LON, LAT, ALT, ROLL, PITCH, YAW };

typedef struct Reader {
    const TrackReading *how;
    TrackBuild build;
    TrackLines lines;
    double reference_s; // Unix time of #0
    bool has_time;
    double frame_s;
    double reference_lon_deg, reference_lat_deg;
    char id[ID_BYTES]; // the object taken; "": none yet
    bool is_air, derived;
    double fields[FIELDS_MAX]; // its last T, unchanged where a new one is empty
    bool known[FIELDS_MAX];
    bool continued; // the line before ended with a backslash: this one goes on with its text
} Reader;

bool track_acmi_recognise(const char *head) {
    return strstr(head, "FileType=text/acmi") != NULL;
}

static Result refuse(const Reader *r, const char *expected) {
    log_error("%s:%lld: found '%.60s', expected %s", r->lines.path, (long long)r->lines.number, r->lines.text,
              expected);
    return RESULT_FORMAT;
}

static Result read_heading(Reader *r) {
    if (!track_lines_next(&r->lines))
        return track_lines_failed(&r->lines) ? RESULT_IO : refuse(r, "FileType=text/acmi/tacview");
    if (strncmp(r->lines.text, "FileType=text/acmi", 18) != 0)
        return refuse(r, "FileType=text/acmi/tacview");
    if (!track_lines_next(&r->lines) || strncmp(r->lines.text, "FileVersion=2.", 14) != 0)
        return track_lines_failed(&r->lines) ? RESULT_IO : refuse(r, "FileVersion=2.2, or another of 2");
    return RESULT_OK;
}

// Cuts off the text up to the next comma that no backslash stands before; NULL at the end.
static char *next_part(char **rest) {
    char *part = *rest, *c = part;
    if (!part)
        return NULL;
    while (*c && *c != ',')
        c += c[0] == '\\' && c[1] ? 2 : 1;
    *rest = *c ? c + 1 : NULL;
    *c = '\0';
    return part;
}

// The value of a property without its escapes, if `part` is of that name.
static const char *value_of(char *part, const char *name) {
    size_t length = strlen(name);
    if (strncmp(part, name, length) != 0 || part[length] != '=')
        return NULL;
    char *value = part + length + 1, *to = value;
    for (const char *from = value; *from; from++) {
        if (from[0] == '\\' && from[1])
            from++;
        *to++ = *from;
    }
    *to = '\0';
    return value;
}

static void read_global(Reader *r, char *rest) {
    for (char *part; (part = next_part(&rest));) {
        const char *time = value_of(part, "ReferenceTime");
        const char *lon = time ? NULL : value_of(part, "ReferenceLongitude");
        const char *lat = time || lon ? NULL : value_of(part, "ReferenceLatitude");
        bool understood = time  ? (r->has_time = track_time_read(time, &r->reference_s))
                          : lon ? track_read_number(lon, &r->reference_lon_deg)
                          : lat ? track_read_number(lat, &r->reference_lat_deg)
                                : true;
        if (!understood)
            log_warn("%s:%lld: '%.60s' is not understood; expected a time as 2024-06-01T12:00:00Z, or degrees",
                     r->lines.path, (long long)r->lines.number, part);
    }
}

// ---- objects ----

typedef struct Object {
    char *place;      // the value of T; NULL: none
    const char *name; // where one is asked for; NULL: none
    bool is_air, is_named, is_derived;
} Object;

static Object read_object(const Reader *r, char *rest) {
    static const char *const names[] = {"Name", "Pilot", "CallSign"};
    Object object = {0};
    for (char *part; (part = next_part(&rest));) {
        const char *value;
        if (strncmp(part, "T=", 2) == 0)
            object.place = part + 2;
        else if ((value = value_of(part, "Type")))
            object.is_air = strstr(value, "Air") != NULL;
        else if ((value = value_of(part, "Comments")))
            object.is_derived = strstr(value, TRACK_DERIVED_MARK) != NULL;
        else
            for (size_t i = 0; i < COUNT_OF(names) && r->how->object; i++)
                if ((value = value_of(part, names[i]))) {
                    object.is_named |= strcmp(value, r->how->object) == 0;
                    object.name = value;
                }
    }
    return object;
}

static void choose(Reader *r, const char *id, bool is_air) {
    snprintf(r->id, sizeof r->id, "%s", id);
    r->is_air = is_air;
    r->derived = false;
    memset(r->known, 0, sizeof r->known);
}

// The object asked for by id or name; else the first with a place, until an aircraft comes.
static bool is_taken(Reader *r, const char *id, const Object *object) {
    if (r->id[0] && strcmp(id, r->id) == 0)
        return true;
    bool better = r->how->object ? !r->id[0] && (object->is_named || strcasecmp(id, r->how->object) == 0)
                                 : object->place && (!r->id[0] || (object->is_air && !r->is_air));
    if (!better)
        return false;
    if (r->id[0])
        track_build_restart(&r->build);
    choose(r, id, object->is_air);
    return true;
}

// Splits at '|'; -1: a field is neither empty nor a number.
static int read_fields(Reader *r, char *text) {
    int count = 0;
    for (char *next = text; next && count < FIELDS_MAX; count++) {
        char *bar = strchr(next, '|');
        if (bar)
            *bar++ = '\0';
        // Of five, the last two are flat coordinates, no attitude.
        if (*next && !track_read_number(next, &r->fields[count]))
            return -1;
        r->known[count] |= *next != '\0';
        next = bar;
    }
    return count;
}

static Result add_place(Reader *r, char *text) {
    double before[FIELDS_MAX];
    memcpy(before, r->fields, sizeof before);
    int count = read_fields(r, text);
    bool turned = count == 6 || count == 9;
    if (count < 3 || !r->known[LON] || !r->known[LAT] || !r->known[ALT]) {
        memcpy(r->fields, before, sizeof before);
        track_build_skip(&r->build, TRACK_SKIP_MALFORMED, r->lines.number);
        return RESULT_OK;
    }
    TrackPoint point = {.t_s = r->reference_s + r->frame_s, .flags = TRACK_DERIVED};
    point.at = (Viewpoint){.lat_deg = r->fields[LAT] + r->reference_lat_deg,
                           .lon_deg = r->fields[LON] + r->reference_lon_deg,
                           .alt_m = r->fields[ALT]};
    if (turned && r->known[ROLL] && r->known[PITCH] && r->known[YAW]) {
        point.at.heading_deg = r->fields[YAW];
        point.at.pitch_deg = r->fields[PITCH];
        point.bank_deg = r->fields[ROLL];
        point.flags = r->derived ? TRACK_DERIVED : 0;
    }
    return track_build_add(&r->build, r->lines.number, &point);
}

static Result read_line_of_object(Reader *r, const char *id, char *rest) {
    bool whole = !r->lines.cut && r->lines.ended;
    Object object = read_object(r, rest);
    if (!is_taken(r, id, &object)) {
        if (object.place || object.name)
            track_build_other(&r->build, id, object.name);
        if (object.place)
            track_build_skip(&r->build, TRACK_SKIP_OTHER, r->lines.number);
        return RESULT_OK;
    }
    r->is_air |= object.is_air;
    r->derived |= object.is_derived;
    if (!object.place)
        return RESULT_OK;
    if (whole)
        return add_place(r, object.place);
    track_build_skip(&r->build, TRACK_SKIP_MALFORMED, r->lines.number);
    return RESULT_OK;
}

static void read_frame(Reader *r) {
    double frame_s;
    if (track_read_number(r->lines.text + 1, &frame_s) && fabs(frame_s) < 1e11)
        r->frame_s = frame_s;
    else
        track_build_skip(&r->build, TRACK_SKIP_MALFORMED, r->lines.number);
}

static bool ends_with_backslash(const char *text) {
    size_t length = strlen(text), run = 0;
    while (run < length && text[length - 1 - run] == '\\')
        run++;
    return run % 2 == 1;
}

static Result read_line(Reader *r) {
    char *text = r->lines.text;
    bool continued = r->continued;
    r->continued = ends_with_backslash(text);
    if (continued || !*text || strncmp(text, "//", 2) == 0)
        return RESULT_OK;
    if (*text == '#') {
        read_frame(r);
        return RESULT_OK;
    }
    if (*text == '-') { // the object leaves, and may come again
        if (strcmp(text + 1, r->id) == 0) {
            track_build_gap(&r->build);
            memset(r->known, 0, sizeof r->known);
        }
        return RESULT_OK;
    }
    char *rest = text, *id = next_part(&rest);
    if (strlen(id) >= ID_BYTES || strspn(id, "0123456789abcdefABCDEF") != strlen(id)) {
        track_build_skip(&r->build, TRACK_SKIP_MALFORMED, r->lines.number);
        return RESULT_OK;
    }
    if (strcmp(id, "0") != 0)
        return read_line_of_object(r, id, rest);
    read_global(r, rest);
    return RESULT_OK;
}

static Result read_all(Reader *r) {
    Result result = read_heading(r);
    while (result == RESULT_OK && track_lines_next(&r->lines))
        result = read_line(r);
    if (result == RESULT_OK && track_lines_failed(&r->lines))
        result = RESULT_IO;
    if (result != RESULT_OK)
        return result;
    r->build.track->format = "acmi";
    r->build.track->heights = TRACK_HEIGHTS_GEOID;
    if (!r->has_time)
        log_warn("%s: no ReferenceTime: the day of the flight is unknown", r->lines.path);
    return track_build_end(&r->build, r->has_time);
}

Result track_acmi_read(const char *path, const TrackReading *how, Track *out) {
    Reader reader = {.how = how, .build = track_build_begin(path, out)};
    reader.build.asked = how->object;
    Result result = track_lines_open(path, &reader.lines);
    if (result != RESULT_OK)
        return result;
    result = read_all(&reader);
    track_lines_close(&reader.lines);
    if (result != RESULT_OK)
        track_clear(out);
    return result;
}

// ---- writing ----

#define COLUMNS 6
#define NUMBER_BYTES 32

static void write_escaped(const char *text, FILE *to) {
    for (; *text; text++) {
        if (*text == ',' || *text == '\\')
            fputc('\\', to);
        fputc((unsigned char)*text < 0x20 ? '?' : *text, to);
    }
}

static void print_place(const TrackPoint *p, char out[COLUMNS][NUMBER_BYTES]) {
    snprintf(out[LON], NUMBER_BYTES, "%.9f", track_longitude(p->at.lon_deg));
    snprintf(out[LAT], NUMBER_BYTES, "%.9f", p->at.lat_deg);
    snprintf(out[ALT], NUMBER_BYTES, "%.3f", p->at.alt_m);
    snprintf(out[ROLL], NUMBER_BYTES, "%.6f", p->bank_deg);
    snprintf(out[PITCH], NUMBER_BYTES, "%.6f", p->at.pitch_deg);
    snprintf(out[YAW], NUMBER_BYTES, "%.6f", p->at.heading_deg);
}

// What is as before is left empty.
static void write_place(const TrackPoint *point, char before[COLUMNS][NUMBER_BYTES], FILE *to) {
    char now[COLUMNS][NUMBER_BYTES];
    print_place(point, now);
    fputs("1,T=", to);
    for (int c = 0; c < COLUMNS; c++)
        fprintf(to, "%s%s", c ? "|" : "", strcmp(now[c], before[c]) == 0 ? "" : now[c]);
    memcpy(before, now, sizeof now);
}

static void write_properties(const Track *track, FILE *to) {
    fputs(",Type=Air+FixedWing,Name=", to);
    write_escaped(track->name, to);
    if (track_is_derived(track))
        fputs(",Comments=" TRACK_DERIVED_MARK, to);
}

void track_acmi_write(const Track *track, const Geoid *geoid, FILE *to) {
    char time[TRACK_TIME_BYTES], before[COLUMNS][NUMBER_BYTES] = {{0}};
    (void)geoid;
    track_time_write(track->start_unix_s, time);
    fprintf(to, "FileType=text/acmi/tacview\nFileVersion=2.2\n0,ReferenceTime=%s\n0,DataSource=Overfly\n", time);
    for (int i = 0; i < track->count && !ferror(to); i++) {
        const TrackPoint *point = &track->points[i];
        if (i > 0 && point->flags & TRACK_GAP) {
            fputs("-1\n", to);
            memset(before, 0, sizeof before);
        }
        fprintf(to, "#%.3f\n", point->t_s - track->points[0].t_s);
        write_place(point, before, to);
        if (i == 0)
            write_properties(track, to);
        fputc('\n', to);
    }
}
