// Diamonds on the GPU give the bits of their CPU twin: errors, split bits before and after closure, triangles; for
// every operation a predicate can have, on DEMs of awkward sizes, with holes, and on real ones.
#include <inttypes.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cut_support.h"
#include "gl_support.h"
#include "render/diamond/diamond_gpu.h"
#include "render/gl.h"
#include "terrain/diamond/diamond.h"

#define SEED UINT64_C(31)
#define ALL_FIELDS (DIAMOND_FIELD_DATUM | DIAMOND_FIELD_DEGREES)

static const DemGeoref ROUGH = {DEM_CRS_GEOGRAPHIC, 0, false, 12.3, 46.9, 0.0006, -0.0004};

// --- a model on both sides

typedef struct Twins {
    Jobs *jobs;
    Geoid *geoid;
    Terrain *terrain;
    DiamondModel model; // the CPU's
    DiamondGpu *gpu;    // made without errors: it generates its own
    uint32_t *cpu_bits, *gpu_bits;
} Twins;

static void twins_begin(Twins *t, Terrain *terrain, unsigned fields) {
    t->terrain = terrain;
    assert_int_equal(diamond_model_create(terrain, fields, 1, t->jobs, &t->model), RESULT_OK);
    assert_int_equal(diamond_gpu_create(&t->model, INT64_C(1) << 31, gl_is_software(), true, &t->gpu), RESULT_OK);
    assert_false(diamond_gpu_has_errors(t->gpu));
    t->cpu_bits = malloc(sizeof(uint32_t) * t->model.layout.word_count);
    t->gpu_bits = malloc(sizeof(uint32_t) * t->model.layout.word_count);
    assert_true(t->cpu_bits && t->gpu_bits);
}

static void twins_end(Twins *t) {
    free(t->cpu_bits);
    free(t->gpu_bits);
    diamond_gpu_destroy(&t->gpu);
    diamond_model_destroy(&t->model);
    terrain_destroy(&t->terrain);
    geoid_close(&t->geoid);
    jobs_destroy(&t->jobs);
    assert_int_equal(gl_take_error(), GL_NO_ERROR);
}

static Twins twins_rough(int width, int height, unsigned fields) {
    Twins t = {0};
    assert_int_equal(jobs_create(2, &t.jobs), RESULT_OK);
    Dem *dem = support_rough_dem(width, height, &ROUGH, 900.0, SEED);
    twins_begin(&t, support_terrain(dem, TERRAIN_ERROR_TOTAL, 12, t.jobs), fields);
    return t;
}

// --- comparisons

static void check_errors(Twins *t, const char *what) {
    size_t entries = DIAMOND_SLOTS * (size_t)t->model.layout.word_count;
    float *errors = malloc(entries * sizeof *errors);
    assert_non_null(errors);
    assert_int_equal(diamond_generate_errors(&t->model, t->jobs, NULL), RESULT_OK);
    diamond_gpu_generate_errors(t->gpu, NULL);
    diamond_gpu_read_errors(t->gpu, errors);
    size_t different = 0, first = 0;
    for (size_t i = entries; i-- > 0;)
        if (memcmp(&errors[i], &t->model.error_m[i], sizeof *errors) != 0)
            different++, first = i;
    float gpu = errors[first], cpu = t->model.error_m[first];
    free(errors);
    if (different)
        fail_msg("%s: %zu of %zu errors differ, first entry %zu: GPU %.9g, CPU %.9g", what, different, entries, first,
                 (double)gpu, (double)cpu);
}

static void compare_bits(Twins *t, const char *what, const char *phase) {
    diamond_gpu_read_bits(t->gpu, t->gpu_bits);
    uint32_t different = 0, first = 0;
    for (uint32_t i = t->model.layout.word_count; i-- > 0;)
        if (t->gpu_bits[i] != t->cpu_bits[i])
            different++, first = i;
    if (different)
        fail_msg("%s, %s: %u of %u words differ, first %u: GPU %04x, CPU %04x", what, phase, different,
                 t->model.layout.word_count, first, t->gpu_bits[first], t->cpu_bits[first]);
}

// The smallest index first, the order round the triangle kept.
static void rotate_triangles(uint32_t *indices, size_t triangles) {
    for (size_t i = 0; i < triangles; i++) {
        uint32_t *t = &indices[3 * i], a = t[0], b = t[1], c = t[2];
        int least = a < b ? (a < c ? 0 : 2) : b < c ? 1 : 2;
        t[0] = least == 0 ? a : least == 1 ? b : c;
        t[1] = least == 0 ? b : least == 1 ? c : a;
        t[2] = least == 0 ? c : least == 1 ? a : b;
    }
}

static int order_triangles(const void *a, const void *b) {
    const uint32_t *p = a, *q = b;
    for (int i = 0; i < 3; i++)
        if (p[i] != q[i])
            return p[i] < q[i] ? -1 : 1;
    return 0;
}

static size_t check_triangles(Twins *t, const char *what) {
    DiamondIndices cpu = {0};
    assert_int_equal(diamond_generate_indices(&t->model, t->cpu_bits, t->jobs, &cpu), RESULT_OK);
    diamond_gpu_generate_indices(t->gpu);
    size_t triangles = cpu.count / 3;
    int64_t count = diamond_gpu_count_now(t->gpu);
    if (count != (int64_t)triangles)
        fail_msg("%s: GPU %" PRId64 " triangles, CPU %zu", what, count, triangles);
    uint32_t *gpu = malloc((triangles + 1) * 3 * sizeof *gpu);
    assert_non_null(gpu);
    diamond_gpu_read_indices(t->gpu, gpu, count);
    rotate_triangles(gpu, triangles);
    rotate_triangles(cpu.indices, triangles);
    qsort(gpu, triangles, 3 * sizeof *gpu, order_triangles);
    qsort(cpu.indices, triangles, 3 * sizeof *gpu, order_triangles);
    bool same = memcmp(gpu, cpu.indices, triangles * 3 * sizeof *gpu) == 0;
    free(gpu);
    diamond_indices_destroy(&cpu);
    if (!same)
        fail_msg("%s: the same number of triangles, %zu, but others", what, triangles);
    return triangles;
}

// --- views

static LodView view_of(const Terrain *terrain, double across, double down, double above_m, double tau_px) {
    const Dem *dem = terrain_dem(terrain);
    Vec3d eye = support_eye(terrain, across * (dem->width - 1), down * (dem->height - 1), above_m);
    return support_view(eye, tau_px);
}

static const DiamondLens LENS = {0.9, 0.6};

// What is split by both, before and after closure, and its triangles.
static size_t check_program(Twins *t, const DiamondProgram *program, const LodView *view, const char *what) {
    DiamondView seen = diamond_view(&t->model, view, view->tau_px, &LENS);
    diamond_evaluate(&t->model, program, &seen, t->jobs, t->cpu_bits);
    assert_int_equal(diamond_gpu_evaluate(t->gpu, program, &seen), RESULT_OK);
    compare_bits(t, what, "evaluation");
    int64_t chosen = diamond_count(&t->model, t->cpu_bits);
    diamond_close(&t->model, t->jobs, t->cpu_bits);
    diamond_gpu_close(t->gpu);
    compare_bits(t, what, "closure");
    size_t triangles = check_triangles(t, what);
    print_message("%s: %" PRId64 " split, %" PRId64 " closed, %zu triangles\n", what, chosen,
                  diamond_count(&t->model, t->cpu_bits), triangles);
    return triangles;
}

static void check_tolerances(Twins *t, const char *name) {
    DiamondProgram tolerance;
    diamond_select_bind(NULL, &t->model, &tolerance);
    const double taus[] = {30.0, 2.0, 0.3};
    size_t count = t->model.layout.width > 1000 ? 2 : 3; // sorting a million triangles takes its time
    for (size_t i = 0; i < count; i++) {
        char what[96];
        LodView view = view_of(t->terrain, 0.3, 0.6, 200.0 * (double)(i + 1), taus[i]);
        snprintf(what, sizeof what, "%s, tau %g", name, taus[i]);
        check_program(t, &tolerance, &view, what);
    }
}

// --- predicates. %1$g and %2$g: latitude and longitude of the middle

static const char *const PREDICATES[] = {
    "error > 5",
    "px > 1.5 && inview",
    "distance < 3km || level < 4",
    "height > 500m && step >= 4",
    "!(error < 2) || within(%1$.6f, %2$.6f, 2000)",
    "box(%2$.6f, %1$.6f, 180, 89) && error * 2 - 1 > tau + 0.5",
    "-error >= -3 && level <= 9",
    "tolerance || error * error > 400",
};

static void bind_predicate(const Twins *t, const char *form, DiamondProgram *out) {
    char text[160];
    DiamondSelect *select = NULL;
    snprintf(text, sizeof text, form, t->model.middle_lat_deg, t->model.middle_lon_deg);
    assert_int_equal(diamond_select_create(text, &LENS, &select), RESULT_OK);
    diamond_select_bind(select, &t->model, out);
    diamond_select_destroy(&select);
}

static void check_predicates(Twins *t, const char *name, bool used[DIAMOND_OP_COUNT]) {
    LodView view = view_of(t->terrain, 0.6, 0.7, 400.0, 1.5);
    for (size_t i = 0; i < COUNT_OF(PREDICATES); i++) {
        DiamondProgram program;
        char what[160];
        bind_predicate(t, PREDICATES[i], &program);
        snprintf(what, sizeof what, "%s, %s", name, PREDICATES[i]);
        check_program(t, &program, &view, what);
        for (int step = 0; step < program.step_count; step++)
            used[program.steps[step].op] = true;
    }
}

// --- tests

static void awkward_sizes_have_the_twins_bits(void **state) {
    (void)state;
    static const int SIZES[][2] = {{2, 2},   {3, 2},    {2, 9},    {5, 5},    {17, 17},
                                   {64, 65}, {33, 129}, {130, 67}, {327, 468}};
    for (size_t i = 0; i < COUNT_OF(SIZES); i++) {
        char what[64];
        snprintf(what, sizeof what, "%d x %d", SIZES[i][0], SIZES[i][1]);
        Twins t = twins_rough(SIZES[i][0], SIZES[i][1], 0);
        check_errors(&t, what);
        check_tolerances(&t, what);
        twins_end(&t);
    }
}

static void predicates_of_all_operations_have_the_twins_bits(void **state) {
    (void)state;
    bool used[DIAMOND_OP_COUNT] = {false};
    Twins t = twins_rough(150, 131, ALL_FIELDS);
    check_errors(&t, "rough");
    check_predicates(&t, "rough", used);
    twins_end(&t);
    for (int op = 0; op < DIAMOND_OP_COUNT; op++)
        if (!used[op])
            fail_msg("operation %d is in no predicate of this test", op);
}

static void ground_that_rounding_alone_bends_has_the_twins_bits(void **state) {
    (void)state;
    Twins t = {0};
    Dem *dem = NULL;
    assert_int_equal(jobs_create(2, &t.jobs), RESULT_OK);
    assert_int_equal(dem_create(66, 97, &ROUGH, DEM_DATUM_ELLIPSOID, &dem), RESULT_OK);
    for (int i = 0; i < 66 * 97; i++)
        dem->height_m[i] = 1234.5f + 0.1f * (float)(i % 66) - 0.7f * (float)(i / 66);
    twins_begin(&t, support_terrain(dem, TERRAIN_ERROR_TOTAL, 12, t.jobs), 0);
    check_errors(&t, "a tilted plane");
    check_tolerances(&t, "a tilted plane");
    twins_end(&t);
}

static void holes_have_the_twins_bits(void **state) {
    (void)state;
    Twins t = {0};
    uint64_t random = SEED;
    assert_int_equal(jobs_create(2, &t.jobs), RESULT_OK);
    Dem *dem = support_rough_dem(120, 83, &ROUGH, 700.0, SEED);
    dem->void_bits = calloc((120 * 83 + 7) / 8, 1);
    assert_non_null(dem->void_bits);
    for (int i = 0; i < 120 * 83; i++)
        if (support_random(&random) % 97 == 0 || (i % 120 > 60 && i % 120 < 80 && i / 120 > 20 && i / 120 < 33))
            dem->void_bits[i >> 3] = (uint8_t)(dem->void_bits[i >> 3] | 1 << (i & 7));
    twins_begin(&t, support_terrain(dem, TERRAIN_ERROR_TOTAL, 12, t.jobs), 0);
    check_errors(&t, "holes");
    check_tolerances(&t, "holes");
    twins_end(&t);
}

static void a_fully_split_start_has_the_twins_closure(void **state) {
    (void)state;
    Twins t = twins_rough(129, 75, 0);
    diamond_fill(&t.model, t.cpu_bits);
    diamond_gpu_fill(t.gpu, t.cpu_bits);
    diamond_close(&t.model, t.jobs, t.cpu_bits);
    diamond_gpu_close(t.gpu);
    compare_bits(&t, "129 x 75, all split", "closure");
    size_t triangles = check_triangles(&t, "129 x 75, all split");
    assert_int_equal(triangles, 2 * 128 * 74);
    twins_end(&t);
}

// One split bit anywhere needs ancestors up to the coarsest plane, across super-squares.
static void one_split_diamond_has_the_twins_closure(void **state) {
    (void)state;
    Twins t = twins_rough(97, 141, 0);
    uint64_t random = SEED;
    for (int round = 0; round < 60; round++) {
        int col = (int)(support_random(&random) % 97), row = (int)(support_random(&random) % 141);
        DiamondPlace place = diamond_place(&t.model.layout, col, row);
        memcpy(t.cpu_bits, t.model.always, sizeof(uint32_t) * t.model.layout.word_count);
        if (place.plane < t.model.layout.level_count)
            t.cpu_bits[place.word] |= UINT32_C(1) << place.bit;
        diamond_gpu_fill(t.gpu, t.cpu_bits);
        diamond_close(&t.model, t.jobs, t.cpu_bits);
        diamond_gpu_close(t.gpu);
        compare_bits(&t, "one split diamond", "closure");
        check_triangles(&t, "one split diamond");
    }
    twins_end(&t);
}

static void more_triangles_than_room_are_counted_and_left_out(void **state) {
    (void)state;
    enum { ROOM = 500 };
    uint32_t indices[3 * ROOM], all = 65 * 65;
    Twins t = twins_rough(65, 65, 0);
    diamond_gpu_destroy(&t.gpu);
    assert_int_equal(diamond_gpu_create(&t.model, ROOM, gl_is_software(), true, &t.gpu), RESULT_OK);
    assert_int_equal(diamond_gpu_triangles_max(t.gpu), ROOM);
    diamond_fill(&t.model, t.cpu_bits);
    diamond_gpu_fill(t.gpu, t.cpu_bits);
    diamond_gpu_generate_indices(t.gpu);
    assert_int_equal(diamond_gpu_count_now(t.gpu), 2 * 64 * 64);
    diamond_gpu_read_indices(t.gpu, indices, ROOM);
    for (int i = 0; i < 3 * ROOM; i += 3) {
        assert_true(indices[i] < all && indices[i + 1] < all && indices[i + 2] < all);
        assert_true(indices[i] != indices[i + 1] && indices[i] != indices[i + 2]); // all of the room is filled
    }
    twins_end(&t);
}

// Counts that arrive later are the ones of their own generation. Timed as on hardware, by queries.
static void counts_arrive_in_order_without_waiting(void **state) {
    (void)state;
    Twins t = twins_rough(65, 65, 0);
    diamond_gpu_destroy(&t.gpu);
    assert_int_equal(diamond_gpu_create(&t.model, INT64_C(1) << 31, false, false, &t.gpu), RESULT_OK);
    int64_t expected[9] = {0};
    uint64_t generation = 99, newest = 0;
    assert_int_equal(diamond_gpu_count_ready(t.gpu, &generation), -1);
    for (uint64_t round = 1; round <= 8; round++) {
        memset(t.cpu_bits, 0, sizeof(uint32_t) * t.model.layout.word_count);
        for (uint64_t i = 0; i < round; i++)
            t.cpu_bits[5 * i] = DIAMOND_EDGES | DIAMOND_CENTRES; // in the finest plane
        diamond_gpu_fill(t.gpu, t.cpu_bits);
        diamond_gpu_close(t.gpu);
        diamond_gpu_generate_indices(t.gpu);
        expected[round] = diamond_gpu_count_now(t.gpu);
        int64_t ready = diamond_gpu_count_ready(t.gpu, &generation);
        assert_true(generation >= newest && generation <= round);
        newest = generation;
        assert_int_equal(ready, newest ? expected[newest] : -1);
        assert_true(expected[round] > expected[round - 1]);
    }
    assert_true(newest > 0);
    for (int phase = 0; phase < DIAMOND_PHASE_COUNT; phase++)
        assert_true(diamond_gpu_ms(t.gpu, (DiamondPhase)phase) >= 0.0);
    twins_end(&t);
}

// --- real ground

static void check_real(const char *name, unsigned fields) {
    Twins t = {0};
    bool used[DIAMOND_OP_COUNT];
    assert_int_equal(jobs_create(2, &t.jobs), RESULT_OK);
    Terrain *terrain = support_shared_terrain(name, &t.geoid, t.jobs);
    if (!terrain) {
        jobs_destroy(&t.jobs);
        skip();
    }
    const char *why;
    assert_int_equal(diamond_gpu_check(terrain, &why), RESULT_OK);
    twins_begin(&t, terrain, fields);
    check_errors(&t, name);
    check_tolerances(&t, name);
    if (fields)
        check_predicates(&t, name, used);
    twins_end(&t);
}

static void mount_fuji_has_the_twins_bits(void **state) {
    (void)state;
    check_real("mt_fuji_srtm3_1201.tif", ALL_FIELDS);
}

static void puget_sound_has_the_twins_bits(void **state) {
    (void)state;
    check_real("puget_utm10_160m_1025.tif", 0);
}

static void maui_has_the_twins_bits(void **state) {
    (void)state;
    check_real("maui_utm4n_40m_2049.tif", 0);
}

static void the_tatra_have_the_twins_bits(void **state) {
    (void)state;
    check_real("tatra_srtm3_2401.tif", 0);
}

static void central_europe_has_the_twins_bits(void **state) {
    (void)state;
    check_real("ce_srtm3_4801.tif", 0);
}

static void maui_in_degrees_has_the_twins_bits(void **state) {
    (void)state;
    check_real("maui_srtm1_2049.tif", 0);
}

static void mount_washington_has_the_twins_bits(void **state) {
    (void)state;
    check_real("N44W072.hgt", ALL_FIELDS);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(awkward_sizes_have_the_twins_bits),
        cmocka_unit_test(predicates_of_all_operations_have_the_twins_bits),
        cmocka_unit_test(ground_that_rounding_alone_bends_has_the_twins_bits),
        cmocka_unit_test(holes_have_the_twins_bits),
        cmocka_unit_test(a_fully_split_start_has_the_twins_closure),
        cmocka_unit_test(one_split_diamond_has_the_twins_closure),
        cmocka_unit_test(more_triangles_than_room_are_counted_and_left_out),
        cmocka_unit_test(counts_arrive_in_order_without_waiting),
        cmocka_unit_test(mount_fuji_has_the_twins_bits),
        cmocka_unit_test(puget_sound_has_the_twins_bits),
        cmocka_unit_test(maui_has_the_twins_bits),
        cmocka_unit_test(the_tatra_have_the_twins_bits),
        cmocka_unit_test(central_europe_has_the_twins_bits),
        cmocka_unit_test(maui_in_degrees_has_the_twins_bits),
        cmocka_unit_test(mount_washington_has_the_twins_bits),
    };
    Context *context = NULL;
    if (!gl_support_begin(16, 16, &context))
        return GL_SKIP_STATUS;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    context_destroy(&context);
    return failed;
}
