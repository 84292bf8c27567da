// The geoid made when building, read through terrain/geo.h, against its own source and a reference grid.
#define _GNU_SOURCE
#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/log.h"
#include "base/paths.h"
#include "terrain/geo.h"

#define REFERENCE SHARED_DIR "/geo/egm96-15.pgm"
#define VALUES (721 * 1440)

static void hear(void *user, LogLevel level, const char *message) {
    if (level == LOG_ERROR)
        snprintf(user, 2048, "%s", message);
}

static Geoid *open_made(void) {
    char path[PATHS_BYTES_MAX];
    Geoid *geoid = NULL;
    assert_int_equal(paths_find_data("geoid/egm96-15.pgm", path), RESULT_OK);
    assert_int_equal(geoid_open(path, &geoid), RESULT_OK);
    return geoid;
}

static uint8_t *read_values(const char *path) {
    uint8_t *values = malloc(2 * VALUES);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fseek(file, -2L * VALUES, SEEK_END), 0);
    assert_int_equal(fread(values, 2, VALUES, file), VALUES);
    fclose(file);
    return values;
}

static void made_grid_equals_the_reference(void **state) {
    (void)state;
    if (access(REFERENCE, R_OK)) {
        print_message("skipped: no %s\n", REFERENCE);
        skip();
    }
    char path[PATHS_BYTES_MAX];
    assert_int_equal(paths_find_data("geoid/egm96-15.pgm", path), RESULT_OK);
    uint8_t *ours = read_values(path), *theirs = read_values(REFERENCE);
    int different = 0;
    for (int i = 0; i < VALUES; i++)
        different += ours[2 * i] != theirs[2 * i] || ours[2 * i + 1] != theirs[2 * i + 1];
    print_message("%d of %d values differ\n", different, VALUES);
    free(ours);
    free(theirs);
    assert_int_equal(different, 0);
}

// From the GTX file, whose rows begin at 90 S, 180 W, every quarter degree: big-endian floats after 40 bytes.
static float source_value(FILE *file, int row, int col) {
    uint8_t bytes[4];
    assert_int_equal(fseek(file, 40L + 4L * (row * 1440L + col), SEEK_SET), 0);
    assert_int_equal(fread(bytes, 1, 4, file), 4);
    uint32_t bits = (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void grid_points_have_the_source_values(void **state) {
    (void)state;
    Geoid *geoid = open_made();
    FILE *file = fopen(EGM96_GTX, "rb");
    assert_non_null(file);
    double worst = 0.0;
    for (int row = 0; row <= 720; row += 5)
        for (int col = 0; col < 1440; col += 7) {
            double lat = -90.0 + row * 0.25, lon = -180.0 + col * 0.25;
            double error = fabs(geoid_undulation_m(geoid, lat, lon) - (double)source_value(file, row, col));
            // A cubic through twelve points does not meet them exactly.
            worst = fmax(worst, error);
        }
    fclose(file);
    geoid_close(&geoid);
    assert_null(geoid);
    print_message("at grid points: %.4f m from the source\n", worst);
    assert_true(worst < 0.2);
}

static void poles_have_the_published_values_at_any_longitude(void **state) {
    (void)state;
    Geoid *geoid = open_made();
    for (double lon = -720.0; lon <= 720.0; lon += 15.0) {
        double north = geoid_undulation_m(geoid, 90.0, lon), south = geoid_undulation_m(geoid, -90.0, lon);
        if (fabs(north - 13.606) >= 0.01 || fabs(south - -29.534) >= 0.01)
            fail_msg("at longitude %g: %.4f and %.4f m, expected 13.606 and -29.534", lon, north, south);
    }
    geoid_close(&geoid);
}

// The largest jump across a meridian. The cubic patches don't quite meet, anywhere.
static double jump_across(const Geoid *geoid, double lon) {
    double jump = 0.0;
    for (double lat = -89.9; lat < 90.0; lat += 0.3)
        jump =
            fmax(jump, fabs(geoid_undulation_m(geoid, lat, lon - 1e-9) - geoid_undulation_m(geoid, lat, lon + 1e-9)));
    return jump;
}

static void seams_are_as_smooth_as_any_meridian(void **state) {
    (void)state;
    Geoid *geoid = open_made();
    double ordinary = 0.0;
    for (double lon = -170.0; lon < 180.0; lon += 20.25)
        ordinary = fmax(ordinary, jump_across(geoid, lon));
    double greenwich = jump_across(geoid, 0.0), antimeridian = jump_across(geoid, 180.0);
    print_message("jumps: %.4f m at 0, %.4f m at 180, up to %.4f m elsewhere\n", greenwich, antimeridian, ordinary);
    assert_true(greenwich <= 1.5 * ordinary);
    assert_true(antimeridian <= 1.5 * ordinary);
    for (double lon = -360.0; lon <= 360.0; lon += 7.3)
        assert_true(fabs(geoid_undulation_m(geoid, 10.0, lon) - geoid_undulation_m(geoid, 10.0, lon + 360.0)) < 1e-9);
    geoid_close(&geoid);
}

typedef struct Reader {
    const Geoid *geoid;
    double sum;
} Reader;

static void *sum_undulations(void *user) {
    Reader *reader = user;
    for (int i = 0; i < 200000; i++)
        reader->sum += geoid_undulation_m(reader->geoid, (i * 37 % 18000) / 100.0 - 90.0, (i * 61 % 36000) / 100.0);
    return NULL;
}

static void threads_read_the_same_values(void **state) {
    (void)state;
    Geoid *geoid = open_made();
    pthread_t threads[4];
    Reader readers[4];
    for (int i = 0; i < 4; i++) {
        readers[i] = (Reader){.geoid = geoid};
        assert_int_equal(pthread_create(&threads[i], NULL, sum_undulations, &readers[i]), 0);
    }
    for (int i = 0; i < 4; i++)
        pthread_join(threads[i], NULL);
    for (int i = 1; i < 4; i++)
        assert_true(readers[i].sum == readers[0].sum);
    geoid_close(&geoid);
}

static void missing_geoid_is_an_error_that_names_the_file(void **state) {
    (void)state;
    char heard[2048] = "";
    Geoid *geoid = NULL;
    log_set_sink(hear, heard);
    Result result = geoid_open("/nowhere/egm96-15.pgm", &geoid);
    log_set_sink(NULL, NULL);
    print_message("%s: %s\n", result_name(result), heard);
    assert_int_equal(result, RESULT_NOT_FOUND);
    assert_non_null(strstr(heard, "/nowhere/egm96-15.pgm"));
    assert_null(geoid);
}

static void damaged_geoid_is_refused(void **state) {
    (void)state;
    char path[] = "/tmp/overfly-geoid-XXXXXX.pgm", heard[2048] = "";
    int file = mkstemps(path, 4);
    assert_true(file >= 0);
    const char text[] = "P5\n# Offset -108\n# Scale 0.003\n1440 721\n65535\nshort";
    assert_int_equal(write(file, text, sizeof text), sizeof text);
    close(file);
    Geoid *geoid = NULL;
    log_set_sink(hear, heard);
    Result result = geoid_open(path, &geoid);
    log_set_sink(NULL, NULL);
    unlink(path);
    print_message("%s: %s\n", result_name(result), heard);
    assert_int_equal(result, RESULT_FORMAT);
    assert_non_null(strstr(heard, path));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(made_grid_equals_the_reference),
        cmocka_unit_test(grid_points_have_the_source_values),
        cmocka_unit_test(poles_have_the_published_values_at_any_longitude),
        cmocka_unit_test(seams_are_as_smooth_as_any_meridian),
        cmocka_unit_test(threads_read_the_same_values),
        cmocka_unit_test(missing_geoid_is_an_error_that_names_the_file),
        cmocka_unit_test(damaged_geoid_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
