// What measuring tells of each sample, and how far the surface moved between two cuts: against plain searches over the
// triangles.
#include "base/arena.h"
#include "terrain/terrain_parts.h"
#include "tests/cut_support.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SEED UINT64_C(90125)
#define WIDTH 97
#define HEIGHT 71
#define SAMPLES (WIDTH * HEIGHT)

typedef struct Fixture {
    Jobs *jobs;
    Terrain *terrain;
    Lod *lods[2];
    Arena *frames[2];
    LodCut cuts[2];
    float error_px[2][SAMPLES], rise_m[2][SAMPLES];
    Measure measures[2];
} Fixture;

static void measure_both(Fixture *f, Jobs *jobs) {
    for (int i = 0; i < 2; i++) {
        const MeasureMaps maps = {f->error_px[i], f->rise_m[i]};
        assert_int_equal(measure_cut_maps(f->terrain, &f->cuts[i], jobs, &maps, &f->measures[i]), RESULT_OK);
    }
}

// Two cuts of one rough terrain, a few steps apart, the second one coarser.
static Fixture *fixture_begin(void) {
    const DemGeoref georef = {DEM_CRS_GEOGRAPHIC, 0, false, 12.3, 46.9, 0.0006, -0.0004};
    Fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    assert_int_equal(jobs_create(2, &f->jobs), RESULT_OK);
    f->terrain =
        support_terrain(support_rough_dem(WIDTH, HEIGHT, &georef, 700.0, SEED), TERRAIN_ERROR_TOTAL, 6, f->jobs);
    for (int i = 0; i < 2; i++) {
        LodOptions options = lod_default_options();
        LodView view = support_view(support_eye(f->terrain, 30.0 + i, 40.0, 120.0), 3.0 + 5.0 * i);
        assert_int_equal(lod_create(&options, f->terrain, &f->lods[i]), RESULT_OK);
        assert_int_equal(arena_create(1 << 16, &f->frames[i]), RESULT_OK);
        assert_int_equal(lod_update(f->lods[i], &view, f->jobs, f->frames[i], &f->cuts[i]), RESULT_OK);
    }
    measure_both(f, f->jobs);
    return f;
}

static void fixture_end(Fixture *f) {
    for (int i = 0; i < 2; i++) {
        lod_destroy(&f->lods[i]);
        arena_destroy(&f->frames[i]);
    }
    terrain_destroy(&f->terrain);
    jobs_destroy(&f->jobs);
    free(f);
}

// The height above the sample of the first triangle found that holds it, in long double; NaN: none does.
static long double rise_of(const Fixture *f, const LodCut *cut, int col, int row) {
    Vec3d base, up;
    Vec3d exact = terrain_ecef(f->terrain, col, row);
    grid_base(terrain_grid(f->terrain), col, row, &base, &up);
    for (int32_t i = 0; i < cut->item_count; i++) {
        const LodPage *page = cut->items[i].page;
        for (int32_t k = 0; k < cut->items[i].index_count; k += 3) {
            long double x[3], y[3], w[3], sum = 0.0L;
            for (int c = 0; c < 3; c++) {
                const LodVertex *v = &page->vertices[cut->items[i].indices[k + c]];
                x[c] = page->col0 + v->col - col;
                y[c] = page->row0 + v->row - row;
            }
            for (int c = 0; c < 3; c++)
                w[c] = x[(c + 2) % 3] * y[(c + 1) % 3] - x[(c + 1) % 3] * y[(c + 2) % 3];
            if (w[0] < 0 || w[1] < 0 || w[2] < 0)
                continue;
            for (int c = 0; c < 3; c++) {
                const LodVertex *v = &page->vertices[cut->items[i].indices[k + c]];
                long double px = (long double)(page->origin.x + v->x) / GRID_LATTICE_PER_M - exact.x;
                long double py = (long double)(page->origin.y + v->y) / GRID_LATTICE_PER_M - exact.y;
                long double pz = (long double)(page->origin.z + v->z) / GRID_LATTICE_PER_M - exact.z;
                sum += w[c] * (px * up.x + py * up.y + pz * up.z);
            }
            return sum / (w[0] + w[1] + w[2]);
        }
    }
    return NAN;
}

static void test_maps_are_those_of_a_plain_search(void **state) {
    (void)state;
    Fixture *f = fixture_begin();
    for (int i = 0; i < 2; i++) {
        for (int sample = 0; sample < SAMPLES; sample += 7) {
            double wanted = (double)rise_of(f, &f->cuts[i], sample % WIDTH, sample / WIDTH);
            if (!(fabs(wanted - (double)f->rise_m[i][sample]) <= 1e-4))
                fail_msg("cut %d, sample %d: rise %g m, expected %g", i, sample, (double)f->rise_m[i][sample], wanted);
        }
    }
    fixture_end(f);
}

static void test_the_map_of_errors_has_the_measured_greatest_where_it_is_said_to_be(void **state) {
    (void)state;
    Fixture *f = fixture_begin();
    for (int i = 0; i < 2; i++) {
        float most = 0.0f;
        for (int sample = 0; sample < SAMPLES; sample++)
            most = fmaxf(most, f->error_px[i][sample]);
        const Measure *m = &f->measures[i];
        assert_true(m->max_px > 1.0);
        assert_float_equal((double)most, m->max_px, m->max_px * (double)FLT_EPSILON);
        assert_float_equal((double)f->error_px[i][m->worst_row * WIDTH + m->worst_col], (double)most, 0.0);
        Measure plain;
        assert_int_equal(measure_cut(f->terrain, &f->cuts[i], f->jobs, &plain), RESULT_OK);
        assert_float_equal(plain.max_px, m->max_px, 0.0);
        assert_float_equal(plain.rms_px, m->rms_px, 0.0);
    }
    fixture_end(f);
}

static void test_popping_is_the_greatest_move_of_the_surface(void **state) {
    (void)state;
    Fixture *f = fixture_begin();
    const LodView *view = &f->cuts[1].view;
    MeasurePopping popping, none;
    double wanted = 0.0;
    for (int sample = 0; sample < SAMPLES; sample++) {
        Vec3d exact = terrain_ecef(f->terrain, sample % WIDTH, sample / WIDTH);
        double moved = fabs((double)f->rise_m[1][sample] - (double)f->rise_m[0][sample]);
        wanted = fmax(wanted, view->px_per_rad * moved / vec3d_distance(exact, view->eye_ecef));
    }
    assert_int_equal(measure_popping(f->terrain, view, f->rise_m[0], f->rise_m[1], f->jobs, &popping), RESULT_OK);
    assert_true(wanted > 1.0);
    assert_float_equal(popping.max_px, wanted, wanted * 1e-12);
    assert_int_equal(measure_popping(f->terrain, view, f->rise_m[1], f->rise_m[1], f->jobs, &none), RESULT_OK);
    assert_float_equal(none.max_px, 0.0, 0.0);
    fixture_end(f);
}

static void test_samples_that_nothing_covers_are_no_numbers_and_do_not_pop(void **state) {
    (void)state;
    Fixture *f = fixture_begin();
    LodItem *items = malloc(sizeof *items * (size_t)f->cuts[1].item_count);
    assert_non_null(items);
    memcpy(items, f->cuts[1].items, sizeof *items * (size_t)f->cuts[1].item_count);
    items[0].index_count = 0;
    LodCut cut = f->cuts[1];
    cut.items = items;
    const MeasureMaps maps = {f->error_px[1], f->rise_m[1]};
    Measure measure;
    MeasurePopping popping;
    assert_int_equal(measure_cut_maps(f->terrain, &cut, f->jobs, &maps, &measure), RESULT_OK);
    int64_t open = 0;
    for (int sample = 0; sample < SAMPLES; sample++) {
        assert_int_equal(isnan(f->error_px[1][sample]), isnan(f->rise_m[1][sample]));
        open += isnan(f->rise_m[1][sample]);
    }
    assert_true(open > 0);
    assert_int_equal(measure.samples, SAMPLES - open);
    assert_int_equal(measure_popping(f->terrain, &cut.view, f->rise_m[0], f->rise_m[1], f->jobs, &popping), RESULT_OK);
    assert_true(isfinite(popping.max_px));
    free(items);
    fixture_end(f);
}

static void test_any_number_of_workers_gives_the_same_maps(void **state) {
    (void)state;
    Fixture *f = fixture_begin();
    MeasurePopping first, other;
    float errors[SAMPLES], rises[SAMPLES];
    memcpy(errors, f->error_px[0], sizeof errors);
    memcpy(rises, f->rise_m[0], sizeof rises);
    assert_int_equal(measure_popping(f->terrain, &f->cuts[1].view, f->rise_m[0], f->rise_m[1], f->jobs, &first),
                     RESULT_OK);
    for (int workers = 1; workers <= 5; workers += 2) {
        Jobs *jobs;
        assert_int_equal(jobs_create(workers, &jobs), RESULT_OK);
        measure_both(f, jobs);
        assert_memory_equal(errors, f->error_px[0], sizeof errors);
        assert_memory_equal(rises, f->rise_m[0], sizeof rises);
        assert_int_equal(measure_popping(f->terrain, &f->cuts[1].view, f->rise_m[0], f->rise_m[1], jobs, &other),
                         RESULT_OK);
        assert_memory_equal(&first, &other, sizeof first);
        jobs_destroy(&jobs);
    }
    fixture_end(f);
}

// ---- stretches ----

#define STRETCH 9

typedef struct Walk {
    Lod *lod;
    Arena *frame;
    LodCut cut;
    MeasureStretch *stretch;
    float *rise_m[2]; // whole maps of the cut before and of this one
    int moved;        // pairs
} Walk;

static void walk_begin(const Fixture *f, LodMethod method, Walk *walk) {
    LodOptions options = lod_default_options();
    options.method = method;
    *walk = (Walk){.moved = 0};
    assert_int_equal(lod_create(&options, f->terrain, &walk->lod), RESULT_OK);
    assert_int_equal(arena_create(1 << 16, &walk->frame), RESULT_OK);
    assert_int_equal(measure_stretch_create(f->terrain, &walk->stretch), RESULT_OK);
    for (int i = 0; i < 2; i++) {
        walk->rise_m[i] = malloc(sizeof *walk->rise_m[i] * SAMPLES);
        assert_non_null(walk->rise_m[i]);
    }
}

static void walk_end(Walk *walk) {
    measure_stretch_destroy(&walk->stretch);
    lod_destroy(&walk->lod);
    arena_destroy(&walk->frame);
    free(walk->rise_m[0]);
    free(walk->rise_m[1]);
}

// Along the ground, with a tolerance that leaps now and then: levels change, and so does the number of items.
static void walk_on(const Fixture *f, Walk *walk, int i) {
    LodView view = support_view(support_eye(f->terrain, 20.0 + 2.0 * i, 35.0 + i, 150.0), i % 4 == 3 ? 12.0 : 3.0);
    lod_release(walk->lod, walk->cut.frame);
    arena_reset(walk->frame);
    assert_int_equal(lod_update(walk->lod, &view, f->jobs, walk->frame, &walk->cut), RESULT_OK);
}

// The whole map of a cut, by a stretch that knows no other.
static void map_whole(const Fixture *f, const LodCut *cut, float *rise_m) {
    MeasureStretch *whole;
    MeasurePopping popping;
    assert_int_equal(measure_stretch_create(f->terrain, &whole), RESULT_OK);
    assert_int_equal(measure_stretch_add(whole, cut, f->jobs, &popping), RESULT_OK);
    assert_float_equal(popping.max_px, 0.0, 0.0);
    memcpy(rise_m, measure_stretch_rise_m(whole), sizeof *rise_m * SAMPLES);
    measure_stretch_destroy(&whole);
}

static void expect_measured_rises(Fixture *f, const LodCut *cut, const float *rise_m) {
    const MeasureMaps maps = {.rise_m = f->rise_m[0]};
    Measure measure;
    assert_int_equal(measure_cut_maps(f->terrain, cut, f->jobs, &maps, &measure), RESULT_OK);
    for (int sample = 0; sample < SAMPLES; sample++) {
        double found_m = (double)rise_m[sample], wanted_m = (double)f->rise_m[0][sample];
        if (isnan(found_m) != isnan(wanted_m) || fabs(found_m - wanted_m) > 1e-4)
            fail_msg("sample %d: rise %g m, expected %g", sample, found_m, wanted_m);
    }
}

// Adds a cut, and fails unless the map and the popping are those of whole maps, to the bit.
static double add_and_compare(Fixture *f, Walk *walk, const LodCut *cut, int i) {
    float *whole_m = walk->rise_m[i & 1];
    MeasurePopping found, wanted = {0};
    map_whole(f, cut, whole_m);
    assert_int_equal(measure_stretch_add(walk->stretch, cut, f->jobs, &found), RESULT_OK);
    assert_memory_equal(measure_stretch_rise_m(walk->stretch), whole_m, sizeof *whole_m * SAMPLES);
    expect_measured_rises(f, cut, whole_m);
    if (i > 0)
        assert_int_equal(measure_popping(f->terrain, &cut->view, walk->rise_m[(i & 1) ^ 1], whole_m, f->jobs, &wanted),
                         RESULT_OK);
    assert_float_equal(found.max_px, wanted.max_px, 0.0);
    if (found.max_px > 0.0)
        assert_memory_equal(&found, &wanted, sizeof found);
    walk->moved += found.max_px > 0.0;
    return found.max_px;
}

static void test_a_stretch_gives_what_whole_maps_give(void **state) {
    (void)state;
    static const LodMethod methods[] = {LOD_HYBRID, LOD_PATCH, LOD_GEOMIPMAP, LOD_GEOMIPMAP_YE, LOD_DIAMOND};
    Fixture *f = fixture_begin();
    for (size_t m = 0; m < COUNT_OF(methods); m++) {
        Walk walk;
        walk_begin(f, methods[m], &walk);
        for (int i = 0; i < STRETCH; i++) {
            walk_on(f, &walk, i);
            add_and_compare(f, &walk, &walk.cut, i);
        }
        assert_true(walk.moved > 2);
        walk_end(&walk);
    }
    fixture_end(f);
}

// Of one view again and again: nothing moves, whatever is claimed of revisions; then one vertex does, by known pixels;
// then an item is gone, and comes back.
static void test_a_stretch_finds_a_vertex_that_moves_and_an_item_that_goes(void **state) {
    (void)state;
    Fixture *f = fixture_begin();
    Walk walk;
    walk_begin(f, LOD_HYBRID, &walk);
    walk_on(f, &walk, 0);
    LodCut cut = walk.cut;
    LodItem *items = malloc(sizeof *items * (size_t)cut.item_count);
    LodPage page = *cut.items[1].page;
    LodVertex *vertices = malloc(sizeof *vertices * (size_t)page.vertex_count);
    assert_true(items && vertices);
    memcpy(items, cut.items, sizeof *items * (size_t)cut.item_count);
    memcpy(vertices, page.vertices, sizeof *vertices * (size_t)page.vertex_count);
    assert_float_equal(add_and_compare(f, &walk, &cut, 0), 0.0, 0.0);
    cut.items = items;
    assert_float_equal(add_and_compare(f, &walk, &cut, 1), 0.0, 0.0);
    LodVertex *v = &vertices[items[1].indices[0]];
    int col = page.col0 + v->col, row = page.row0 + v->row;
    Vec3d base, up;
    grid_base(terrain_grid(f->terrain), col, row, &base, &up);
    v->x += (int32_t)lround(up.x * 50.0 * GRID_LATTICE_PER_M);
    v->y += (int32_t)lround(up.y * 50.0 * GRID_LATTICE_PER_M);
    v->z += (int32_t)lround(up.z * 50.0 * GRID_LATTICE_PER_M);
    page.vertices = vertices;
    items[1].page = &page; // of the same id and revision
    double px = cut.view.px_per_rad * 50.0 / vec3d_distance(terrain_ecef(f->terrain, col, row), cut.view.eye_ecef);
    double found = add_and_compare(f, &walk, &cut, 2);
    if (!(found > 0.99 * px))
        fail_msg("moved by %g px, found %g", px, found);
    items[1].index_count = 0;
    add_and_compare(f, &walk, &cut, 3);
    items[1] = walk.cut.items[1];
    add_and_compare(f, &walk, &cut, 4);
    cut.item_count--; // and the last one is not there at all
    add_and_compare(f, &walk, &cut, 5);
    free(items);
    free(vertices);
    walk_end(&walk);
    fixture_end(f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_maps_are_those_of_a_plain_search),
        cmocka_unit_test(test_the_map_of_errors_has_the_measured_greatest_where_it_is_said_to_be),
        cmocka_unit_test(test_popping_is_the_greatest_move_of_the_surface),
        cmocka_unit_test(test_samples_that_nothing_covers_are_no_numbers_and_do_not_pop),
        cmocka_unit_test(test_any_number_of_workers_gives_the_same_maps),
        cmocka_unit_test(test_a_stretch_gives_what_whole_maps_give),
        cmocka_unit_test(test_a_stretch_finds_a_vertex_that_moves_and_an_item_that_goes),
    };
    return cmocka_run_group_tests_name("test_measure_maps", tests, NULL, NULL);
}
