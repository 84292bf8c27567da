// IGC: FAI/IGC "Technical Specification for GNSS Flight Recorders", appendix A: records A, H, I and B.
#include "app/track/track_build.h"
#include "app/track/track_formats_internal.h"
#include "app/track/track_lines.h"
#include "app/track/track_time.h"
#include "base/log.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define B_BYTES 35                 // of a B record without extensions
#define NOON_S (0.5 * TRACK_DAY_S) // a time of day that goes back by more has passed midnight
#define DEGREE_UNITS 6000000       // of 1e-5 minutes, as we write them

// Where an extension of the B record stands, bytes from 0; none: count 0.
typedef struct Extension {
    int first, count;
} Extension;

typedef enum Told { TOLD_NOTHING, TOLD_ELLIPSOID, TOLD_GEOID, TOLD_NONE } Told; // by HFALG

typedef enum ToldPressure { PRESSURE_ISA, PRESSURE_OTHER, PRESSURE_NONE } ToldPressure; // by HFALP

typedef struct Reader {
    TrackBuild build;
    TrackLines lines;
    bool from_pressure;
    bool again;   // a second reading: what is wrong has been said
    double day_s; // Unix time of the day's beginning; 0 while there was no date
    bool has_date;
    double clock_s;          // the time of day of the last fix; negative: none yet
    Extension lad, lod, tds; // further digits of latitude, longitude minutes; of seconds
    Told told;
    ToldPressure told_pressure;
    bool has_gnss, has_pressure; // any fix with such an altitude
} Reader;

bool track_igc_recognise(const char *head) {
    if (strncmp(head, "HFDTE", 5) == 0 || strstr(head, "\nHFDTE"))
        return true;
    for (const char *b = head; b; b = strchr(b, '\n') ? strchr(b, '\n') + 1 : NULL)
        if (*b == 'B' && strspn(b + 1, "0123456789") >= 13)
            return true;
    return false;
}

static bool is_digits(const char *text, int count) {
    for (int i = 0; i < count; i++)
        if (text[i] < '0' || text[i] > '9')
            return false;
    return true;
}

static int number_of(const char *digits, int count) {
    int value = 0;
    for (int i = 0; i < count; i++)
        value = 10 * value + (digits[i] - '0');
    return value;
}

// ---- headers ----

// HFDTEDDMMYY, or HFDTEDATE:DDMMYY,NN with or without spaces. Years of two digits are those of 1980 to 2079.
static void read_date(Reader *r) {
    const char *digits = r->lines.text + 5;
    digits += strcspn(digits, "0123456789");
    double day_s;
    bool valid = strspn(digits, "0123456789") >= 6;
    if (valid) {
        int year = number_of(digits + 4, 2);
        valid = track_time_of_day(year < 80 ? 2000 + year : 1900 + year, number_of(digits + 2, 2), number_of(digits, 2),
                                  &day_s);
    }
    if (!valid) {
        if (!r->again)
            log_warn("%s:%lld: '%.40s': no date; expected HFDTE and DDMMYY", r->lines.path, (long long)r->lines.number,
                     r->lines.text);
        return;
    }
    r->day_s = day_s;
    r->has_date = true;
    r->clock_s = -1.0;
}

// HFALG:GEO, HFALGALTGPS:ELL
static void read_gnss_datum(Reader *r) {
    const char *colon = strrchr(r->lines.text, ':'), *value = colon ? colon + 1 : r->lines.text + 5;
    value += strspn(value, " ");
    r->told = strncmp(value, "ELL", 3) == 0   ? TOLD_ELLIPSOID
              : strncmp(value, "GEO", 3) == 0 ? TOLD_GEOID
              : strncmp(value, "NIL", 3) == 0 ? TOLD_NONE
                                              : TOLD_NOTHING;
}

// HFALPALTPRESSURE:ISA; MSL: the recorder counts from the sea by the day's own pressure
static void read_pressure_datum(Reader *r) {
    const char *colon = strrchr(r->lines.text, ':'), *value = colon ? colon + 1 : r->lines.text + 5;
    value += strspn(value, " ");
    r->told_pressure = strncmp(value, "MSL", 3) == 0   ? PRESSURE_OTHER
                       : strncmp(value, "NIL", 3) == 0 ? PRESSURE_NONE
                                                       : PRESSURE_ISA;
    if (r->told_pressure == PRESSURE_OTHER && !r->again)
        log_warn(
            "%s:%lld: '%.40s': pressure altitudes that are not of the standard atmosphere; they are left out where "
            "there are others",
            r->lines.path, (long long)r->lines.number, r->lines.text);
}

// The second letter says who told it: the recorder, the observer or the pilot.
static void read_header(Reader *r) {
    if (strlen(r->lines.text) < 5)
        return;
    if (strncmp(r->lines.text + 2, "DTE", 3) == 0)
        read_date(r);
    else if (strncmp(r->lines.text + 2, "ALG", 3) == 0)
        read_gnss_datum(r);
    else if (strncmp(r->lines.text + 2, "ALP", 3) == 0)
        read_pressure_datum(r);
}

// SSFFCCC: bytes SS to FF, counted from 1, hold CCC. False: nothing that a B record can have.
static bool read_extension(Reader *r, const char *one) {
    if (strlen(one) < 7 || !is_digits(one, 4))
        return false;
    int first = number_of(one, 2), last = number_of(one + 2, 2);
    Extension *into = strncmp(one + 4, "LAD", 3) == 0   ? &r->lad
                      : strncmp(one + 4, "LOD", 3) == 0 ? &r->lod
                      : strncmp(one + 4, "TDS", 3) == 0 ? &r->tds
                                                        : NULL;
    if (into)
        *into = (Extension){first - 1, last - first + 1};
    return first > B_BYTES && last >= first;
}

// I NN then NN times SSFFCCC. Where any makes no sense, none is trusted.
static void read_extensions(Reader *r) {
    const char *text = r->lines.text;
    bool valid = strlen(text) >= 3 && is_digits(text + 1, 2);
    r->lad = r->lod = r->tds = (Extension){0, 0};
    int count = valid ? number_of(text + 1, 2) : 0;
    for (int i = 0; i < count && valid; i++)
        valid = strlen(text) >= (size_t)(10 + 7 * i) && read_extension(r, text + 3 + 7 * i);
    if (valid)
        return;
    r->lad = r->lod = r->tds = (Extension){0, 0};
    if (!r->again)
        log_warn(
            "%s:%lld: '%.40s': no list of extensions; expected I, their number in two digits, and as often SSFFCCC; "
            "positions have no further digits",
            r->lines.path, (long long)r->lines.number, r->lines.text);
}

// ---- fixes ----

// What the digits of an extension add, in units of the last digit before them: 0 .. 1.
static double further_digits(const char *text, Extension e) {
    double value = 0.0, unit = 1.0;
    if (e.count == 0 || strlen(text) < (size_t)(e.first + e.count) || !is_digits(text + e.first, e.count))
        return 0.0;
    for (int i = 0; i < e.count; i++)
        value += (unit *= 0.1) * (text[e.first + i] - '0');
    return value;
}

// DDMMmmm or DDDMMmmm and a hemisphere.
static bool read_angle(const char *text, int degree_digits, const char *hemispheres, double further, double *out) {
    const char *minutes = text + degree_digits;
    if (!is_digits(text, degree_digits + 5) || !strchr(hemispheres, minutes[5]) || number_of(minutes, 2) > 59)
        return false;
    *out = number_of(text, degree_digits) + (number_of(minutes, 5) + further) / 60000.0;
    if (minutes[5] == hemispheres[1])
        *out = -*out;
    return fabs(*out) <= (degree_digits == 2 ? 90.0 : 180.0);
}

// Five characters: digits, the first of which may be a sign.
static bool read_altitude(const char *text, double *out) {
    bool negative = *text == '-';
    if (!is_digits(text + negative, 5 - negative))
        return false;
    *out = number_of(text + negative, 5 - negative) * (negative ? -1.0 : 1.0);
    return true;
}

static bool read_clock(const Reader *r, double *clock_s) {
    const char *text = r->lines.text + 1;
    if (!is_digits(text, 6))
        return false;
    int hours = number_of(text, 2), minutes = number_of(text + 2, 2), seconds = number_of(text + 4, 2);
    *clock_s = hours * 3600.0 + minutes * 60.0 + seconds + further_digits(r->lines.text, r->tds);
    return hours < 24 && minutes < 60 && seconds < 61;
}

static bool read_fix(Reader *r, TrackPoint *point, double *clock_s) {
    const char *text = r->lines.text;
    double pressure_m, gnss_m;
    if (r->lines.cut || strlen(text) < B_BYTES || !read_clock(r, clock_s) ||
        !read_angle(text + 7, 2, "NS", further_digits(text, r->lad), &point->at.lat_deg) ||
        !read_angle(text + 15, 3, "EW", further_digits(text, r->lod), &point->at.lon_deg) || !strchr("AV", text[24]) ||
        !read_altitude(text + 25, &pressure_m) || !read_altitude(text + 30, &gnss_m))
        return false;
    r->has_gnss |= gnss_m != 0.0;
    r->has_pressure |= pressure_m != 0.0;
    point->pressure_m = (float)pressure_m;
    point->at.alt_m = r->from_pressure ? pressure_m : gnss_m;
    return true;
}

static Result add_fix(Reader *r) {
    TrackPoint point = {.flags = TRACK_DERIVED | TRACK_PRESSURE};
    double clock_s;
    if (!read_fix(r, &point, &clock_s)) {
        track_build_skip(&r->build, TRACK_SKIP_MALFORMED, r->lines.number);
        return RESULT_OK;
    }
    if (r->clock_s >= 0.0 && clock_s < r->clock_s - NOON_S)
        r->day_s += TRACK_DAY_S;
    r->clock_s = clock_s;
    point.t_s = r->day_s + clock_s;
    if (r->lines.text[24] == 'V') {
        track_build_skip(&r->build, TRACK_SKIP_INVALID, r->lines.number);
        return RESULT_OK;
    }
    return track_build_add(&r->build, r->lines.number, &point);
}

static Result read_lines(Reader *r) {
    Result result = RESULT_OK;
    while (result == RESULT_OK && track_lines_next(&r->lines)) {
        char kind = r->lines.text[0];
        if (kind == 'B')
            result = add_fix(r);
        else if (kind == 'H')
            read_header(r);
        else if (kind == 'I')
            read_extensions(r);
    }
    return result == RESULT_OK && track_lines_failed(&r->lines) ? RESULT_IO : result;
}

static Result read_all(Reader *r, const char *path, Track *out, bool from_pressure) {
    r->build = track_build_begin(path, out);
    r->from_pressure = from_pressure;
    r->day_s = 0.0;
    r->clock_s = -1.0;
    r->has_date = r->has_gnss = r->has_pressure = false;
    r->told = TOLD_NOTHING;
    r->told_pressure = PRESSURE_ISA;
    r->lad = r->lod = r->tds = (Extension){0, 0};
    return read_lines(r);
}

// ---- altitudes ----

static TrackHeights gnss_heights(const Reader *r, TrackIgcAlt asked) {
    if (r->told == TOLD_ELLIPSOID || r->told == TOLD_GEOID) {
        bool other = (asked == TRACK_IGC_ELLIPSOID && r->told == TOLD_GEOID) ||
                     (asked == TRACK_IGC_GEOID && r->told == TOLD_ELLIPSOID);
        if (other)
            log_warn("%s: its HFALG says that altitudes are above the %s, which is believed; take that line away to "
                     "have --igc-alt",
                     r->lines.path, r->told == TOLD_GEOID ? "geoid" : "ellipsoid");
        return r->told == TOLD_GEOID ? TRACK_HEIGHTS_GEOID : TRACK_HEIGHTS_ELLIPSOID;
    }
    return asked == TRACK_IGC_GEOID       ? TRACK_HEIGHTS_GEOID_ASKED
           : asked == TRACK_IGC_ELLIPSOID ? TRACK_HEIGHTS_ELLIPSOID_ASKED
                                          : TRACK_HEIGHTS_ELLIPSOID_ASSUMED;
}

static bool is_above_ellipsoid(TrackHeights heights) {
    return heights == TRACK_HEIGHTS_ELLIPSOID || heights == TRACK_HEIGHTS_ELLIPSOID_ASKED ||
           heights == TRACK_HEIGHTS_ELLIPSOID_ASSUMED;
}

// A column of zeros is none.
static void settle_pressure(const Reader *r) {
    if (r->has_pressure && r->told_pressure == PRESSURE_ISA)
        return;
    for (int i = 0; i < r->build.track->count; i++)
        r->build.track->points[i].flags &= ~(unsigned)TRACK_PRESSURE;
}

static Result settle_heights(Reader *r, const TrackReading *how) {
    Track *track = r->build.track;
    track->heights = r->from_pressure ? TRACK_HEIGHTS_PRESSURE : gnss_heights(r, how->igc_alt);
    if (!is_above_ellipsoid(track->heights))
        return RESULT_OK;
    if (!how->geoid) {
        log_error("%s: altitudes above the ellipsoid, and no geoid to convert them by; expected one", r->lines.path);
        return RESULT_UNSUPPORTED;
    }
    for (int i = 0; i < track->count; i++) {
        Viewpoint *at = &track->points[i].at;
        at->alt_m -= geoid_undulation_m(how->geoid, at->lat_deg, at->lon_deg);
    }
    return RESULT_OK;
}

static Result finish(Reader *r, const TrackReading *how) {
    Result result = settle_heights(r, how);
    if (result != RESULT_OK)
        return result;
    settle_pressure(r);
    r->build.track->format = "igc";
    if (!r->has_date)
        log_warn("%s: no HFDTE record: the day of the flight is unknown", r->lines.path);
    return track_build_end(&r->build, r->has_date);
}

// Recorders without GNSS altitude write zeros: then the pressure column is all there is.
static Result read_with(Reader *r, const char *path, const TrackReading *how, Track *out) {
    Result result = read_all(r, path, out, how->igc_alt == TRACK_IGC_PRESSURE);
    bool no_gnss = !r->has_gnss || r->told == TOLD_NONE;
    if (result == RESULT_OK && !r->from_pressure && no_gnss && out->count > 0) {
        log_warn("%s: without GNSS altitudes; pressure altitudes are taken, which are not above the geoid", path);
        track_clear(out);
        r->again = true;
        result = track_lines_rewind(&r->lines);
        if (result == RESULT_OK)
            result = read_all(r, path, out, true);
    }
    return result == RESULT_OK ? finish(r, how) : result;
}

Result track_igc_read(const char *path, const TrackReading *how, Track *out) {
    Reader reader;
    *out = (Track){0};
    reader.again = false;
    Result result = track_lines_open(path, &reader.lines);
    if (result != RESULT_OK)
        return result;
    result = read_with(&reader, path, how, out);
    track_lines_close(&reader.lines);
    if (result != RESULT_OK)
        track_clear(out);
    return result;
}

// ---- writing ----

// Which columns have altitudes, and what they are there.
typedef struct Altitudes {
    const Geoid *geoid; // NULL: the GNSS column has them above the geoid
    bool gnss, pressure;
} Altitudes;

// What came from such a file above the geoid goes back as it was, to the metre.
static Altitudes altitudes_of(const Track *track, const Geoid *geoid) {
    bool as_it_was = track->format && strcmp(track->format, "igc") == 0 && !is_above_ellipsoid(track->heights);
    return (Altitudes){.geoid = as_it_was ? NULL : geoid,
                       .gnss = track->heights != TRACK_HEIGHTS_PRESSURE,
                       .pressure = track_has_pressure(track)};
}

static void write_header(const Track *track, const Altitudes *altitudes, FILE *to) {
    TrackDate date = track_time_date(track->start_unix_s);
    fprintf(to,
            "AXXXOVFOverfly\r\nHFDTEDATE:%02d%02d%02d,01\r\nHFDTMGPSDATUM:WGS84\r\nHFALGALTGPS:%s\r\n"
            "HFALPALTPRESSURE:%s\r\nI023637LAD3839LOD\r\n",
            date.day % 100, date.month % 100, date.year % 100,
            !altitudes->gnss   ? "NIL"
            : altitudes->geoid ? "ELL"
                               : "GEO",
            altitudes->pressure ? "ISA" : "NIL");
}

static int whole_altitude(double alt_m) {
    return (int)lround(fmin(fmax(alt_m, -9999.0), 99999.0));
}

static int pressure_altitude(const TrackState *state, const Altitudes *altitudes) {
    if (!altitudes->gnss)
        return whole_altitude(state->at.alt_m);
    return altitudes->pressure ? whole_altitude(state->pressure_m) : 0;
}

static int gnss_altitude(const Viewpoint *at, const Altitudes *altitudes) {
    double n = altitudes->geoid ? geoid_undulation_m(altitudes->geoid, at->lat_deg, at->lon_deg) : 0.0;
    return altitudes->gnss ? whole_altitude(at->alt_m + n) : 0;
}

// Minutes are cut after three digits, and go on in LAD and LOD.
static void write_fix(double utc_s, const TrackState *state, const Altitudes *altitudes, FILE *to) {
    const Viewpoint *at = &state->at;
    TrackDate date = track_time_date(utc_s);
    double lon_deg = track_longitude(at->lon_deg);
    int lat = (int)lround(fabs(at->lat_deg) * DEGREE_UNITS), lon = (int)lround(fabs(lon_deg) * DEGREE_UNITS);
    fprintf(to, "B%02d%02d%02.0f%02d%05d%c%03d%05d%cA%05d%05d%02d%02d\r\n", date.hour, date.minute, date.second,
            lat / DEGREE_UNITS, lat % DEGREE_UNITS / 100, at->lat_deg < 0.0 ? 'S' : 'N', lon / DEGREE_UNITS,
            lon % DEGREE_UNITS / 100, lon_deg < 0.0 ? 'W' : 'E', pressure_altitude(state, altitudes),
            gnss_altitude(at, altitudes), lat % 100, lon % 100);
}

// The last point before the next gap.
static int segment_end(const Track *track, int i) {
    while (i + 1 < track->count && !(track->points[i + 1].flags & TRACK_GAP))
        i++;
    return i;
}

// A fix has whole seconds: the flight is told at the whole second nearest to each point, where it has that second.
void track_igc_write(const Track *track, const Geoid *geoid, FILE *to) {
    Altitudes altitudes = altitudes_of(track, geoid);
    double written_s = -INFINITY;
    int first = 0, last = -1;
    write_header(track, &altitudes, to);
    for (int i = 0; i < track->count && !ferror(to); i++) {
        if (i > last) {
            first = i;
            last = segment_end(track, i);
        }
        double whole_s = round(track_utc(track, i)), begin = track_utc(track, first), end = track_utc(track, last);
        bool outside = (whole_s < begin - 5e-4 || whole_s > end + 5e-4) && last > first;
        if (outside || whole_s <= written_s)
            continue;
        const TrackPoint *point = &track->points[i];
        bool exact = last == first || fabs(whole_s - track_utc(track, i)) < 5e-4;
        TrackState state = exact ? (TrackState){.at = point->at, .pressure_m = (double)point->pressure_m}
                                 : track_state_at(track, whole_s - track->start_unix_s);
        write_fix(whole_s, &state, &altitudes, to);
        written_s = whole_s;
    }
}
