// Nested errors: exact nesting on every vertex, the same bits from both schemes and any number of workers, and the
// total error against a scan of all samples in double.
#include "terrain/errors/error_field.h"
#include "terrain/terrain_parts.h"
#include "tests/cut_support.h"
#include "tests/slow.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define SEED UINT64_C(20101)

static const DemGeoref HILLS = {DEM_CRS_GEOGRAPHIC, 0, false, 19.0, 50.0, 1.0 / 1200, -1.0 / 1200};
static const DemGeoref METRES = {DEM_CRS_UTM, 33, true, 420000.0, 5400000.0, 30.0, -30.0};
static const DemGeoref GLOBE = {DEM_CRS_GEOGRAPHIC, 0, false, -179.0, 70.0, 0.5, -0.5};

// Counts what is wrong, names the first few, and goes on.
typedef struct Tally {
    int64_t checked, wrong;
} Tally;

static void tally(Tally *t, bool right, const char *what, int col, int row, double parent, double child) {
    t->checked++;
    if (!right && t->wrong++ < 5)
        print_error("%s at (%d, %d): parent %.9g, child %.9g\n", what, col, row, parent, child);
}

static Vec3d lattice_position(const Terrain *terrain, int col, int row) {
    const Dem *dem = terrain_dem(terrain);
    double h = (double)dem->height_m[(size_t)row * (size_t)dem->width + (size_t)col];
    return grid_point_ecef(grid_lattice(terrain_grid(terrain), col, row, h));
}

// One parent and child: errors do not grow towards the child, spheres contain each other with room for rounding.
static void check_child(const Terrain *terrain, int col, int row, int child_col, int child_row, Tally *t) {
    const Dem *dem = terrain_dem(terrain);
    if (child_col < 0 || child_row < 0 || child_col >= dem->width || child_row >= dem->height)
        return;
    ErrorCodes parent = error_field_at(&terrain->errors, col, row);
    ErrorCodes child = error_field_at(&terrain->errors, child_col, child_row);
    tally(t, parent.delta >= child.delta, "delta", col, row, (double)error_field_decode(parent.delta),
          (double)error_field_decode(child.delta));
    if (parent.delta == ERROR_FIELD_ALWAYS)
        return;
    double apart = vec3d_distance(lattice_position(terrain, col, row), lattice_position(terrain, child_col, child_row));
    double needed = apart + (double)error_field_decode(child.radius);
    double radius = (double)error_field_decode(parent.radius);
    tally(t, radius >= needed + 1e-4, "radius", col, row, radius, needed);
}

// Children by the definition in the papers, from the vertex's own step: not by the code that made the field.
static void check_vertex(const Terrain *terrain, int col, int row, Tally *t) {
    int s = 1;
    while ((col | row) % (2 * s) == 0)
        s *= 2;
    bool centre = col / s % 2 && row / s % 2;
    if (centre) {
        check_child(terrain, col, row, col - s, row, t);
        check_child(terrain, col, row, col + s, row, t);
        check_child(terrain, col, row, col, row - s, t);
        check_child(terrain, col, row, col, row + s, t);
    } else if (s > 1) {
        for (int i = 0; i < 4; i++)
            check_child(terrain, col, row, col + (i & 1 ? s : -s) / 2, row + (i & 2 ? s : -s) / 2, t);
    }
}

static void check_nesting(const Terrain *terrain, const char *name) {
    Tally t = {0};
    const Dem *dem = terrain_dem(terrain);
    for (int row = 0; row < dem->height; row++)
        for (int col = 0; col < dem->width; col++)
            if (col | row)
                check_vertex(terrain, col, row, &t);
    print_message("%s: %" PRId64 " relations, %" PRId64 " broken\n", name, t.checked, t.wrong);
    assert_int_equal(t.wrong, 0);
}

static Jobs *jobs_of(int workers) {
    Jobs *jobs;
    assert_int_equal(jobs_create(workers, &jobs), RESULT_OK);
    return jobs;
}

static void check_shared_nesting(const char *name) {
    Jobs *jobs = jobs_of(0);
    Geoid *geoid = NULL;
    Terrain *terrain = support_shared_terrain(name, &geoid, jobs);
    if (!terrain) {
        jobs_destroy(&jobs);
        skip();
    }
    check_nesting(terrain, name);
    terrain_destroy(&terrain);
    geoid_close(&geoid);
    jobs_destroy(&jobs);
}

static void test_errors_nest_on_every_vertex_of_the_tatra(void **state) {
    (void)state;
    SKIP_WHERE_THREADS_ARE_WATCHED();
    check_shared_nesting("tatra_srtm3_2401.tif");
}
static void test_errors_nest_on_every_vertex_of_puget_sound(void **state) {
    (void)state;
    SKIP_WHERE_THREADS_ARE_WATCHED();
    check_shared_nesting("puget_utm10_160m_1025.tif");
}
static void test_errors_nest_on_every_vertex_of_maui(void **state) {
    (void)state;
    SKIP_WHERE_THREADS_ARE_WATCHED();
    check_shared_nesting("maui_utm4n_40m_2049.tif");
}

static void test_errors_nest_for_any_size_and_place(void **state) {
    (void)state;
    static const struct {
        const char *name;
        const DemGeoref *georef;
        int width, height;
    } CASES[] = {{"300 x 201", &HILLS, 300, 201},
                 {"33 x 700", &METRES, 33, 700},
                 {"717 x 281 of the globe", &GLOBE, 717, 281},
                 {"2 x 2", &METRES, 2, 2},
                 {"130 x 3", &HILLS, 130, 3}};
    Jobs *jobs = jobs_of(2);
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        for (int kind = TERRAIN_ERROR_MIDPOINT; kind <= TERRAIN_ERROR_TOTAL; kind++) {
            Dem *dem = support_rough_dem(CASES[i].width, CASES[i].height, CASES[i].georef, 1500.0, SEED);
            Terrain *terrain = support_terrain(dem, (TerrainErrorKind)kind, 6, jobs);
            check_nesting(terrain, CASES[i].name);
            terrain_destroy(&terrain);
        }
    }
    jobs_destroy(&jobs);
}

static uint64_t field_hash(const Terrain *terrain, TerrainErrorKind kind, int stride, ErrorScheme scheme, int workers) {
    Jobs *jobs = jobs_of(workers);
    ErrorFieldInput input = {.height_m = terrain_dem(terrain)->height_m,
                             .grid = terrain_grid(terrain),
                             .forest = &terrain->forest,
                             .kind = kind,
                             .stride = stride,
                             .scheme = scheme};
    ErrorField field;
    assert_int_equal(error_field_create(&input, jobs, &field), RESULT_OK);
    uint64_t hash = error_field_hash(&field);
    error_field_destroy(&field);
    jobs_destroy(&jobs);
    return hash;
}

static void check_schemes(int width, int height, const DemGeoref *georef) {
    Jobs *jobs = jobs_of(1);
    Terrain *terrain =
        support_terrain(support_rough_dem(width, height, georef, 1200.0, SEED), TERRAIN_ERROR_TOTAL, 6, jobs);
    static const struct {
        TerrainErrorKind kind;
        int stride;
    } KINDS[] = {{TERRAIN_ERROR_MIDPOINT, 0}, {TERRAIN_ERROR_TOTAL, 0}, {TERRAIN_ERROR_TOTAL, 2}};
    for (size_t k = 0; k < COUNT_OF(KINDS); k++) {
        TerrainErrorKind kind = KINDS[k].kind;
        int stride = KINDS[k].stride;
        uint64_t recursive = field_hash(terrain, kind, stride, ERROR_SCHEME_RECURSIVE, 1);
        static const int WORKERS[] = {1, 2, 3, 8};
        for (size_t i = 0; i < COUNT_OF(WORKERS); i++) {
            uint64_t parallel = field_hash(terrain, kind, stride, ERROR_SCHEME_PARALLEL, WORKERS[i]);
            if (parallel != recursive)
                fail_msg("%d x %d, kind %d, stride %d, %d workers: %016" PRIx64 ", recursive %016" PRIx64, width,
                         height, kind, stride, WORKERS[i], parallel, recursive);
        }
        print_message("%4d x %4d, kind %d, stride %d: %016" PRIx64 " from all\n", width, height, kind, stride,
                      recursive);
    }
    terrain_destroy(&terrain);
    jobs_destroy(&jobs);
}

static void test_both_schemes_and_any_number_of_workers_give_the_same_bits(void **state) {
    (void)state;
    check_schemes(257, 257, &HILLS);
    check_schemes(300, 201, &HILLS);
    check_schemes(344, 403, &METRES);
    check_schemes(2, 2, &HILLS);
    check_schemes(3, 2, &HILLS);
    check_schemes(2, 90, &METRES);
    check_schemes(64, 66, &GLOBE);
    check_schemes(717, 281, &GLOBE);
}

// The oracle: barycentric interpolation of exact positions in double, over every sample of one triangle.
typedef struct Point {
    int col, row;
} Point;

static double doubled_area(Point a, Point b, Point c) {
    return (double)(b.col - a.col) * (c.row - a.row) - (double)(b.row - a.row) * (c.col - a.col);
}

static Vec3d exact_position(const Terrain *terrain, Point p) {
    const Dem *dem = terrain_dem(terrain);
    return grid_ecef(terrain_grid(terrain), p.col, p.row,
                     (double)dem->height_m[(size_t)p.row * (size_t)dem->width + (size_t)p.col]);
}

static double triangle_deviation(const Terrain *terrain, Point a, Point b, Point c) {
    Vec3d pa = exact_position(terrain, a), pb = exact_position(terrain, b), pc = exact_position(terrain, c);
    double area = doubled_area(a, b, c), most = 0.0;
    int west = (int)fmin(a.col, fmin(b.col, c.col)), east = (int)fmax(a.col, fmax(b.col, c.col));
    int north = (int)fmin(a.row, fmin(b.row, c.row)), south = (int)fmax(a.row, fmax(b.row, c.row));
    for (int row = north; row <= south; row++) {
        for (int col = west; col <= east; col++) {
            Point p = {col, row};
            double u = doubled_area(p, b, c) / area, v = doubled_area(a, p, c) / area, w = 1.0 - u - v;
            if (u < -1e-12 || v < -1e-12 || w < -1e-12)
                continue;
            Vec3d q = vec3d_add(vec3d_add(vec3d_scale(pa, u), vec3d_scale(pb, v)), vec3d_scale(pc, w));
            most = fmax(most, vec3d_distance(exact_position(terrain, p), q));
        }
    }
    return most;
}

static double diamond_deviation(const Terrain *terrain, int col, int row, int s) {
    const Dem *dem = terrain_dem(terrain);
    Point left, right, apexes[2];
    if (col / s % 2 && row / s % 2) {
        int rise = (col / (2 * s) + row / (2 * s)) % 2 ? -s : s;
        left = (Point){col - s, row - rise}, right = (Point){col + s, row + rise};
        apexes[0] = (Point){col - s, row + rise}, apexes[1] = (Point){col + s, row - rise};
    } else {
        int dx = col / s % 2 ? s : 0, dy = s - dx;
        left = (Point){col - dx, row - dy}, right = (Point){col + dx, row + dy};
        apexes[0] = (Point){col - dy, row - dx}, apexes[1] = (Point){col + dy, row + dx};
    }
    double most = 0.0;
    for (int i = 0; i < 2; i++)
        if (apexes[i].col >= 0 && apexes[i].row >= 0 && apexes[i].col < dem->width && apexes[i].row < dem->height)
            most = fmax(most, triangle_deviation(terrain, left, right, apexes[i]));
    return most;
}

static Terrain *bounded_terrain(Dem *dem, int stride, Jobs *jobs) {
    const TerrainOptions options = {.error = TERRAIN_ERROR_TOTAL, .error_stride = stride, .patch_level = 6};
    Terrain *terrain;
    assert_int_equal(terrain_create(&options, dem, NULL, jobs, &terrain), RESULT_OK);
    return terrain;
}

static void check_total(const DemGeoref *georef, double relief_m, int stride, const char *name) {
    Jobs *jobs = jobs_of(2);
    Terrain *terrain = bounded_terrain(support_rough_dem(193, 161, georef, relief_m, SEED), stride, jobs);
    double least_room = INFINITY, most_room = 0.0;
    int64_t checked = 0;
    for (int row = 0; row < 161; row++) {
        for (int col = 0; col < 193; col++) {
            int s = 1;
            while ((col | row) && (col | row) % (2 * s) == 0)
                s *= 2;
            float delta = error_field_decode(error_field_at(&terrain->errors, col, row).delta);
            if (!(delta < INFINITY))
                continue;
            double exact = diamond_deviation(terrain, col, row, s), room = (double)delta - exact;
            checked++;
            least_room = fmin(least_room, room);
            most_room = fmax(most_room, exact > 1.0 ? room / exact : 0.0);
            if (room < 0.0)
                fail_msg("%s, stride %d: vertex (%d, %d): delta %.9g m, deviation %.9g m", name, stride, col, row,
                         (double)delta, exact);
        }
    }
    print_message("%s, stride %d: %" PRId64 " diamonds, at least %.3g m to spare\n", name, stride, checked, least_room);
    terrain_destroy(&terrain);
    jobs_destroy(&jobs);
}

static void test_the_total_error_bounds_every_sample_of_every_diamond(void **state) {
    (void)state;
    SKIP_WHERE_THREADS_ARE_WATCHED();
    static const int STRIDES[] = {0, 1};
    for (size_t i = 0; i < COUNT_OF(STRIDES); i++) {
        check_total(&HILLS, 1800.0, STRIDES[i], "hills");
        check_total(&HILLS, 0.0, STRIDES[i], "flat, curved by the Earth");
        check_total(&METRES, 900.0, STRIDES[i], "UTM");
        check_total(&GLOBE, 6000.0, STRIDES[i], "globe");
    }
}

// Bounding sees nothing that looking would not: with a smaller stride no error falls, and a stride above all diamonds
// is the exact field.
static void test_bounded_errors_are_never_below_exact_ones(void **state) {
    (void)state;
    SKIP_WHERE_THREADS_ARE_WATCHED();
    static const int STRIDES[] = {1024, 64, 16, 4, 1};
    Jobs *jobs = jobs_of(2);
    Terrain *finer = bounded_terrain(support_rough_dem(300, 201, &HILLS, 1500.0, SEED), 0, jobs);
    uint64_t exact = error_field_hash(&finer->errors);
    for (size_t i = 0; i < COUNT_OF(STRIDES); i++) {
        Terrain *coarser = bounded_terrain(support_rough_dem(300, 201, &HILLS, 1500.0, SEED), STRIDES[i], jobs);
        int64_t raised = 0;
        for (int sample = 0; sample < 300 * 201; sample++) {
            int before = error_field_at(&finer->errors, sample % 300, sample / 300).delta;
            int after = error_field_at(&coarser->errors, sample % 300, sample / 300).delta;
            if (after < before)
                fail_msg("stride %d, sample %d: code %d below %d", STRIDES[i], sample, after, before);
            raised += after > before;
        }
        bool all_exact = STRIDES[i] >= 64; // the largest base tile has a side of 128
        assert_int_equal(error_field_hash(&coarser->errors) == exact, all_exact);
        assert_int_equal(raised > 0, !all_exact);
        check_nesting(coarser, "bounded");
        terrain_destroy(&finer);
        finer = coarser;
    }
    terrain_destroy(&finer);
    jobs_destroy(&jobs);
}

static void test_a_stride_that_is_no_power_of_two_is_refused(void **state) {
    (void)state;
    static const int STRIDES[] = {-1, 3, 2048};
    Jobs *jobs = jobs_of(1);
    for (size_t i = 0; i < COUNT_OF(STRIDES); i++) {
        const TerrainOptions options = {.error = TERRAIN_ERROR_TOTAL, .error_stride = STRIDES[i], .patch_level = 6};
        Dem *dem = support_rough_dem(9, 9, &HILLS, 100.0, SEED);
        Terrain *terrain;
        assert_int_equal(terrain_create(&options, dem, NULL, jobs, &terrain), RESULT_RANGE);
        dem_destroy(&dem);
    }
    jobs_destroy(&jobs);
}

static void test_codes_round_up_and_keep_the_order(void **state) {
    (void)state;
    uint64_t random = SEED;
    for (int i = 0; i < 100000; i++) {
        float value = (float)exp(support_between(&random, -20.0, 20.0));
        float kept = error_field_decode(error_field_encode(value));
        if (kept < value || kept > value * 1.004f)
            fail_msg("%.9g became %.9g", (double)value, (double)kept);
    }
    assert_int_equal(error_field_encode(0.0f), 0);
    assert_true(isinf(error_field_decode(ERROR_FIELD_ALWAYS)));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_codes_round_up_and_keep_the_order),
        cmocka_unit_test(test_both_schemes_and_any_number_of_workers_give_the_same_bits),
        cmocka_unit_test(test_errors_nest_for_any_size_and_place),
        cmocka_unit_test(test_errors_nest_on_every_vertex_of_the_tatra),
        cmocka_unit_test(test_errors_nest_on_every_vertex_of_puget_sound),
        cmocka_unit_test(test_errors_nest_on_every_vertex_of_maui),
        cmocka_unit_test(test_the_total_error_bounds_every_sample_of_every_diamond),
        cmocka_unit_test(test_bounded_errors_are_never_below_exact_ones),
        cmocka_unit_test(test_a_stride_that_is_no_power_of_two_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
