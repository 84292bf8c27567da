// Selections: what people may write, what they are told when they may not, what each word selects, and that any of them
// gives a whole mesh.
#include "base/arena.h"
#include "base/log.h"
#include "terrain/diamond/diamond.h"
#include "terrain/diamond/diamond_rules.h"
#include "terrain/geodesy.h"
#include "terrain/terrain_parts.h"
#include "tests/cut_support.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SEED UINT64_C(36842)

static const DemGeoref HILLS = {DEM_CRS_GEOGRAPHIC, 0, false, 19.0, 50.0, 1.0 / 1200, -1.0 / 1200};
static const DemGeoref METRES = {DEM_CRS_UTM, 33, true, 420000.0, 5400000.0, 30.0, -30.0};
static const DemGeoref DATE_LINE = {DEM_CRS_GEOGRAPHIC, 0, false, 179.9, -16.0, 1.0 / 1200, -1.0 / 1200};
static const DiamondLens LENS = {0.9, 0.6};

typedef struct Heard {
    int errors;
    char text[8192];
} Heard;

static void hear(void *user, LogLevel level, const char *message) {
    Heard *heard = user;
    heard->errors += level == LOG_ERROR;
    snprintf(heard->text, sizeof heard->text, "%s", message);
}

static DiamondSelect *select_of(const char *text) {
    DiamondSelect *select = NULL;
    assert_int_equal(diamond_select_create(text, &LENS, &select), RESULT_OK);
    return select;
}

// ---- what may be written ----

static void test_what_may_be_written(void **state) {
    (void)state;
    static const struct {
        const char *text;
        bool promises;
    } cases[] = {{"tolerance", true},
                 {"((tolerance))", true},
                 {"tolerance || error > 5", true},
                 {"error > 5 || (level < 3 || tolerance)", true},
                 {"tolerance && tolerance", true},
                 {"(tolerance || inview) && (tolerance || step < 4)", true},
                 {"tolerance && inview", false},
                 {"!tolerance", false},
                 {"!!tolerance", false},
                 {"px > tau", false},
                 {"error > 5 || within(36.6, -84.2, 2000)", false},
                 {"error>5||within(36.6,-84.2,2km)", false},
                 {"error >= 5ft", false},
                 {"distance < 1.5e3", false},
                 {"distance<.5mi", false},
                 {"height > -10 && height < 1000ft", false},
                 {"-height + 3 * (2 - level) <= --4", false},
                 {"error > distance * 0.001", false},
                 {"box(-84.5, 36, -84, 36.5) && step >= 2", false},
                 {"box(179, -17, -179, -16)", false},
                 {"!(level < 4) || !inview", false},
                 {" \tlevel\n<\r5 ", false},
                 {"1 < 2", false}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        DiamondSelect *select = select_of(cases[i].text);
        if (diamond_select_promises(select) != cases[i].promises)
            fail_msg("'%s': promises %d, expected %d", cases[i].text, diamond_select_promises(select),
                     cases[i].promises);
        assert_string_equal(diamond_select_text(select), cases[i].text);
        diamond_select_destroy(&select);
        assert_null(select);
    }
}

static const struct {
    const char *text;
    int character;
    const char *named;
} WRONG[] = {{"", 1, "found the end"},
             {"   ", 4, "found the end"},
             {"error", 1, "a condition as the whole selection, found a number; compare it"},
             {"5", 1, "a condition"},
             {"error >", 8, "found the end"},
             {"error > > 5", 9, "found '>'"},
             {"errr > 5", 1, "found 'errr'"},
             {"Error > 5", 1, "found 'Error'"},
             {"error > 5 ||", 13, "found the end"},
             {"error > 5 | level < 3", 11, "found '|'"},
             {"error > 5 & level < 3", 11, "found '&'"},
             {"error == 5", 7, "found '='"},
             {"error > 5 level < 3", 11, "an operator or the end, found 'level'"},
             {"(error > 5", 11, "an operator or ')', found the end"},
             {"error > 5)", 10, "found ')'"},
             {"error && level < 3", 1, "a condition beside '&&', found a number"},
             {"tolerance + 1 > 2", 1, "a number beside '+', found a condition"},
             {"!error", 2, "a condition after '!'"},
             {"-tolerance", 2, "a number after '-'"},
             {"1 < error < 5", 11, "found '<'"},
             {"tolerance > 1", 1, "a number beside '>'"},
             {"error > 5kg", 9, "m, km, ft, nmi, mi or nothing after it, found '5kg'"},
             {"error > 1e99", 9, "at most 1e30"},
             {"error > 1e999999", 9, "at most 1e30"},
             {"within", 7, "within(LAT, LON, METRES), found the end"},
             {"within(1, 2)", 12, "within(LAT, LON, METRES), found ')'"},
             {"within(1, 2, 3, 4)", 15, "within(LAT, LON, METRES), found ','"},
             {"within(error, 2, 3)", 8, "found 'error'"},
             {"within(91, 2, 3)", 1, "a latitude of -90 to 90"},
             {"within(1, 2, -3)", 1, "a radius of 0 or more"},
             {"box(1, 5, 2, 4)", 1, "the south below the north"},
             {"box(1, 2, 3)", 12, "box(WEST, SOUTH, EAST, NORTH)"},
             {"error > $", 9, "found '$'"},
             {"error / 2 > 1", 7, "found '/'"},
             {"error > .", 9, "found '.'"}};

static void test_what_may_not_be_written_is_told_where_and_why(void **state) {
    (void)state;
    Heard heard;
    log_set_sink(hear, &heard);
    for (size_t i = 0; i < COUNT_OF(WRONG); i++) {
        DiamondSelect *select = NULL;
        char where[32];
        heard = (Heard){0};
        snprintf(where, sizeof where, "character %d:", WRONG[i].character);
        Result result = diamond_select_create(WRONG[i].text, &LENS, &select);
        if (result != RESULT_USAGE || heard.errors != 1 || !strstr(heard.text, where) ||
            !strstr(heard.text, WRONG[i].named))
            fail_msg("'%s': %s, %d messages, '%s'; expected '%s' and '%s'", WRONG[i].text, result_name(result),
                     heard.errors, heard.text, where, WRONG[i].named);
    }
    log_set_sink(NULL, NULL);
}

static void test_a_view_without_sides_has_no_inview(void **state) {
    (void)state;
    Heard heard = {0};
    DiamondSelect *select = NULL;
    log_set_sink(hear, &heard);
    assert_int_equal(diamond_select_create("error > 5 && inview", NULL, &select), RESULT_USAGE);
    log_set_sink(NULL, NULL);
    assert_non_null(strstr(heard.text, "character 14"));
}

// ---- anything at all ----

static void append_random_word(uint64_t *random, char *text, size_t capacity) {
    static const char *const words[] = {"error",
                                        "px",
                                        "distance",
                                        "height",
                                        "level",
                                        "step",
                                        "tau",
                                        "tolerance",
                                        "inview",
                                        "within(",
                                        "box(",
                                        "1",
                                        "2.5km",
                                        "-",
                                        "+",
                                        "*",
                                        "<",
                                        ">=",
                                        "&&",
                                        "||",
                                        "!",
                                        "(",
                                        ")",
                                        ",",
                                        "1e9",
                                        "within(50, 19, 100)",
                                        "box(19, 49, 20, 50)",
                                        " "};
    char byte[2] = {(char)(support_random(random) % 255 + 1), 0};
    const char *word = support_random(random) % 16 ? words[support_random(random) % COUNT_OF(words)] : byte;
    if (strlen(text) + strlen(word) + 1 < capacity)
        strcat(text, word);
}

static void test_any_text_is_taken_or_refused(void **state) {
    (void)state;
    uint64_t random = SEED;
    Heard heard = {0};
    int taken = 0, refused = 0;
    print_message("seed %" PRIu64 "\n", SEED);
    log_set_sink(hear, &heard);
    for (int i = 0; i < 60000; i++) {
        char text[600] = "";
        DiamondSelect *select = NULL;
        int words = (int)(support_random(&random) % (i % 50 ? 9 : 120));
        for (int k = 0; k <= words; k++)
            append_random_word(&random, text, sizeof text);
        heard.errors = 0;
        Result result = diamond_select_create(text, i % 3 ? &LENS : NULL, &select);
        if (result == RESULT_OK)
            taken++;
        else
            refused++;
        assert_true((result == RESULT_OK && !heard.errors) || (result == RESULT_USAGE && heard.errors == 1));
        diamond_select_destroy(&select);
    }
    log_set_sink(NULL, NULL);
    print_message("%d taken, %d refused\n", taken, refused);
    assert_true(taken > 100 && refused > 100);
}

static Result create_repeated(const char *piece, int times, const char *end) {
    static char text[8192];
    DiamondSelect *select = NULL;
    text[0] = 0;
    for (int i = 0; i < times; i++)
        strcat(text, piece);
    strcat(text, end);
    Result result = diamond_select_create(text, &LENS, &select);
    diamond_select_destroy(&select);
    return result;
}

static void test_deep_and_long_selections_are_refused_before_they_harm(void **state) {
    (void)state;
    Heard heard = {0};
    log_set_sink(hear, &heard);
    assert_int_equal(create_repeated("(", 3000, "tolerance"), RESULT_USAGE);
    assert_int_equal(create_repeated("!", 3000, "tolerance"), RESULT_USAGE);
    assert_int_equal(create_repeated("-", 3000, "1 < 2"), RESULT_USAGE);
    assert_int_equal(create_repeated("1+(", 20, "1"), RESULT_USAGE); // needs more than the stack
    assert_int_equal(create_repeated("level<3||", 100, "tolerance"), RESULT_USAGE);
    assert_int_equal(create_repeated("within(1,2,3)||", 30, "tolerance"), RESULT_USAGE);
    assert_int_equal(create_repeated("          ", 500, "tolerance"), RESULT_USAGE);
    assert_int_equal(create_repeated("!", 20, "tolerance"), RESULT_OK);
    assert_int_equal(create_repeated("level<3||", 30, "tolerance"), RESULT_OK);
    log_set_sink(NULL, NULL);
}

// ---- what words select ----

typedef struct World {
    Jobs *jobs;
    Terrain *terrain;
    DiamondModel model;
    uint32_t *bits;
    LodView view;
} World;

static World world_of_size(const DemGeoref *georef, int width, int height) {
    World w = {0};
    assert_int_equal(jobs_create(2, &w.jobs), RESULT_OK);
    w.terrain = support_terrain(support_rough_dem(width, height, georef, 900.0, SEED), TERRAIN_ERROR_TOTAL, 6, w.jobs);
    assert_int_equal(diamond_model_create(w.terrain, DIAMOND_FIELD_DATUM | DIAMOND_FIELD_DEGREES, 1, w.jobs, &w.model),
                     RESULT_OK);
    assert_int_equal(diamond_generate_errors(&w.model, w.jobs, NULL), RESULT_OK);
    w.bits = calloc(w.model.layout.word_count, sizeof *w.bits);
    assert_non_null(w.bits);
    w.view = support_view(support_eye(w.terrain, 60.0, 70.0, 500.0), 1.5);
    return w;
}

static World world_of(const DemGeoref *georef) {
    return world_of_size(georef, 150, 131);
}

static void world_end(World *w) {
    free(w->bits);
    diamond_model_destroy(&w->model);
    terrain_destroy(&w->terrain);
    jobs_destroy(&w->jobs);
}

static void evaluate(World *w, const char *text) {
    DiamondSelect *select = select_of(text);
    DiamondProgram program;
    DiamondView view = diamond_view(&w->model, &w->view, w->view.tau_px, diamond_select_lens(select));
    diamond_select_bind(select, &w->model, &program);
    diamond_evaluate(&w->model, &program, &view, w->jobs, w->bits);
    diamond_select_destroy(&select);
}

// What an oracle may know of a vertex.
typedef struct Vertex {
    int col, row, step, level;
    double error_m, height_m, distance_m, reach_m;
    double lat_deg, lon_deg;
    Vec3d position;
} Vertex;

static Vertex vertex_of(const World *w, int plane, uint32_t word, int slot) {
    const DiamondLayout *layout = &w->model.layout;
    uint32_t i = (word - layout->offset[plane]) % layout->across[plane];
    uint32_t j = (word - layout->offset[plane]) / layout->across[plane];
    int bit = diamond_slot_bit(slot), s = 1 << plane;
    Vertex v = {.col = s * ((int)(4 * i) + bit % 4), .row = s * ((int)(4 * j) + bit / 4), .step = s};
    size_t sample = (size_t)v.row * (size_t)layout->width + (size_t)v.col;
    v.level = 2 * (layout->level_count - 1 - plane) + (slot >= 4);
    v.error_m = (double)w->model.error_m[diamond_entry(layout, slot, word)];
    v.height_m = (double)w->model.height_m[sample];
    v.position = grid_ecef(w->terrain->grid, v.col, v.row, v.height_m);
    v.distance_m = vec3d_distance(v.position, w->view.eye_ecef);
    v.reach_m = (double)w->model.reach_m[(slot < 4 ? 0 : layout->word_count) + word];
    grid_geodetic(w->terrain->grid, v.col, v.row, &v.lat_deg, &v.lon_deg);
    return v;
}

// -1: not to be split, 1: to be split, 0: near the border of the selection, where rounding decides.
typedef int Oracle(const World *w, const Vertex *v);

static void expect_selected(World *w, const char *text, Oracle *oracle) {
    const DiamondLayout *layout = &w->model.layout;
    int64_t split = 0, not_split = 0;
    evaluate(w, text);
    for (int plane = 0; plane < layout->level_count; plane++)
        for (uint32_t n = 0; n < layout->across[plane] * layout->down[plane] * DIAMOND_SLOTS; n++) {
            uint32_t word = layout->offset[plane] + n / DIAMOND_SLOTS;
            int slot = (int)(n % DIAMOND_SLOTS), bit = diamond_slot_bit(slot);
            bool found = w->bits[word] >> bit & 1;
            if (!(w->model.valid[word] >> bit & 1)) {
                assert_false(found);
                continue;
            }
            if (w->model.always[word] >> bit & 1) {
                assert_true(found);
                continue;
            }
            Vertex v = vertex_of(w, plane, word, slot);
            int expected = oracle(w, &v);
            if ((expected > 0 && !found) || (expected < 0 && found))
                fail_msg("'%s': (%d, %d) step %d: split %d, expected %d", text, v.col, v.row, v.step, found,
                         expected > 0);
            split += expected > 0;
            not_split += expected < 0;
        }
    if (!split || !not_split)
        fail_msg("'%s': %" PRId64 " to be split, %" PRId64 " not: the oracle tells nothing", text, split, not_split);
}

static int beyond(double value, double limit) {
    return fabs(value - limit) < 1e-5 * (1.0 + fabs(limit)) ? 0 : value > limit ? 1 : -1;
}

static int error_above_5(const World *w, const Vertex *v) {
    (void)w;
    return beyond(v->error_m, 5.0);
}
static int error_above_5_or_coarse(const World *w, const Vertex *v) {
    return v->level < 6 ? 1 : error_above_5(w, v);
}
static int steps_but_edges(const World *w, const Vertex *v) {
    (void)w;
    return v->step <= 4 && !(v->level % 2) ? 1 : -1;
}
static int level_expression(const World *w, const Vertex *v) {
    (void)w;
    return -v->level + 3 * (2 - v->step) < -20 ? 1 : -1;
}
static int height_above_1000ft(const World *w, const Vertex *v) {
    (void)w;
    return beyond(v->height_m, 304.8);
}
static int nearer_than_2km(const World *w, const Vertex *v) {
    (void)w;
    return -beyond(v->distance_m, 2000.0);
}
static int error_by_distance(const World *w, const Vertex *v) {
    (void)w;
    return beyond(v->error_m, 0.002 * v->distance_m);
}
static int within_1500m(const World *w, const Vertex *v) {
    double lat, lon;
    grid_geodetic(w->terrain->grid, 75.0, 60.0, &lat, &lon);
    Vec3d up = geodesy_up(lat * GEODESY_RAD_PER_DEG, lon * GEODESY_RAD_PER_DEG);
    Vec3d place = geodesy_to_ecef((Geodetic){lat * GEODESY_RAD_PER_DEG, lon * GEODESY_RAD_PER_DEG, 0.0});
    Vec3d away = vec3d_sub(v->position, place);
    double d = vec3d_length(vec3d_sub(away, vec3d_scale(up, vec3d_dot(away, up))));
    return d < 1500.0 ? 1 : d > 1500.0 + v->reach_m + 2.0 ? -1 : 0;
}
static int in_box(const World *w, const Vertex *v) {
    double lat0, lon0, lat1, lon1;
    grid_geodetic(w->terrain->grid, 100.0, 90.0, &lat0, &lon0);
    grid_geodetic(w->terrain->grid, 145.0, 50.0, &lat1, &lon1);
    double east = remainder(v->lon_deg - lon0, 360.0), room = v->reach_m / 60000.0;
    double width = remainder(lon1 - lon0, 360.0);
    if (east > 1e-5 && east < width - 1e-5 && v->lat_deg > lat0 + 1e-5 && v->lat_deg < lat1 - 1e-5)
        return 1;
    bool away = east < -room || east > width + room || v->lat_deg < lat0 - room || v->lat_deg > lat1 + room;
    return away ? -1 : 0;
}
static int in_front(const World *w, const Vertex *v) {
    Vec3d ahead = w->view.forward_ecef, up = vec3d_normalize(w->view.eye_ecef);
    Vec3d right = vec3d_normalize(vec3d_cross(ahead, up)), away = vec3d_sub(v->position, w->view.eye_ecef);
    up = vec3d_cross(right, ahead);
    double depth = vec3d_dot(away, ahead), room = v->reach_m * 2.5 + 5.0;
    double x = fabs(vec3d_dot(away, right)) - LENS.tan_right * depth;
    double y = fabs(vec3d_dot(away, up)) - LENS.tan_up * depth;
    if (depth > 0.0 && x < 0.0 && y < 0.0)
        return 1;
    return depth < -room || x > room || y > room ? -1 : 0;
}

static void test_each_word_selects_what_it_says(void **state) {
    (void)state;
    static const struct {
        const char *name;
        const DemGeoref *georef;
    } places[] = {{"hills", &HILLS}, {"UTM", &METRES}, {"the date line", &DATE_LINE}};
    for (size_t i = 0; i < COUNT_OF(places); i++) {
        World w = world_of(places[i].georef);
        char within[128], box[128];
        double lat, lon, lat0, lon0, lat1, lon1;
        grid_geodetic(w.terrain->grid, 75.0, 60.0, &lat, &lon);
        grid_geodetic(w.terrain->grid, 100.0, 90.0, &lat0, &lon0);
        grid_geodetic(w.terrain->grid, 145.0, 50.0, &lat1, &lon1);
        snprintf(within, sizeof within, "within(%.9f, %.9f, 1.5km)", lat, lon);
        snprintf(box, sizeof box, "box(%.9f, %.9f, %.9f, %.9f)", lon0, lat0, lon1, lat1);
        print_message("%s: %s, %s\n", places[i].name, within, box);
        expect_selected(&w, "error > 5", error_above_5);
        expect_selected(&w, "!(error <= 5)", error_above_5);
        expect_selected(&w, "error > 5 || level < 6", error_above_5_or_coarse);
        expect_selected(&w,
                        "step <= 4 && (level < 1 || (level >= 2 && level <= 2) || (level > 3 && level < 5) || "
                        "(level > 5 && !(level > 6)) || (level > 7 && level < 9) || (level > 9 && level < 11) || "
                        "(level > 11 && level < 13))",
                        steps_but_edges);
        expect_selected(&w, "-level + 3 * (2 - step) < -20", level_expression);
        expect_selected(&w, "height > 1000ft", height_above_1000ft);
        expect_selected(&w, "distance < 2km", nearer_than_2km);
        expect_selected(&w, "error > distance * 0.002", error_by_distance);
        expect_selected(&w, within, within_1500m);
        expect_selected(&w, box, in_box);
        expect_selected(&w, "inview", in_front);
        world_end(&w);
    }
}

static int beyond_170(const World *w, const Vertex *v) {
    double lon = fabs(remainder(v->lon_deg, 360.0)), room = v->reach_m / 50000.0;
    (void)w;
    if (lon > 170.001 && v->lat_deg > 10.001 && v->lat_deg < 29.999)
        return 1;
    return lon < 170.0 - room || v->lat_deg < 10.0 - room || v->lat_deg > 30.0 + room ? -1 : 0;
}

static void test_a_box_reaches_around_the_globe_s_back(void **state) {
    (void)state;
    static const DemGeoref globe = {DEM_CRS_GEOGRAPHIC, 0, false, -180.0, 60.0, 1.0, -1.0};
    World w = world_of_size(&globe, 360, 81);
    expect_selected(&w, "box(170, 10, -170, 30)", beyond_170);
    expect_selected(&w, "box(-190, 10, -170, 30)", beyond_170);
    expect_selected(&w, "box(170, 10, 190, 30) || level < 0", beyond_170);
    world_end(&w);
}

static void test_tolerance_as_a_selection_is_the_tolerance(void **state) {
    (void)state;
    World w = world_of(&HILLS);
    size_t bytes = sizeof *w.bits * w.model.layout.word_count;
    uint32_t *plain = malloc(bytes);
    DiamondProgram program;
    assert_non_null(plain);
    DiamondView view = diamond_view(&w.model, &w.view, w.view.tau_px, NULL);
    diamond_select_bind(NULL, &w.model, &program);
    diamond_evaluate(&w.model, &program, &view, w.jobs, plain);
    evaluate(&w, "tolerance && 1 < 2"); // by the interpreter
    assert_memory_equal(w.bits, plain, bytes);
    free(plain);
    world_end(&w);
}

// ---- runs of super-squares ----

static void append(char *text, const char *piece) {
    assert_true(strlen(text) + strlen(piece) < 2000);
    strcat(text, piece);
}

static void append_number(uint64_t *random, char *text, int depth) {
    static const char *const numbers[] = {"error", "px",  "distance", "height", "level",
                                          "step",  "tau", "0.5",      "3",      "200"};
    static const char *const signs[] = {" + ", " - ", " * "};
    if (depth == 0 || support_random(random) % 2) {
        append(text, numbers[support_random(random) % COUNT_OF(numbers)]);
        return;
    }
    append(text, "(");
    append_number(random, text, depth - 1);
    append(text, signs[support_random(random) % COUNT_OF(signs)]);
    append_number(random, text, depth - 1);
    append(text, ")");
}

static void append_condition(uint64_t *random, char *text, int depth) {
    static const char *const conditions[] = {"tolerance", "inview", "within(49.93, 19.05, 700)", "step < 4",
                                             "box(19.1, 49.9, 19.2, 49.95)"};
    static const char *const signs[] = {" < ", " <= ", " > ", " >= "};
    uint64_t kind = support_random(random) % 6;
    append(text, kind == 0 ? "!(" : "(");
    if (depth == 0 || kind == 1) {
        append(text, conditions[support_random(random) % COUNT_OF(conditions)]);
    } else if (kind == 2) {
        append_number(random, text, 2);
        append(text, signs[support_random(random) % COUNT_OF(signs)]);
        append_number(random, text, 2);
    } else {
        append_condition(random, text, depth - 1);
        append(text, support_random(random) % 2 ? " && " : " || ");
        append_condition(random, text, depth - 1);
    }
    append(text, ")");
}

static void test_what_is_foreseen_for_a_run_is_what_each_diamond_says(void **state) {
    (void)state;
    uint64_t random = SEED;
    World w = world_of_size(&HILLS, 420, 300);
    size_t bytes = sizeof *w.bits * w.model.layout.word_count;
    uint32_t *each = malloc(bytes);
    DiamondRun *runs = w.model.runs;
    assert_non_null(each);
    for (int i = 0; i < 150; i++) {
        char text[2048] = "";
        append_condition(&random, text, 3);
        w.view = support_view(support_eye(w.terrain, support_between(&random, 0.0, 420.0),
                                          support_between(&random, 0.0, 300.0), support_between(&random, 5.0, 4000.0)),
                              2.0);
        w.model.runs = NULL;
        evaluate(&w, text);
        memcpy(each, w.bits, bytes);
        w.model.runs = runs;
        evaluate(&w, text);
        if (memcmp(each, w.bits, bytes) != 0)
            fail_msg("'%s': %" PRId64 " split, asking each %" PRId64, text, diamond_count(&w.model, w.bits),
                     diamond_count(&w.model, each));
    }
    free(each);
    world_end(&w);
}

// ---- meshes ----

static void check_mesh(Terrain *terrain, Jobs *jobs, const char *text, Arena *frame) {
    LodOptions options = lod_default_options();
    DiamondSelect *select = select_of(text);
    Lod *lod;
    LodCut cut;
    options.method = LOD_DIAMOND;
    options.select = select;
    LodView view = support_view(support_eye(terrain, 20.0, 30.0, 300.0), 2.0);
    assert_int_equal(lod_create(&options, terrain, &lod), RESULT_OK);
    assert_int_equal(lod_update(lod, &view, jobs, frame, &cut), RESULT_OK);
    assert_true(cut.promises == diamond_select_promises(select));
    assert_true(cut.stats.closed >= cut.stats.chosen);
    support_check_cut(terrain, &cut, jobs, text);
    lod_destroy(&lod);
    diamond_select_destroy(&select);
    arena_reset(frame);
}

static Terrain *terrain_with_holes(int width, int height, Jobs *jobs) {
    uint64_t random = SEED;
    Dem *dem = support_rough_dem(width, height, &HILLS, 700.0, SEED);
    dem->void_bits = calloc(((size_t)width * (size_t)height + 7) / 8, 1);
    assert_non_null(dem->void_bits);
    for (int i = 0; i < width * height / 200; i++) {
        uint64_t at = support_random(&random) % (uint64_t)(width * height);
        dem->void_bits[at >> 3] |= (uint8_t)(1u << (at & 7));
    }
    return support_terrain(dem, TERRAIN_ERROR_TOTAL, 6, jobs);
}

static void test_any_selection_gives_a_whole_mesh(void **state) {
    (void)state;
    static const char *const texts[] = {"error > 20 && level > 9",
                                        "step <= 1 && within(49.97, 19.03, 300)",
                                        "level >= 5 && level <= 5",
                                        "level < 4 || (step < 2 && height > 300)",
                                        "!tolerance && step < 8",
                                        "tolerance && inview",
                                        "tolerance || step <= 1 && box(19.01, 49.9, 19.02, 50)",
                                        "px > 3 || 1 < 0",
                                        "1 < 0",
                                        "0 < 1"};
    static const struct { int width, height; } sizes[] = {{2, 2}, {3, 2}, {65, 65}, {117, 168}, {130, 71}};
    Jobs *jobs;
    Arena *frame;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &frame), RESULT_OK);
    for (size_t i = 0; i < COUNT_OF(sizes); i++) {
        Terrain *terrain =
            i == 4 ? terrain_with_holes(sizes[i].width, sizes[i].height, jobs)
                   : support_terrain(support_rough_dem(sizes[i].width, sizes[i].height, &HILLS, 700.0, SEED),
                                     TERRAIN_ERROR_TOTAL, 6, jobs);
        for (size_t k = 0; k < COUNT_OF(texts); k++)
            check_mesh(terrain, jobs, texts[k], frame);
        terrain_destroy(&terrain);
    }
    arena_destroy(&frame);
    jobs_destroy(&jobs);
}

static void test_a_selection_above_the_budget_is_refused_by_name(void **state) {
    (void)state;
    Heard heard = {0};
    World w = world_of(&HILLS);
    LodOptions options = lod_default_options();
    DiamondSelect *select = select_of("step >= 1");
    Lod *lod;
    Arena *frame;
    LodCut cut;
    options.method = LOD_DIAMOND;
    options.select = select;
    options.max_triangles = 1000;
    assert_int_equal(lod_create(&options, w.terrain, &lod), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &frame), RESULT_OK);
    log_set_sink(hear, &heard);
    assert_int_equal(lod_update(lod, &w.view, w.jobs, frame, &cut), RESULT_RANGE);
    log_set_sink(NULL, NULL);
    assert_non_null(strstr(heard.text, "step >= 1"));
    assert_non_null(strstr(heard.text, "--max-triangles"));
    lod_destroy(&lod);
    arena_destroy(&frame);
    diamond_select_destroy(&select);
    world_end(&w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_what_may_be_written),
        cmocka_unit_test(test_what_may_not_be_written_is_told_where_and_why),
        cmocka_unit_test(test_a_view_without_sides_has_no_inview),
        cmocka_unit_test(test_any_text_is_taken_or_refused),
        cmocka_unit_test(test_deep_and_long_selections_are_refused_before_they_harm),
        cmocka_unit_test(test_each_word_selects_what_it_says),
        cmocka_unit_test(test_a_box_reaches_around_the_globe_s_back),
        cmocka_unit_test(test_tolerance_as_a_selection_is_the_tolerance),
        cmocka_unit_test(test_what_is_foreseen_for_a_run_is_what_each_diamond_says),
        cmocka_unit_test(test_any_selection_gives_a_whole_mesh),
        cmocka_unit_test(test_a_selection_above_the_budget_is_refused_by_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
