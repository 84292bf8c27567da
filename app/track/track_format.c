#define _POSIX_C_SOURCE 200809L
#include "app/track/track_format.h"

#include "app/track/track_formats_internal.h"
#include "base/log.h"
#include "terrain/mesh/mesh_file.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#define HEAD_BYTES 4096

const TrackFormat track_formats[] = {
    {.name = "igc",
     .ending = ".igc",
     .what = "IGC flight log",
     .wants_geoid = true,
     .wants_start = true,
     .has_pressure = true,
     .recognise = track_igc_recognise,
     .read = track_igc_read,
     .write = track_igc_write},
    {.name = "gpx",
     .ending = ".gpx",
     .what = "GPX 1.1",
     .wants_geoid = true,
     .wants_start = true,
     .has_objects = true,
     .recognise = track_gpx_recognise,
     .read = track_gpx_read,
     .write = track_gpx_write},
    {.name = "kml",
     .ending = ".kml",
     .what = "KML gx:Track",
     .wants_start = true,
     .has_attitude = true,
     .has_objects = true,
     .recognise = track_kml_recognise,
     .read = track_kml_read,
     .write = track_kml_write},
    {.name = "acmi",
     .ending = ".acmi",
     .what = "Tacview ACMI 2.2",
     .wants_start = true,
     .has_attitude = true,
     .has_objects = true,
     .recognise = track_acmi_recognise,
     .read = track_acmi_read,
     .write = track_acmi_write},
    {.name = "csv",
     .ending = ".csv",
     .what = "CSV",
     .has_attitude = true,
     .recognise = track_csv_recognise,
     .read = track_csv_read,
     .write = track_csv_write},
    {0},
};

TrackReading track_reading_default(void) {
    return (TrackReading){.igc_alt = TRACK_IGC_UNTOLD};
}

// ".igc, .gpx, ..."
static void list_endings(bool written, char *out, size_t bytes) {
    size_t used = 0;
    out[0] = '\0';
    for (const TrackFormat *f = track_formats; f->name; f++)
        if ((!written || f->write) && used < bytes)
            used += (size_t)snprintf(out + used, bytes - used, "%s%s", used ? ", " : "", f->ending);
}

static const TrackFormat *find_ending(const char *path) {
    size_t length = strlen(path);
    for (const TrackFormat *f = track_formats; f->name; f++) {
        size_t ending = strlen(f->ending);
        if (length > ending && strcasecmp(path + length - ending, f->ending) == 0)
            return f;
    }
    return NULL;
}

bool track_is_named(const char *path) {
    return find_ending(path) != NULL;
}

Result track_format_of_ending(const char *path, const TrackFormat **out) {
    char endings[128];
    const TrackFormat *format = find_ending(path);
    if (format && format->write) {
        *out = format;
        return RESULT_OK;
    }
    list_endings(true, endings, sizeof endings);
    log_error("%s: expected a name that ends with one of %s", path, endings);
    return RESULT_USAGE;
}

// A pipe would be waited for, and could not be read twice.
static Result check_file(const char *path) {
    struct stat about;
    if (stat(path, &about) != 0) {
        log_error("%s: the flight cannot be opened: %s", path, strerror(errno));
        return errno == ENOENT ? RESULT_NOT_FOUND : RESULT_IO;
    }
    if (S_ISREG(about.st_mode))
        return RESULT_OK;
    log_error("%s: %s; expected the file of a flight", path, S_ISDIR(about.st_mode) ? "a folder" : "no regular file");
    return RESULT_FORMAT;
}

static Result refuse_empty(const char *path) {
    char endings[128];
    list_endings(false, endings, sizeof endings);
    log_error("%s: the file is empty; expected a flight as .ofr, %s", path, endings);
    return RESULT_FORMAT;
}

static Result read_head(const char *path, char head[HEAD_BYTES + 1]) {
    Result result = check_file(path);
    if (result != RESULT_OK)
        return result;
    FILE *file = fopen(path, "rb");
    size_t count = file ? fread(head, 1, HEAD_BYTES, file) : 0;
    bool failed = !file || ferror(file);
    head[count] = '\0';
    if (failed)
        log_error("%s: the flight cannot be read: %s", path, strerror(errno));
    if (file)
        fclose(file);
    if (failed)
        return RESULT_IO;
    return count > 0 ? RESULT_OK : refuse_empty(path);
}

static Result refuse_unknown(const char *path, const char *head) {
    char endings[128];
    list_endings(false, endings, sizeof endings);
    if (strncmp(head, "PK\3\4", 4) == 0)
        log_error("%s: a zip archive, as .kmz and .zip.acmi are; unpack it first", path);
    else
        log_error("%s:1: of no known format; expected a flight as .ofr, %s", path, endings);
    return RESULT_FORMAT;
}

Result track_format_of_file(const char *path, const TrackFormat **out) {
    char head[HEAD_BYTES + 1];
    Result result = read_head(path, head);
    if (result != RESULT_OK)
        return result;
    const TrackFormat *named = find_ending(path);
    bool zipped = strncmp(head, "PK\3\4", 4) == 0;
    if (named && !zipped && named->recognise(head)) {
        *out = named;
        return RESULT_OK;
    }
    for (const TrackFormat *f = track_formats; f->name; f++) {
        if (zipped || !f->recognise(head))
            continue;
        if (named)
            log_warn("%s: is %s, whatever its name says", path, f->what);
        *out = f;
        return RESULT_OK;
    }
    *out = named;
    return named && !zipped ? RESULT_OK : refuse_unknown(path, head);
}

Result track_load(const char *path, const TrackReading *how, Track *out) {
    const TrackFormat *format;
    Result result = track_format_of_file(path, &format);
    return result == RESULT_OK ? format->read(path, how, out) : result;
}

Result track_save(const char *path, const TrackFormat *format, const Track *track, const Geoid *geoid) {
    if (format->wants_start && !isfinite(track->start_unix_s)) {
        log_error("%s: %s needs a date, and the flight has none; give it one: --start 2024-06-01T12:00:00Z", path,
                  format->what);
        return RESULT_USAGE;
    }
    if (track->heights == TRACK_HEIGHTS_PRESSURE && !format->has_pressure)
        log_warn("%s: pressure altitudes are written where %s has those above the geoid", path, format->what);
    MeshFile *file = NULL;
    Result result = mesh_file_create(path, &file);
    if (result != RESULT_OK)
        return result;
    format->write(track, geoid, mesh_file_stream(file));
    return mesh_file_commit(&file);
}

// ---- what the formats share ----

bool track_read_number(const char *text, double *out) {
    char *end;
    *out = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(*out);
}

double track_utc(const Track *track, int point) {
    return track->start_unix_s + (track->points[point].t_s - track->points[0].t_s);
}

double track_longitude(double lon_deg) {
    return remainder(lon_deg, 360.0);
}

// Bytes of the UTF-8 character at `text`, by its first byte and the count of those that continue it; 0: none.
static int character_bytes(const unsigned char *text) {
    int bytes = *text < 0x80 ? 1 : *text >= 0xC2 && *text < 0xE0 ? 2 : *text >= 0xE0 && *text < 0xF0 ? 3 : 0;
    for (int i = 1; i < bytes; i++)
        if ((text[i] & 0xC0) != 0x80)
            return 0;
    return bytes;
}

void track_write_xml_text(const char *text, FILE *to) {
    for (const unsigned char *t = (const unsigned char *)text; *t;) {
        int bytes = character_bytes(t);
        if (*t == '&' || *t == '<' || *t == '>' || *t == '"')
            fprintf(to, "&#%d;", *t);
        else if (bytes == 0 || *t < 0x20)
            fputc('?', to);
        else
            fwrite(t, 1, (size_t)bytes, to);
        t += bytes ? bytes : 1;
    }
}
