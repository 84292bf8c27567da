// What the picture knows of the ground, against planes, lakes and ridges whose slopes, waters and shadows are known.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/log.h"
#include "render/frame.h"
#include "render/ground/ground_shade.h"
#include "render/ground/ground_surface.h"
#include "render/ground/noise.h"
#include "terrain/geodesy.h"
#include "tests/cut_support.h"

#define SIDE 161
#define DEG GEODESY_RAD_PER_DEG

static const DemGeoref GEOGRAPHIC = {
    .crs = DEM_CRS_GEOGRAPHIC, .x0 = 20.0, .y0 = 49.5, .dx = 1.0 / 1200, .dy = -1.0 / 1200};
// The far east of its zone: grid north is 1.9 degrees off true north.
static const DemGeoref UTM = {
    .crs = DEM_CRS_UTM, .utm_zone = 34, .utm_north = true, .x0 = 690000.0, .y0 = 5500000.0, .dx = 50.0, .dy = -50.0};

typedef double Height(double east_m, double north_m); // from the first sample

typedef struct Ground3 {
    Jobs *jobs;
    Terrain *terrain;
    GroundSource source;
} Ground3;

// Heights as a function of true east and north, so that neither grid's own axes are favoured.
static Ground3 ground_begin(const DemGeoref *georef, Height *height, int side_max) {
    Ground3 ground = {.jobs = NULL};
    Dem *dem = NULL;
    Grid *grid = NULL;
    assert_int_equal(jobs_create(3, &ground.jobs), RESULT_OK);
    assert_int_equal(dem_create(SIDE, SIDE, georef, DEM_DATUM_ELLIPSOID, &dem), RESULT_OK);
    assert_int_equal(grid_create(georef, SIDE, SIDE, &grid), RESULT_OK);
    Vec3d origin, up, at, unused;
    grid_base(grid, 0, 0, &origin, &up);
    Vec3d east = vec3d_normalize(vec3d(-up.y, up.x, 0.0)), north = vec3d_cross(up, east);
    dem->min_m = 1e9f;
    dem->max_m = -1e9f;
    for (int row = 0; row < SIDE; row++) {
        for (int col = 0; col < SIDE; col++) {
            grid_base(grid, col, row, &at, &unused);
            Vec3d to = vec3d_sub(at, origin);
            float h = (float)height(vec3d_dot(to, east), vec3d_dot(to, north));
            dem->height_m[row * SIDE + col] = h;
            dem->min_m = fminf(dem->min_m, h);
            dem->max_m = fmaxf(dem->max_m, h);
        }
    }
    grid_destroy(&grid);
    ground.terrain = support_terrain(dem, TERRAIN_ERROR_MIDPOINT, 8, ground.jobs);
    assert_int_equal(ground_source_create(ground.terrain, side_max, &ground.source), RESULT_OK);
    return ground;
}

static void ground_end(Ground3 *ground) {
    ground_source_destroy(&ground->source);
    terrain_destroy(&ground->terrain);
    jobs_destroy(&ground->jobs);
}

static double tilted(double east_m, double north_m) {
    return 500.0 + 0.3 * east_m - 0.1 * north_m;
}

static void check_tilt(const DemGeoref *georef, const char *name) {
    Ground3 ground = ground_begin(georef, tilted, 4096);
    GroundSurface surface;
    assert_int_equal(ground_surface_create(&ground.source, ground.jobs, &surface), RESULT_OK);
    double length = sqrt(1.0 + 0.3 * 0.3 + 0.1 * 0.1), worst = 0.0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        double east = (surface.cells[i * 4] - 128) / 127.0, north = (surface.cells[i * 4 + 1] - 128) / 127.0;
        worst = fmax(worst, fmax(fabs(east + 0.3 / length), fabs(north - 0.1 / length)));
        assert_int_equal(surface.cells[i * 4 + 3], 0);
    }
    print_message("%s: normals within %.4f (at most 0.006, a byte is 0.008)\n", name, worst);
    assert_true(worst < 0.006);
    ground_surface_destroy(&surface);
    ground_end(&ground);
}

static void a_tilted_plane_has_one_normal(void **state) {
    (void)state;
    check_tilt(&GEOGRAPHIC, "geographic");
    check_tilt(&UTM, "UTM");
}

// A lake of 1 km radius, a pond of two cells, sea in the west, all amid rough land.
static double watery(double east_m, double north_m) {
    double rough =
        40.0 + 10.0 * sin(east_m * 0.02) + 9.0 * cos(north_m * 0.017) + 3.0 * sin(east_m * 0.11 + north_m * 0.07);
    if (hypot(east_m - 6000.0, north_m + 8000.0) < 1000.0)
        return 70.0;
    if (hypot(east_m - 2500.0, north_m + 3000.0) < 120.0)
        return 55.0;
    return east_m < 900.0 ? 0.0 : rough;
}

static bool wet_at(const GroundSurface *surface, double east_m, double north_m) {
    int col = (int)lrint(east_m / 60.29), row = (int)lrint(-north_m / 92.67);
    return surface->cells[(row * SIDE + col) * 4 + 3] != 0;
}

static void lakes_and_the_sea_are_water_and_nothing_else(void **state) {
    (void)state;
    Ground3 ground = ground_begin(&GEOGRAPHIC, watery, 4096);
    GroundSurface surface;
    assert_int_equal(ground_surface_create(&ground.source, ground.jobs, &surface), RESULT_OK);
    int wet = 0;
    for (int i = 0; i < SIDE * SIDE; i++)
        wet += surface.cells[i * 4 + 3] != 0;
    double expected = 3.1416e6 / (60.29 * 92.67) + 900.0 / 60.29 * SIDE;
    print_message("%d cells of water, about %.0f expected; border %.1f m, %.2f of it water\n", wet, expected,
                  (double)surface.border_m, (double)surface.border_water);
    assert_true(wet_at(&surface, 6000.0, -8000.0));
    assert_true(wet_at(&surface, 300.0, -8000.0));
    assert_false(wet_at(&surface, 2500.0, -3000.0)); // a coincidence of samples, not a lake
    assert_false(wet_at(&surface, 4000.0, -5000.0));
    assert_true(fabs(wet - expected) < 0.08 * expected);
    // The table of blocks agrees with the cells.
    uint32_t all =
        surface
            .wet_blocks[(size_t)(SIDE / GROUND_BLOCK + 1) * (size_t)surface.wet_width + (size_t)surface.wet_width - 1];
    uint32_t counted = 0;
    for (int y = 0; y < SIDE; y += GROUND_BLOCK)
        for (int x = 0; x < SIDE; x += GROUND_BLOCK) {
            bool any = false;
            for (int row = y; row < y + GROUND_BLOCK && row < SIDE; row++)
                for (int col = x; col < x + GROUND_BLOCK && col < SIDE; col++)
                    any = any || surface.cells[(row * SIDE + col) * 4 + 3];
            counted += any;
        }
    assert_int_equal(all, counted);
    ground_surface_destroy(&surface);
    ground_end(&ground);
}

static double hilly(double east_m, double north_m) {
    return 800.0 + 500.0 * sin(east_m * 0.0011) * cos(north_m * 0.0009) + 150.0 * sin(east_m * 0.004 + north_m * 0.003);
}

static double height_between(const Dem *dem, double col, double row) {
    int c = (int)col, r = (int)row;
    c = c < SIDE - 1 ? c : SIDE - 2;
    r = r < SIDE - 1 ? r : SIDE - 2;
    double fc = col - c, fr = row - r;
    const float *h = dem->height_m + r * SIDE + c;
    return (h[0] * (1 - fc) + h[1] * fc) * (1 - fr) + (h[SIDE] * (1 - fc) + h[SIDE + 1] * fc) * fr;
}

// By walking towards the sun in small steps; the Earth falls away as it does.
static double tangent_by_walking(const GroundSource *source, int col, int row, double azimuth) {
    const Dem *dem = terrain_dem(source->terrain);
    GroundJacobian j = ground_source_jacobian(source, SIDE / 2, SIDE / 2);
    double det = (double)j.east_col * j.north_row - (double)j.east_row * j.north_col;
    double dc = (sin(azimuth) * j.north_row - cos(azimuth) * j.east_row) / det;
    double dr = (cos(azimuth) * j.east_col - sin(azimuth) * j.north_col) / det;
    double best = 0.0, here = dem->height_m[row * SIDE + col];
    for (double metres = 20.0;; metres += 20.0) {
        double c = col + dc * metres, r = row + dr * metres;
        if (c < 0.0 || r < 0.0 || c > SIDE - 1 || r > SIDE - 1)
            return best;
        best = fmax(best, (height_between(dem, c, r) - here) / metres - metres / (2.0 * GEODESY_A_M));
    }
}

static void shadows_are_those_of_a_walk_towards_the_sun(void **state) {
    (void)state;
    static const double AZIMUTHS_DEG[] = {0.0, 33.0, 90.0, 147.0, 200.0, 271.0, 315.0};
    Ground3 ground = ground_begin(&GEOGRAPHIC, hilly, 4096);
    uint8_t *bytes = malloc(SIDE * SIDE), *other = malloc(SIDE * SIDE);
    assert_true(bytes && other);
    double worst = 0.0, sum = 0.0;
    int count = 0;
    for (size_t a = 0; a < COUNT_OF(AZIMUTHS_DEG); a++) {
        double azimuth = AZIMUTHS_DEG[a] * DEG;
        assert_int_equal(ground_shade_build(&ground.source, azimuth, ground.jobs, bytes), RESULT_OK);
        for (int row = 3; row < SIDE; row += 7) {
            for (int col = 3; col < SIDE; col += 7, count++) {
                double share = bytes[row * SIDE + col] / 255.0, found = GROUND_SHADE_TAN_MAX * share * share;
                double expected = tangent_by_walking(&ground.source, col, row, azimuth);
                // A line passes up to half a cell beside the cell it serves, where the ground is a little higher or
                // lower: that is the difference, and it does not grow with the distance of the horizon.
                worst = fmax(worst, fabs(found - expected));
                sum += fabs(found - expected);
            }
        }
    }
    print_message("tangents differ by %.4f on average, %.4f at most\n", sum / count, worst);
    assert_true(sum / count < 0.015);
    assert_true(worst < 0.25);
    Jobs *one = NULL;
    assert_int_equal(jobs_create(1, &one), RESULT_OK);
    assert_int_equal(ground_shade_build(&ground.source, 1.0, one, bytes), RESULT_OK);
    assert_int_equal(ground_shade_build(&ground.source, 1.0, ground.jobs, other), RESULT_OK);
    assert_memory_equal(bytes, other, SIDE * SIDE);
    jobs_destroy(&one);
    free(bytes);
    free(other);
    ground_end(&ground);
}

static double cone(double east_m, double north_m) { // a hollow in the middle, ridges around
    double away = hypot(east_m - 4800.0, north_m + 7400.0);
    return away < 2500.0 ? 300.0 + 0.4 * away : 1300.0;
}

static void a_hollow_sees_less_sky_than_a_plain(void **state) {
    (void)state;
    Ground3 ground = ground_begin(&GEOGRAPHIC, cone, 4096);
    GroundSurface surface;
    assert_int_equal(ground_surface_create(&ground.source, ground.jobs, &surface), RESULT_OK);
    int hollow = surface.cells[(80 * SIDE + 80) * 4 + 2], plain = surface.cells[(5 * SIDE + 5) * 4 + 2];
    print_message("open sky: hollow %d, plain %d of 255\n", hollow, plain);
    assert_true(hollow < plain - 40);
    assert_true(abs(plain - 184) < 12); // SKY_LEVEL
    ground_surface_destroy(&surface);
    ground_end(&ground);
}

static void a_grid_too_large_for_a_texture_is_reduced(void **state) {
    (void)state;
    log_set_level(LOG_ERROR);
    Ground3 ground = ground_begin(&GEOGRAPHIC, tilted, 100);
    log_set_level(LOG_INFO);
    GroundSurface surface;
    assert_int_equal(ground.source.step, 2);
    assert_int_equal(ground.source.width, 81);
    assert_int_equal(ground_surface_create(&ground.source, ground.jobs, &surface), RESULT_OK);
    float row[81];
    ground_source_row(&ground.source, 40, row);
    assert_float_equal(row[40], terrain_dem(ground.terrain)->height_m[80 * SIDE + 80], 1e-3);
    // The slope is the same, though the cells are twice as large.
    assert_true(abs(surface.cells[(40 * 81 + 40) * 4] - (int)lrint(128 - 127 * 0.3 / sqrt(1.1))) <= 1);
    ground_surface_destroy(&surface);
    ground_end(&ground);
}

static void the_noise_has_no_seam_and_no_offset(void **state) {
    (void)state;
    static uint8_t texels[NOISE_SIDE][NOISE_SIDE][4];
    noise_fill(&texels[0][0][0]);
    double inside = 0.0, across = 0.0, mean = 0.0;
    for (int y = 0; y < NOISE_SIDE; y++) {
        inside += abs(texels[y][100][0] - texels[y][101][0]);
        across += abs(texels[y][NOISE_SIDE - 1][0] - texels[y][0][0]);
        for (int x = 0; x < NOISE_SIDE; x++)
            mean += texels[y][x][0] / (double)(NOISE_SIDE * NOISE_SIDE);
    }
    print_message("steps: %.2f inside, %.2f across the seam; mean %.1f\n", inside / NOISE_SIDE, across / NOISE_SIDE,
                  mean);
    assert_true(across < 2.0 * inside);
    assert_true(fabs(mean - 128.0) < 6.0);
}

// Culling errs towards drawing: nothing whose point projects into the picture is ever left out.
static void nothing_in_view_is_culled(void **state) {
    (void)state;
    uint64_t seed = 99;
    int inside = 0, culled = 0;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int i = 0; i < 20000; i++) {
        double yaw = support_between(&seed, -3.1, 3.1), fov = support_between(&seed, 0.02, 3.1);
        RenderCamera camera = {.eye_ecef = {4e6, 1e6, 5e6}, .fov_y_rad = fov};
        camera.camera_from_ecef = (Mat3d){{{cos(yaw), sin(yaw), 0}, {0, 0, 1}, {sin(yaw), -cos(yaw), 0}}};
        Frame frame = frame_make(&camera, 1280, 800);
        double radius = support_between(&seed, 1.0, 5e4), in_camera[3], f = 1.0 / tan(fov / 2);
        Vec3d at = camera.eye_ecef, point;
        at = vec3d_add(at, vec3d(support_between(&seed, -1e5, 1e5), support_between(&seed, -1e5, 1e5),
                                 support_between(&seed, -1e5, 1e5)));
        Vec3d off = vec3d_normalize(
            vec3d(support_between(&seed, -1, 1), support_between(&seed, -1, 1), support_between(&seed, -1, 1)));
        point = vec3d_sub(vec3d_mad(at, off, radius), camera.eye_ecef); // on the sphere
        for (int k = 0; k < 3; k++)
            in_camera[k] = camera.camera_from_ecef.m[k][0] * point.x + camera.camera_from_ecef.m[k][1] * point.y +
                           camera.camera_from_ecef.m[k][2] * point.z;
        bool seen = in_camera[2] < 0.0 && fabs(in_camera[0]) * f * 800 / 1280 < -in_camera[2] &&
                    fabs(in_camera[1]) * f < -in_camera[2];
        inside += seen;
        culled += !frame_sees_sphere(&frame, at, radius);
        if (seen && !frame_sees_sphere(&frame, at, radius))
            fail_msg("case %d: culled, though a point of it is in view", i);
    }
    print_message("%d in view, %d culled\n", inside, culled);
    assert_true(inside > 1000 && culled > 5000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tilted_plane_has_one_normal),
        cmocka_unit_test(lakes_and_the_sea_are_water_and_nothing_else),
        cmocka_unit_test(shadows_are_those_of_a_walk_towards_the_sun),
        cmocka_unit_test(a_hollow_sees_less_sky_than_a_plain),
        cmocka_unit_test(a_grid_too_large_for_a_texture_is_reduced),
        cmocka_unit_test(the_noise_has_no_seam_and_no_offset),
        cmocka_unit_test(nothing_in_view_is_culled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
