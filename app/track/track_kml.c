// KML 2.2 with Google's extension gx:Track, and KML 2.3's Track: times, places and angles in lists of equal length.
#include "app/track/track_build.h"
#include "app/track/track_formats_internal.h"
#include "app/track/track_time.h"
#include "app/track/track_xml.h"
#include "base/log.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// One of a gx:Track, gathered from its lists.
typedef struct Fix {
    double unix_s;
    double coord[3];  // longitude, latitude, altitude
    double angles[3]; // heading, tilt, roll
    int64_t line;     // of the coord
    bool timed, placed, turned;
} Fix;

typedef struct Reader {
    const TrackReading *how;
    const char *path;
    TrackBuild build;
    Fix *fixes;
    int capacity, when_count, coord_count, angle_count;
    int placemark;               // from 1
    char name[TRACK_NAME_BYTES]; // of this Placemark, where it was told yet
    int taken_placemark;         // whose tracks are taken; 0: none yet
    bool named;                  // this Placemark has the name asked for
    bool derived;                // it says that its angles are ours
    bool assumed;                // altitudes of no stated mode
    bool mode_told, lines;
} Reader;

bool track_kml_recognise(const char *head) {
    return strstr(head, "<kml") != NULL;
}

static Result refuse(const Reader *r, const TrackXmlPlace *place, const char *why) {
    log_error("%s:%lld: %s", r->path, (long long)place->line, why);
    return RESULT_FORMAT;
}

// ---- the lists ----

static Result grow(Reader *r, const TrackXmlPlace *place, int index) {
    if (index < r->capacity)
        return RESULT_OK;
    if (r->capacity >= TRACK_POINTS_MAX)
        return refuse(r, place, "more than 4000000 points; expected a shorter flight");
    int capacity = r->capacity ? 2 * r->capacity : 1024;
    capacity = capacity < TRACK_POINTS_MAX ? capacity : TRACK_POINTS_MAX;
    Fix *fixes = realloc(r->fixes, sizeof *fixes * (size_t)capacity);
    if (!fixes) {
        log_error("%s: no memory for %d points", r->path, capacity);
        return RESULT_MEMORY;
    }
    memset(fixes + r->capacity, 0, sizeof *fixes * (size_t)(capacity - r->capacity));
    r->fixes = fixes;
    r->capacity = capacity;
    return RESULT_OK;
}

static void forget_fixes(Reader *r) {
    int most = r->when_count > r->coord_count ? r->when_count : r->coord_count;
    most = most > r->angle_count ? most : r->angle_count;
    if (most > 0)
        memset(r->fixes, 0, sizeof *r->fixes * (size_t)most);
    r->when_count = r->coord_count = r->angle_count = 0;
}

// Three numbers with white space between.
static bool read_three(const char *text, double out[3]) {
    for (int i = 0; i < 3; i++) {
        char *end;
        out[i] = strtod(text, &end);
        if (end == text || !isfinite(out[i]))
            return false;
        text = end;
    }
    return *text == '\0';
}

static Result add_value(Reader *r, const TrackXmlPlace *place, const char *name, const char *text) {
    int *count = strcmp(name, "when") == 0    ? &r->when_count
                 : strcmp(name, "coord") == 0 ? &r->coord_count
                                              : &r->angle_count;
    Result result = grow(r, place, *count);
    if (result != RESULT_OK)
        return result;
    Fix *fix = &r->fixes[(*count)++];
    if (count == &r->when_count) {
        fix->timed = track_time_read(text, &fix->unix_s);
    } else if (count == &r->coord_count) {
        fix->placed = read_three(text, fix->coord);
        fix->line = place->line;
    } else {
        fix->turned = read_three(text, fix->angles);
    }
    return RESULT_OK;
}

// ---- a track ----

// Tilt and roll are positive clockwise as seen from the end of the axis to the right and of the axis ahead: nose down,
// and left wing down (KML reference, Orientation).
static void set_angles(TrackPoint *point, const Fix *fix) {
    double pitch = remainder(-fix->angles[1], 360.0);
    point->at.heading_deg = fmod(fix->angles[0], 360.0);
    point->at.pitch_deg = fmin(fmax(pitch, -90.0), 90.0);
    point->bank_deg = remainder(-fix->angles[2], 360.0);
}

static Result add_fix(Reader *r, const Fix *fix) {
    if (!fix->timed || !fix->placed) {
        track_build_skip(&r->build, fix->timed ? TRACK_SKIP_MALFORMED : TRACK_SKIP_UNTIMED, fix->line);
        return RESULT_OK;
    }
    TrackPoint point = {.t_s = fix->unix_s, .at = {.lat_deg = fix->coord[1], .lon_deg = fix->coord[0]}};
    point.at.alt_m = fix->coord[2];
    if (fix->turned)
        set_angles(&point, fix);
    if (!fix->turned || r->derived)
        point.flags = TRACK_DERIVED;
    return track_build_add(&r->build, fix->line, &point);
}

static bool is_taken(Reader *r) {
    double number;
    bool asked = !r->how->object || r->named || (track_read_number(r->how->object, &number) && number == r->placemark);
    if (r->taken_placemark == 0 && asked)
        r->taken_placemark = r->placemark;
    return r->taken_placemark == r->placemark;
}

static void note_other(Reader *r) {
    char id[16];
    snprintf(id, sizeof id, "%d", r->placemark);
    track_build_other(&r->build, id, r->name);
}

// The first `count` of the lists.
static Result take_fixes(Reader *r, int count) {
    Result result = RESULT_OK;
    bool taken = count > 0 && is_taken(r);
    track_build_gap(&r->build);
    if (!taken)
        note_other(r);
    for (int i = 0; i < count && result == RESULT_OK; i++) {
        if (taken)
            result = add_fix(r, &r->fixes[i]);
        else
            track_build_skip(&r->build, TRACK_SKIP_OTHER, r->fixes[i].line);
    }
    r->assumed |= taken && !r->mode_told;
    forget_fixes(r);
    return result;
}

static Result end_track(Reader *r, const TrackXmlPlace *place) {
    if (r->when_count == r->coord_count && (r->angle_count == 0 || r->angle_count == r->coord_count))
        return take_fixes(r, r->coord_count);
    log_error("%s:%lld: a track of %d when, %d coord and %d angles; expected as many of each", r->path,
              (long long)place->line, r->when_count, r->coord_count, r->angle_count);
    return RESULT_FORMAT;
}

// Of the track that is open, what has a time and a place.
static Result cut(void *user, int *points) {
    Reader *r = user;
    Result result = take_fixes(r, r->coord_count < r->when_count ? r->coord_count : r->when_count);
    *points = r->build.track->count;
    return result;
}

static Result read_mode(Reader *r, const TrackXmlPlace *place, const char *mode) {
    r->mode_told = strcmp(mode, "absolute") == 0;
    if (strcmp(mode, "relativeToGround") != 0 && strcmp(mode, "relativeToSeaFloor") != 0)
        return RESULT_OK;
    return refuse(r, place, "altitudes relative to the ground; expected altitudeMode absolute");
}

static Result begin(void *user, const TrackXmlPlace *place, const char *name, const char *const *attributes) {
    Reader *r = user;
    (void)attributes;
    if (place->depth == 1 && strcmp(name, "kml") != 0)
        return refuse(r, place, "expected <kml>");
    if (strcmp(name, "Placemark") == 0) {
        r->placemark++;
        r->named = r->derived = false;
        r->name[0] = '\0';
    } else if (strcmp(name, "Track") == 0) {
        r->mode_told = false;
    }
    r->lines |= strcmp(name, "LineString") == 0;
    return RESULT_OK;
}

static Result end(void *user, const TrackXmlPlace *place, const char *name, const char *text) {
    Reader *r = user;
    if (strcmp(place->parent, "Track") == 0) {
        if (strcmp(name, "when") == 0 || strcmp(name, "coord") == 0 || strcmp(name, "angles") == 0)
            return add_value(r, place, name, text);
        if (strcmp(name, "altitudeMode") == 0)
            return read_mode(r, place, text);
    } else if (strcmp(place->parent, "Placemark") == 0) {
        if (strcmp(name, "name") == 0) {
            r->named |= r->how->object && strcmp(text, r->how->object) == 0;
            snprintf(r->name, sizeof r->name, "%s", text);
        }
        r->derived |= strcmp(name, "description") == 0 && strstr(text, TRACK_DERIVED_MARK);
    }
    return strcmp(name, "Track") == 0 ? end_track(r, place) : RESULT_OK;
}

static Result finish(Reader *r) {
    Track *track = r->build.track;
    track->format = "kml";
    track->heights = r->assumed ? TRACK_HEIGHTS_GEOID_ASSUMED : TRACK_HEIGHTS_GEOID;
    if (r->lines && track->count == 0 && r->taken_placemark == 0) {
        log_error("%s: a LineString, which has no times; expected a gx:Track", r->path);
        return RESULT_FORMAT;
    }
    return track_build_end(&r->build, true);
}

Result track_kml_read(const char *path, const TrackReading *how, Track *out) {
    static const TrackXmlHandler handler = {begin, end, cut};
    Reader reader = {.how = how, .build = track_build_begin(path, out), .path = path};
    reader.build.asked = how->object;
    Result result = track_xml_read(path, &handler, &reader);
    if (result == RESULT_OK)
        result = finish(&reader);
    free(reader.fixes);
    if (result != RESULT_OK)
        track_clear(out);
    return result;
}

// ---- writing ----

static void write_angles(const TrackPoint *point, FILE *to) {
    fprintf(to, "<gx:angles>%.6f %.6f %.6f</gx:angles>\n", point->at.heading_deg, 0.0 - point->at.pitch_deg,
            0.0 - point->bank_deg);
}

// One gx:Track; returns the point after it.
static int write_segment(const Track *track, int first, FILE *to) {
    int end = first + 1;
    while (end < track->count && !(track->points[end].flags & TRACK_GAP))
        end++;
    fputs("<gx:Track>\n<altitudeMode>absolute</altitudeMode>\n", to);
    for (int i = first; i < end && !ferror(to); i++) {
        char time[TRACK_TIME_BYTES];
        track_time_write(track_utc(track, i), time);
        fprintf(to, "<when>%s</when>\n", time);
    }
    for (int i = first; i < end && !ferror(to); i++) {
        const Viewpoint *at = &track->points[i].at;
        fprintf(to, "<gx:coord>%.9f %.9f %.3f</gx:coord>\n", track_longitude(at->lon_deg), at->lat_deg, at->alt_m);
    }
    for (int i = first; i < end && !ferror(to); i++)
        write_angles(&track->points[i], to);
    fputs("</gx:Track>\n", to);
    return end;
}

void track_kml_write(const Track *track, const Geoid *geoid, FILE *to) {
    (void)geoid;
    fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\" "
          "xmlns:gx=\"http://www.google.com/kml/ext/2.2\">\n<Document>\n<Placemark>\n<name>",
          to);
    track_write_xml_text(track->name, to);
    fprintf(to, "</name>\n<description>%s</description>\n<gx:MultiTrack>\n<gx:interpolate>0</gx:interpolate>\n",
            track_is_derived(track) ? TRACK_DERIVED_MARK : "attitude as recorded");
    for (int i = 0; i < track->count && !ferror(to);)
        i = write_segment(track, i, to);
    fputs("</gx:MultiTrack>\n</Placemark>\n</Document>\n</kml>\n", to);
}
