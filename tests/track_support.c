#define _GNU_SOURCE
#include "track_support.h"

#include "base/paths.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static void name_file(const char *ending, char path[64]) {
    snprintf(path, 64, "track_text_%ld%s", (long)getpid(), ending);
}

Result track_of_text(const char *text, size_t bytes, const char *ending, const TrackReading *how, Track *out) {
    char path[64];
    name_file(ending, path);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, bytes, file), bytes);
    fclose(file);
    Result result = track_load(path, how, out);
    unlink(path);
    return result;
}

char *text_of_track(const Track *track, const char *ending, const Geoid *geoid, size_t *bytes) {
    char path[64];
    const TrackFormat *format;
    name_file(ending, path);
    assert_int_equal(track_format_of_ending(path, &format), RESULT_OK);
    assert_int_equal(track_save(path, format, track, geoid), RESULT_OK);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *bytes = (size_t)ftell(file);
    rewind(file);
    char *text = calloc(1, *bytes + 1);
    assert_non_null(text);
    assert_int_equal(fread(text, 1, *bytes, file), *bytes);
    fclose(file);
    unlink(path);
    return text;
}

Geoid *track_geoid(void) {
    char path[PATHS_BYTES_MAX];
    Geoid *geoid = NULL;
    assert_int_equal(paths_find_data("geoid/egm96-15.pgm", path), RESULT_OK);
    assert_int_equal(geoid_open(path, &geoid), RESULT_OK);
    return geoid;
}

Track track_aerobatic(int count) {
    Track track = {.name = "aerobatic", .count = count, .start_unix_s = 1704067170.0};
    track.points = calloc((size_t)count, sizeof *track.points);
    assert_non_null(track.points);
    for (int i = 0; i < count; i++) {
        double turn = 0.05 * i;
        track.points[i] = (TrackPoint){.t_s = i,
                                       .at = {.lat_deg = -33.9 + 0.01 * sin(turn),
                                              .lon_deg = 179.998 + 0.01 * cos(turn),
                                              .alt_m = 1200.0 + 7.25 * i,
                                              .heading_deg = fmod(7.0 * i, 360.0),
                                              .pitch_deg = 60.0 * sin(0.3 * i)},
                                       .bank_deg = remainder(11.0 * i, 360.0)};
    }
    return track;
}
