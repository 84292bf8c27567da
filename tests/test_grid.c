// The map from grid to ECEF against GeographicLib, and its bounds against the map itself.
#define _GNU_SOURCE
#include "base/log.h"
#include "terrain/geo.h"
#include "terrain/geodesy.h"
#include "terrain/grid.h"

#include <fenv.h>
#include <inttypes.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SEED UINT64_C(20240611)
#define SECOND (1.0 / 3600.0)

typedef struct Case {
    const char *name;
    DemGeoref georef;
    int width, height;
} Case;

static const Case GEOGRAPHIC[] = {
    {"Tatra, 3 arc-seconds", {DEM_CRS_GEOGRAPHIC, 0, false, 19.0, 50.0, 3 * SECOND, -3 * SECOND}, 2401, 2401},
    {"across the equator and Greenwich", {DEM_CRS_GEOGRAPHIC, 0, false, -1.0, 1.0, 0.01, -0.02}, 200, 100},
    {"whole Earth", {DEM_CRS_GEOGRAPHIC, 0, false, -180.0, 90.0, 0.5, -0.5}, 721, 361},
    {"half a cell over the pole", {DEM_CRS_GEOGRAPHIC, 0, false, -180.25, 90.25, 0.5, -0.5}, 721, 362},
    {"near the north pole", {DEM_CRS_GEOGRAPHIC, 0, false, 10.0, 89.999, 0.01, -0.0005}, 300, 1000},
    {"near the south pole", {DEM_CRS_GEOGRAPHIC, 0, false, -70.0, -89.0, 0.25, -0.001}, 500, 1001},
    {"across the date line", {DEM_CRS_GEOGRAPHIC, 0, false, 179.7, -16.2, SECOND, -SECOND}, 2000, 1000},
    {"longitudes beyond 180", {DEM_CRS_GEOGRAPHIC, 0, false, 355.5, 44.0, 30 * SECOND, -30 * SECOND}, 1201, 1201},
    {"2 x 2", {DEM_CRS_GEOGRAPHIC, 0, false, 6.5, 46.0, 0.25, -0.125}, 2, 2},
};

static const Case UTM[] = {
    {"Puget", {DEM_CRS_UTM, 10, true, 460000.0, 5330000.0, 160.0, -160.0}, 1025, 1025},
    {"Maui", {DEM_CRS_UTM, 4, true, 720000.0, 2330000.0, 40.0, -40.0}, 2049, 2049},
    {"2 x 2", {DEM_CRS_UTM, 33, true, 500000.0, 5500000.0, 30.0, -30.0}, 2, 2},
    {"3 x 2, kilometres apart", {DEM_CRS_UTM, 33, true, 480000.0, 5500000.0, 20000.0, -10000.0}, 3, 2},
    {"far west of the meridian", {DEM_CRS_UTM, 32, true, 20000.0, 100000.0, 100.0, -100.0}, 900, 900},
    {"far east of the meridian", {DEM_CRS_UTM, 32, true, 900000.0, 7000000.0, 90.0, -250.0}, 1100, 300},
    {"far north", {DEM_CRS_UTM, 33, true, 300000.0, 9300000.0, 400.0, -400.0}, 1000, 500},
    {"across the equator, northern zone", {DEM_CRS_UTM, 17, true, 150000.0, 80000.0, 250.0, -250.0}, 2000, 640},
    {"southern", {DEM_CRS_UTM, 19, false, 400000.0, 6400000.0, 90.0, -90.0}, 1500, 1500},
    {"far south", {DEM_CRS_UTM, 1, false, 300000.0, 1200000.0, 500.0, -500.0}, 800, 400},
    {"coarse cells", {DEM_CRS_UTM, 45, true, 100000.0, 9000000.0, 10000.0, -10000.0}, 81, 851},
    {"narrow", {DEM_CRS_UTM, 45, true, 600000.0, 3000000.0, 1.0, -1.0}, 2, 5000},
};

static uint64_t random_next(uint64_t *state) { // splitmix64
    uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

static int random_below(uint64_t *state, int limit) {
    return (int)(random_next(state) % (uint64_t)limit);
}

static double random_between(uint64_t *state, double low, double high) {
    return low + (high - low) * (double)(random_next(state) >> 11) * 0x1p-53;
}

static Grid *create(const Case *c) {
    Grid *grid = NULL;
    assert_int_equal(grid_create(&c->georef, c->width, c->height, &grid), RESULT_OK);
    return grid;
}

static Vec3d oracle_ecef(const Case *c, double col, double row, double h_m) {
    double x = c->georef.x0 + c->georef.dx * col, y = c->georef.y0 + c->georef.dy * row;
    double lat = y, lon = x, ecef[3];
    if (c->georef.crs == DEM_CRS_UTM)
        assert_int_equal(geo_utm_reverse(c->georef.utm_zone, c->georef.utm_north, x, y, &lat, &lon), RESULT_OK);
    if (lat > 90.0) // GeographicLib wants the other side of the pole spelt out
        lat = 180.0 - lat, lon += 180.0;
    if (lat < -90.0)
        lat = -180.0 - lat, lon += 180.0;
    geo_ecef_forward(lat, lon, h_m, ecef);
    return vec3d(ecef[0], ecef[1], ecef[2]);
}

// ---- positions ----

static double worst_at(const Case *c, const Grid *grid, int col, int row) {
    static const double HEIGHTS[] = {-430.0, 0.0, 8848.0};
    double worst = 0.0;
    for (size_t i = 0; i < COUNT_OF(HEIGHTS); i++)
        worst =
            fmax(worst, vec3d_distance(grid_ecef(grid, col, row, HEIGHTS[i]), oracle_ecef(c, col, row, HEIGHTS[i])));
    return worst;
}

// All of the border, and a dense set inside that is in step with nothing.
static double worst_of_grid(const Case *c, const Grid *grid) {
    double worst = 0.0;
    int col_step = c->width / 61 + 1, row_step = c->height / 67 + 1;
    for (int row = 0; row < c->height; row += row_step)
        for (int col = 0; col < c->width; col += col_step)
            worst = fmax(worst, worst_at(c, grid, col, row));
    for (int col = 0; col < c->width; col++)
        worst = fmax(worst, fmax(worst_at(c, grid, col, 0), worst_at(c, grid, col, c->height - 1)));
    for (int row = 0; row < c->height; row++)
        worst = fmax(worst, fmax(worst_at(c, grid, 0, row), worst_at(c, grid, c->width - 1, row)));
    return worst;
}

static void check_positions(const Case *cases, size_t count, double limit_m) {
    int failures = 0;
    for (size_t i = 0; i < count; i++) {
        Grid *grid = create(&cases[i]);
        double worst = worst_of_grid(&cases[i], grid);
        print_message("%-36s %.3g m of GeographicLib, limit %.0e\n", cases[i].name, worst, limit_m);
        failures += !(worst <= limit_m);
        grid_destroy(&grid);
    }
    assert_int_equal(failures, 0);
}

static void test_geographic_positions_are_exact(void **state) {
    (void)state;
    check_positions(GEOGRAPHIC, COUNT_OF(GEOGRAPHIC), 1e-8);
}

static void test_utm_positions_are_within_a_millimetre(void **state) {
    (void)state;
    check_positions(UTM, COUNT_OF(UTM), 1e-3);
}

static void check_normals(const Case *c) {
    Grid *grid = create(c);
    uint64_t random = SEED;
    double worst_length = 0.0, worst_direction = 0.0;
    for (int i = 0; i < 300; i++) {
        int col = random_below(&random, c->width), row = random_below(&random, c->height);
        Vec3d point, normal;
        grid_base(grid, col, row, &point, &normal);
        Vec3d up = vec3d_scale(vec3d_sub(oracle_ecef(c, col, row, 1e6), oracle_ecef(c, col, row, 0.0)), 1e-6);
        worst_length = fmax(worst_length, fabs(vec3d_length(normal) - 1.0));
        worst_direction = fmax(worst_direction, vec3d_distance(normal, up));
        Vec3d raised = grid_ecef(grid, col, row, 1234.5), sum = vec3d_mad(point, normal, 1234.5);
        assert_memory_equal(&raised, &sum, sizeof raised);
    }
    print_message("%-36s normal: length off by %.2g, direction by %.2g\n", c->name, worst_length, worst_direction);
    assert_true(worst_length <= 4e-16);
    assert_true(worst_direction <= 1e-9);
    grid_destroy(&grid);
}

static void test_normals_are_unit_and_geodetic(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT_OF(GEOGRAPHIC); i++)
        check_normals(&GEOGRAPHIC[i]);
    for (size_t i = 0; i < COUNT_OF(UTM); i++)
        check_normals(&UTM[i]);
}

static void test_lattice_is_the_nearest_one(void **state) {
    (void)state;
    Grid *grid = create(&GEOGRAPHIC[0]);
    for (int i = 0; i < 2400; i += 7) {
        Vec3d exact = grid_ecef(grid, i, 2400 - i, 0.37 * i);
        Vec3d drawn = grid_point_ecef(grid_lattice(grid, i, 2400 - i, 0.37 * i));
        assert_true(fabs(drawn.x - exact.x) <= 0.5 * GRID_LATTICE_M);
        assert_true(fabs(drawn.y - exact.y) <= 0.5 * GRID_LATTICE_M);
        assert_true(fabs(drawn.z - exact.z) <= 0.5 * GRID_LATTICE_M);
    }
    grid_destroy(&grid);
}

// ---- longitudes modulo 360 ----

static int64_t count_differing_bits(const Case *a, const Case *b) {
    Grid *first = create(a), *second = create(b);
    int64_t differing = 0;
    for (int col = 0; col < a->width; col++)
        for (int row = 0; row < a->height; row += 97) {
            Vec3d p = grid_ecef(first, col, row, 777.0), q = grid_ecef(second, col, row, 777.0);
            differing += memcmp(&p, &q, sizeof p) != 0;
        }
    grid_destroy(&first);
    grid_destroy(&second);
    return differing;
}

static void test_shift_by_full_turns_gives_the_same_bits(void **state) {
    (void)state;
    static const double WEST[] = {19.0, -84.414, 6.5004166666666667, -180.0, -179.99958333333333,
                                  0.0,  179.7,   12.345678901234};
    static const double TURNS[] = {-360.0, 360.0};
    for (size_t i = 0; i < COUNT_OF(WEST); i++)
        for (size_t j = 0; j < COUNT_OF(TURNS); j++) {
            if (fabs(WEST[i] + TURNS[j]) >= 512.0) // doubles get coarser than the grid's fixed point
                continue;
            Case a = {"", {DEM_CRS_GEOGRAPHIC, 0, false, WEST[i], 47.0, 3 * SECOND, -3 * SECOND}, 1201, 600}, b = a;
            b.georef.x0 = WEST[i] + TURNS[j];
            int64_t differing = count_differing_bits(&a, &b);
            print_message("west %.15g and %.15g: %" PRId64 " positions differ\n", a.georef.x0, b.georef.x0, differing);
            assert_int_equal(differing, 0);
        }
}

static void test_minus_zero_and_540_are_longitudes_too(void **state) {
    (void)state;
    Case zero = {"", {DEM_CRS_GEOGRAPHIC, 0, false, 0.0, 1.0, 0.01, -0.01}, 101, 101}, minus = zero;
    minus.georef.x0 = -0.0;
    assert_int_equal(count_differing_bits(&zero, &minus), 0);
    Case west = {"", {DEM_CRS_GEOGRAPHIC, 0, false, -180.0, 1.0, 0.01, -0.01}, 101, 101}, far = west;
    far.georef.x0 = 540.0;
    assert_int_equal(count_differing_bits(&west, &far), 0);
}

// ---- bounds ----

typedef struct Tightness {
    double across, down, bend; // largest measured share of the bound
} Tightness;

static void check_steps(const Case *c, const Grid *grid, GridBounds bounds, int col, int row, double h_m,
                        Tightness *t) {
    Vec3d p = grid_ecef(grid, col, row, h_m);
    if (col + 1 < c->width)
        t->across = fmax(t->across, vec3d_distance(p, grid_ecef(grid, col + 1, row, h_m)) / bounds.across_m);
    if (row + 1 < c->height)
        t->down = fmax(t->down, vec3d_distance(p, grid_ecef(grid, col, row + 1, h_m)) / bounds.down_m);
}

// The second difference along any line of the grid is at most the second derivative times the squared step. Rounding is
// worth 1e-8 m.
static void check_second_difference(const Grid *grid, GridBounds bounds, const int at[2], const int step[2], double h_m,
                                    Tightness *t) {
    Vec3d p = grid_ecef(grid, at[0] - step[0], at[1] - step[1], h_m), q = grid_ecef(grid, at[0], at[1], h_m);
    Vec3d r = grid_ecef(grid, at[0] + step[0], at[1] + step[1], h_m);
    double difference = vec3d_length(vec3d_sub(vec3d_add(p, r), vec3d_scale(q, 2.0))) - 1e-8;
    double squared = (double)step[0] * step[0] + (double)step[1] * step[1];
    t->bend = fmax(t->bend, difference / (bounds.bend_m * squared));
}

// Rows begin..begin + count - 1.
static Tightness check_band(const Case *c, const Grid *grid, int begin, int count, uint64_t *random) {
    Tightness t = {0};
    double h_max_m = random_between(random, -400.0, 9000.0);
    GridBounds bounds = grid_bounds(grid, begin, begin + count - 1, h_max_m);
    for (int i = 0; i < 400; i++) {
        double h_m = random_below(random, 2) ? h_max_m : random_between(random, -500.0, h_max_m);
        int at[2] = {random_below(random, c->width), begin + random_below(random, count)};
        if (at[1] + 1 < begin + count)
            check_steps(c, grid, bounds, at[0], at[1], h_m, &t);
        int reach[2] = {at[0] < c->width - 1 - at[0] ? at[0] : c->width - 1 - at[0],
                        at[1] - begin < begin + count - 1 - at[1] ? at[1] - begin : begin + count - 1 - at[1]};
        int step[2] = {random_below(random, reach[0] + 1), random_below(random, 2 * reach[1] + 1) - reach[1]};
        if (step[0] || step[1])
            check_second_difference(grid, bounds, at, step, h_m, &t);
    }
    return t;
}

static void check_bounds(const Case *c, uint64_t *random) {
    Grid *grid = create(c);
    Tightness most = {0};
    for (int band = 0; band < 40; band++) {
        int count = 2 + random_below(random, c->height - 1), begin = random_below(random, c->height - count + 1);
        Tightness t = check_band(c, grid, begin, count, random);
        most = (Tightness){fmax(most.across, t.across), fmax(most.down, t.down), fmax(most.bend, t.bend)};
    }
    print_message("%-36s reached of the bounds: across %.4f, down %.4f, bend %.4f\n", c->name, most.across, most.down,
                  most.bend);
    assert_true(most.across <= 1.0);
    assert_true(most.down <= 1.0);
    assert_true(most.bend <= 1.0);
    assert_true(most.down == 0.0 || most.down > 0.9); // bounds that are of use
    grid_destroy(&grid);
}

static void test_bounds_hold_everywhere(void **state) {
    (void)state;
    uint64_t random = SEED;
    print_message("seed %" PRIu64 "\n", random);
    for (size_t i = 0; i < COUNT_OF(GEOGRAPHIC); i++)
        check_bounds(&GEOGRAPHIC[i], &random);
    for (size_t i = 0; i < COUNT_OF(UTM); i++)
        check_bounds(&UTM[i], &random);
}

static void test_bounds_hold_at_random_places(void **state) {
    (void)state;
    uint64_t random = SEED + 1;
    print_message("seed %" PRIu64 "\n", random);
    for (int i = 0; i < 30; i++) {
        double south = random_between(&random, -90.0, 85.0), spacing = random_between(&random, 0.001, 0.02);
        Case geographic = {"random geographic",
                           {DEM_CRS_GEOGRAPHIC, 0, false, random_between(&random, -180.0, 360.0), south + 99 * spacing,
                            spacing * random_between(&random, 0.2, 5.0), -spacing},
                           100,
                           100};
        geographic.georef.y0 = fmin(geographic.georef.y0, 90.0);
        check_bounds(&geographic, &random);
        double dx = random_between(&random, 100.0, 2000.0), dy = dx * random_between(&random, 0.3, 3.0);
        Case utm = {"random UTM",
                    {DEM_CRS_UTM, 1 + random_below(&random, 60), true, random_between(&random, 0.0, 1e6 - 99 * dx),
                     random_between(&random, 99 * dy, 9.3e6), dx, -dy},
                    100,
                    100};
        check_bounds(&utm, &random);
    }
}

// What the bend is for: a triangle whose vertices lie in a circle of rho cells is within bend rho^2 / 2 of the map.
static void check_triangle(const Case *c, const Grid *grid, uint64_t *random, double *most) {
    int rho = 2 + random_below(random, 60),
        centre[2] = {rho + random_below(random, c->width - 2 * rho), rho + random_below(random, c->height - 2 * rho)};
    GridBounds bounds = grid_bounds(grid, centre[1] - rho, centre[1] + rho, 3000.0);
    Vec3d sum = {0};
    double weights[3], col = 0.0, row = 0.0, total = 0.0;
    for (int i = 0; i < 3; i++)
        total += weights[i] = random_between(random, 0.05, 1.0);
    for (int i = 0; i < 3; i++) {
        double angle = random_between(random, 0.0, 6.28);
        int at[2] = {centre[0] + (int)(rho * cos(angle)), centre[1] + (int)(rho * sin(angle))};
        sum = vec3d_mad(sum, grid_ecef(grid, at[0], at[1], 3000.0), weights[i] / total);
        col += at[0] * weights[i] / total;
        row += at[1] * weights[i] / total;
    }
    double error = vec3d_distance(sum, oracle_ecef(c, col, row, 3000.0)) - 2e-6; // interpolation, rounding
    *most = fmax(*most, error / (0.5 * bounds.bend_m * rho * rho));
}

static void test_bend_bounds_linear_interpolation(void **state) {
    (void)state;
    static const Case CASES[] = {
        {"coarse, 60 N", {DEM_CRS_GEOGRAPHIC, 0, false, 5.0, 60.0, 0.02, -0.01}, 400, 400},
        {"equator", {DEM_CRS_GEOGRAPHIC, 0, false, 5.0, 2.0, 0.01, -0.01}, 400, 400},
        {"near the pole", {DEM_CRS_GEOGRAPHIC, 0, false, 5.0, 89.9, 0.5, -0.01}, 400, 400},
        {"UTM, kilometre cells, far east", {DEM_CRS_UTM, 32, true, 599000.0, 7000000.0, 1000.0, -1000.0}, 401, 400},
        {"UTM, oblong cells", {DEM_CRS_UTM, 32, true, 299000.0, 500000.0, 500.0, -1000.0}, 401, 400},
    };
    uint64_t random = SEED + 2;
    print_message("seed %" PRIu64 "\n", random);
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        Grid *grid = create(&CASES[i]);
        double most = 0.0;
        for (int j = 0; j < 3000; j++)
            check_triangle(&CASES[i], grid, &random, &most);
        print_message("%-36s reached %.4f of bend rho^2 / 2\n", CASES[i].name, most);
        assert_true(most <= 1.0);
        grid_destroy(&grid);
    }
}

// ---- geodetic ----

static void check_round_trip(const Case *c) {
    Grid *grid = create(c);
    uint64_t random = SEED;
    double worst = 0.0;
    for (int i = 0; i < 200; i++) {
        double col = random_between(&random, 0.0, c->width - 1), row = random_between(&random, 0.0, c->height - 1);
        double lat, lon, back_col, back_row;
        grid_geodetic(grid, col, row, &lat, &lon);
        if (fabs(lat) > 89.99) // no longitude there
            continue;
        for (int turn = -1; turn <= 1; turn++) {
            assert_true(grid_from_geodetic(grid, lat, lon + 360.0 * turn, &back_col, &back_row));
            double across = fabs(back_col - col);
            across = fmin(across, fabs(across - 360.0 / c->georef.dx)); // a whole turn has two columns for one meridian
            worst = fmax(worst, fmax(across, fabs(back_row - row)));
        }
    }
    print_message("%-36s round trip within %.2g cells\n", c->name, worst);
    assert_true(worst <= 1e-6);
    grid_destroy(&grid);
}

static void test_geodetic_and_back(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT_OF(GEOGRAPHIC); i++)
        check_round_trip(&GEOGRAPHIC[i]);
    for (size_t i = 0; i < COUNT_OF(UTM); i++)
        check_round_trip(&UTM[i]);
}

static void test_longitude_is_taken_towards_the_middle(void **state) {
    (void)state;
    Case c = {"", {DEM_CRS_GEOGRAPHIC, 0, false, 179.0, 1.0, 0.01, -0.01}, 201, 101};
    Grid *grid = create(&c);
    double col, row;
    assert_true(grid_from_geodetic(grid, 0.5, -179.5, &col, &row));
    print_message("179.5 W in a DEM from 179 E: column %.9f, expected 150\n", col);
    assert_true(fabs(col - 150.0) < 1e-9);
    assert_false(grid_from_geodetic(grid, NAN, 0.0, &col, &row));
    assert_false(grid_from_geodetic(grid, 0.0, INFINITY, &col, &row));
    grid_destroy(&grid);
}

// ---- refusals ----

static void drop_message(void *user, LogLevel level, const char *message) {
    (void)level;
    (void)message;
    ++*(int *)user;
}

static void test_impossible_grids_are_refused_with_a_message(void **state) {
    (void)state;
    static const Case BAD[] = {
        {"one column", {DEM_CRS_GEOGRAPHIC, 0, false, 0, 0, 1, -1}, 1, 5},
        {"too wide", {DEM_CRS_GEOGRAPHIC, 0, false, 0, 0, 1e-5, -1e-5}, DEM_SIDE_MAX + 1, 5},
        {"latitude", {DEM_CRS_GEOGRAPHIC, 0, false, 0, 92, 1, -1}, 5, 5},
        {"latitude below", {DEM_CRS_GEOGRAPHIC, 0, false, 0, -80, 1, -1}, 5, 50},
        {"south up", {DEM_CRS_GEOGRAPHIC, 0, false, 0, 0, 1, 1}, 5, 5},
        {"no spacing", {DEM_CRS_GEOGRAPHIC, 0, false, 0, 0, 0, -1}, 5, 5},
        {"NaN", {DEM_CRS_GEOGRAPHIC, 0, false, NAN, 0, 1, -1}, 5, 5},
        {"two turns", {DEM_CRS_GEOGRAPHIC, 0, false, 0, 0, 1, -1}, 721, 5},
        {"zone", {DEM_CRS_UTM, 61, true, 5e5, 1e6, 100, -100}, 5, 5},
        {"easting", {DEM_CRS_UTM, 32, true, 9.9e5, 1e6, 100, -100}, 500, 5},
        {"northing", {DEM_CRS_UTM, 32, true, 5e5, 2e7, 100, -100}, 5, 5},
    };
    for (size_t i = 0; i < COUNT_OF(BAD); i++) {
        Grid *grid = NULL;
        int messages = 0;
        log_set_sink(drop_message, &messages);
        Result result = grid_create(&BAD[i].georef, BAD[i].width, BAD[i].height, &grid);
        log_set_sink(NULL, NULL);
        print_message("%-36s %s, %d message\n", BAD[i].name, result_name(result), messages);
        assert_int_equal(result, RESULT_RANGE);
        assert_int_equal(messages, 1);
        assert_null(grid);
    }
}

int main(void) {
    feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_geographic_positions_are_exact),
        cmocka_unit_test(test_utm_positions_are_within_a_millimetre),
        cmocka_unit_test(test_normals_are_unit_and_geodetic),
        cmocka_unit_test(test_lattice_is_the_nearest_one),
        cmocka_unit_test(test_shift_by_full_turns_gives_the_same_bits),
        cmocka_unit_test(test_minus_zero_and_540_are_longitudes_too),
        cmocka_unit_test(test_bounds_hold_everywhere),
        cmocka_unit_test(test_bounds_hold_at_random_places),
        cmocka_unit_test(test_bend_bounds_linear_interpolation),
        cmocka_unit_test(test_geodetic_and_back),
        cmocka_unit_test(test_longitude_is_taken_towards_the_middle),
        cmocka_unit_test(test_impossible_grids_are_refused_with_a_message),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
