// Files that are missing, damaged, lying, or no elevation: one message each, with the file and a remedy; never a crash.
#define _GNU_SOURCE
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "tests/cut_support.h"
#include "tests/dem_support.h"

// ---- Refusals ---------------------------------------------------------------------------------------------------

static void expect_refusal(const char *path, Result expected, const char *words) {
    DemOptions options = dem_default_options();
    Heard heard;
    Dem *dem = NULL;
    options.spacing_m = 30.0;
    Result result = support_load(&options, path, &dem, &heard);
    print_message("%s: %s\n", result_name(result), heard.error);
    assert_int_equal(result, expected);
    assert_int_equal(heard.errors, 1);
    assert_null(dem);
    assert_non_null(strstr(heard.error, path));
    assert_non_null(strstr(heard.error, words));
}

static void missing_and_empty_files_are_named(void **state) {
    char path[192];
    dem_support_path(*state, "missing.tif", path);
    expect_refusal(path, RESULT_NOT_FOUND, "No such file");
    static const char *const NAMES[] = {"empty.tif", "empty.png", "N10E010.hgt", "empty.zip", "N10E010.hgt.gz"};
    for (size_t i = 0; i < COUNT_OF(NAMES); i++) {
        dem_support_path(*state, NAMES[i], path);
        support_write(path, "", 0);
        expect_refusal(path, RESULT_FORMAT, "again");
    }
}

static void folder_without_elevation_is_named(void **state) {
    char path[192];
    dem_support_path(*state, "hollow", path);
    support_run("mkdir -p %s", path);
    expect_refusal(path, RESULT_NOT_FOUND, ".hgt");
}

static void other_kinds_of_file_are_refused(void **state) {
    char path[192];
    dem_support_path(*state, "notes.txt", path);
    support_write(path, "No terrain here.\n", 17);
    expect_refusal(path, RESULT_FORMAT, "gdalwarp");
    char record[1025];
    snprintf(record, sizeof record, "%-1024s", "SOMEWHERE, WASH.  7.5 MINUTE QUAD");
    dem_support_path(*state, "old.dem", path);
    support_write(path, record, 1024);
    expect_refusal(path, RESULT_UNSUPPORTED, "gdalwarp -t_srs");
}

static void unsupported_geotiffs_name_the_command_that_mends_them(void **state) {
    support_skip_without_gdal();
    static const struct {
        const char *arguments;
        Result result;
        const char *words;
    } CASES[] = {
        {"-a_srs EPSG:26710 -a_ullr 500000 5200000 509700 5193900", RESULT_UNSUPPORTED, "gdalwarp -t_srs EPSG:32610"},
        {"-a_srs EPSG:4267", RESULT_UNSUPPORTED, "gdalwarp -t_srs EPSG:4326"},
        {"-a_srs EPSG:3857 -a_ullr 0 9700 9700 0", RESULT_UNSUPPORTED, "gdalwarp -t_srs EPSG:4326"},
        {"-a_srs EPSG:2056 -a_ullr 2600000 1200000 2609700 1193900", RESULT_UNSUPPORTED, "gdalwarp -t_srs EPSG:4326"},
        {"-ot Float64", RESULT_UNSUPPORTED, "-ot Float32"},
        {"-ot CFloat32", RESULT_UNSUPPORTED, "-ot Float32"},
        {"-ot Int16 -b 1 -b 1 -b 1", RESULT_UNSUPPORTED, "gdal_translate -b 1"},
        {"-ot Byte -b 1 -b 1 -b 1 -co PHOTOMETRIC=RGB", RESULT_FORMAT, "--image"},
        {"-ot Int16 -srcwin 0 0 1 20", RESULT_RANGE, "1 x 20"},
        {"-ot Int16 -srcwin 0 0 20 1", RESULT_RANGE, "20 x 1"},
        {"-ot Int16 -srcwin 20 40 11 7", RESULT_RANGE, "voids"},
        {"-ot Int16 -a_ullr 10 99 11 45", RESULT_RANGE, "-a_ullr"},
        {"-ot Float32 -scale 0 1 0 1000", RESULT_FORMAT, "-a_scale"},
        {"-gcp 0 0 10 46 -gcp 97 0 11 46 -gcp 0 61 10 45 -a_nodata none", RESULT_UNSUPPORTED, "gdalwarp"},
    };
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        char path[192], name[32];
        snprintf(name, sizeof name, "bad%zu.tif", i);
        dem_support_translate(*state, CASES[i].arguments, name, path);
        expect_refusal(path, CASES[i].result, CASES[i].words);
    }
}

static void image_without_coordinate_system_asks_for_it(void **state) {
    support_skip_without_gdal();
    char path[192];
    dem_support_path(*state, "nowhere.tif", path);
    support_run("gdal_translate -q %s %s", (*(DemSupport **)state)->source, path);
    expect_refusal(path, RESULT_UNSUPPORTED, "-a_srs");
}

static void rotated_matrix_is_refused(void **state) {
    support_skip_without_gdal();
    static const double TURNED[][6] = {{10.0, 0.001, 0.0002, 46.0, 0.0002, -0.001},
                                       {11.0, -0.001, 0.0, 46.0, 0.0, -0.001},
                                       {10.0, 0.0, 0.001, 46.0, 0.001, 0.0}};
    for (size_t i = 0; i < COUNT_OF(TURNED); i++) {
        char vrt[192], path[192];
        dem_support_vrt(*state, "turned.vrt", "EPSG:4326", TURNED[i], "", vrt);
        dem_support_path(*state, "turned.tif", path);
        support_run("gdal_translate -q %s %s", vrt, path);
        expect_refusal(path, RESULT_UNSUPPORTED, "gdalwarp");
    }
}

static void pictures_are_no_elevation(void **state) {
    support_skip_without_gdal();
    char path[192];
    dem_support_translate(*state, "-of PNG -ot Byte -a_nodata none", "eight.png", path);
    expect_refusal(path, RESULT_FORMAT, "16-bit");
    dem_support_translate(*state, "-of PNG -ot Byte -b 1 -b 1 -b 1 -scale 0 1250 0 255 -a_nodata none", "photo.png",
                          path);
    expect_refusal(path, RESULT_FORMAT, "terrarium");
}

// ---- Lies -------------------------------------------------------------------------------------------------------

// Overwrites the value of a tag of a little-endian classic TIFF's first directory, as a 32-bit number.
static void set_tag(uint8_t *tiff, size_t count, unsigned tag, uint32_t value) {
    uint32_t directory;
    memcpy(&directory, tiff + 4, 4);
    unsigned entries = tiff[directory] | tiff[directory + 1] << 8;
    for (unsigned i = 0; i < entries; i++) {
        uint8_t *entry = tiff + directory + 2 + 12 * i;
        assert_true(entry + 12 <= tiff + count);
        if ((unsigned)(entry[0] | entry[1] << 8) != tag)
            continue;
        entry[2] = 4, entry[3] = 0;
        memcpy(entry + 8, &value, 4);
        return;
    }
    fail_msg("no tag %u", tag);
}

static void lying_tiff_headers_are_refused(void **state) {
    support_skip_without_gdal();
    static const struct {
        const char *arguments;
        unsigned tag;
        uint32_t value;
    } LIES[] = {{"", 256, 0x80000000u},
                {"", 257, 0x80000000u},
                {"", 256, 0xffffffffu},
                {"", 256, 1 << 20},
                {"", 257, 1 << 20},
                {"-co COMPRESS=DEFLATE", 257, 1 << 20},
                {"-co COMPRESS=LZW", 256, 1 << 20},
                {"-co COMPRESS=ZSTD", 257, 1 << 20},
                {"-co TILED=YES -co COMPRESS=DEFLATE", 322, 0x7ffffff0u},
                {"-co TILED=YES -co COMPRESS=DEFLATE", 323, 0x7ffffff0u},
                {"-co COMPRESS=DEFLATE", 278, 0x7fffffffu},
                {"", 258, 64}};
    for (size_t i = 0; i < COUNT_OF(LIES); i++) {
        char arguments[96], path[192], name[32];
        size_t count;
        snprintf(arguments, sizeof arguments, "-ot Int16 %s", LIES[i].arguments);
        snprintf(name, sizeof name, "lie%zu.tif", i);
        dem_support_translate(*state, arguments, name, path);
        uint8_t *bytes = support_read(path, &count);
        set_tag(bytes, count, LIES[i].tag, LIES[i].value);
        support_write(path, bytes, count);
        free(bytes);
        DemOptions options = dem_default_options();
        Heard heard;
        Dem *dem = NULL;
        Result result = support_load(&options, path, &dem, &heard);
        print_message("tag %u = %u: %s %s\n", LIES[i].tag, LIES[i].value, result_name(result), heard.error);
        // More rows in a strip than there are is no lie: the strip is then as long as it is.
        assert_true(result != RESULT_OK || LIES[i].tag == 278);
        assert_int_equal(heard.errors, result == RESULT_OK ? 0 : 1);
        dem_destroy(&dem);
    }
}

static void lying_png_header_is_refused(void **state) {
    uint8_t png[64] = {0x89, 'P',  'N',  'G',  13,   10,   26,   10,   0,    0,  0, 13, 'I', 'H', 'D',
                       'R',  0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff, 16, 0, 0,  0,   0};
    char path[192];
    dem_support_path(*state, "lie.png", path);
    support_write(path, png, sizeof png);
    expect_refusal(path, RESULT_FORMAT, "promises");
}

// ---- Damage -----------------------------------------------------------------------------------------------------

// Whatever is wrong: a failure says so once; a success has finite heights.
static void load_damaged(const char *path, const char *what, size_t place) {
    DemOptions options = dem_default_options();
    Heard heard;
    Dem *dem = NULL;
    options.spacing_m = 30.0;
    Result result = support_load(&options, path, &dem, &heard);
    if (heard.errors != (result == RESULT_OK ? 0 : 1))
        fail_msg("%s: %s at %zu: %s with %d messages, the last: %s", path, what, place, result_name(result),
                 heard.errors, heard.error);
    for (int64_t i = 0; dem && i < (int64_t)dem->width * dem->height; i++)
        if (!isfinite(dem->height_m[i]))
            fail_msg("%s: %s at %zu: sample %lld is %g", path, what, place, (long long)i, (double)dem->height_m[i]);
    dem_destroy(&dem);
}

static void truncate_everywhere(const char *path, const uint8_t *bytes, size_t count) {
    for (size_t k = 0; k < 24; k++) {
        size_t length = k < 8 ? k * 37 % count : count - 1 - (count - 1) * (k - 8) / 17;
        support_write(path, bytes, length);
        load_damaged(path, "cut off", length);
    }
}

// Half of the damage goes to the first 600 bytes, where headers are.
static void flip_bits(const char *path, uint8_t *bytes, size_t count, int times, uint64_t *random) {
    for (int k = 0; k < times; k++) {
        size_t range = k & 1 && count > 600 ? 600 : count;
        size_t place = support_random(random) % range;
        uint8_t mask = (uint8_t)(1u << (support_random(random) % 8));
        bytes[place] ^= mask;
        support_write(path, bytes, count);
        load_damaged(path, "a bit flipped", place);
        bytes[place] ^= mask;
    }
}

static void damage(const char *path, int times) {
    uint64_t seed = 20, random = seed;
    size_t count;
    uint8_t *bytes = support_read(path, &count);
    print_message("%s: %zu bytes, %d flips, seed %llu\n", path, count, times, (unsigned long long)seed);
    truncate_everywhere(path, bytes, count);
    flip_bits(path, bytes, count, times, &random);
    free(bytes);
}

static void damaged_images_never_crash(void **state) {
    support_skip_without_gdal();
    static const struct {
        const char *arguments, *name;
    } CASES[] = {
        {"-ot Int16", "strip.tif"},
        {"-ot UInt16 -a_nodata 0 -co COMPRESS=DEFLATE -co PREDICTOR=2", "deflate.tif"},
        {"-ot Int16 -co COMPRESS=LZW -co TILED=YES -co BLOCKXSIZE=32 -co BLOCKYSIZE=32", "lzw.tif"},
        {"-ot Float32 -co COMPRESS=ZSTD -co PREDICTOR=3 -co BIGTIFF=YES", "zstd.tif"},
        {"-ot Int16 -a_srs EPSG:32633+5773 -a_ullr 400000 5200000 409700 5193900 -a_scale 0.5", "utm.tif"},
        {"-ot UInt16 -of PNG -a_nodata 0", "gray.png"},
    };
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        char path[192];
        dem_support_translate(*state, CASES[i].arguments, CASES[i].name, path);
        damage(path, 120);
    }
}

static void damaged_tiles_never_crash(void **state) {
    char path[192], gz[192];
    int16_t *samples = calloc(1201 * 1201, sizeof *samples);
    dem_support_path(*state, "S01W001.hgt", path);
    dem_support_path(*state, "S01W001.hgt.gz", gz);
    support_write(path, samples, 1201 * 1201 * sizeof *samples);
    free(samples);
    support_run("gzip -c %s > %s", path, gz);
    damage(gz, 40);
    truncate(path, 1000000) == 0 ? expect_refusal(path, RESULT_FORMAT, "2884802") : fail();
    if (access(SHARED_DIR "/dem/N20W157.hgt.zip", R_OK) == 0) {
        dem_support_path(*state, "N20W157.hgt.zip", path);
        support_run("cp " SHARED_DIR "/dem/N20W157.hgt.zip %s && chmod +w %s", path, path);
        damage(path, 4);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(missing_and_empty_files_are_named),
        cmocka_unit_test(folder_without_elevation_is_named),
        cmocka_unit_test(other_kinds_of_file_are_refused),
        cmocka_unit_test(unsupported_geotiffs_name_the_command_that_mends_them),
        cmocka_unit_test(image_without_coordinate_system_asks_for_it),
        cmocka_unit_test(rotated_matrix_is_refused),
        cmocka_unit_test(pictures_are_no_elevation),
        cmocka_unit_test(lying_tiff_headers_are_refused),
        cmocka_unit_test(lying_png_header_is_refused),
        cmocka_unit_test(damaged_images_never_crash),
        cmocka_unit_test(damaged_tiles_never_crash),
    };
    return cmocka_run_group_tests(tests, dem_support_setup, dem_support_teardown);
}
