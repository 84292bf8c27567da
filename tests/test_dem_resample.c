// dem_resample against polynomials, which the cubic must keep, and against what is lost when samples become fewer.
#include "terrain/dem/dem_resample.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static Dem *make_dem(int width, int height, double (*height_at)(double u, double v)) {
    DemGeoref georef = {.crs = DEM_CRS_GEOGRAPHIC, .x0 = 10.0, .y0 = 47.0, .dx = 1e-3, .dy = -2e-3};
    Dem *dem = NULL;
    assert_int_equal(dem_create(width, height, &georef, DEM_DATUM_EGM96, &dem), RESULT_OK);
    for (int row = 0; row < height; row++)
        for (int col = 0; col < width; col++)
            dem->height_m[row * width + col] = (float)height_at(col / (width - 1.0), row / (height - 1.0));
    return dem;
}

static double quadratic(double u, double v) {
    return 100.3 + 40.7 * u - 30.0 * v + 25.0 * u * u - 60.0 * u * v + 10.0 * v * v;
}

static double plane(double u, double v) {
    return 300.0 - 200.0 * u + 90.0 * v;
}

static Dem *resample(const Dem *dem, int width, int height) {
    Dem *made = NULL;
    assert_int_equal(dem_resample(dem, width, height, &made), RESULT_OK);
    assert_int_equal(made->width, width);
    assert_int_equal(made->height, height);
    return made;
}

// Greatest difference from `height_at` among samples at least `rim` of the sides away from the rim.
static double greatest_off(const Dem *dem, double (*height_at)(double u, double v), double rim) {
    double greatest = 0.0;
    for (int row = 0; row < dem->height; row++) {
        for (int col = 0; col < dem->width; col++) {
            double u = col / (dem->width - 1.0), v = row / (dem->height - 1.0);
            double off = fabs((double)dem->height_m[row * dem->width + col] - height_at(u, v));
            if (fmin(fmin(u, 1.0 - u), fmin(v, 1.0 - v)) >= rim && !(off <= greatest))
                greatest = off;
        }
    }
    return greatest;
}

static void finer_samples_keep_quadratic_ground(void **state) {
    (void)state;
    Dem *dem = make_dem(21, 17, quadratic), *made = resample(dem, 129, 65);
    double off = greatest_off(made, quadratic, 0.13); // two of the coarser samples
    print_message("greatest difference from the quadratic: %g m\n", off);
    assert_true(off < 1e-4);
    dem_destroy(&made);
    dem_destroy(&dem);
}

static void samples_that_coincide_keep_their_heights(void **state) {
    (void)state;
    Dem *dem = make_dem(9, 7, quadratic), *made = resample(dem, 33, 13);
    for (int row = 0; row < 7; row++)
        for (int col = 0; col < 9; col++) {
            double found = (double)made->height_m[2 * row * 33 + 4 * col];
            double wanted = (double)dem->height_m[row * 9 + col];
            if (!(fabs(found - wanted) < 1e-4))
                fail_msg("sample (%d, %d): %g m, expected %g", col, row, found, wanted);
        }
    dem_destroy(&made);
    dem_destroy(&dem);
}

static void the_area_stays_the_same(void **state) {
    (void)state;
    Dem *dem = make_dem(21, 17, plane), *made = resample(dem, 65, 9);
    DemBounds before, after;
    assert_int_equal(dem_bounds(dem, &before), RESULT_OK);
    assert_int_equal(dem_bounds(made, &after), RESULT_OK);
    print_message("west %.9f, %.9f; south %.9f, %.9f\n", before.west_deg, after.west_deg, before.south_deg,
                  after.south_deg);
    assert_true(fabs(before.west_deg - after.west_deg) < 1e-12 && fabs(before.east_deg - after.east_deg) < 1e-12);
    assert_true(fabs(before.south_deg - after.south_deg) < 1e-12 && fabs(before.north_deg - after.north_deg) < 1e-12);
    assert_int_equal(made->datum, dem->datum);
    dem_destroy(&made);
    dem_destroy(&dem);
}

static void fewer_samples_keep_a_slope(void **state) {
    (void)state;
    Dem *dem = make_dem(257, 129, plane), *made = resample(dem, 33, 33);
    double off = greatest_off(made, plane, 0.13);
    print_message("greatest difference from the plane: %g m\n", off);
    assert_true(off < 1e-2);
    dem_destroy(&made);
    dem_destroy(&dem);
}

// Taking every eighth sample would give all of one colour.
static void fewer_samples_average_what_they_cannot_hold(void **state) {
    (void)state;
    Dem *dem = make_dem(257, 257, plane);
    for (int i = 0; i < 257 * 257; i++)
        dem->height_m[i] = (i % 257 + i / 257) % 2 ? 100.0f : -100.0f;
    Dem *made = resample(dem, 33, 33);
    double greatest = 0.0;
    for (int row = 4; row < 29; row++)
        for (int col = 4; col < 29; col++)
            greatest = fmax(greatest, fabs((double)made->height_m[row * 33 + col]));
    print_message("a checkerboard of 100 m becomes %g m at most\n", greatest);
    assert_true(greatest < 1.0);
    assert_true((double)made->min_m >= -100.0 && (double)made->max_m <= 100.0 && made->min_m <= made->max_m);
    dem_destroy(&made);
    dem_destroy(&dem);
}

static void the_same_size_is_the_same_ground(void **state) {
    (void)state;
    Dem *dem = make_dem(21, 17, quadratic), *made = resample(dem, 21, 17);
    for (int i = 0; i < 21 * 17; i++)
        if (!(fabsf(made->height_m[i] - dem->height_m[i]) < 1e-4f))
            fail_msg("sample %d: %g m, expected %g", i, (double)made->height_m[i], (double)dem->height_m[i]);
    dem_destroy(&made);
    dem_destroy(&dem);
}

static void impossible_sizes_are_refused(void **state) {
    (void)state;
    Dem *dem = make_dem(5, 5, plane), *made = NULL;
    assert_int_equal(dem_resample(dem, 1, 5, &made), RESULT_RANGE);
    assert_int_equal(dem_resample(dem, 5, DEM_SIDE_MAX + 1, &made), RESULT_RANGE);
    assert_null(made);
    dem_destroy(&dem);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finer_samples_keep_quadratic_ground),
        cmocka_unit_test(samples_that_coincide_keep_their_heights),
        cmocka_unit_test(the_area_stays_the_same),
        cmocka_unit_test(fewer_samples_keep_a_slope),
        cmocka_unit_test(fewer_samples_average_what_they_cannot_hold),
        cmocka_unit_test(the_same_size_is_the_same_ground),
        cmocka_unit_test(impossible_sizes_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
