// Elevation files in every variety against what GDAL's tools find in them, sample by sample.
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

// ---- Comparing --------------------------------------------------------------------------------------------------

typedef struct Expected {
    const char *type;
    double scale, offset; // metres = stored * scale + offset
    double nodata;        // as stored
    bool area;
} Expected;

static void check_georef(const char *what, const Dem *dem, const GdalRaster *gdal) {
    const double *t = gdal->transform;
    bool south_up = t[5] > 0.0;
    double x0 = t[0] + 0.5 * t[1], y0 = t[3] + (south_up ? gdal->height - 0.5 : 0.5) * t[5];
    double turns = 360.0 * round((dem->georef.x0 - x0) / 360.0);
    if (fabs(dem->georef.x0 - turns - x0) > 1e-9 * fabs(x0) || fabs(dem->georef.y0 - y0) > 1e-9 * fabs(y0) ||
        fabs(dem->georef.dx - t[1]) > 1e-9 * t[1] || fabs(dem->georef.dy + fabs(t[5])) > 1e-9 * fabs(t[5]))
        fail_msg("%s: first centre %.12g %.12g step %.12g %.12g; GDAL: %.12g %.12g, %.12g %.12g", what, dem->georef.x0,
                 dem->georef.y0, dem->georef.dx, dem->georef.dy, x0, y0, t[1], t[5]);
}

static int64_t check_samples(const char *what, const Dem *dem, const GdalRaster *gdal, const Expected *expected) {
    int64_t voids = 0;
    for (int row = 0; row < dem->height; row++)
        for (int col = 0; col < dem->width; col++) {
            int gdal_row = gdal->transform[5] > 0.0 ? dem->height - 1 - row : row;
            double stored = (double)gdal->stored[gdal_row * dem->width + col];
            float found = dem->height_m[row * dem->width + col];
            if (stored == expected->nodata || !isfinite(stored)) {
                voids++;
                assert_true(isfinite(found));
                continue;
            }
            double wanted = stored * expected->scale + expected->offset;
            if (!(fabs((double)found - wanted) <= 1e-6 * fmax(1.0, fabs(wanted))))
                fail_msg("%s: at column %d, row %d: %.9g m; GDAL: %.9g", what, col, row, (double)found, wanted);
        }
    return voids;
}

static void check_range(const char *what, const Dem *dem, const GdalRaster *gdal, const Expected *expected) {
    double low = INFINITY, high = -INFINITY;
    for (int i = 0; i < dem->width * dem->height; i++)
        if ((double)gdal->stored[i] != expected->nodata && isfinite(gdal->stored[i])) {
            low = fmin(low, (double)gdal->stored[i] * expected->scale + expected->offset);
            high = fmax(high, (double)gdal->stored[i] * expected->scale + expected->offset);
        }
    if (fabs((double)dem->min_m - low) > 1e-3 || fabs((double)dem->max_m - high) > 1e-3)
        fail_msg("%s: %g..%g m; GDAL: %g..%g", what, (double)dem->min_m, (double)dem->max_m, low, high);
}

static Dem *load(const char *path, Heard *heard) {
    DemOptions options = dem_default_options();
    Dem *dem = NULL;
    Result result = support_load(&options, path, &dem, heard);
    if (result != RESULT_OK)
        fail_msg("%s: %s: %s", path, result_name(result), heard->error);
    return dem;
}

static void check_against_gdal(const DemSupport *support, const char *path, const Expected *expected) {
    Heard heard;
    Dem *dem = load(path, &heard);
    GdalRaster gdal = support_gdal_raster(support, path);
    assert_int_equal(dem->width, gdal.width);
    assert_int_equal(dem->height, gdal.height);
    assert_string_equal(dem->type, expected->type);
    assert_int_equal(dem->pixel_is_area, expected->area);
    check_georef(path, dem, &gdal);
    check_range(path, dem, &gdal, expected);
    assert_int_equal(dem->voids, check_samples(path, dem, &gdal, expected));
    free(gdal.stored);
    dem_destroy(&dem);
    assert_null(dem);
}

// ---- Storage ----------------------------------------------------------------------------------------------------

static void every_storage_gives_gdals_samples(void **state) {
    support_skip_without_gdal();
    static const struct {
        const char *arguments, *type;
    } CASES[] = {
        {"-ot Int16", "int16"},
        {"-ot Int16 -co BLOCKYSIZE=1", "int16"},
        {"-ot Int16 -co BLOCKYSIZE=61 -co COMPRESS=DEFLATE", "int16"},
        {"-ot Int16 -co COMPRESS=DEFLATE -co PREDICTOR=2 -co BLOCKYSIZE=7", "int16"},
        {"-ot Int16 -co COMPRESS=LZW -co PREDICTOR=2", "int16"},
        {"-ot Int16 -co COMPRESS=ZSTD -co PREDICTOR=2", "int16"},
        {"-ot Int16 -co COMPRESS=PACKBITS", "int16"},
        {"-ot Int16 -co ENDIANNESS=BIG -co COMPRESS=DEFLATE -co PREDICTOR=2", "int16"},
        {"-ot Int16 -co TILED=YES -co BLOCKXSIZE=32 -co BLOCKYSIZE=16", "int16"},
        {"-ot Int16 -co TILED=YES -co COMPRESS=DEFLATE -co PREDICTOR=2", "int16"},
        {"-ot Int16 -co TILED=YES -co COMPRESS=LZW -co BIGTIFF=YES", "int16"},
        {"-ot Int16 -co TILED=YES -co COMPRESS=ZSTD -co BIGTIFF=YES", "int16"},
        {"-ot UInt16 -a_nodata 65535", "uint16"},
        {"-ot UInt16 -a_nodata 0 -co COMPRESS=DEFLATE -co PREDICTOR=2 -co BLOCKYSIZE=16", "uint16"},
        {"-ot UInt16 -a_nodata 0 -co COMPRESS=ZSTD -co TILED=YES", "uint16"},
        {"-ot UInt16 -a_nodata 0 -co ENDIANNESS=BIG -co COMPRESS=LZW -co BIGTIFF=YES", "uint16"},
        {"-ot Float32", "float32"},
        {"-ot Float32 -co COMPRESS=DEFLATE -co PREDICTOR=3", "float32"},
        {"-ot Float32 -co COMPRESS=LZW -co PREDICTOR=2 -co BLOCKYSIZE=5", "float32"},
        {"-ot Float32 -co COMPRESS=ZSTD -co PREDICTOR=3 -co TILED=YES -co BIGTIFF=YES", "float32"},
        {"-ot Float32 -co ENDIANNESS=BIG -co TILED=YES", "float32"},
        {"-ot Int32 -co COMPRESS=DEFLATE -co PREDICTOR=2", "int32"},
        {"-ot UInt32 -a_nodata 0 -co TILED=YES", "uint32"},
        {"-ot Byte -scale 0 1250 1 250 -a_nodata 0 -co COMPRESS=LZW", "uint8"},
    };
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        char path[192], name[32];
        snprintf(name, sizeof name, "storage%zu.tif", i);
        dem_support_translate(*state, CASES[i].arguments, name, path);
        const char *nodata = strstr(CASES[i].arguments, "-a_nodata ");
        Expected expected = {
            .type = CASES[i].type, .scale = 1.0, .nodata = nodata ? atof(nodata + 10) : SUPPORT_NODATA, .area = true};
        check_against_gdal(*state, path, &expected);
    }
}

static void scale_and_offset_apply_to_samples(void **state) {
    support_skip_without_gdal();
    char path[192];
    dem_support_translate(*state, "-ot Int16 -a_scale 0.1 -a_offset 100", "scaled.tif", path);
    check_against_gdal(*state, path, &(Expected){"int16", 0.1, 100.0, SUPPORT_NODATA, true});
}

static void feet_become_metres(void **state) {
    support_skip_without_gdal();
    static const struct {
        const char *srs, *elements;
        double metres;
    } CASES[] = {{"EPSG:4326", "<UnitType>ft</UnitType>", 0.3048},
                 {"EPSG:4326", "<UnitType>us-ft</UnitType>", 1200.0 / 3937.0},
                 {"EPSG:4326", "<UnitType>m</UnitType>", 1.0},
                 {"EPSG:4326+6360", "", 1200.0 / 3937.0},
                 {"EPSG:4326+8228", "", 0.3048}};
    const double transform[6] = {10.0, 0.001, 0.0, 46.0, 0.0, -0.001};
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        char vrt[192], path[192];
        dem_support_vrt(*state, "feet.vrt", CASES[i].srs, transform, CASES[i].elements, vrt);
        dem_support_path(*state, "feet.tif", path);
        support_run("gdal_translate -q %s %s", vrt, path);
        check_against_gdal(*state, path, &(Expected){"int16", CASES[i].metres, 0.0, SUPPORT_NODATA, true});
    }
}

static void lowest_float_and_nan_are_voids(void **state) {
    support_skip_without_gdal();
    char path[192];
    dem_support_translate(*state, "-ot Float32 -a_nodata nan", "nan.tif", path);
    Heard heard;
    Dem *dem = load(path, &heard); // -9999 is a height there
    assert_int_equal(dem->voids, 0);
    dem_destroy(&dem);
    char lowest[192];
    dem_support_path(*state, "lowest.tif", lowest);
    support_run("gdalwarp -q -ot Float32 -s_srs EPSG:4326 -t_srs EPSG:4326 -dstnodata -3.40282346638529e+38 %s %s",
                (*(DemSupport **)state)->source, lowest);
    dem = load(lowest, &heard);
    assert_int_equal(dem->voids, 11 * 7);
    dem_destroy(&dem);
}

static void alpha_marks_voids_and_a_second_band_is_named(void **state) {
    support_skip_without_gdal();
    char path[192];
    Heard heard;
    dem_support_translate(*state, "-ot UInt16 -b 1 -b mask -a_nodata none -co ALPHA=YES", "alpha.tif", path);
    Dem *dem = load(path, &heard);
    assert_int_equal(dem->voids, 11 * 7);
    assert_int_equal(heard.warnings, 0);
    dem_destroy(&dem);
    dem_support_translate(*state, "-ot UInt16 -b 1 -b 1 -a_nodata 0 -co INTERLEAVE=PIXEL", "two.tif", path);
    dem = load(path, &heard);
    assert_int_equal(heard.warnings, 1);
    assert_non_null(strstr(heard.warning, "the first is read"));
    dem_destroy(&dem);
    check_against_gdal(*state, path, &(Expected){"uint16", 1.0, 0.0, 0.0, true});
    dem_support_translate(*state, "-ot UInt16 -b 1 -b 1 -a_nodata 0 -co INTERLEAVE=BAND -co COMPRESS=LZW", "two.tif",
                          path);
    check_against_gdal(*state, path, &(Expected){"uint16", 1.0, 0.0, 0.0, true});
}

// ---- Placement --------------------------------------------------------------------------------------------------

static void placements_are_gdals(void **state) {
    support_skip_without_gdal();
    static const struct {
        const char *what, *arguments;
        bool area;
        const char *crs;
    } CASES[] = {
        {"point", "-mo AREA_OR_POINT=Point", false, "EPSG:4326"},
        {"utm north", "-a_srs EPSG:32633 -a_ullr 400000 5200000 409700 5193900", true, "EPSG:32633"},
        {"utm south, point", "-a_srs EPSG:32719 -a_ullr 400000 8200000 409700 8193900 -mo AREA_OR_POINT=Point", false,
         "EPSG:32719"},
        {"utm, cells not square", "-a_srs EPSG:32633 -a_ullr 400000 5200000 404850 5193900", true, "EPSG:32633"},
        {"0..360", "-a_ullr 200 46 200.5 45.7", true, "EPSG:4326"},
        {"540", "-a_ullr 540.5 46 541 45.7", true, "EPSG:4326"},
        {"over the antimeridian", "-a_ullr 179.8 -16 180.4 -16.3", true, "EPSG:4326"},
        {"west of it", "-a_ullr -180.4 -16 -179.8 -16.3", true, "EPSG:4326"},
        {"half a pixel beyond 180 and 90", "-a_ullr -181.875 91.5 181.875 -91.5", true, "EPSG:4326"},
        {"the whole globe", "-a_ullr -180 90 180 -90", true, "EPSG:4326"},
    };
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        char path[192];
        dem_support_translate(*state, CASES[i].arguments, "placed.tif", path);
        check_against_gdal(*state, path, &(Expected){"int32", 1.0, 0.0, SUPPORT_NODATA, CASES[i].area});
        Heard heard;
        Dem *dem = load(path, &heard);
        double middle = dem->georef.x0 + 0.5 * dem->georef.dx * (dem->width - 1);
        if (strcmp(dem->crs_name, CASES[i].crs) != 0 || (dem->georef.crs == DEM_CRS_GEOGRAPHIC && fabs(middle) > 180.0))
            fail_msg("%s: %s, middle %g", CASES[i].what, dem->crs_name, middle);
        dem_destroy(&dem);
    }
}

static void south_up_matrix_is_turned(void **state) {
    support_skip_without_gdal();
    char vrt[192], path[192];
    const double transform[6] = {10.0, 0.001, 0.0, 45.0, 0.0, 0.001};
    dem_support_vrt(*state, "south.vrt", "EPSG:4326", transform, "", vrt);
    dem_support_path(*state, "south.tif", path);
    support_run("gdal_translate -q %s %s", vrt, path);
    check_against_gdal(*state, path, &(Expected){"int16", 1.0, 0.0, SUPPORT_NODATA, true});
}

static void user_defined_utm_is_recognised(void **state) {
    support_skip_without_gdal();
    char path[192];
    dem_support_translate(*state,
                          "-a_srs '+proj=tmerc +lat_0=0 +lon_0=15 +k=0.9996 +x_0=500000 +y_0=0 +datum=WGS84 +units=m' "
                          "-a_ullr 400000 5200000 409700 5193900",
                          "tmerc.tif", path);
    Heard heard;
    Dem *dem = load(path, &heard);
    assert_int_equal(dem->georef.crs, DEM_CRS_UTM);
    assert_int_equal(dem->georef.utm_zone, 33);
    assert_true(dem->georef.utm_north);
    dem_destroy(&dem);
}

static void vertical_datum_comes_from_the_file(void **state) {
    support_skip_without_gdal();
    static const struct {
        const char *srs;
        DemDatum datum;
        bool assumed;
        int warnings;
    } CASES[] = {{"EPSG:4326", DEM_DATUM_EGM96, true, 0},
                 {"EPSG:4326+5773", DEM_DATUM_EGM96, false, 0},
                 {"EPSG:4979", DEM_DATUM_ELLIPSOID, false, 0},
                 {"EPSG:4326+5703", DEM_DATUM_EGM96, true, 1}};
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        char arguments[64], path[192];
        snprintf(arguments, sizeof arguments, "-ot Int16 -a_srs %s", CASES[i].srs);
        dem_support_translate(*state, arguments, "datum.tif", path);
        Heard heard;
        Dem *dem = load(path, &heard);
        if (dem->datum != CASES[i].datum || dem->datum_assumed != CASES[i].assumed ||
            heard.warnings != CASES[i].warnings)
            fail_msg("%s: datum %d, assumed %d, %d warnings: %s", CASES[i].srs, dem->datum, dem->datum_assumed,
                     heard.warnings, heard.warning);
        dem_destroy(&dem);
    }
}

static void given_datum_wins(void **state) {
    support_skip_without_gdal();
    char path[192];
    dem_support_translate(*state, "-ot Int16", "given.tif", path);
    DemOptions options = dem_default_options();
    options.datum_given = true;
    options.datum = DEM_DATUM_ELLIPSOID;
    Heard heard;
    Dem *dem;
    assert_int_equal(support_load(&options, path, &dem, &heard), RESULT_OK);
    assert_int_equal(dem->datum, DEM_DATUM_ELLIPSOID);
    assert_false(dem->datum_assumed);
    dem_destroy(&dem);
}

// ---- PNG --------------------------------------------------------------------------------------------------------

static void png_is_placed_by_spacing_or_bounds(void **state) {
    support_skip_without_gdal();
    char path[192];
    dem_support_translate(*state, "-of PNG -ot UInt16 -a_nodata none", "gray.png", path);
    DemOptions options = dem_default_options();
    Heard heard;
    Dem *dem;
    assert_int_equal(support_load(&options, path, &dem, &heard), RESULT_UNSUPPORTED);
    assert_non_null(strstr(heard.error, "--spacing"));
    options.spacing_m = 90.0;
    assert_int_equal(support_load(&options, path, &dem, &heard), RESULT_OK);
    double spacing_m[2];
    assert_int_equal(dem_spacing_m(dem, spacing_m), RESULT_OK);
    assert_true(fabs(spacing_m[0] - 90.0) < 1e-3 && fabs(spacing_m[1] - 90.0) < 1e-3);
    assert_false(dem->georeferenced);
    assert_string_equal(dem->type, "uint16");
    assert_true(dem->height_m[5 * SUPPORT_WIDTH + 3] == (float)dem_support_height(3, 5));
    dem_destroy(&dem);
    options = dem_default_options();
    options.bounds_given = true;
    options.west_deg = 179.0, options.east_deg = -179.0, options.south_deg = -17.0, options.north_deg = -16.0;
    assert_int_equal(support_load(&options, path, &dem, &heard), RESULT_OK);
    DemBounds bounds;
    assert_int_equal(dem_bounds(dem, &bounds), RESULT_OK);
    print_message("bounds %.9g %.9g %.9g %.9g\n", bounds.west_deg, bounds.south_deg, bounds.east_deg, bounds.north_deg);
    assert_true(fabs(bounds.east_deg - bounds.west_deg - 2.0) < 1e-9);
    assert_true(fabs(bounds.south_deg + 17.0) < 1e-9 && fabs(bounds.north_deg + 16.0) < 1e-9);
    dem_destroy(&dem);
}

static void png_with_nodata_has_voids(void **state) {
    support_skip_without_gdal();
    char path[192];
    dem_support_translate(*state, "-of PNG -ot UInt16 -a_nodata 0", "nodata.png", path);
    DemOptions options = dem_default_options();
    options.spacing_m = 90.0;
    Heard heard;
    Dem *dem;
    assert_int_equal(support_load(&options, path, &dem, &heard), RESULT_OK);
    assert_int_equal(dem->voids, 11 * 7);
    assert_true(dem->height_m[60 * SUPPORT_WIDTH + 96] == (float)dem_support_height(96, 60));
    dem_destroy(&dem);
}

static void terrarium_decodes_three_channels(void **state) {
    support_skip_without_gdal();
    char ppm[192], path[192];
    dem_support_path(*state, "terrarium.ppm", ppm);
    dem_support_path(*state, "terrarium.png", path);
    FILE *file = fopen(ppm, "wb");
    assert_non_null(file);
    fprintf(file, "P6\n16 16\n255\n");
    for (int i = 0; i < 256; i++) {
        int encoded = (int)lround((-400.0 + 30.25 * i + 32768.0) * 256.0);
        fputc(encoded >> 16, file), fputc(encoded >> 8 & 255, file), fputc(encoded & 255, file);
    }
    fclose(file);
    support_run("gdal_translate -q -of PNG %s %s", ppm, path);
    DemOptions options = dem_default_options();
    options.spacing_m = 30.0;
    Heard heard;
    Dem *dem;
    assert_int_equal(support_load(&options, path, &dem, &heard), RESULT_OK);
    assert_string_equal(dem->type, "rgb8");
    for (int i = 0; i < 256; i++)
        assert_true(dem->height_m[i] == (float)(-400.0 + 30.25 * i));
    dem_destroy(&dem);
}

// ---- Voids ------------------------------------------------------------------------------------------------------

static void voids_are_filled_smoothly_from_their_rim(void **state) {
    support_skip_without_gdal();
    char path[192];
    dem_support_translate(*state, "-ot Int16", "voids.tif", path);
    Heard heard;
    Dem *dem = load(path, &heard);
    assert_int_equal(dem->voids, 11 * 7);
    assert_null(dem->void_bits);
    float low = INFINITY, high = -INFINITY;
    for (int row = 39; row < 48; row++)
        for (int col = 19; col < 32; col++)
            if (dem_support_height(col, row) != SUPPORT_NODATA) {
                low = fminf(low, dem->height_m[row * SUPPORT_WIDTH + col]);
                high = fmaxf(high, dem->height_m[row * SUPPORT_WIDTH + col]);
            }
    for (int row = 40; row < 47; row++)
        for (int col = 20; col < 31; col++) {
            float found = dem->height_m[row * SUPPORT_WIDTH + col];
            if (!(found >= low && found <= high))
                fail_msg("filled with %g m; its rim is %g..%g", (double)found, (double)low, (double)high);
        }
    dem_destroy(&dem);
}

static void hole_marks_voids_and_error_refuses_them(void **state) {
    support_skip_without_gdal();
    char path[192];
    dem_support_translate(*state, "-ot Int16", "hole.tif", path);
    DemOptions options = dem_default_options();
    Heard heard;
    Dem *dem;
    options.voids = DEM_VOIDS_HOLE;
    assert_int_equal(support_load(&options, path, &dem, &heard), RESULT_OK);
    int marked = 0;
    for (int row = 0; row < dem->height; row++)
        for (int col = 0; col < dem->width; col++) {
            assert_int_equal(dem_is_void(dem, col, row), dem_support_height(col, row) == SUPPORT_NODATA);
            marked += dem_is_void(dem, col, row);
        }
    assert_int_equal(marked, dem->voids);
    dem_destroy(&dem);
    options.voids = DEM_VOIDS_ERROR;
    assert_int_equal(support_load(&options, path, &dem, &heard), RESULT_RANGE);
    assert_int_equal(heard.errors, 1);
    assert_non_null(strstr(heard.error, "77"));
}

static void plane_is_restored_across_a_large_void(void **state) {
    support_skip_without_gdal();
    char asc[192], path[192];
    dem_support_path(*state, "plane.asc", asc);
    dem_support_path(*state, "plane.tif", path);
    FILE *file = fopen(asc, "w");
    assert_non_null(file);
    fprintf(file, "ncols 256\nnrows 256\nxllcorner 10\nyllcorner 45\ncellsize 0.001\nNODATA_value -9999\n");
    for (int row = 0; row < 256; row++)
        for (int col = 0; col < 256; col++)
            fprintf(file, "%d ", hypot(col - 128, row - 128) < 90.0 ? -9999 : 1000 + 4 * col - 2 * row);
    fclose(file);
    support_run("gdal_translate -q -a_srs EPSG:4326 -ot Float32 %s %s", asc, path);
    Heard heard;
    Dem *dem = load(path, &heard);
    double worst = 0.0;
    for (int row = 0; row < 256; row++)
        for (int col = 0; col < 256; col++)
            worst = fmax(worst, fabs((double)dem->height_m[row * 256 + col] - (1000 + 4 * col - 2 * row)));
    print_message("a tilted plane of 720 x 360 m across a void of 180 samples: %.2f m off at most\n", worst);
    dem_destroy(&dem);
    assert_true(worst < 36.0); // 5 % of its relief
}

// ---- The data at hand -------------------------------------------------------------------------------------------

static void shared_files_have_gdals_samples(void **state) {
    support_skip_without_gdal();
    static const struct {
        const char *name, *type;
        double scale;
        bool area;
    } FILES[] = {{"puget_utm10_160m_1025.tif", "uint16", 0.1, true},
                 {"maui_utm4n_40m_2049.tif", "int16", 1.0, true},
                 {"maui_srtm1_2049.tif", "int16", 1.0, true},
                 {"tatra_srtm3_2401.tif", "int16", 1.0, true},
                 {"ce_srtm3_4801.tif", "int16", 1.0, true},
                 {"mt_fuji_srtm3_1201.tif", "int16", 1.0, true},
                 {"N49E020.hgt", "int16", 1.0, false},
                 {"N44W072.hgt", "int16", 1.0, false}};
    int found = 0;
    for (size_t i = 0; i < COUNT_OF(FILES); i++) {
        char path[512];
        snprintf(path, sizeof path, SHARED_DIR "/dem/%s", FILES[i].name);
        if (access(path, R_OK))
            continue;
        check_against_gdal(*state, path, &(Expected){FILES[i].type, FILES[i].scale, 0.0, -32768.0, FILES[i].area});
        found++;
    }
    if (found < (int)COUNT_OF(FILES))
        print_message("%d of %zu files of " SHARED_DIR "/dem are missing\n", (int)COUNT_OF(FILES) - found,
                      COUNT_OF(FILES));
    if (found == 0)
        skip();
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_storage_gives_gdals_samples),
        cmocka_unit_test(scale_and_offset_apply_to_samples),
        cmocka_unit_test(feet_become_metres),
        cmocka_unit_test(lowest_float_and_nan_are_voids),
        cmocka_unit_test(alpha_marks_voids_and_a_second_band_is_named),
        cmocka_unit_test(placements_are_gdals),
        cmocka_unit_test(south_up_matrix_is_turned),
        cmocka_unit_test(user_defined_utm_is_recognised),
        cmocka_unit_test(vertical_datum_comes_from_the_file),
        cmocka_unit_test(given_datum_wins),
        cmocka_unit_test(png_is_placed_by_spacing_or_bounds),
        cmocka_unit_test(png_with_nodata_has_voids),
        cmocka_unit_test(terrarium_decodes_three_channels),
        cmocka_unit_test(voids_are_filled_smoothly_from_their_rim),
        cmocka_unit_test(hole_marks_voids_and_error_refuses_them),
        cmocka_unit_test(plane_is_restored_across_a_large_void),
        cmocka_unit_test(shared_files_have_gdals_samples),
    };
    return cmocka_run_group_tests(tests, dem_support_setup, dem_support_teardown);
}
