// Measuring: good cuts are found good, with the errors a plain search over all triangles gives; each way of spoiling
// one is condemned.
#include "base/log.h"
#include "terrain/grid.h"
#include "terrain/lod/cut_copy.h"
#include "terrain/measure/measure.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SEED UINT64_C(77)
#define CELLS 32
#define SIDE (CELLS + 1)
#define SAMPLES (SIDE * SIDE)
#define PAGES 4
#define TRIANGLES_MAX (2 * CELLS * CELLS)

// A cut of up to four items, one per quadrant. Each has a page of its own with all samples of the DEM, and its own
// origin: a vertex of two items is there twice.
typedef struct Fixture {
    Dem dem;
    float height_m[SAMPLES];
    Grid *grid;
    Jobs *jobs;
    LodPage pages[PAGES];
    LodVertex vertices[PAGES][SAMPLES];
    LodItem items[PAGES];
    uint16_t indices[PAGES][3 * TRIANGLES_MAX + 3];
    bool active[SAMPLES];
    LodCut cut;
} Fixture;

static uint64_t random_next(uint64_t *state) { // splitmix64
    uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

static int sample(int col, int row) {
    return row * SIDE + col;
}

// ---- a cut by longest-edge bisection ----

typedef struct Point {
    int col, row;
} Point;

static Point middle(Point a, Point b) {
    return (Point){(a.col + b.col) / 2, (a.row + b.row) / 2};
}

static bool is_leaf(Point left, Point right) {
    return abs(left.col - right.col) <= 1 && abs(left.row - right.row) <= 1;
}

// Activates the midpoint of every triangle that has something active below it. True when anything changed.
static bool close_below(Fixture *f, Point apex, Point left, Point right, bool *any) {
    if (is_leaf(left, right))
        return *any = false;
    Point m = middle(left, right);
    bool in_left, in_right, changed = close_below(f, m, apex, left, &in_left);
    changed |= close_below(f, m, right, apex, &in_right);
    bool *active = &f->active[sample(m.col, m.row)];
    if ((in_left || in_right) && !*active)
        *active = changed = true;
    *any = *active;
    return changed;
}

static void emit(Fixture *f, Point apex, Point left, Point right) {
    if (!is_leaf(left, right)) {
        Point m = middle(left, right);
        if (f->active[sample(m.col, m.row)]) {
            emit(f, m, apex, left);
            emit(f, m, right, apex);
            return;
        }
    }
    int col = apex.col + left.col + right.col, row = apex.row + left.row + right.row;
    int page = (col > 3 * CELLS / 2) + 2 * (row > 3 * CELLS / 2);
    uint16_t *to = f->indices[page] + f->items[page].index_count;
    to[0] = (uint16_t)sample(apex.col, apex.row);
    to[1] = (uint16_t)sample(left.col, left.row);
    to[2] = (uint16_t)sample(right.col, right.row);
    f->items[page].index_count += 3;
}

// The apex, then counter-clockwise from above.
static void triangulate(Fixture *f) {
    const Point nw = {0, 0}, ne = {CELLS, 0}, se = {CELLS, CELLS}, sw = {0, CELLS};
    for (bool changed = true, any; changed;) {
        changed = close_below(f, nw, sw, ne, &any);
        changed |= close_below(f, se, ne, sw, &any);
    }
    for (int i = 0; i < PAGES; i++)
        f->items[i].index_count = 0;
    emit(f, nw, sw, ne);
    emit(f, se, ne, sw);
}

// ---- set-up ----

static void fill_page(Fixture *f, int page) {
    GridPoint near = grid_lattice(f->grid, CELLS / 2, CELLS / 2, 0.0);
    GridPoint *origin = &f->pages[page].origin;
    *origin = (GridPoint){(near.x / GRID_LATTICE_PER_M + 100 * page) * GRID_LATTICE_PER_M,
                          (near.y / GRID_LATTICE_PER_M - 333 * page) * GRID_LATTICE_PER_M,
                          near.z / GRID_LATTICE_PER_M * GRID_LATTICE_PER_M};
    for (int row = 0; row < SIDE; row++)
        for (int col = 0; col < SIDE; col++) {
            GridPoint p = grid_lattice(f->grid, col, row, (double)f->height_m[sample(col, row)]);
            f->vertices[page][sample(col, row)] = (LodVertex){(int32_t)(p.x - origin->x), (int32_t)(p.y - origin->y),
                                                              (int32_t)(p.z - origin->z), (uint16_t)col, (uint16_t)row};
        }
    f->pages[page].vertex_count = SAMPLES;
    f->pages[page].vertices = f->vertices[page];
    f->items[page] = (LodItem){.page = &f->pages[page], .indices = f->indices[page]};
}

// Random heights over 400 m, cells of about 100 m, the eye 1500 m up beside the middle.
static Fixture *fixture_create(uint64_t seed) {
    Fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    f->dem = (Dem){.width = SIDE,
                   .height = SIDE,
                   .georef = {DEM_CRS_GEOGRAPHIC, 0, false, 20.0, 49.0, 0.001, -0.001},
                   .datum = DEM_DATUM_ELLIPSOID,
                   .height_m = f->height_m};
    assert_int_equal(grid_create(&f->dem.georef, SIDE, SIDE, &f->grid), RESULT_OK);
    assert_int_equal(jobs_create(2, &f->jobs), RESULT_OK);
    for (int i = 0; i < SAMPLES; i++)
        f->height_m[i] = (float)(random_next(&seed) % 4000) * 0.1f;
    for (int i = 0; i < PAGES; i++)
        fill_page(f, i);
    f->cut = (LodCut){.item_count = PAGES, .items = f->items};
    f->cut.view = (LodView){.eye_ecef = grid_ecef(f->grid, 19, 13, 1500.0), .px_per_rad = 700.0, .tau_px = 1.0};
    return f;
}

static void fixture_destroy(Fixture *f) {
    grid_destroy(&f->grid);
    jobs_destroy(&f->jobs);
    free(f);
}

static Fixture *fixture_random_cut(uint64_t seed, int active) {
    Fixture *f = fixture_create(seed);
    for (int i = 0; i < active; i++)
        f->active[random_next(&seed) % SAMPLES] = true;
    triangulate(f);
    return f;
}

static Fixture *fixture_full_cut(uint64_t seed) {
    Fixture *f = fixture_create(seed);
    memset(f->active, true, sizeof f->active);
    triangulate(f);
    return f;
}

static int64_t triangle_count(const Fixture *f) {
    int64_t count = 0;
    for (int i = 0; i < PAGES; i++)
        count += f->items[i].index_count / 3;
    return count;
}

static Measure measured(const Fixture *f) {
    Measure m;
    assert_int_equal(measure_cut_of(&f->dem, f->grid, &f->cut, f->jobs, &m), RESULT_OK);
    return m;
}

static void print_measure(const char *what, const Measure *m) {
    print_message("%-34s max %.4g px at (%d, %d), t-junctions %" PRId64 ", holes %" PRId64 ", overlaps %" PRId64 "\n",
                  what, m->max_px, m->worst_col, m->worst_row, m->t_junctions, m->holes, m->overlaps);
}

static void assert_whole(const Measure *m) {
    assert_int_equal(m->t_junctions, 0);
    assert_int_equal(m->holes, 0);
    assert_int_equal(m->overlaps, 0);
    assert_int_equal(m->samples, SAMPLES);
}

// ---- the oracle: every sample against every triangle ----

static Vec3d oracle_drawn(const Fixture *f, int page, uint16_t index) {
    const LodVertex *v = &f->vertices[page][index];
    GridPoint o = f->pages[page].origin;
    return grid_point_ecef((GridPoint){o.x + v->x, o.y + v->y, o.z + v->z});
}

// -1 where the triangle does not hold the sample.
static double oracle_error(const Fixture *f, int page, const uint16_t *index, int col, int row) {
    double x[3], y[3], share[3];
    for (int i = 0; i < 3; i++)
        x[i] = index[i] % SIDE - col, y[i] = index[i] / SIDE - row;
    double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    Vec3d q = {0};
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        share[i] = (x[j] * y[k] - x[k] * y[j]) / area;
        if (share[i] < 0.0)
            return -1.0;
        q = vec3d_mad(q, oracle_drawn(f, page, index[i]), share[i]);
    }
    Vec3d p = grid_ecef(f->grid, col, row, (double)f->height_m[sample(col, row)]);
    return f->cut.view.px_per_rad * vec3d_distance(p, q) / vec3d_distance(p, f->cut.view.eye_ecef);
}

static double oracle_at(const Fixture *f, int col, int row) {
    double error = -1.0;
    for (int page = 0; page < PAGES; page++)
        for (int i = 0; i < f->items[page].index_count; i += 3)
            error = fmax(error, oracle_error(f, page, f->indices[page] + i, col, row));
    return error;
}

static int compare_doubles(const void *left, const void *right) {
    const double *a = left, *b = right;
    return (*a > *b) - (*a < *b);
}

static bool near(double found, double expected) {
    return fabs(found - expected) <= 2e-7 * expected + 1e-9;
}

static void check_against_oracle(const Fixture *f) {
    double errors[SAMPLES], sum = 0.0;
    int above = 0;
    for (int i = 0; i < SAMPLES; i++) {
        errors[i] = oracle_at(f, i % SIDE, i / SIDE);
        sum += errors[i] * errors[i];
        above += errors[i] > f->cut.view.tau_px;
    }
    qsort(errors, SAMPLES, sizeof errors[0], compare_doubles);
    Measure m = measured(f);
    double p99 = errors[(int)ceil(0.99 * SAMPLES) - 1], p999 = errors[(int)ceil(0.999 * SAMPLES) - 1];
    print_message("%5" PRId64 " triangles: max %.6g (%.6g), p99.9 %.6g (%.6g), p99 %.6g (%.6g), rms %.6g (%.6g)\n",
                  triangle_count(f), m.max_px, errors[SAMPLES - 1], m.p999_px, p999, m.p99_px, p99, m.rms_px,
                  sqrt(sum / SAMPLES));
    assert_true(near(m.max_px, errors[SAMPLES - 1]));
    assert_true(near(m.p999_px, p999));
    assert_true(near(m.p99_px, p99));
    assert_true(near(m.rms_px, sqrt(sum / SAMPLES)));
    assert_true(near(m.above_tau_share, (double)above / SAMPLES));
    assert_true(near(oracle_at(f, m.worst_col, m.worst_row), m.max_px));
    assert_whole(&m);
}

static void test_errors_are_those_of_a_plain_search(void **state) {
    (void)state;
    print_message("seed %" PRIu64 "; the search's figures in brackets\n", SEED);
    static const int ACTIVE[] = {0, 1, 3, 10, 30, 100};
    for (size_t i = 0; i < COUNT_OF(ACTIVE); i++) {
        Fixture *f = fixture_random_cut(SEED + i, ACTIVE[i]);
        check_against_oracle(f);
        fixture_destroy(f);
    }
}

static void test_all_samples_drawn_leave_only_the_lattice(void **state) {
    (void)state;
    Fixture *f = fixture_full_cut(SEED);
    Measure m = measured(f);
    double limit = f->cut.view.px_per_rad * GRID_LATTICE_M * sqrt(0.75) / 1000.0;
    print_measure("every sample drawn", &m);
    print_message("%" PRId64 " triangles, expected %d; limit %.3g px\n", triangle_count(f), TRIANGLES_MAX, limit);
    assert_int_equal(triangle_count(f), TRIANGLES_MAX);
    assert_true(m.max_px <= limit);
    assert_whole(&m);
    fixture_destroy(f);
}

static void test_random_bisections_are_whole(void **state) {
    (void)state;
    print_message("seeds %" PRIu64 " and on\n", SEED);
    for (uint64_t i = 0; i < 60; i++) {
        Fixture *f = fixture_random_cut(SEED + i, (int)(i * i / 4));
        Measure m = measured(f);
        assert_whole(&m);
        fixture_destroy(f);
    }
}

static void test_any_number_of_workers_gives_the_same_bytes(void **state) {
    (void)state;
    static const int WORKERS[] = {1, 2, 3, 8};
    Fixture *f = fixture_random_cut(SEED, 40);
    Measure first = measured(f);
    for (size_t i = 0; i < COUNT_OF(WORKERS); i++) {
        jobs_destroy(&f->jobs);
        assert_int_equal(jobs_create(WORKERS[i], &f->jobs), RESULT_OK);
        Measure m = measured(f);
        assert_memory_equal(&m, &first, sizeof m);
    }
    fixture_destroy(f);
}

typedef struct Steps {
    int left; // until it ends
    int asked;
    MeasureSoFar last;
} Steps;

static bool step_on(void *user, const MeasureSoFar *so_far) {
    Steps *steps = user;
    steps->asked++;
    assert_true(so_far->share >= steps->last.share && so_far->max_px >= steps->last.max_px && so_far->share <= 1.0);
    steps->last = *so_far;
    return steps->left-- > 0;
}

// Wherever it is told to end, it ends and has measured nothing; else the pauses change nothing.
static void test_measuring_ends_when_it_is_told_to(void **state) {
    (void)state;
    Jobs *one = NULL;
    Fixture *f = fixture_random_cut(SEED, 40);
    Measure whole = measured(f), untouched;
    memset(&untouched, 7, sizeof untouched);
    assert_int_equal(jobs_create(1, &one), RESULT_OK);
    int ended = 0;
    for (int left = 0;; left++) {
        Steps steps = {.left = left};
        const MeasurePace pace = {step_on, &steps};
        Measure m = untouched;
        Result result = measure_cut_paced(&f->dem, f->grid, &f->cut, one, &pace, &m);
        if (result == RESULT_OK) {
            assert_memory_equal(&m, &whole, sizeof m);
            assert_true(steps.last.share == 1.0 && (float)steps.last.max_px >= (float)m.max_px);
            assert_true(steps.last.max_px <= m.max_px * 1.000001);
            break;
        }
        assert_int_equal(result, RESULT_BUDGET);
        assert_memory_equal(&m, &untouched, sizeof m);
        ended++;
    }
    print_message("ended in %d places\n", ended);
    assert_true(ended > 10);
    jobs_destroy(&one);
    fixture_destroy(f);
}

static double nearest_m(const LodCut *cut, int item) {
    return vec3d_length(vec3d_sub(cut->items[item].centre_ecef, cut->view.eye_ecef)) - cut->items[item].radius_m;
}

static void test_a_copy_of_a_cut_measures_the_same_without_it(void **state) {
    (void)state;
    Fixture *f = fixture_random_cut(SEED, 40);
    Measure whole = measured(f);
    CutCopy copy = {0};
    for (int i = 0; i < 2; i++) // the second time in the memory of the first
        assert_int_equal(cut_copy_take(&copy, &f->cut, SIZE_MAX), RESULT_OK);
    cut_copy_sort(&copy);
    for (int i = 1; i < copy.cut.item_count; i++)
        assert_true(nearest_m(&copy.cut, i - 1) <= nearest_m(&copy.cut, i));
    memset(f->vertices, 0, sizeof f->vertices);
    memset(f->indices, 0, sizeof f->indices);
    memset(f->pages, 0, sizeof f->pages);
    Measure m;
    assert_int_equal(measure_cut_of(&f->dem, f->grid, &copy.cut, f->jobs, &m), RESULT_OK);
    assert_memory_equal(&m, &whole, sizeof m);
    assert_int_equal(cut_copy_take(&copy, &f->cut, 1000), RESULT_BUDGET);
    assert_null(copy.items);
    cut_copy_free(&copy);
    fixture_destroy(f);
}

// ---- spoilt cuts ----

// A page's first triangle whose sides are not on the DEM's border.
static int inner_triangle(const Fixture *f, int page) {
    for (int i = 0; i < f->items[page].index_count; i += 3) {
        bool inside = true;
        for (int k = 0; k < 3; k++) {
            int col = f->indices[page][i + k] % SIDE, row = f->indices[page][i + k] / SIDE;
            inside &= col > 0 && row > 0 && col < CELLS && row < CELLS;
        }
        if (inside)
            return i;
    }
    fail_msg("the cut has no inner triangle");
    return 0;
}

static void move_vertex(Fixture *f, int page, int at, double metres) {
    f->vertices[page][at].x += (int32_t)lrint(metres * GRID_LATTICE_PER_M);
}

static void test_a_moved_vertex_is_above_the_tolerance(void **state) {
    (void)state;
    Fixture *f = fixture_full_cut(SEED);
    f->cut.view.tau_px = 0.75;
    int at = sample(21, 8);
    double away_m = vec3d_distance(grid_ecef(f->grid, 21, 8, (double)f->height_m[at]), f->cut.view.eye_ecef);
    for (int page = 0; page < PAGES; page++)
        move_vertex(f, page, at, 2.0 * f->cut.view.tau_px / f->cut.view.px_per_rad * away_m);
    Measure m = measured(f);
    print_measure("a vertex moved by 2 tau", &m);
    assert_true(fabs(m.max_px - 1.5) < 1e-3);
    assert_int_equal(m.worst_col, 21);
    assert_int_equal(m.worst_row, 8);
    assert_true(fabs(m.above_tau_share * SAMPLES - 1.0) < 1e-6);
    assert_whole(&m);
    fixture_destroy(f);
}

static void test_a_vertex_at_two_positions_is_a_hole(void **state) {
    (void)state;
    Fixture *f = fixture_full_cut(SEED);
    f->vertices[1][sample(CELLS / 2, 5)].y += 1; // a lattice unit, in one of the two pages that meet there
    Measure m = measured(f);
    print_measure("a vertex at two positions", &m);
    assert_int_equal(m.holes, 1);
    assert_int_equal(m.overlaps, 0);
    fixture_destroy(f);
}

static void test_a_missing_triangle_is_a_hole(void **state) {
    (void)state;
    for (int page = 0; page < PAGES; page++) {
        Fixture *f = fixture_random_cut(SEED, 60);
        int last = f->items[page].index_count -= 3, gone = inner_triangle(f, page);
        memcpy(f->indices[page] + gone, f->indices[page] + last, 3 * sizeof(uint16_t));
        Measure m = measured(f);
        print_measure("a triangle removed", &m);
        assert_true(m.holes >= 3);
        assert_int_equal(m.overlaps, 0);
        fixture_destroy(f);
    }
}

static void test_a_missing_corner_is_a_hole(void **state) {
    (void)state;
    Fixture *f = fixture_random_cut(SEED, 0);
    f->items[0].index_count = 0; // half of the DEM
    f->items[1].index_count = f->items[1].index_count > 3 ? 3 : f->items[1].index_count;
    Measure m = measured(f);
    print_measure("half of the DEM removed", &m);
    assert_true(m.holes > 400);
    assert_true(m.samples < SAMPLES);
    fixture_destroy(f);
}

static void test_a_doubled_triangle_is_an_overlap(void **state) {
    (void)state;
    for (int other = 0; other < 2; other++) { // within its own item, or in another one
        Fixture *f = fixture_random_cut(SEED, 60);
        int to = other ? 3 : 0, from = inner_triangle(f, 0);
        memcpy(f->indices[to] + f->items[to].index_count, f->indices[0] + from, 3 * sizeof(uint16_t));
        f->items[to].index_count += 3;
        Measure m = measured(f);
        print_measure("a triangle doubled", &m);
        assert_true(m.overlaps >= 1);
        assert_int_equal(m.t_junctions, 0);
        fixture_destroy(f);
    }
}

static void test_a_doubled_item_is_an_overlap(void **state) {
    (void)state;
    Fixture *f = fixture_full_cut(SEED);
    LodItem items[PAGES + 1];
    memcpy(items, f->items, sizeof f->items);
    items[PAGES] = items[2];
    f->cut.items = items;
    f->cut.item_count = PAGES + 1;
    Measure m = measured(f);
    print_measure("an item drawn twice", &m);
    assert_true(m.overlaps >= CELLS * CELLS / 4);
    fixture_destroy(f);
}

static void test_an_edge_split_on_one_side_is_a_t_junction(void **state) {
    (void)state;
    Fixture *f = fixture_random_cut(SEED, 0); // two triangles
    for (int page = 0; page < PAGES; page++) {
        uint16_t *t = f->indices[page];
        if (!f->items[page].index_count)
            continue;
        uint16_t m = (uint16_t)sample(CELLS / 2, CELLS / 2), split[6] = {m, t[0], t[1], m, t[2], t[0]};
        memcpy(t, split, sizeof split);
        f->items[page].index_count += 3;
        break;
    }
    Measure m = measured(f);
    print_measure("an edge split on one side", &m);
    assert_int_equal(triangle_count(f), 3);
    assert_int_equal(m.t_junctions, 1);
    assert_int_equal(m.overlaps, 0);
    fixture_destroy(f);
}

static void test_a_turned_triangle_is_condemned(void **state) {
    (void)state;
    Fixture *f = fixture_random_cut(SEED, 60);
    uint16_t *t = f->indices[0] + inner_triangle(f, 0), first = t[0];
    t[0] = t[1];
    t[1] = first;
    Measure m = measured(f);
    print_measure("a triangle turned over", &m);
    assert_true(m.overlaps >= 1);
    assert_true(m.holes >= 3);
    fixture_destroy(f);
}

static void test_a_degenerate_triangle_is_condemned(void **state) {
    (void)state;
    Fixture *f = fixture_full_cut(SEED);
    f->indices[0][1] = f->indices[0][0];
    Measure m = measured(f);
    print_measure("a degenerate triangle", &m);
    assert_true(m.overlaps >= 1);
    assert_true(m.holes >= 1);
    fixture_destroy(f);
}

static void test_an_index_or_place_beyond_the_data_is_condemned(void **state) {
    (void)state;
    Fixture *f = fixture_full_cut(SEED);
    f->indices[1][4] = UINT16_MAX;
    Measure m = measured(f);
    print_measure("an index beyond the page", &m);
    assert_true(m.holes >= 1);
    f->pages[2].row0 = CELLS;
    m = measured(f);
    print_measure("a page beyond the DEM", &m);
    assert_true(m.overlaps >= 1 && m.holes >= 1);
    fixture_destroy(f);
}

static void test_an_empty_cut_is_all_hole(void **state) {
    (void)state;
    Fixture *f = fixture_create(SEED);
    f->cut.item_count = 0;
    Measure m = measured(f);
    print_measure("an empty cut", &m);
    assert_int_equal(m.samples, 0);
    assert_int_equal(m.holes, SAMPLES + CELLS * CELLS);
    assert_true(m.max_px == 0.0 && m.rms_px == 0.0 && m.above_tau_share == 0.0);
    fixture_destroy(f);
}

// ---- odd numbers ----

static void test_a_height_that_is_no_number_is_infinitely_wrong(void **state) {
    (void)state;
    Fixture *f = fixture_full_cut(SEED);
    f->height_m[sample(3, 4)] = NAN;
    Measure m = measured(f);
    print_measure("a height that is not a number", &m);
    assert_true(isinf(m.max_px));
    assert_int_equal(m.worst_col, 3);
    assert_int_equal(m.worst_row, 4);
    assert_true(isfinite(m.p999_px) && m.above_tau_share > 0.0);
    fixture_destroy(f);
}

static void test_an_eye_on_a_vertex_is_finite_or_infinite_but_a_number(void **state) {
    (void)state;
    Fixture *f = fixture_full_cut(SEED);
    int at = sample(10, 10);
    f->cut.view.eye_ecef = grid_ecef(f->grid, 10, 10, (double)f->height_m[at]);
    Measure m = measured(f);
    print_measure("the eye on a vertex", &m);
    assert_false(isnan(m.max_px) || isnan(m.rms_px));
    assert_int_equal(m.worst_col, 10);
    f->cut.view.eye_ecef = grid_point_ecef(grid_lattice(f->grid, 10, 10, (double)f->height_m[at]));
    m = measured(f);
    print_measure("the eye where a vertex is drawn", &m);
    assert_false(isnan(m.max_px));
    assert_whole(&m);
    fixture_destroy(f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_errors_are_those_of_a_plain_search),
        cmocka_unit_test(test_all_samples_drawn_leave_only_the_lattice),
        cmocka_unit_test(test_random_bisections_are_whole),
        cmocka_unit_test(test_any_number_of_workers_gives_the_same_bytes),
        cmocka_unit_test(test_measuring_ends_when_it_is_told_to),
        cmocka_unit_test(test_a_copy_of_a_cut_measures_the_same_without_it),
        cmocka_unit_test(test_a_moved_vertex_is_above_the_tolerance),
        cmocka_unit_test(test_a_vertex_at_two_positions_is_a_hole),
        cmocka_unit_test(test_a_missing_triangle_is_a_hole),
        cmocka_unit_test(test_a_missing_corner_is_a_hole),
        cmocka_unit_test(test_a_doubled_triangle_is_an_overlap),
        cmocka_unit_test(test_a_doubled_item_is_an_overlap),
        cmocka_unit_test(test_an_edge_split_on_one_side_is_a_t_junction),
        cmocka_unit_test(test_a_turned_triangle_is_condemned),
        cmocka_unit_test(test_a_degenerate_triangle_is_condemned),
        cmocka_unit_test(test_an_index_or_place_beyond_the_data_is_condemned),
        cmocka_unit_test(test_an_empty_cut_is_all_hole),
        cmocka_unit_test(test_a_height_that_is_no_number_is_infinitely_wrong),
        cmocka_unit_test(test_an_eye_on_a_vertex_is_finite_or_infinite_but_a_number),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
