// The phases of the diamond method, each against an oracle that knows nothing of super-squares: errors by a scan of all
// samples, closure by recursion, triangles by a walk over bintrees, and the hybrid method's cut.
#include "base/arena.h"
#include "terrain/diamond/diamond.h"
#include "terrain/diamond/diamond_rules.h"
#include "terrain/patches/refine.h"
#include "terrain/terrain_parts.h"
#include "tests/cut_support.h"
#include "tests/slow.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SEED UINT64_C(2011)

static const DemGeoref HILLS = {DEM_CRS_GEOGRAPHIC, 0, false, 19.0, 50.0, 1.0 / 1200, -1.0 / 1200};
static const DemGeoref METRES = {DEM_CRS_UTM, 33, true, 420000.0, 5400000.0, 30.0, -30.0};
static const DemGeoref GLOBE = {DEM_CRS_GEOGRAPHIC, 0, false, -179.0, 70.0, 0.5, -0.5};

static const struct {
    int width, height;
} SIZES[] = {{2, 2}, {3, 2}, {2, 37}, {5, 5}, {9, 4}, {65, 65}, {66, 67}, {131, 94}, {33, 129}, {100, 3}, {61, 63}};

typedef struct World {
    Jobs *jobs;
    Terrain *terrain;
    DiamondModel model;
    uint32_t *bits;
} World;

static World world_of(Dem *dem, int workers) {
    World w = {0};
    assert_int_equal(jobs_create(workers, &w.jobs), RESULT_OK);
    w.terrain = support_terrain(dem, TERRAIN_ERROR_TOTAL, 6, w.jobs);
    assert_int_equal(diamond_model_create(w.terrain, 0, 1, w.jobs, &w.model), RESULT_OK);
    assert_int_equal(diamond_generate_errors(&w.model, w.jobs, NULL), RESULT_OK);
    w.bits = calloc(w.model.layout.word_count, sizeof *w.bits);
    assert_non_null(w.bits);
    return w;
}

static World rough_world(int width, int height, const DemGeoref *georef, double relief_m, int workers) {
    return world_of(support_rough_dem(width, height, georef, relief_m, SEED), workers);
}

static void world_end(World *w) {
    free(w->bits);
    diamond_model_destroy(&w->model);
    terrain_destroy(&w->terrain);
    jobs_destroy(&w->jobs);
}

// ---- diamonds, by the definition in the papers ----

typedef struct Point {
    int col, row;
} Point;

typedef struct Diamond {
    Point ends[2], parents[2];
} Diamond;

static int step_of(int col, int row) {
    int s = 1;
    while ((col | row) && (col | row) % (2 * s) == 0)
        s *= 2;
    return s;
}

static Diamond diamond_of(int col, int row) {
    int s = step_of(col, row);
    if (col / s % 2 && row / s % 2) {
        int rise = (col / (2 * s) + row / (2 * s)) % 2 ? -s : s;
        return (Diamond){{{col - s, row - rise}, {col + s, row + rise}},
                         {{col - s, row + rise}, {col + s, row - rise}}};
    }
    int dx = col / s % 2 ? s : 0, dy = s - dx;
    return (Diamond){{{col - dx, row - dy}, {col + dx, row + dy}}, {{col - dy, row - dx}, {col + dy, row + dx}}};
}

static bool inside(const World *w, Point p) {
    return p.col >= 0 && p.row >= 0 && p.col < w->model.layout.width && p.row < w->model.layout.height;
}

static bool is_diamond(const World *w, Point p) {
    return (p.col | p.row) && inside(w, p) && step_of(p.col, p.row) < 1 << w->model.layout.level_count;
}

static bool get_bit(const World *w, const uint32_t *bits, Point p) {
    if (!is_diamond(w, p))
        return inside(w, p); // always split
    DiamondPlace place = diamond_place(&w->model.layout, p.col, p.row);
    return bits[place.word] >> place.bit & 1;
}

static void set_bit(const World *w, uint32_t *bits, Point p) {
    DiamondPlace place = diamond_place(&w->model.layout, p.col, p.row);
    bits[place.word] |= UINT32_C(1) << place.bit;
}

static size_t entry_of(const World *w, Point p) {
    DiamondPlace place = diamond_place(&w->model.layout, p.col, p.row);
    for (int slot = 0; slot < DIAMOND_SLOTS; slot++)
        if (diamond_slot_bit(slot) == place.bit)
            return diamond_entry(&w->model.layout, slot, place.word);
    fail_msg("(%d, %d) has no slot", p.col, p.row);
    return 0;
}

static void test_every_sample_has_its_own_bit(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT_OF(SIZES); i++) {
        World w = rough_world(SIZES[i].width, SIZES[i].height, &HILLS, 500.0, 1);
        int64_t diamonds = 0;
        for (int row = 0; row < SIZES[i].height; row++)
            for (int col = 0; col < SIZES[i].width; col++) {
                Point p = {col, row};
                if (!is_diamond(&w, p))
                    continue;
                assert_false(get_bit(&w, w.bits, p)); // set by no other
                set_bit(&w, w.bits, p);
                diamonds++;
            }
        assert_memory_equal(w.bits, w.model.valid, sizeof *w.bits * w.model.layout.word_count);
        assert_int_equal(diamond_count(&w.model, w.bits), diamonds);
        world_end(&w);
    }
}

// ---- errors ----

static double doubled_area(Point a, Point b, Point c) {
    return (double)(b.col - a.col) * (c.row - a.row) - (double)(b.row - a.row) * (c.col - a.col);
}

static double height_of(const World *w, Point p) {
    return (double)w->model.height_m[(size_t)p.row * (size_t)w->model.layout.width + (size_t)p.col];
}

static Vec3d exact_position(const World *w, Point p) {
    return grid_ecef(w->terrain->grid, p.col, p.row, height_of(w, p));
}

typedef struct Deviation {
    double height_m, distance_m; // from the plane of heights; |P - Q|
} Deviation;

static void scan_triangle(const World *w, Point a, Point b, Point c, Deviation *most) {
    Vec3d pa = exact_position(w, a), pb = exact_position(w, b), pc = exact_position(w, c);
    double area = doubled_area(a, b, c);
    int west = (int)fmin(a.col, fmin(b.col, c.col)), east = (int)fmax(a.col, fmax(b.col, c.col));
    int north = (int)fmin(a.row, fmin(b.row, c.row)), south = (int)fmax(a.row, fmax(b.row, c.row));
    for (int row = north; row <= south; row++) {
        for (int col = west; col <= east; col++) {
            Point p = {col, row};
            double u = doubled_area(p, b, c) / area, v = doubled_area(a, p, c) / area, t = 1.0 - u - v;
            if (u < -1e-12 || v < -1e-12 || t < -1e-12)
                continue;
            double h = u * height_of(w, a) + v * height_of(w, b) + t * height_of(w, c);
            Vec3d q = vec3d_add(vec3d_add(vec3d_scale(pa, u), vec3d_scale(pb, v)), vec3d_scale(pc, t));
            most->height_m = fmax(most->height_m, fabs(height_of(w, p) - h));
            most->distance_m = fmax(most->distance_m, vec3d_distance(exact_position(w, p), q));
        }
    }
}

static double range_of(const World *w, const Diamond *d) {
    double low = INFINITY, high = -INFINITY;
    for (int i = 0; i < 4; i++) {
        Point p = i < 2 ? d->ends[i] : d->parents[i - 2];
        if (inside(w, p)) {
            low = fmin(low, height_of(w, p));
            high = fmax(high, height_of(w, p));
        }
    }
    return high - low;
}

static void check_error(const World *w, Point p, const char *name, double *least_room) {
    int s = step_of(p.col, p.row), plane = __builtin_ctz((unsigned)s);
    bool centre = p.col / s % 2 && p.row / s % 2;
    double error = (double)w->model.error_m[entry_of(w, p)];
    if (get_bit(w, w->model.always, p)) {
        assert_true(isinf(error));
        return;
    }
    Diamond d = diamond_of(p.col, p.row);
    Deviation most = {0.0, 0.0};
    for (int i = 0; i < 2; i++)
        if (inside(w, d.parents[i]))
            scan_triangle(w, d.ends[0], d.ends[1], d.parents[i], &most);
    const DiamondTerms *t = &w->model.terms[w->model.layout.row_offset[plane] + (uint32_t)(p.row / s)];
    double drift = (double)(centre ? t->centre_drift : t->edge_drift);
    double expected = most.height_m + range_of(w, &d) * drift + (double)(centre ? t->centre_sag_m : t->edge_sag_m);
    if (fabs(error - expected) > 1e-3 + 1e-6 * expected)
        fail_msg("%s: (%d, %d): error %.9g m, a scan in double gives %.9g", name, p.col, p.row, error, expected);
    if (error < most.distance_m)
        fail_msg("%s: (%d, %d): error %.9g m, a sample is off by %.9g", name, p.col, p.row, error, most.distance_m);
    *least_room = fmin(*least_room, error - most.distance_m);
}

static void check_errors(int width, int height, const DemGeoref *georef, double relief_m, const char *name) {
    World w = rough_world(width, height, georef, relief_m, 2);
    double least_room = INFINITY;
    for (int row = 0; row < height; row++)
        for (int col = 0; col < width; col++)
            if (is_diamond(&w, (Point){col, row}))
                check_error(&w, (Point){col, row}, name, &least_room);
    print_message("%s: at least %.3g m to spare\n", name, least_room);
    world_end(&w);
}

static void test_errors_are_those_of_a_scan_and_bound_every_sample(void **state) {
    (void)state;
    check_errors(193, 161, &HILLS, 1800.0, "hills");
    check_errors(129, 130, &METRES, 900.0, "UTM");
    check_errors(97, 65, &GLOBE, 6000.0, "globe");
    check_errors(65, 65, &HILLS, 0.0, "flat, curved by the Earth");
    for (size_t i = 0; i < COUNT_OF(SIZES); i++)
        check_errors(SIZES[i].width, SIZES[i].height, &METRES, 300.0, "an awkward size");
}

// ---- what is random ----

// One vertex in `rarity`, with all that is always split.
static void set_random(const World *w, uint64_t *random, uint64_t rarity) {
    memcpy(w->bits, w->model.always, sizeof *w->bits * w->model.layout.word_count);
    for (int row = 0; row < w->model.layout.height; row++)
        for (int col = 0; col < w->model.layout.width; col++)
            if (is_diamond(w, (Point){col, row}) && support_random(random) % rarity == 0)
                set_bit(w, w->bits, (Point){col, row});
}

// Kinds of patterns: sparser and sparser noise, a checkerboard, one vertex.
#define PATTERNS 6
static void set_pattern(const World *w, int kind, uint64_t *random) {
    static const uint64_t rarities[] = {2, 7, 40, 1000};
    int width = w->model.layout.width, height = w->model.layout.height;
    set_random(w, random, kind < 4 ? rarities[kind] : UINT64_MAX);
    for (int row = 0; row < height && kind == 4; row++)
        for (int col = (row + 1) % 2; col < width; col += 2)
            if (is_diamond(w, (Point){col, row}))
                set_bit(w, w->bits, (Point){col, row});
    Point one = {(int)(support_random(random) % (uint64_t)width), (int)(support_random(random) % (uint64_t)height)};
    if (kind == 5 && is_diamond(w, one))
        set_bit(w, w->bits, one);
}

// ---- closure ----

static void split(const World *w, uint32_t *bits, Point p) {
    if (!is_diamond(w, p) || get_bit(w, bits, p))
        return;
    set_bit(w, bits, p);
    Diamond d = diamond_of(p.col, p.row);
    split(w, bits, d.parents[0]);
    split(w, bits, d.parents[1]);
}

static void check_closure(World *w, const char *what) {
    size_t bytes = sizeof *w->bits * w->model.layout.word_count;
    uint32_t *expected = calloc(w->model.layout.word_count, sizeof *expected);
    assert_non_null(expected);
    for (int row = 0; row < w->model.layout.height; row++)
        for (int col = 0; col < w->model.layout.width; col++)
            if (is_diamond(w, (Point){col, row}) && get_bit(w, w->bits, (Point){col, row}))
                split(w, expected, (Point){col, row});
    diamond_close(&w->model, w->jobs, w->bits);
    int64_t found = diamond_count(&w->model, w->bits), wanted = diamond_count(&w->model, expected);
    if (memcmp(w->bits, expected, bytes) != 0)
        fail_msg("%s: %" PRId64 " split, recursion splits %" PRId64, what, found, wanted);
    free(expected);
}

// ---- triangles: a walk over the forest's bintrees ----

typedef struct Triangle {
    uint32_t corner[3]; // sorted
} Triangle;

typedef struct Triangles {
    Triangle *list;
    size_t count, capacity;
} Triangles;

static int compare_triangles(const void *a, const void *b) {
    return memcmp(a, b, sizeof(Triangle)); // any order will do, if it is one
}

static void add_triangle(Triangles *t, uint32_t a, uint32_t b, uint32_t c) {
    if (t->count == t->capacity) {
        t->capacity = 2 * t->capacity + 1024;
        t->list = realloc(t->list, t->capacity * sizeof *t->list);
        assert_non_null(t->list);
    }
    uint32_t low = a < b ? a : b, high = a < b ? b : a;
    t->list[t->count++] = c < low    ? (Triangle){{c, low, high}}
                          : c > high ? (Triangle){{low, high, c}}
                                     : (Triangle){{low, c, high}};
}

static uint32_t sample_of(const World *w, PatchCorner c) {
    return (uint32_t)(c.row * w->model.layout.width + c.col);
}

static void walk(const World *w, const PatchTriangle *t, int cells, Triangles *out) {
    PatchCorner middle = patch_triangle_middle(t);
    // Half of a cell: the hypotenuse's middle is no sample.
    if (cells > 0 && get_bit(w, w->bits, (Point){middle.col, middle.row})) {
        PatchTriangle first = patch_triangle_half(t, middle, 0), second = patch_triangle_half(t, middle, 1);
        walk(w, &first, cells - 1, out);
        walk(w, &second, cells - 1, out);
        return;
    }
    add_triangle(out, sample_of(w, t->left), sample_of(w, t->right), sample_of(w, t->apex));
}

static Triangles triangles_of_forest(const World *w) {
    Triangles out = {0};
    for (int32_t i = 0; i < w->terrain->forest.tile_count; i++) {
        const ForestTile *tile = &w->terrain->forest.tiles[i];
        for (int root = 0; root < 2; root++) {
            PatchTriangle t = patch_forest_root(tile, root);
            walk(w, &t, 2 * __builtin_ctz((unsigned)tile->side), &out);
        }
    }
    qsort(out.list, out.count, sizeof *out.list, compare_triangles);
    return out;
}

static Triangles triangles_of_indices(const World *w, const DiamondIndices *indices) {
    Triangles out = {0};
    int width = w->model.layout.width;
    for (size_t i = 0; i < indices->count; i += 3) {
        const uint32_t *c = indices->indices + i;
        Point p[3];
        for (int k = 0; k < 3; k++)
            p[k] = (Point){(int)(c[k] % (uint32_t)width), (int)(c[k] / (uint32_t)width)};
        if (!(doubled_area(p[0], p[1], p[2]) < 0.0)) // rows run south
            fail_msg("triangle (%d, %d) (%d, %d) (%d, %d) is not counter-clockwise", p[0].col, p[0].row, p[1].col,
                     p[1].row, p[2].col, p[2].row);
        add_triangle(&out, c[0], c[1], c[2]);
    }
    qsort(out.list, out.count, sizeof *out.list, compare_triangles);
    return out;
}

static void expect_same(const Triangles *found, const Triangles *expected, const char *what) {
    if (found->count != expected->count ||
        (found->count && memcmp(found->list, expected->list, found->count * sizeof *found->list) != 0))
        fail_msg("%s: %zu triangles, %zu expected, or others", what, found->count, expected->count);
}

static void check_triangles(World *w, const char *what) {
    DiamondIndices indices = {0};
    assert_int_equal(diamond_generate_indices(&w->model, w->bits, w->jobs, &indices), RESULT_OK);
    Triangles found = triangles_of_indices(w, &indices), expected = triangles_of_forest(w);
    expect_same(&found, &expected, what);
    free(found.list);
    free(expected.list);
    diamond_indices_destroy(&indices);
}

static void test_any_split_bits_close_as_recursion_does_and_give_the_bintrees_triangles(void **state) {
    (void)state;
    uint64_t random = SEED;
    for (size_t i = 0; i < COUNT_OF(SIZES); i++) {
        World w = rough_world(SIZES[i].width, SIZES[i].height, &METRES, 200.0, 2);
        for (int kind = 0; kind < PATTERNS; kind++) {
            char what[64];
            snprintf(what, sizeof what, "%d x %d, pattern %d", SIZES[i].width, SIZES[i].height, kind);
            set_pattern(&w, kind, &random);
            check_closure(&w, what);
            check_triangles(&w, what);
        }
        world_end(&w);
    }
}

static void test_a_large_terrain_closes_as_recursion_does(void **state) {
    SKIP_WHERE_THREADS_ARE_WATCHED();
    (void)state;
    uint64_t random = SEED;
    World w = rough_world(700, 519, &HILLS, 900.0, 3); // several chunks of rows
    for (int kind = 1; kind < PATTERNS; kind++) {
        set_pattern(&w, kind, &random);
        check_closure(&w, "700 x 519");
        check_triangles(&w, "700 x 519");
    }
    diamond_fill(&w.model, w.bits);
    check_closure(&w, "fully split");
    check_triangles(&w, "fully split");
    world_end(&w);
}

static void test_holes_are_split_all_around(void **state) {
    (void)state;
    uint64_t random = SEED;
    Dem *dem = support_rough_dem(83, 70, &HILLS, 900.0, SEED);
    dem->void_bits = calloc((83 * 70 + 7) / 8, 1);
    assert_non_null(dem->void_bits);
    for (int i = 0; i < 40; i++) {
        uint64_t at = support_random(&random) % (83 * 70);
        dem->void_bits[at >> 3] |= (uint8_t)(1u << (at & 7));
    }
    World w = world_of(dem, 2);
    for (int kind = 0; kind < PATTERNS; kind++) {
        set_pattern(&w, kind, &random);
        check_closure(&w, "holes");
        check_triangles(&w, "holes");
    }
    for (int i = 0; i < 83 * 70; i++)
        if (dem->void_bits[i >> 3] >> (i & 7) & 1)
            assert_true(get_bit(&w, w.bits, (Point){i % 83, i / 83}));
    world_end(&w);
}

// ---- the hybrid method's cut, from nested errors ----

static void set_nested(const World *w, const RefineView *view) {
    memcpy(w->bits, w->model.always, sizeof *w->bits * w->model.layout.word_count);
    for (int row = 0; row < w->model.layout.height; row++)
        for (int col = 0; col < w->model.layout.width; col++) {
            Point p = {col, row};
            if (!is_diamond(w, p))
                continue;
            ErrorCodes codes = error_field_at(&w->terrain->errors, col, row);
            GridPoint at = grid_lattice(w->terrain->grid, col, row, height_of(w, p));
            if (refine_is_active(view, grid_point_ecef(at), error_field_decode(codes.delta),
                                 error_field_decode(codes.radius)))
                set_bit(w, w->bits, p);
        }
}

static Triangles triangles_of_cut(const World *w, const LodCut *cut) {
    Triangles out = {0};
    for (int32_t i = 0; i < cut->item_count; i++) {
        const LodItem *item = &cut->items[i];
        uint32_t sample[3];
        for (int32_t k = 0; k < item->index_count; k++) {
            const LodVertex *v = &item->page->vertices[item->indices[k]];
            sample[k % 3] = sample_of(w, (PatchCorner){item->page->col0 + v->col, item->page->row0 + v->row});
            if (k % 3 == 2)
                add_triangle(&out, sample[0], sample[1], sample[2]);
        }
    }
    qsort(out.list, out.count, sizeof *out.list, compare_triangles);
    return out;
}

static void check_hybrid(World *w, const LodView *view) {
    LodOptions options = lod_default_options();
    Lod *lod;
    Arena *frame;
    LodCut cut;
    assert_int_equal(lod_create(&options, w->terrain, &lod), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &frame), RESULT_OK);
    assert_int_equal(lod_update(lod, view, w->jobs, frame, &cut), RESULT_OK);
    RefineView refine = refine_view(view, view->tau_px);
    set_nested(w, &refine);
    int64_t before = diamond_count(&w->model, w->bits);
    diamond_close(&w->model, w->jobs, w->bits);
    assert_int_equal(diamond_count(&w->model, w->bits), before); // nested errors are closed as they are
    DiamondIndices indices = {0};
    assert_int_equal(diamond_generate_indices(&w->model, w->bits, w->jobs, &indices), RESULT_OK);
    Triangles found = triangles_of_indices(w, &indices), expected = triangles_of_cut(w, &cut);
    expect_same(&found, &expected, "the hybrid method's cut");
    free(found.list);
    free(expected.list);
    diamond_indices_destroy(&indices);
    lod_destroy(&lod);
    arena_destroy(&frame);
}

static void test_nested_errors_give_the_hybrid_methods_triangles(void **state) {
    SKIP_WHERE_THREADS_ARE_WATCHED();
    (void)state;
    World w = rough_world(300, 233, &HILLS, 1200.0, 2);
    static const double taus[] = {0.4, 1.0, 6.0};
    for (size_t i = 0; i < COUNT_OF(taus); i++) {
        LodView view = support_view(support_eye(w.terrain, 70.0 + 60.0 * (double)i, 100.0, 400.0), taus[i]);
        check_hybrid(&w, &view);
    }
    world_end(&w);
}

// ---- evaluation ----

static LodView random_view(const World *w, uint64_t *random) {
    double col = support_between(random, -0.3, 1.3) * w->model.layout.width;
    double row = support_between(random, -0.3, 1.3) * w->model.layout.height;
    double above = pow(10.0, support_between(random, -1.0, 5.0)) * (support_random(random) % 8 ? 1.0 : -1.0);
    return support_view(support_eye(w->terrain, col, row, above), pow(10.0, support_between(random, -1.0, 1.5)));
}

// In double, from the exact positions: what is not split is far enough for its error.
static void check_tolerance(const World *w, const LodView *view) {
    double nu = view->px_per_rad / view->tau_px;
    for (int row = 0; row < w->model.layout.height; row++)
        for (int col = 0; col < w->model.layout.width; col++) {
            Point p = {col, row};
            if (!is_diamond(w, p) || get_bit(w, w->bits, p))
                continue;
            Diamond d = diamond_of(col, row);
            double error = (double)w->model.error_m[entry_of(w, p)], reach = 0.0;
            for (int i = 0; i < 4; i++) {
                Point corner = i < 2 ? d.ends[i] : d.parents[i - 2];
                if (inside(w, corner))
                    reach = fmax(reach, vec3d_distance(exact_position(w, p), exact_position(w, corner)));
            }
            double needed = nu * error + reach + error, distance = vec3d_distance(exact_position(w, p), view->eye_ecef);
            if (distance < needed)
                fail_msg("(%d, %d) is not split: %.9g m away, should be %.9g", col, row, distance, needed);
        }
}

static void test_what_is_not_split_keeps_the_tolerance(void **state) {
    SKIP_WHERE_THREADS_ARE_WATCHED();
    (void)state;
    uint64_t random = SEED;
    World w = rough_world(230, 163, &METRES, 900.0, 2);
    DiamondProgram program;
    diamond_select_bind(NULL, &w.model, &program);
    for (int i = 0; i < 12; i++) {
        LodView view = random_view(&w, &random);
        DiamondView seen = diamond_view(&w.model, &view, view.tau_px, NULL);
        diamond_evaluate(&w.model, &program, &seen, w.jobs, w.bits);
        check_tolerance(&w, &view);
    }
    world_end(&w);
}

static void test_runs_that_are_skipped_have_nothing_to_split(void **state) {
    SKIP_WHERE_THREADS_ARE_WATCHED();
    (void)state;
    uint64_t random = SEED;
    World w = rough_world(700, 519, &HILLS, 900.0, 2);
    DiamondProgram program;
    diamond_select_bind(NULL, &w.model, &program);
    size_t bytes = sizeof *w.bits * w.model.layout.word_count;
    uint32_t *all = malloc(bytes);
    assert_non_null(all);
    for (int i = 0; i < 40; i++) {
        LodView view = random_view(&w, &random);
        DiamondView seen = diamond_view(&w.model, &view, view.tau_px, NULL);
        DiamondModel bare = w.model;
        bare.runs = NULL;
        diamond_evaluate(&w.model, &program, &seen, w.jobs, w.bits);
        diamond_evaluate(&bare, &program, &seen, w.jobs, all);
        if (memcmp(all, w.bits, bytes) != 0)
            fail_msg("view %d: %" PRId64 " split, asking all %" PRId64, i, diamond_count(&w.model, w.bits),
                     diamond_count(&w.model, all));
    }
    free(all);
    world_end(&w);
}

// ---- any number of workers ----

static uint64_t hash_bytes(uint64_t hash, const void *bytes, size_t count) {
    const unsigned char *b = bytes;
    for (size_t i = 0; i < count; i++)
        hash = (hash ^ b[i]) * UINT64_C(0x100000001b3); // FNV-1a
    return hash;
}

static uint64_t hash_of_phases(int workers) {
    World w = rough_world(301, 233, &HILLS, 1500.0, workers);
    DiamondIndices indices = {0};
    DiamondProgram program;
    size_t words = w.model.layout.word_count;
    LodView view = support_view(support_eye(w.terrain, 100.0, 90.0, 300.0), 1.0);
    DiamondView seen = diamond_view(&w.model, &view, view.tau_px, NULL);
    diamond_select_bind(NULL, &w.model, &program);
    diamond_evaluate(&w.model, &program, &seen, w.jobs, w.bits);
    uint64_t hash = hash_bytes(UINT64_C(0xcbf29ce484222325), w.model.error_m, sizeof(float) * DIAMOND_SLOTS * words);
    hash = hash_bytes(hash, w.model.reach_m, sizeof(float) * 2 * words);
    hash = hash_bytes(hash, w.bits, sizeof *w.bits * words);
    diamond_close(&w.model, w.jobs, w.bits);
    assert_int_equal(diamond_generate_indices(&w.model, w.bits, w.jobs, &indices), RESULT_OK);
    hash = hash_bytes(hash, w.bits, sizeof *w.bits * words);
    hash = hash_bytes(hash, indices.indices, sizeof *indices.indices * indices.count);
    diamond_indices_destroy(&indices);
    world_end(&w);
    return hash;
}

static void test_every_phase_gives_the_same_bytes_for_any_number_of_workers(void **state) {
    (void)state;
    static const int counts[] = {2, 3, 8};
    uint64_t one = hash_of_phases(1);
    for (size_t i = 0; i < COUNT_OF(counts); i++) {
        uint64_t hash = hash_of_phases(counts[i]);
        if (hash != one)
            fail_msg("%d workers: %016" PRIx64 ", one %016" PRIx64, counts[i], hash, one);
    }
}

// ---- as a method ----

typedef struct Flight {
    World w;
    Lod *lod;
    Arena *frame;
    LodCut cut;
} Flight;

static Flight flight_begin(bool resident) {
    Flight f = {.w = rough_world(301, 233, &HILLS, 900.0, 2)};
    LodOptions options = lod_default_options();
    options.method = LOD_DIAMOND;
    options.resident = resident;
    options.serial = 5;
    assert_int_equal(lod_create(&options, f.w.terrain, &f.lod), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &f.frame), RESULT_OK);
    return f;
}

static void flight_end(Flight *f) {
    lod_destroy(&f->lod);
    arena_destroy(&f->frame);
    world_end(&f->w);
}

static void fly(Flight *f, double col) {
    LodView view = support_view(support_eye(f->w.terrain, col, 100.0, 200.0), 1.0);
    if (f->cut.frame)
        lod_release(f->lod, f->cut.frame);
    arena_reset(f->frame);
    assert_int_equal(lod_update(f->lod, &view, f->w.jobs, f->frame, &f->cut), RESULT_OK);
}

static void test_squares_whose_bits_stay_keep_their_lists(void **state) {
    (void)state;
    Flight f = flight_begin(false);
    fly(&f, 80.0);
    assert_int_equal(f.cut.stats.patches_reused, 0);
    fly(&f, 80.0); // nothing moved
    assert_int_equal(f.cut.stats.patches_reused, f.cut.item_count);
    assert_int_equal(f.cut.stats.index_bytes, 0);
    fly(&f, 80.4); // a little did
    assert_in_range(f.cut.stats.patches_reused, 1, f.cut.item_count - 1);
    assert_true(f.cut.stats.triangles_rebuilt < f.cut.stats.triangles);
    flight_end(&f);
}

static void test_a_resident_cut_is_an_order_for_the_same_bits(void **state) {
    (void)state;
    Flight cpu = flight_begin(false), gpu = flight_begin(true);
    fly(&cpu, 80.0);
    fly(&gpu, 80.0);
    assert_int_equal(gpu.cut.item_count, 0);
    assert_true(gpu.cut.promises);
    assert_non_null(gpu.cut.resident);
    const DiamondOrder *order = gpu.cut.resident;
    assert_null(order->model->error_m); // the renderer's to generate
    assert_int_equal(order->model->id >> 40, 5);
    DiamondModel model = *order->model;
    assert_int_equal(diamond_generate_errors(&model, gpu.w.jobs, NULL), RESULT_OK);
    diamond_evaluate(&model, order->program, &order->view, gpu.w.jobs, gpu.w.bits);
    assert_int_equal(diamond_count(&model, gpu.w.bits), cpu.cut.stats.chosen);
    diamond_close(&model, gpu.w.jobs, gpu.w.bits);
    assert_int_equal(diamond_count(&model, gpu.w.bits), cpu.cut.stats.closed);
    free(model.error_m);
    free(model.runs);
    flight_end(&cpu);
    flight_end(&gpu);
}

// ---- arithmetic ----

static void test_roots_and_reciprocals_are_within_a_millionth(void **state) {
    (void)state;
    uint64_t random = SEED;
    for (int i = 0; i < 200000; i++) {
        float x = (float)exp(support_between(&random, -30.0, 60.0));
        double root = (double)diamond_root(x), reciprocal = (double)diamond_reciprocal(x);
        if (fabs(root / sqrt((double)x) - 1.0) > 1e-6 || fabs(reciprocal * (double)x - 1.0) > 1e-6)
            fail_msg("%.9g: root %.9g, reciprocal %.9g", (double)x, root, reciprocal);
    }
    assert_true(diamond_root(0.0f) == 0.0f);
    assert_true(isfinite(diamond_root(INFINITY)));
}

// px is what a sample's error can take at most, and as much as tau where the tolerance begins to hold.
static void test_px_and_tolerance_agree(void **state) {
    (void)state;
    uint64_t random = SEED;
    for (int i = 0; i < 200000; i++) {
        float error = (float)pow(10.0, support_between(&random, -3.0, 3.0));
        float reach = (float)pow(10.0, support_between(&random, 0.0, 4.0));
        float distance = (float)pow(10.0, support_between(&random, 0.0, 6.0)), tau = 1.5f, lambda = 700.0f;
        float px = diamond_px(error, reach, distance * distance, lambda, 0.1f);
        double gap = (double)distance - (double)reach - (double)error - 0.1;
        double exact = gap > 0.0 ? (double)lambda * (double)error / gap : HUGE_VAL;
        bool splits = diamond_tolerance(error, reach, distance * distance, lambda / tau, 0.1f);
        if (exact <= 1e20 && (double)px < exact)
            fail_msg("%.9g px, in double %.9g", (double)px, exact);
        if (exact > (double)tau && !splits)
            fail_msg("%.9g px of %.9g, and not split", exact, (double)tau);
        if (splits && !(px > tau * 0.999f))
            fail_msg("split at %.9g px of %.9g", (double)px, (double)tau);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_sample_has_its_own_bit),
        cmocka_unit_test(test_errors_are_those_of_a_scan_and_bound_every_sample),
        cmocka_unit_test(test_any_split_bits_close_as_recursion_does_and_give_the_bintrees_triangles),
        cmocka_unit_test(test_a_large_terrain_closes_as_recursion_does),
        cmocka_unit_test(test_holes_are_split_all_around),
        cmocka_unit_test(test_nested_errors_give_the_hybrid_methods_triangles),
        cmocka_unit_test(test_what_is_not_split_keeps_the_tolerance),
        cmocka_unit_test(test_runs_that_are_skipped_have_nothing_to_split),
        cmocka_unit_test(test_every_phase_gives_the_same_bytes_for_any_number_of_workers),
        cmocka_unit_test(test_squares_whose_bits_stay_keep_their_lists),
        cmocka_unit_test(test_a_resident_cut_is_an_order_for_the_same_bits),
        cmocka_unit_test(test_roots_and_reciprocals_are_within_a_millionth),
        cmocka_unit_test(test_px_and_tolerance_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
