// The papers' figures, as the program has them, against the papers' texts where those are at hand.
#include "app/reproduce/reproduce_figures.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define NUMBERS_MAX 12

// The whole text, or NULL where it is not at hand.
static char *read_paper(const char *name) {
    char path[1024];
    snprintf(path, sizeof path, SHARED_DIR "/papers/%s", name);
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    char *text = calloc(1, 1 << 18);
    assert_non_null(text);
    assert_true(fread(text, 1, (1 << 18) - 1, file) > 0);
    fclose(file);
    return text;
}

// The numbers of the first line after `after` that begins with `begin`, from `begin`'s end on. A comma is a decimal
// point, or, with `thousands`, nothing.
static int read_line(const char *text, const char *after, const char *begin, bool thousands,
                     double numbers[NUMBERS_MAX]) {
    const char *at = strstr(text, after);
    if (!at)
        fail_msg("the text has no '%s'", after);
    char wanted[64], word[64];
    snprintf(wanted, sizeof wanted, "\n%s", begin);
    at = strstr(at, wanted);
    if (!at)
        fail_msg("the text has no line '%s' after '%s'", begin, after);
    at += strlen(wanted);
    int count = 0;
    while (*at && *at != '\n' && count < NUMBERS_MAX) {
        size_t length = 0;
        for (at += strspn(at, " \t|*"); *at && !strchr(" \t|*\n", *at); at++)
            if (!(*at == ',' && thousands) && length + 1 < sizeof word)
                word[length++] = *at == ',' ? '.' : *at;
        word[length] = '\0';
        char *end;
        double value = strtod(word, &end);
        if (end != word)
            numbers[count++] = *end == 'k' ? 1e3 * value : value;
        at += strspn(at, " \t|*");
    }
    return count;
}

static void compare(const char *what, int count, const double *text, const double *ours) {
    for (int i = 0; i < count; i++)
        if (!(fabs(text[i] - ours[i]) <= 1e-9 * fabs(text[i])))
            fail_msg("%s, number %d: the paper has %.10g, the program %.10g", what, i + 1, text[i], ours[i]);
}

static char *paper_or_skip(const char *name) {
    char *text = read_paper(name);
    if (!text) {
        print_message("[  SKIPPED ] ../shared/papers/%s is not at hand\n", name);
        skip();
    }
    return text;
}

static void loefflers_preprocessing_is_as_printed(void **state) {
    (void)state;
    char *text = paper_or_skip("loeffler_hybrid.txt");
    double single[NUMBERS_MAX], quad[NUMBERS_MAX];
    assert_int_equal(read_line(text, "Table 1:", "<i>Single-Core</i>", false, single), 8);
    assert_int_equal(read_line(text, "Table 1:", "<i>Quad-Core</i>", false, quad), 8);
    for (int i = 0; i < 4; i++) {
        const FiguresPreprocess *f = figures_preprocess((1024 << i) + 1);
        assert_non_null(f);
        compare("single core", 2, single + 2 * i, (double[]){f->single_recursive_s, f->single_parallel_s});
        compare("quad core", 2, quad + 2 * i, (double[]){f->quad_recursive_s, f->quad_parallel_s});
    }
    free(text);
}

static void loefflers_triangles_are_as_printed(void **state) {
    (void)state;
    char *text = paper_or_skip("loeffler_hybrid.txt");
    for (int tau = 0; tau < 3; tau++) {
        const char *begin = (const char *[]){"0,5", "1,0", "2,0"}[tau];
        double patch[NUMBERS_MAX], hybrid[NUMBERS_MAX];
        assert_int_equal(read_line(text, "\tPatch-based approach", begin, false, patch), 6);
        assert_int_equal(read_line(text, "\tOur hybrid approach", begin, false, hybrid), 6);
        for (int i = 0; i < 3; i++) {
            const FiguresHybrid *f = figures_hybrid((1024 << i) + 1, 0.5 * (1 << tau));
            assert_non_null(f);
            compare("patch", 2, patch + 2 * i, (double[]){f->patch_fps, f->patch_triangles});
            compare("hybrid", 2, hybrid + 2 * i, (double[]){f->hybrid_fps, f->hybrid_triangles});
        }
    }
    free(text);
}

static void biedermanns_frames_are_as_printed(void **state) {
    (void)state;
    char *text = paper_or_skip("biedermann_uncoupled.txt");
    for (int i = 0; i < FIGURES_UNCOUPLED_COUNT; i++) {
        const FiguresUncoupled *f = &figures_uncoupled[i];
        char begin[16];
        double row[NUMBERS_MAX];
        snprintf(begin, sizeof begin, "%d\t", f->vertices);
        assert_int_equal(read_line(text, "Table 1:", begin, false, row), 3);
        compare(begin, 3, row, (double[]){f->serial_fps, f->parallel_fps, f->increase_percent});
    }
    free(text);
}

static void yalcins_phases_are_as_printed(void **state) {
    (void)state;
    static const struct {
        const char *begin;
        size_t offset;
    } lines[] = {
        {"Gen. Hier.\tTotal time", offsetof(FiguresDiamond, generation_ms)},
        {"\tRoot-Depth", offsetof(FiguresDiamond, generation_root_ms)},
        {"\tMax-Depth", offsetof(FiguresDiamond, generation_deepest_ms)},
        {"Evaluate\tView-Dep.", offsetof(FiguresDiamond, evaluation_ms)},
        {"Closure\tMax. Time", offsetof(FiguresDiamond, closure_max_ms)},
        {"\tView-Dep.", offsetof(FiguresDiamond, closure_ms)},
        {"Gen. Index\tView-Dep.", offsetof(FiguresDiamond, indices_ms)},
        {"Total time (View-Dep.)", offsetof(FiguresDiamond, dynamic_ms)},
        {"Render (fps)\tDynamic", offsetof(FiguresDiamond, dynamic_fps)},
        {"\tStatic", offsetof(FiguresDiamond, static_fps)},
    };
    char *text = paper_or_skip("yalcin_diamonds.txt");
    for (size_t line = 0; line < COUNT_OF(lines); line++) {
        double row[NUMBERS_MAX], ours[4];
        for (int i = 0; i < 4; i++) {
            const FiguresDiamond *f = figures_diamond((512 << i) + 1);
            assert_non_null(f);
            memcpy(&ours[i], (const char *)f + lines[line].offset, sizeof ours[i]);
        }
        assert_int_equal(read_line(text, "9.1. Hierarchy generation", lines[line].begin, true, row), 4);
        compare(lines[line].begin, 4, row, ours);
    }
    free(text);
}

static void expect_phrase(const char *text, const char *format, double number) {
    char phrase[128];
    snprintf(phrase, sizeof phrase, format, number);
    if (!strstr(text, phrase))
        fail_msg("the text has no '%s'", phrase);
}

static void yes_results_are_as_printed(void **state) {
    (void)state;
    char *text = paper_or_skip("ye_static_lod.txt");
    const FiguresStatic *geomipmap = figures_static("geomipmap"), *ye = figures_static("geomipmap-ye");
    const FiguresStatic *roam = figures_static("roam");
    assert_non_null(geomipmap);
    assert_non_null(ye);
    assert_non_null(roam);
    expect_phrase(text, "our version produce %.0f-odd", geomipmap->triangles);
    expect_phrase(text, "and %.0f-odd triangles", ye->triangles);
    expect_phrase(text, "approximately %.0ffps", geomipmap->fps);
    expect_phrase(text, "and %.0ffps", ye->fps);
    expect_phrase(text, "constantly %.0f triangles", roam->triangles);
    expect_phrase(text, "near %.0ffps", roam->fps);
    free(text);
}

static void what_a_paper_has_not_measured_is_not_there(void **state) {
    (void)state;
    assert_null(figures_preprocess(513));
    assert_null(figures_hybrid(8193, 1.0));
    assert_null(figures_hybrid(1025, 4.0));
    assert_null(figures_diamond(8193));
    assert_null(figures_static("hybrid"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(loefflers_preprocessing_is_as_printed),
        cmocka_unit_test(loefflers_triangles_are_as_printed),
        cmocka_unit_test(biedermanns_frames_are_as_printed),
        cmocka_unit_test(yalcins_phases_are_as_printed),
        cmocka_unit_test(yes_results_are_as_printed),
        cmocka_unit_test(what_a_paper_has_not_measured_is_not_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
