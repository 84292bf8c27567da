// GPX 1.1, www.topografix.com/GPX/1/1: elements trk, trkseg, trkpt with ele, time and geoidheight.
#include "app/track/track_build.h"
#include "app/track/track_formats_internal.h"
#include "app/track/track_time.h"
#include "app/track/track_xml.h"
#include "base/log.h"

#include <math.h>
#include <string.h>

typedef struct Reader {
    const TrackReading *how;
    TrackBuild build;
    const char *path;
    int number;                  // of the trk, from 1
    bool taken;                  // this trk's points
    bool begun;                  // some trk's points were taken
    char name[TRACK_NAME_BYTES]; // of this trk
    TrackPoint point;
    double geoid_m; // geoidheight; NaN: none
    bool has_place, has_time, has_height, damaged;
    bool converted, routes;
} Reader;

bool track_gpx_recognise(const char *head) {
    return strstr(head, "<gpx") != NULL;
}

static double attribute(const char *const *attributes, const char *name, bool *found) {
    double value = 0.0;
    for (; *attributes; attributes += 2)
        if (strcmp(attributes[0], name) == 0)
            *found = track_read_number(attributes[1], &value);
    return value;
}

static void begin_point(Reader *r, const char *const *attributes) {
    bool lat = false, lon = false;
    r->point = (TrackPoint){.flags = TRACK_DERIVED};
    r->point.at.lat_deg = attribute(attributes, "lat", &lat);
    r->point.at.lon_deg = attribute(attributes, "lon", &lon);
    r->geoid_m = NAN;
    r->has_place = lat && lon;
    r->has_time = r->has_height = r->damaged = false;
}

static bool is_asked_number(const Reader *r) {
    double number;
    return r->how->object && track_read_number(r->how->object, &number) && number == r->number;
}

static Result begin(void *user, const TrackXmlPlace *place, const char *name, const char *const *attributes) {
    Reader *r = user;
    if (place->depth == 1 && strcmp(name, "gpx") != 0) {
        log_error("%s:%lld: found <%s>, expected <gpx>", r->path, (long long)place->line, name);
        return RESULT_FORMAT;
    }
    if (strcmp(name, "trk") == 0 && place->depth == 2) {
        r->number++;
        r->name[0] = '\0';
        r->taken = r->how->object ? is_asked_number(r) : !r->begun;
    } else if (strcmp(name, "trkseg") == 0) {
        track_build_gap(&r->build);
    } else if (strcmp(name, "trkpt") == 0) {
        begin_point(r, attributes);
    } else if (strcmp(name, "rtept") == 0) {
        r->routes = true;
    }
    return RESULT_OK;
}

// Height above the ellipsoid is ele + geoidheight, whichever geoid the writer has.
static void carry_to_our_geoid(Reader *r) {
    Viewpoint *at = &r->point.at;
    if (!isfinite(r->geoid_m) || !r->how->geoid || fabs(at->lat_deg) > 90.0 || fabs(at->lon_deg) > 540.0)
        return;
    at->alt_m += r->geoid_m - geoid_undulation_m(r->how->geoid, at->lat_deg, at->lon_deg);
    r->converted = true;
}

static Result end_point(Reader *r, int64_t line) {
    TrackSkip why = !r->taken                     ? TRACK_SKIP_OTHER
                    : !r->has_place || r->damaged ? TRACK_SKIP_MALFORMED
                    : !r->has_time                ? TRACK_SKIP_UNTIMED
                    : !r->has_height              ? TRACK_SKIP_NO_HEIGHT
                                                  : TRACK_SKIP_COUNT;
    if (why != TRACK_SKIP_COUNT) {
        track_build_skip(&r->build, why, line);
        return RESULT_OK;
    }
    r->begun = true;
    carry_to_our_geoid(r);
    return track_build_add(&r->build, line, &r->point);
}

static void end_value(Reader *r, const char *name, const char *text) {
    if (strcmp(name, "ele") == 0)
        r->damaged |= !(r->has_height = track_read_number(text, &r->point.at.alt_m));
    else if (strcmp(name, "time") == 0)
        r->damaged |= !(r->has_time = track_time_read(text, &r->point.t_s));
    else if (strcmp(name, "geoidheight") == 0)
        r->damaged |= !track_read_number(text, &r->geoid_m);
}

static void end_name(Reader *r, const char *text) {
    r->taken |= r->how->object && strcmp(text, r->how->object) == 0;
    snprintf(r->name, sizeof r->name, "%s", text);
}

static void note_other(Reader *r) {
    char id[16];
    snprintf(id, sizeof id, "%d", r->number);
    track_build_other(&r->build, id, r->name);
}

static Result end(void *user, const TrackXmlPlace *place, const char *name, const char *text) {
    Reader *r = user;
    if (strcmp(place->parent, "trkpt") == 0)
        end_value(r, name, text);
    else if (strcmp(name, "trkpt") == 0)
        return end_point(r, place->line);
    else if (strcmp(name, "name") == 0 && strcmp(place->parent, "trk") == 0)
        end_name(r, text);
    else if (strcmp(name, "trk") == 0 && !r->taken)
        note_other(r);
    return RESULT_OK;
}

// A point that is open is none.
static Result cut(void *user, int *points) {
    const Reader *r = user;
    *points = r->build.track->count;
    return RESULT_OK;
}

static Result finish(Reader *r) {
    Track *track = r->build.track;
    track->format = "gpx";
    track->heights = r->converted ? TRACK_HEIGHTS_GEOID_HEIGHT : TRACK_HEIGHTS_GEOID_ASSUMED;
    if (r->number == 0 && r->routes) {
        log_error("%s: a route, which has no times; expected a track", r->path);
        return RESULT_FORMAT;
    }
    return track_build_end(&r->build, true);
}

Result track_gpx_read(const char *path, const TrackReading *how, Track *out) {
    static const TrackXmlHandler handler = {begin, end, cut};
    Reader reader = {.how = how, .build = track_build_begin(path, out), .path = path};
    reader.build.asked = how->object;
    Result result = track_xml_read(path, &handler, &reader);
    if (result == RESULT_OK)
        result = finish(&reader);
    if (result != RESULT_OK)
        track_clear(out);
    return result;
}

// ---- writing ----

static void write_point(const Track *track, int i, const Geoid *geoid, FILE *to) {
    const Viewpoint *at = &track->points[i].at;
    char time[TRACK_TIME_BYTES];
    track_time_write(track_utc(track, i), time);
    fprintf(to, "<trkpt lat=\"%.9f\" lon=\"%.9f\"><ele>%.3f</ele><time>%s</time>", at->lat_deg,
            track_longitude(at->lon_deg), at->alt_m, time);
    if (geoid)
        fprintf(to, "<geoidheight>%.3f</geoidheight>", geoid_undulation_m(geoid, at->lat_deg, at->lon_deg));
    fputs("</trkpt>\n", to);
}

void track_gpx_write(const Track *track, const Geoid *geoid, FILE *to) {
    fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
          "<gpx version=\"1.1\" creator=\"Overfly\" xmlns=\"http://www.topografix.com/GPX/1/1\">\n<trk><name>",
          to);
    track_write_xml_text(track->name, to);
    fputs("</name>\n<trkseg>\n", to);
    for (int i = 0; i < track->count && !ferror(to); i++) {
        if (i > 0 && track->points[i].flags & TRACK_GAP)
            fputs("</trkseg>\n<trkseg>\n", to);
        write_point(track, i, geoid, to);
    }
    fputs("</trkseg></trk>\n</gpx>\n", to);
}
