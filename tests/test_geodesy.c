// terrain/geodesy.h against GeographicLib and against formulas in long double, with floating-point exceptions trapped.
#define _GNU_SOURCE
#include <fenv.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#include "terrain/geo.h"
#include "terrain/geodesy.h"

#define EARTH_RADIUS_M 6.4e6

static const double HEIGHTS_M[] = {-10000.0, -430.0, 0.0, 1.0, 8848.0, 1e5, 1e6, 1e7, 3.6e7, 1e8, 1e9};
static const double LATITUDES_DEG[] = {-90.0, -89.9999999, -89.0, -45.0, -1e-9, -0.0, 0.0,        1e-12,
                                       1e-9,  0.0001,      23.5,  45.0,  60.0,  89.0, 89.9999999, 90.0};
static const double LONGITUDES_DEG[] = {-180.0, -179.9999999, -90.0, -1e-9,       -0.0, 0.0,
                                        1e-9,   45.0,         90.0,  179.9999999, 180.0};

typedef struct PointL {
    long double x, y, z;
} PointL;

static PointL exact_ecef(long double lat_rad, long double lon_rad, long double h_m) {
    long double f = 1.0L / 298.257223563L, e2 = f * (2.0L - f), a = 6378137.0L;
    long double n = a / sqrtl(1.0L - e2 * sinl(lat_rad) * sinl(lat_rad));
    long double across = (n + h_m) * cosl(lat_rad);
    return (PointL){across * cosl(lon_rad), across * sinl(lon_rad), (n * (1.0L - e2) + h_m) * sinl(lat_rad)};
}

static double distance_m(Vec3d a, PointL b) {
    long double x = (long double)a.x - b.x, y = (long double)a.y - b.y, z = (long double)a.z - b.z;
    return (double)sqrtl(x * x + y * y + z * z);
}

// An error in parts of what a double can tell apart at that distance from the Earth's centre.
static double in_ulps(double error_m, double h_m) {
    return error_m / ((EARTH_RADIUS_M + fabs(h_m)) * 0x1p-53);
}

typedef void Visit(double lat_deg, double lon_deg, double h_m, double *worst);

static double visit_all(Visit *visit) {
    double worst = 0.0;
    for (size_t h = 0; h < COUNT_OF(HEIGHTS_M); h++) {
        for (size_t i = 0; i < COUNT_OF(LATITUDES_DEG); i++)
            for (size_t j = 0; j < COUNT_OF(LONGITUDES_DEG); j++)
                visit(LATITUDES_DEG[i], LONGITUDES_DEG[j], HEIGHTS_M[h], &worst);
        for (double lat = -89.75; lat < 90.0; lat += 0.5)
            visit(lat, 3.0 * lat, HEIGHTS_M[h], &worst);
    }
    return worst;
}

static void compare_forward(double lat_deg, double lon_deg, double h_m, double *worst) {
    double lat = lat_deg * GEODESY_RAD_PER_DEG, lon = lon_deg * GEODESY_RAD_PER_DEG;
    Vec3d found = geodesy_to_ecef((Geodetic){lat, lon, h_m});
    *worst = fmax(*worst, in_ulps(distance_m(found, exact_ecef(lat, lon, h_m)), h_m));
}

static void forward_is_exact_to_a_few_roundings(void **state) {
    (void)state;
    double worst = visit_all(compare_forward);
    print_message("geodetic to ECEF: %.2f units of the last place from long double\n", worst);
    assert_true(worst < 8.0);
}

static void compare_forward_library(double lat_deg, double lon_deg, double h_m, double *worst) {
    double theirs[3];
    geo_ecef_forward(lat_deg, lon_deg, h_m, theirs);
    Vec3d ours = geodesy_to_ecef((Geodetic){lat_deg * GEODESY_RAD_PER_DEG, lon_deg * GEODESY_RAD_PER_DEG, h_m});
    double error = distance_m(ours, (PointL){theirs[0], theirs[1], theirs[2]});
    *worst = fmax(*worst, in_ulps(error, h_m));
}

static void forward_agrees_with_geographiclib(void **state) {
    (void)state;
    double worst = visit_all(compare_forward_library);
    print_message("geodetic to ECEF: %.2f units of the last place from GeographicLib\n", worst);
    assert_true(worst < 12.0);
}

// The larger of the errors in units of what hard case 13 allows.
static double inverse_error(Geodetic found, double lat_deg, double lon_deg, double h_m) {
    double lat_error = fabs(found.lat_rad / GEODESY_RAD_PER_DEG - lat_deg);
    double lon_error = fabs(remainder(found.lon_rad / GEODESY_RAD_PER_DEG - lon_deg, 360.0));
    lon_error *= cos(lat_deg * GEODESY_RAD_PER_DEG); // near a pole a millimetre is many degrees
    return fmax(fmax(lat_error, lon_error) / 1e-9, fabs(found.h_m - h_m) / 1e-6);
}

static void compare_round_trip(double lat_deg, double lon_deg, double h_m, double *worst) {
    double lat = lat_deg * GEODESY_RAD_PER_DEG, lon = lon_deg * GEODESY_RAD_PER_DEG;
    PointL exact = exact_ecef(lat, lon, h_m);
    Geodetic found = geodesy_from_ecef((Vec3d){(double)exact.x, (double)exact.y, (double)exact.z});
    double error = inverse_error(found, lat_deg, lon_deg, h_m);
    if (error > 1.0)
        print_message("lat %.12g lon %.12g h %g: found %.15g %.15g %.9f\n", lat_deg, lon_deg, h_m,
                      found.lat_rad / GEODESY_RAD_PER_DEG, found.lon_rad / GEODESY_RAD_PER_DEG, found.h_m);
    *worst = fmax(*worst, error);
}

static void inverse_is_within_a_billionth_degree_and_a_micrometre(void **state) {
    (void)state;
    double worst = visit_all(compare_round_trip);
    print_message("ECEF to geodetic: %.3f of 1e-9 degrees or 1e-6 m\n", worst);
    assert_true(worst < 1.0);
}

static void compare_inverse_library(double lat_deg, double lon_deg, double h_m, double *worst) {
    double ecef[3], lat, lon, h;
    geo_ecef_forward(lat_deg, lon_deg, h_m, ecef);
    geo_ecef_reverse(ecef, &lat, &lon, &h);
    Geodetic ours = geodesy_from_ecef((Vec3d){ecef[0], ecef[1], ecef[2]});
    *worst = fmax(*worst, inverse_error(ours, lat, hypot(ecef[0], ecef[1]) > 0.0 ? lon : 0.0, h));
}

static void inverse_agrees_with_geographiclib(void **state) {
    (void)state;
    double worst = visit_all(compare_inverse_library);
    print_message("ECEF to geodetic: %.3f of 1e-9 degrees or 1e-6 m from GeographicLib\n", worst);
    assert_true(worst < 1.0);
}

static void axis_has_longitude_zero(void **state) {
    (void)state;
    const double zs[] = {6356752.3142451793, -6356752.3142451793, 6346752.0, -1e9};
    for (size_t i = 0; i < COUNT_OF(zs); i++)
        for (int sign = 0; sign < 4; sign++) {
            Vec3d point = {sign & 1 ? -0.0 : 0.0, sign & 2 ? -0.0 : 0.0, zs[i]};
            Geodetic found = geodesy_from_ecef(point);
            assert_true(found.lon_rad == 0.0);
            assert_true(found.lat_rad == copysign(GEODESY_PI / 2.0, zs[i]));
            assert_true(fabs(found.h_m - (fabs(zs[i]) - GEODESY_B_M)) <= 1e-6);
        }
}

static void local_frame_is_orthonormal_and_up_is_the_normal(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT_OF(LATITUDES_DEG); i++)
        for (size_t j = 0; j < COUNT_OF(LONGITUDES_DEG); j++) {
            double lat = LATITUDES_DEG[i] * GEODESY_RAD_PER_DEG, lon = LONGITUDES_DEG[j] * GEODESY_RAD_PER_DEG;
            Mat3d frame = geodesy_enu_from_ecef(lat, lon);
            Vec3d east = {frame.m[0][0], frame.m[0][1], frame.m[0][2]};
            Vec3d north = {frame.m[1][0], frame.m[1][1], frame.m[1][2]};
            Vec3d up = {frame.m[2][0], frame.m[2][1], frame.m[2][2]};
            Vec3d rise =
                vec3d_sub(geodesy_to_ecef((Geodetic){lat, lon, 1000.0}), geodesy_to_ecef((Geodetic){lat, lon, 0.0}));
            assert_true(vec3d_distance(vec3d_cross(east, north), up) < 1e-15);
            assert_true(vec3d_distance(up, geodesy_up(lat, lon)) == 0.0);
            assert_true(vec3d_distance(vec3d_scale(rise, 1e-3), up) < 1e-11);
        }
}

int main(void) {
    feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forward_is_exact_to_a_few_roundings),
        cmocka_unit_test(forward_agrees_with_geographiclib),
        cmocka_unit_test(inverse_is_within_a_billionth_degree_and_a_micrometre),
        cmocka_unit_test(inverse_agrees_with_geographiclib),
        cmocka_unit_test(axis_has_longitude_zero),
        cmocka_unit_test(local_frame_is_orthonormal_and_up_is_the_normal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
