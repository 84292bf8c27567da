// Several files as one elevation model: adjacent tiles, overlaps, gaps, the antimeridian, and files that don't fit.
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

#include "tests/dem_support.h"

#define TILE 1201

static Result load_paths(char (*paths)[192], int count, Dem **out, Heard *heard) {
    const char *list[8];
    for (int i = 0; i < count; i++)
        list[i] = paths[i];
    DemOptions options = dem_default_options();
    return support_load_paths(&options, list, count, out, heard);
}

// ---- SRTM tiles -------------------------------------------------------------------------------------------------

// A height that depends on the place alone, so that shared borders agree.
static int height_at(int lat_rows, int lon_cols) {
    return 100 + abs(lat_rows * 7 + lon_cols * 3) % 3000;
}

static void write_tile(const char *folder, int lat, int lon) {
    char path[256];
    snprintf(path, sizeof path, "%s/%c%02d%c%03d.hgt", folder, lat < 0 ? 'S' : 'N', abs(lat), lon < 0 ? 'W' : 'E',
             abs(lon));
    uint8_t *bytes = malloc(2 * TILE * TILE);
    for (int row = 0; row < TILE; row++)
        for (int col = 0; col < TILE; col++) {
            int turned = lon * 1200 + col < -100 * 1200 ? lon * 1200 + col + 360 * 1200 : lon * 1200 + col;
            int height = height_at((lat + 1) * 1200 - row, turned);
            bytes[2 * (row * TILE + col)] = (uint8_t)(height >> 8);
            bytes[2 * (row * TILE + col) + 1] = (uint8_t)height;
        }
    support_write(path, bytes, 2 * TILE * TILE);
    free(bytes);
}

static void make_folder(const DemSupport *support, const char *name, char *out) {
    dem_support_path(support, name, out);
    support_run("mkdir -p %s", out);
}

static Dem *load_folder(const char *folder) {
    char paths[1][192];
    Heard heard;
    Dem *dem;
    snprintf(paths[0], sizeof paths[0], "%s", folder);
    Result result = load_paths(paths, 1, &dem, &heard);
    if (result != RESULT_OK)
        fail_msg("%s: %s", folder, result_name(result));
    return dem;
}

static void check_heights(const Dem *dem, int north_rows, int west_cols) {
    for (int row = 0; row < dem->height; row++)
        for (int col = 0; col < dem->width; col++) {
            float found = dem->height_m[(size_t)row * (size_t)dem->width + (size_t)col];
            if (found != (float)height_at(north_rows - row, west_cols + col))
                fail_msg("at column %d, row %d: %g m, written %d", col, row, (double)found,
                         height_at(north_rows - row, west_cols + col));
        }
}

static void folder_of_tiles_is_one_grid(void **state) {
    char folder[192];
    make_folder(*state, "four", folder);
    for (int lat = -1; lat <= 0; lat++)
        for (int lon = 10; lon <= 11; lon++)
            write_tile(folder, lat, lon);
    support_run("gzip %s/N00E010.hgt", folder);
    Dem *dem = load_folder(folder);
    print_message("%d x %d from %.9g, %.9g\n", dem->width, dem->height, dem->georef.x0, dem->georef.y0);
    assert_int_equal(dem->width, 2401);
    assert_int_equal(dem->height, 2401);
    assert_true(dem->georef.x0 == 10.0 && dem->georef.y0 == 1.0);
    assert_int_equal(dem->voids, 0);
    assert_false(dem->datum_assumed);
    check_heights(dem, 1200, 10 * 1200);
    dem_destroy(&dem);
}

static void missing_tile_of_the_rectangle_is_void(void **state) {
    char folder[192];
    make_folder(*state, "three", folder);
    write_tile(folder, 46, 7);
    write_tile(folder, 47, 7);
    write_tile(folder, 47, 8);
    Dem *dem = load_folder(folder);
    assert_int_equal(dem->width, 2401);
    assert_int_equal(dem->height, 2401);
    assert_int_equal(dem->voids, 1200 * 1200);
    assert_true(isfinite(dem->height_m[2401 * 2401 - 1]));
    dem_destroy(&dem);
}

static void tiles_on_both_sides_of_the_antimeridian_are_neighbours(void **state) {
    char folder[192];
    make_folder(*state, "antimeridian", folder);
    write_tile(folder, -17, 179);
    write_tile(folder, -17, -180);
    Dem *dem = load_folder(folder);
    double middle = dem->georef.x0 + 1200.0 * dem->georef.dx;
    print_message("%d x %d, middle %.9g\n", dem->width, dem->height, middle);
    assert_int_equal(dem->width, 2401);
    assert_int_equal(dem->voids, 0);
    assert_true(fabs(fabs(middle) - 180.0) < 1e-9);
    check_heights(dem, -16 * 1200, 179 * 1200);
    dem_destroy(&dem);
}

static void distant_tiles_are_refused(void **state) {
    char paths[2][192], folder[192];
    make_folder(*state, "apart", folder);
    write_tile(folder, 46, 7);
    write_tile(folder, 46, 9);
    Heard heard;
    Dem *dem;
    snprintf(paths[0], sizeof paths[0], "%s", folder);
    assert_int_equal(load_paths(paths, 1, &dem, &heard), RESULT_RANGE);
    assert_null(dem);
}

static void shared_tiles_equal_gdals(void **state) {
    (void)state;
    support_skip_without_gdal();
    const char *zip = SHARED_DIR "/dem/N20W157.hgt.zip";
    if (access(zip, R_OK)) {
        print_message("skipped: no %s\n", zip);
        skip();
    }
    GdalRaster gdal = support_gdal_raster(*state, zip);
    char paths[1][192];
    Heard heard;
    Dem *dem;
    snprintf(paths[0], sizeof paths[0], "%s", zip);
    assert_int_equal(load_paths(paths, 1, &dem, &heard), RESULT_OK);
    int64_t voids = 0;
    for (int i = 0; i < dem->width * dem->height; i++) {
        voids += gdal.stored[i] == -32768.0f;
        assert_true(gdal.stored[i] == -32768.0f || gdal.stored[i] == dem->height_m[i]);
    }
    assert_int_equal(dem->voids, voids);
    free(gdal.stored);
    dem_destroy(&dem);
}

// ---- GeoTIFF ----------------------------------------------------------------------------------------------------

// Four parts of the source; `overlap` samples of each are in its neighbours as well.
static void cut_in_four(const DemSupport *support, const char *storage, int overlap, char (*paths)[192]) {
    static const int X[] = {0, 40, 0, 40}, Y[] = {0, 0, 25, 25};
    for (int i = 0; i < 4; i++) {
        char arguments[160], name[32];
        snprintf(arguments, sizeof arguments, "-ot Int16 %s -srcwin %d %d %d %d", storage, X[i], Y[i],
                 X[i] ? SUPPORT_WIDTH - 40 : 40 + overlap, Y[i] ? SUPPORT_HEIGHT - 25 : 25 + overlap);
        snprintf(name, sizeof name, "part%d.tif", i);
        dem_support_translate(support, arguments, name, paths[i]);
    }
}

static void parts_of_a_geotiff_make_the_whole(void **state) {
    support_skip_without_gdal();
    static const struct {
        const char *storage;
        int overlap;
    } CASES[] = {{"", 0}, {"-mo AREA_OR_POINT=Point", 1}, {"-co TILED=YES -co COMPRESS=DEFLATE", 3}};
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        char paths[4][192];
        Heard heard;
        Dem *dem;
        cut_in_four(*state, CASES[i].storage, CASES[i].overlap, paths);
        assert_int_equal(load_paths(paths, 4, &dem, &heard), RESULT_OK);
        assert_int_equal(dem->width, SUPPORT_WIDTH);
        assert_int_equal(dem->height, SUPPORT_HEIGHT);
        assert_int_equal(dem->voids, 11 * 7);
        for (int row = 0; row < dem->height; row++)
            for (int col = 0; col < dem->width; col++)
                if (dem_support_height(col, row) != SUPPORT_NODATA)
                    assert_true(dem->height_m[row * dem->width + col] == (float)dem_support_height(col, row));
        dem_destroy(&dem);
    }
}

static void files_that_share_more_than_a_border_are_named(void **state) {
    support_skip_without_gdal();
    static const int OVERLAPS[] = {1, 12, 20};
    for (size_t i = 0; i < COUNT_OF(OVERLAPS); i++) {
        char paths[4][192];
        Heard heard;
        Dem *dem;
        cut_in_four(*state, "", OVERLAPS[i], paths);
        assert_int_equal(load_paths(paths, 4, &dem, &heard), RESULT_OK);
        assert_int_equal(dem->file_count, 4);
        assert_string_equal(dem->files[3], paths[3]);
        bool named = strstr(heard.warning, "overlap") && strstr(heard.warning, "part0.tif and ");
        print_message("%d shared: '%s'\n", OVERLAPS[i], heard.warning);
        assert_int_equal(named, OVERLAPS[i] > 16);
        dem_destroy(&dem);
    }
}

static void other_grids_are_refused(void **state) {
    support_skip_without_gdal();
    static const char *const OTHERS[] = {
        "-ot Int16 -a_srs EPSG:32633 -a_ullr 400000 5200000 409700 5193900", // another system
        "-ot Int16 -a_ullr 10.09 45.06 10.18 45.0",                          // another distance
        "-ot Int16 -a_srs EPSG:4979",                                        // another datum
    };
    char paths[2][192];
    dem_support_translate(*state, "-ot Int16", "first.tif", paths[0]);
    for (size_t i = 0; i < COUNT_OF(OTHERS); i++) {
        Heard heard;
        Dem *dem;
        dem_support_translate(*state, OTHERS[i], "other.tif", paths[1]);
        assert_int_equal(load_paths(paths, 2, &dem, &heard), RESULT_RANGE);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(folder_of_tiles_is_one_grid),
        cmocka_unit_test(missing_tile_of_the_rectangle_is_void),
        cmocka_unit_test(tiles_on_both_sides_of_the_antimeridian_are_neighbours),
        cmocka_unit_test(distant_tiles_are_refused),
        cmocka_unit_test(shared_tiles_equal_gdals),
        cmocka_unit_test(parts_of_a_geotiff_make_the_whole),
        cmocka_unit_test(files_that_share_more_than_a_border_are_named),
        cmocka_unit_test(other_grids_are_refused),
    };
    return cmocka_run_group_tests(tests, dem_support_setup, dem_support_teardown);
}
