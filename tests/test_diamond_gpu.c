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
    diamond_close(&t->model, t->jobs, t->cpu_bits);
    diamond_gpu_close(t->gpu);
    compare_bits(t, what, "closure");
    return check_triangles(t, what);
}

static void check_tolerances(Twins *t, const char *what) {
    DiamondProgram tolerance;
    diamond_select_bind(NULL, &t->model, &tolerance);
    const double taus[] = {0.3, 2.0, 30.0};
    for (size_t i = 0; i < COUNT_OF(taus); i++) {
        LodView view = view_of(t->terrain, 0.3, 0.6, 200.0 * (double)(i + 1), taus[i]);
        size_t triangles = check_program(t, &tolerance, &view, what);
        print_message("%s, tau %g: %zu triangles\n", what, taus[i], triangles);
    }
}

// --- tests

static void awkward_sizes_have_the_twins_bits(void **state) {
    (void)state;
    static const int SIZES[][2] = {{2, 2}, {3, 2}, {2, 9}, {5, 5}, {17, 17}, {64, 65}, {33, 129}, {130, 67}, {97, 300}};
    for (size_t i = 0; i < COUNT_OF(SIZES); i++) {
        char what[64];
        snprintf(what, sizeof what, "%d x %d", SIZES[i][0], SIZES[i][1]);
        Twins t = twins_rough(SIZES[i][0], SIZES[i][1], 0);
        check_errors(&t, what);
        check_tolerances(&t, what);
        twins_end(&t);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(awkward_sizes_have_the_twins_bits),
    };
    Context *context = NULL;
    if (!gl_support_begin(16, 16, &context))
        return GL_SKIP_STATUS;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    context_destroy(&context);
    return failed;
}
