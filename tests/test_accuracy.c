// The accuracy benchmark from inside: good cuts are found good, spoilt ones are condemned by the report, and its
// figures are those of the frames.
#define _GNU_SOURCE // mkdtemp, open_memstream
#include "app/accuracy/accuracy_hitches.h"
#include "app/accuracy/accuracy_html.h"
#include "app/accuracy/accuracy_plots.h"
#include "app/accuracy/accuracy_report.h"
#include "app/signals.h"
#include "base/paths.h"
#include "heard.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define TAU 3.0

// A small plan over the default scene, once round on the spot.
static const char *const ARGUMENTS[] = {"--methods", "hybrid,roam,geomipmap",
                                        "--tau",     "3,6",
                                        "--track",   "turn",
                                        "--errors",  "total",
                                        "--frames",  "6",
                                        "--rounds",  "2",
                                        "--size",    "96x64",
                                        "--threads", "2",
                                        "--quick"};

typedef struct Bench {
    Options *options;
    AccuracyPlan plan;
    Accuracy accuracy;
} Bench;

static Bench *bench_begin(void) {
    Bench *b = calloc(1, sizeof *b);
    assert_non_null(b);
    assert_int_equal(options_create(COMMAND_BENCH, &b->options), RESULT_OK);
    assert_int_equal(options_read_arguments(b->options, (int)COUNT_OF(ARGUMENTS), (char *const *)ARGUMENTS), RESULT_OK);
    assert_int_equal(accuracy_plan(b->options, &b->plan), RESULT_OK);
    return b;
}

static void bench_run(Bench *b) {
    assert_int_equal(accuracy_run(&b->plan, &b->accuracy), RESULT_OK);
}

static void bench_end(Bench *b) {
    accuracy_clear(&b->accuracy);
    options_destroy(&b->options);
    free(b);
}

// ---- spoiling ----

typedef enum Harm { HARM_VERTEX, HARM_CRACK, HARM_TRIANGLE, HARM_HAIR } Harm;

// A copy of a cut whose first fitting item is spoilt, until the next one is.
typedef struct Spoiler {
    Harm harm;
    int only;         // of all cuts, from 1; 0: each
    int seen, spoilt; // cuts
    LodItem *items;
    LodPage page;
    LodVertex *vertices;
    uint16_t *indices;
} Spoiler;

static void spoiler_clear(Spoiler *s) {
    free(s->items);
    free(s->vertices);
    free(s->indices);
    s->items = NULL;
    s->vertices = NULL;
    s->indices = NULL;
}

static Vec3d place_of(const LodPage *page, const LodVertex *v) {
    GridPoint p = {page->origin.x + v->x, page->origin.y + v->y, page->origin.z + v->z};
    return grid_point_ecef(p);
}

// Whether another item draws a vertex at that column and row.
static bool is_shared(const LodCut *cut, int32_t item, int32_t col, int32_t row) {
    for (int32_t i = 0; i < cut->item_count; i++) {
        const LodPage *page = cut->items[i].page;
        for (int32_t k = 0; k < cut->items[i].index_count && i != item; k++) {
            const LodVertex *v = &page->vertices[cut->items[i].indices[k]];
            if (page->col0 + v->col == col && page->row0 + v->row == row)
                return true;
        }
    }
    return false;
}

// A vertex that the item draws, and no other, or others too; -1: there is none.
static int find_vertex(const Dem *dem, const LodCut *cut, int32_t item, bool shared) {
    const LodPage *page = cut->items[item].page;
    for (int32_t k = 0; k < cut->items[item].index_count; k++) {
        int vertex = cut->items[item].indices[k];
        int32_t col = page->col0 + page->vertices[vertex].col, row = page->row0 + page->vertices[vertex].row;
        bool rim = col == 0 || row == 0 || col == dem->width - 1 || row == dem->height - 1;
        if (!rim && is_shared(cut, item, col, row) == shared)
            return vertex;
    }
    return -1;
}

// By `tau_px` as the eye sees it, along the vertical.
static void lift(const LodCut *cut, const LodPage *page, LodVertex *v, double tau_px) {
    Vec3d place = place_of(page, v);
    Geodetic where = geodesy_from_ecef(place);
    double metres = tau_px * vec3d_distance(place, cut->view.eye_ecef) / cut->view.px_per_rad;
    Vec3d up = vec3d_scale(geodesy_up(where.lat_rad, where.lon_rad), metres * GRID_LATTICE_PER_M);
    v->x += (int32_t)lround(up.x);
    v->y += (int32_t)lround(up.y);
    v->z += (int32_t)lround(up.z);
}

static void spoil_item(Spoiler *s, const LodCut *cut, LodItem *item, int vertex) {
    size_t vertices = (size_t)item->page->vertex_count, indices = (size_t)item->index_count;
    s->page = *item->page;
    s->vertices = malloc(vertices * sizeof *s->vertices);
    s->indices = malloc(indices * sizeof *s->indices);
    assert_true(s->vertices && s->indices);
    memcpy(s->vertices, item->page->vertices, vertices * sizeof *s->vertices);
    memcpy(s->indices, item->indices, indices * sizeof *s->indices);
    s->page.vertices = s->vertices;
    item->page = &s->page;
    item->indices = s->indices;
    if (s->harm == HARM_TRIANGLE)
        item->index_count -= 3;
    else
        lift(cut, &s->page, &s->vertices[vertex], s->harm == HARM_VERTEX ? 2.0 * cut->view.tau_px : 0.02);
}

static void spoil(void *user, const Terrain *terrain, LodCut *cut) {
    Spoiler *s = user;
    spoiler_clear(s);
    if (++s->seen != s->only && s->only)
        return;
    s->items = malloc(sizeof *s->items * (size_t)cut->item_count);
    assert_non_null(s->items);
    memcpy(s->items, cut->items, sizeof *s->items * (size_t)cut->item_count);
    cut->items = s->items;
    for (int32_t i = 0; i < cut->item_count; i++) {
        int vertex = find_vertex(terrain_dem(terrain), cut, i, s->harm == HARM_CRACK);
        if (vertex < 0)
            continue;
        spoil_item(s, cut, &s->items[i], vertex);
        s->spoilt++;
        return;
    }
}

static Bench *spoilt_bench(Spoiler *spoiler) {
    Bench *b = bench_begin();
    b->plan.rounds = 1; // of times, which nobody looks at
    b->plan.tamper = spoil;
    b->plan.tamper_user = spoiler;
    bench_run(b);
    spoiler_clear(spoiler);
    assert_true(spoiler->spoilt > 0);
    return b;
}

// ---- what is told ----

static char *told_by(Result (*write)(const Accuracy *, FILE *), const Accuracy *accuracy) {
    char *bytes = NULL;
    size_t count;
    FILE *memory = open_memstream(&bytes, &count);
    assert_non_null(memory);
    assert_int_equal(write(accuracy, memory), RESULT_OK);
    fclose(memory);
    return bytes;
}

static Result write_json(const Accuracy *accuracy, FILE *to) {
    Json *json = accuracy_make_json(accuracy);
    Result result = json_write(json, to);
    json_destroy(&json);
    return result;
}

static Result write_text(const Accuracy *accuracy, FILE *to) {
    accuracy_write_text(accuracy, to);
    return RESULT_OK;
}

static void remove_folder(const char *folder) {
    char command[PATHS_BYTES_MAX];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    assert_int_equal(system(command), 0);
}

// report.html of a report written to a folder that does not last.
static char *told_by_report(const Accuracy *accuracy) {
    char folder[] = "test_accuracy_XXXXXX", path[64], *bytes;
    size_t count;
    assert_non_null(mkdtemp(folder));
    assert_int_equal(accuracy_check_report(accuracy->plan.options, folder), RESULT_OK);
    assert_int_equal(accuracy_write_report(accuracy, folder), RESULT_OK);
    snprintf(path, sizeof path, "%s/report.html", folder);
    assert_int_equal(accuracy_read_file(path, &bytes, &count), RESULT_OK);
    remove_folder(folder);
    return bytes;
}

static void expect_told(const char *what, const char *text, const char *part, bool wanted) {
    if ((strstr(text, part) != NULL) != wanted)
        fail_msg("%s: '%s' is %s", what, part, wanted ? "not there" : "there");
}

static bool is_condemned(const Bench *b, int variant, int tau) {
    return !accuracy_run_holds(accuracy_run_at(&b->accuracy, 0, variant, tau));
}

// ---- tests ----

static void test_good_cuts_are_found_good(void **state) {
    Bench *b = *state;
    assert_true(accuracy_holds(&b->accuracy));
    for (int i = 0; i < b->accuracy.run_count; i++) {
        const AccuracyRun *run = &b->accuracy.runs[i];
        const AccuracyVariant *variant = &b->plan.variants[run->variant];
        assert_true(run->summary.same_cuts);
        assert_int_equal(run->summary.promised, variant->method != LOD_GEOMIPMAP);
        assert_true(run->summary.max_px > 0.0 && run->summary.triangles_mean > 10.0);
    }
    assert_true(b->accuracy.worst.run >= 0 && b->accuracy.worst.repeated);
    double kept = b->accuracy.dems[0].begin_ms[2];
    AccuracySummary *still = &accuracy_run_at(&b->accuracy, 0, 1, 1)->summary;
    double popping_px = still->popping_px;
    still->popping_px = 0.0;
    b->accuracy.dems[0].begin_ms[2] = 1234567.5; // found again in the table
    char *html = told_by_report(&b->accuracy), *json = told_by(write_json, &b->accuracy);
    b->accuracy.dems[0].begin_ms[2] = kept;
    still->popping_px = popping_px;
    expect_told("report.html", html, ">none in 23 pairs<", true);
    expect_told("report.html", html, ">1234567.5<", true);
    expect_told("report.html", html, "<strong>Every promise held:</strong>", true);
    expect_told("report.html", html, "broken\"", false);
    expect_told("report.html", html, "http://", false);
    expect_told("summary.json", json, "\"promises_held\":\ttrue", true);
    free(html);
    free(json);
}

static void test_a_vertex_moved_by_two_tolerances_is_condemned(void **state) {
    (void)state;
    Spoiler spoiler = {.harm = HARM_VERTEX};
    Bench *b = spoilt_bench(&spoiler);
    assert_false(accuracy_holds(&b->accuracy));
    const AccuracySummary *s = &accuracy_run_at(&b->accuracy, 0, 0, 0)->summary;
    assert_true(s->max_px > 1.5 * TAU && s->max_px < 3.5 * TAU);
    assert_int_equal(s->t_junctions + s->holes + s->overlaps, 0); // wrong, but whole
    assert_true(is_condemned(b, 0, 0) && is_condemned(b, 1, 1));
    assert_false(is_condemned(b, 2, 0)); // it promises nothing
    char *html = told_by_report(&b->accuracy), *json = told_by(write_json, &b->accuracy);
    char *text = told_by(write_text, &b->accuracy);
    expect_told("report.html", html, "<div class=\"verdict broken\"", true);
    expect_told("report.html", html, "px measured where at most 3 were promised", true);
    expect_told("report.html", html, "<td class=\"text broken\">broken</td>", true);
    expect_told("report.html", html, ">held<", false); // in no table
    expect_told("summary.json", json, "\"promise_held\":\tfalse", true);
    expect_told("summary.json", json, "\"promises_held\":\tfalse", true);
    expect_told("text", text, "BROKEN: 0 of 4 runs that promise a bound kept it; 0 of 6 runs had cracks", true);
    free(html);
    free(json);
    free(text);
    bench_end(b);
}

// In the middle of the stretch, whose cuts are not measured otherwise.
static void test_a_vertex_that_jumps_in_a_stretch_pops(void **state) {
    const Bench *good = *state;
    Spoiler spoiler = {.harm = HARM_VERTEX, .only = good->accuracy.dems[0].pose_count + ACCURACY_STRETCH_QUICK / 2};
    Bench *b = spoilt_bench(&spoiler);
    const AccuracySummary *s = &accuracy_run_at(&b->accuracy, 0, 0, 0)->summary;
    double calm_px = accuracy_run_at(&good->accuracy, 0, 0, 0)->summary.popping_px;
    print_message("popping %.3f px, expected 2 tau, %g px, and what it is without, %.3f px, at most beside it\n",
                  s->popping_px, 2.0 * TAU, calm_px);
    assert_int_equal(spoiler.spoilt, 1);
    assert_true(fabs(s->popping_px - 2.0 * TAU) < calm_px + 0.01 && calm_px < TAU);
    assert_int_equal(s->popping_pairs, accuracy_run_at(&good->accuracy, 0, 0, 0)->summary.popping_pairs);
    assert_true(accuracy_holds(&b->accuracy)); // popping is not promised
    bench_end(b);
}

// Even where the hair is far below the tolerance.
static void test_a_crack_is_condemned_however_thin(void **state) {
    (void)state;
    Spoiler spoiler = {.harm = HARM_CRACK};
    Bench *b = spoilt_bench(&spoiler);
    const AccuracySummary *s = &accuracy_run_at(&b->accuracy, 0, 0, 0)->summary;
    assert_true(s->max_px <= TAU && s->holes > 0);
    for (int variant = 0; variant < b->plan.variant_count; variant++)
        assert_true(is_condemned(b, variant, 0)); // also those that promise no bound: no surface may have cracks
    char *html = told_by_report(&b->accuracy), *text = told_by(write_text, &b->accuracy);
    expect_told("report.html", html, "<div class=\"verdict broken\"", true);
    expect_told("report.html", html, " holes, ", true);
    expect_told("text", text, "6 of 6 runs had cracks", true);
    free(html);
    free(text);
    bench_end(b);
}

static void test_a_missing_triangle_is_condemned(void **state) {
    (void)state;
    Spoiler spoiler = {.harm = HARM_TRIANGLE};
    Bench *b = spoilt_bench(&spoiler);
    assert_true(is_condemned(b, 0, 0) && is_condemned(b, 2, 1));
    assert_true(accuracy_run_at(&b->accuracy, 0, 2, 1)->summary.holes > 0);
    bench_end(b);
}

// A hair inside the page is below what is tolerated, and no crack.
static void test_what_is_tolerated_is_not_condemned(void **state) {
    (void)state;
    Spoiler spoiler = {.harm = HARM_HAIR};
    Bench *b = spoilt_bench(&spoiler);
    assert_true(accuracy_run_at(&b->accuracy, 0, 2, 0)->summary.holes == 0);
    assert_false(is_condemned(b, 2, 0));
    bench_end(b);
}

static void test_summaries_are_those_of_the_frames(void **state) {
    Bench *b = *state;
    const AccuracyDem *dem = &b->accuracy.dems[0];
    for (int i = 0; i < b->accuracy.run_count; i++) {
        const AccuracyRun *run = &b->accuracy.runs[i];
        double most = 0.0, squares = 0.0, popping = 0.0, slowest = 0.0;
        for (int pose = 0; pose < dem->pose_count; pose++) {
            const AccuracyFrame *frame = &run->frames[pose];
            most = fmax(most, frame->measure.max_px);
            squares += frame->measure.rms_px * frame->measure.rms_px / dem->pose_count;
            assert_int_equal(isnan(frame->popping_px), dem->poses[pose].jump);
            assert_true(frame->least.frame_ms <= frame->median.frame_ms);
            assert_true(frame->median.frame_ms <= frame->most.frame_ms);
            assert_int_equal(frame->measure.samples, (int64_t)dem->width * dem->height);
            if (dem->poses[pose].jump)
                continue;
            popping = fmax(popping, frame->popping_px);
            slowest = fmax(slowest, frame->most.frame_ms);
        }
        assert_float_equal(run->summary.max_px, most, 0.0);
        assert_float_equal(run->summary.rms_px, sqrt(squares), 1e-12);
        assert_float_equal(run->summary.popping_px, fmax(popping, run->stretch_px), 0.0);
        assert_int_equal(run->stretch_pairs, ACCURACY_STRETCH_QUICK - 1);
        assert_float_equal(run->summary.frame_ms.max, slowest, 0.0);
        assert_float_equal(run->frames[run->summary.worst_frame].measure.max_px, most, 0.0);
        assert_true(run->summary.frame_p50.least <= run->summary.frame_p50.most);
    }
}

// The nested errors are built for those that take them, and for nobody else.
static void test_each_method_has_a_beginning_of_its_own(void **state) {
    const Bench *b = *state;
    const AccuracyDem *dem = &b->accuracy.dems[0];
    for (int i = 0; i < b->plan.variant_count; i++) {
        bool nested = b->plan.variants[i].method != LOD_GEOMIPMAP;
        assert_int_equal(accuracy_is_nested(b->plan.variants[i].method), nested);
        assert_true(dem->begin_ms[i] > (nested ? dem->build_ms[0][0] : 0.0));
    }
}

static void test_gains_lie_within_their_spread(void **state) {
    const Bench *b = *state;
    const AccuracyScaling *scaling = &b->accuracy.scaling;
    assert_true(scaling->speed_count > 1);
    for (int i = 0; i < scaling->speed_count; i++) {
        const AccuracySpeed *speed = &scaling->speeds[i];
        assert_true(0.0 < speed->least_speedup && speed->least_speedup <= speed->speedup);
        assert_true(speed->speedup <= speed->most_speedup);
        assert_true(speed->threads > 1 || (speed->least_speedup == 1.0 && speed->most_speedup == 1.0));
    }
}

static void test_costs_between_tolerances_lie_between_them(void **state) {
    Bench *b = *state;
    const AccuracySummary *fine = &accuracy_run_at(&b->accuracy, 0, 0, 0)->summary;
    const AccuracySummary *coarse = &accuracy_run_at(&b->accuracy, 0, 0, 1)->summary;
    AccuracyCost middle = accuracy_cost_at(&b->accuracy, 0, 0, sqrt(fine->max_px * coarse->max_px));
    assert_float_equal(middle.triangles, sqrt(fine->triangles_mean * coarse->triangles_mean), 1e-6 * middle.triangles);
    assert_float_equal(accuracy_cost_at(&b->accuracy, 0, 0, fine->max_px).triangles, fine->triangles_mean, 1e-6);
    assert_true(isnan(accuracy_cost_at(&b->accuracy, 0, 0, 0.5 * fine->max_px).triangles));
    assert_true(isnan(accuracy_cost_at(&b->accuracy, 0, 0, 2.0 * coarse->max_px).triangles));
}

// Frames made slow by hand: each is told with the stage that made it so.
static void test_hitches_are_told_with_their_cause(void **state) {
    Bench *b = *state;
    AccuracyRun *run = accuracy_run_at(&b->accuracy, 0, 1, 1);
    AccuracyHitch hitches[ACCURACY_HITCHES_MAX];
    int before, found;
    (void)accuracy_hitches(&b->accuracy, 0, hitches, &before);
    AccuracyFrame *frames[] = {&run->frames[1], &run->frames[2], &run->frames[4], &run->frames[5]}; // others: jumps
    const AccuracyFrame kept[] = {*frames[0], *frames[1], *frames[2], *frames[3]};
    double p50 = run->summary.frame_ms.p50;
    frames[0]->median.draw_ms += 3000.0 * p50;
    frames[0]->median.frame_ms = 3000.0 * p50;
    for (int i = 1; i < 4; i++) // whatever a busy machine made of them
        frames[i]->median.frame_ms = frames[i]->most.frame_ms = p50;
    frames[1]->most.frame_ms = 200.0 * p50;
    int count = accuracy_hitches(&b->accuracy, 0, hitches, &found);
    assert_true(found >= 2 && found <= before + 2 && count >= 2);
    assert_int_equal(hitches[0].pose, 1);
    assert_non_null(strstr(hitches[0].cause, "all rounds: drawing"));
    assert_int_equal(hitches[1].pose, 2);
    assert_non_null(strstr(hitches[1].cause, "one round: the system"));
    for (int i = 0; i < 4; i++)
        *frames[i] = kept[i];
}

// ---- signals ----

// Sends one once the first model is done with.
static void interrupt_second(void *user, const Terrain *terrain, LodCut *cut) {
    const Accuracy *accuracy = user;
    (void)terrain, (void)cut;
    if (accuracy->dems_finished > 0 && !accuracy->signal)
        raise(SIGINT);
}

static void test_a_signal_leaves_the_models_that_were_finished(void **state) {
    (void)state;
    for (int finished = 0; finished < 2; finished++) {
        Bench *b = bench_begin();
        sigset_t before;
        b->plan.dem_count = 2; // the default scene twice
        b->plan.variant_count = b->plan.tau_count = b->plan.rounds = 1;
        b->plan.tamper = interrupt_second;
        b->plan.tamper_user = &b->accuracy;
        signals_hold(&before);
        if (!finished)
            raise(SIGINT);
        bench_run(b);
        signals_restore(&before);
        assert_true(accuracy_is_interrupted(&b->accuracy) && b->accuracy.signal == SIGINT);
        assert_int_equal(b->accuracy.plan.dem_count, finished);
        assert_int_equal(b->accuracy.run_count, finished);
        assert_int_equal(accuracy_holds(&b->accuracy), true);
        if (finished) {
            char *text = told_by(write_text, &b->accuracy), *json = told_by(write_json, &b->accuracy);
            expect_told("text", text, "of 2 elevation models, 1 could not be finished and is not in it", true);
            expect_told("JSON", json, "\"interrupted\":\ttrue", true);
            free(text);
            free(json);
        }
        bench_end(b);
    }
}

static int set_up(void **state) {
    Bench *b = bench_begin();
    bench_run(b);
    *state = b;
    return 0;
}

static int tear_down(void **state) {
    bench_end(*state);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_good_cuts_are_found_good),
        cmocka_unit_test(test_a_vertex_moved_by_two_tolerances_is_condemned),
        cmocka_unit_test(test_a_vertex_that_jumps_in_a_stretch_pops),
        cmocka_unit_test(test_a_crack_is_condemned_however_thin),
        cmocka_unit_test(test_a_missing_triangle_is_condemned),
        cmocka_unit_test(test_what_is_tolerated_is_not_condemned),
        cmocka_unit_test(test_summaries_are_those_of_the_frames),
        cmocka_unit_test(test_each_method_has_a_beginning_of_its_own),
        cmocka_unit_test(test_gains_lie_within_their_spread),
        cmocka_unit_test(test_costs_between_tolerances_lie_between_them),
        cmocka_unit_test(test_hitches_are_told_with_their_cause),
        cmocka_unit_test(test_a_signal_leaves_the_models_that_were_finished),
    };
    return cmocka_run_group_tests_name("test_accuracy", tests, set_up, tear_down);
}
