// Characters, measures and the atlas of render/hud/text.h, and what a canvas makes of them. No GL.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "base/log.h"
#include "base/paths.h"
#include "render/hud/canvas.h"
#include "render/hud/text.h"

static int open_font(void **state) {
    char path[PATHS_BYTES_MAX];
    return paths_find_data("fonts/DejaVuSans.ttf", path) != RESULT_OK || text_create(path, (Text **)state) != RESULT_OK;
}

static int close_font(void **state) {
    text_destroy((Text **)state);
    return *state != NULL;
}

static void expect_characters(const char *utf8, const uint32_t *expected) {
    const char *at = utf8;
    for (int i = 0;; i++) {
        uint32_t character = text_next_character(&at);
        if (character != expected[i])
            print_error("character %d of a text: expected U+%04X, found U+%04X\n", i, expected[i], character);
        assert_int_equal(character, expected[i]);
        if (character == 0)
            break;
    }
    assert_ptr_equal(at, utf8 + strlen(utf8));
}

static void valid_utf8_is_decoded(void **state) {
    (void)state;
    expect_characters("a\xC3\xA9\xCF\x84\xE2\x82\xAC\xF0\x9F\x9B\xA9z",
                      (uint32_t[]){'a', 0xE9, 0x3C4, 0x20AC, 0x1F6E9, 'z', 0});
    expect_characters("", (uint32_t[]){0});
    expect_characters("\xF4\x8F\xBF\xBF", (uint32_t[]){0x10FFFF, 0});
}

// Cases of the Unicode standard, chapter 3.9: overlong forms, surrogates, beyond the last plane, cut off.
static void invalid_utf8_gives_replacements_byte_by_byte(void **state) {
    (void)state;
    const uint32_t r = TEXT_REPLACEMENT;
    expect_characters("\xC0\xAF", (uint32_t[]){r, r, 0});
    expect_characters("\xE0\x80\xAF", (uint32_t[]){r, r, r, 0});
    expect_characters("\xED\xA0\x80", (uint32_t[]){r, r, r, 0});
    expect_characters("\xF4\x90\x80\x80", (uint32_t[]){r, r, r, r, 0});
    expect_characters("\xE2\x82", (uint32_t[]){r, r, 0});
    expect_characters("\xFF"
                      "a",
                      (uint32_t[]){r, 'a', 0});
}

static void digits_are_equally_wide(void **state) {
    Text *text = *state;
    float width = text_width_px(text, "0", 100.0f);
    for (char digit[] = "1"; digit[0] <= '9'; digit[0]++) {
        float other = text_width_px(text, digit, 100.0f);
        if (other != width)
            print_error("digit %s is %.3f wide, 0 is %.3f\n", digit, (double)other, (double)width);
        assert_true(other == width);
    }
    assert_true(text_width_px(text, "00", 50.0f) == width);
}

// Advance widths and cap height of DejaVu Sans 2.37 as its hmtx and OS/2 tables give them, units of 1/2048 em.
static void measures_are_those_of_the_font_file(void **state) {
    Text *text = *state;
    const struct {
        uint32_t character;
        double units;
    } ADVANCES[] = {{'0', 1303}, {'A', 1401}, {'m', 1995}, {' ', 651}, {0x3C4, 1233}};
    for (size_t i = 0; i < COUNT_OF(ADVANCES); i++) {
        double units = (double)text_find_glyph(text, ADVANCES[i].character)->advance * 2048.0;
        print_message("U+%04X: expected %.0f, found %.3f\n", ADVANCES[i].character, ADVANCES[i].units, units);
        assert_true(units > ADVANCES[i].units - 0.01 && units < ADVANCES[i].units + 0.01);
    }
    double cap = (double)text_cap_height(text) * 2048.0;
    print_message("cap height: expected 1493, found %.3f\n", cap);
    assert_true(cap > 1492.9 && cap < 1493.1);
}

// The field's sign says inside or outside: along the middle of an l there is ink, beside it there is none.
static void field_is_positive_inside_the_strokes(void **state) {
    Text *text = *state;
    const TextGlyph *glyph = text_find_glyph(text, 'l');
    int column = (int)((glyph->u0 + glyph->u1) * 0.5f * TEXT_ATLAS_PX),
        row = (int)((glyph->v0 + glyph->v1) * 0.5f * TEXT_ATLAS_PX);
    const uint8_t *line = text_atlas(text) + (size_t)row * TEXT_ATLAS_PX;
    print_message("in the stroke %d, beside it %d\n", line[column], line[(int)(glyph->u0 * TEXT_ATLAS_PX) + 1]);
    assert_true(line[column] > 128);
    assert_true(line[(int)(glyph->u0 * TEXT_ATLAS_PX) + 1] < 64);
}

static void glyphs_are_drawn_once(void **state) {
    Text *text = *state;
    text_width_px(text, "once", 10.0f);
    uint64_t revision = text_atlas_revision(text);
    text_width_px(text, "once", 20.0f);
    assert_int_equal(text_atlas_revision(text), revision);
}

static void a_full_atlas_gives_replacements(void **state) {
    Text *text = *state;
    float replacement = text_find_glyph(text, TEXT_REPLACEMENT)->advance;
    for (uint32_t character = 0x20; character < 0x3000; character++)
        assert_true(text_find_glyph(text, character)->advance >= 0.0f);
    assert_true(text_find_glyph(text, 0x2FFF)->advance == replacement);
    assert_true(text_width_px(text, "0", 2048.0f) > 1302.0f);
}

static void what_is_no_font_is_refused(void **state) {
    (void)state;
    Text *text = NULL;
    log_set_level(LOG_ERROR);
    assert_int_equal(text_create("/nonexistent/font.ttf", &text), RESULT_IO);
    assert_int_equal(text_create(SOURCE_DIR "/tests/test_text.c", &text), RESULT_FORMAT);
    assert_null(text);
}

static void text_is_placed_by_its_alignment(void **state) {
    Text *text = *state;
    Canvas *canvas;
    assert_int_equal(canvas_create(&canvas), RESULT_OK);
    const CanvasAlign ALIGNS[] = {CANVAS_LEFT, CANVAS_CENTRE, CANVAS_RIGHT};
    float width = text_width_px(text, "lol", 20.0f), left[3];
    for (int i = 0; i < 3; i++) {
        canvas_begin(canvas, 1.0f);
        CanvasFont font = {text, 20.0f, ALIGNS[i], {1, 1, 1, 1}};
        canvas_text(canvas, &font, (CanvasPoint){100.0f, 50.0f}, "lol");
        const CanvasShape *shapes;
        assert_int_equal(canvas_over(canvas, &shapes), 3);
        left[i] = shapes[0].a[0];
    }
    print_message("left ends %.2f %.2f %.2f, width %.2f\n", (double)left[0], (double)left[1], (double)left[2],
                  (double)width);
    assert_float_equal(left[0] - left[1], width * 0.5f, 1e-3f);
    assert_float_equal(left[0] - left[2], width, 1e-3f);
    canvas_destroy(&canvas);
}

static void shapes_without_ink_are_left_out(void **state) {
    (void)state;
    Canvas *canvas;
    const CanvasShape *shapes;
    const CanvasColour clear = {1, 1, 1, 0}, ink = {1, 1, 1, 1};
    assert_int_equal(canvas_create(&canvas), RESULT_OK);
    canvas_begin(canvas, 1.0f);
    canvas_line(canvas, (CanvasPoint){0, 0}, (CanvasPoint){9, 9}, 1.0f, clear);
    canvas_line(canvas, (CanvasPoint){0, 0}, (CanvasPoint){INFINITY, 9}, 1.0f, ink);
    canvas_box(canvas, (CanvasRect){0, 0, 9, 9}, 1.0f, clear);
    assert_int_equal(canvas_over(canvas, &shapes), 0);
    assert_int_equal(canvas_under(canvas, &shapes), 0);
    canvas_destroy(&canvas);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(valid_utf8_is_decoded),
        cmocka_unit_test(invalid_utf8_gives_replacements_byte_by_byte),
        cmocka_unit_test_setup_teardown(digits_are_equally_wide, open_font, close_font),
        cmocka_unit_test_setup_teardown(measures_are_those_of_the_font_file, open_font, close_font),
        cmocka_unit_test_setup_teardown(field_is_positive_inside_the_strokes, open_font, close_font),
        cmocka_unit_test_setup_teardown(glyphs_are_drawn_once, open_font, close_font),
        cmocka_unit_test_setup_teardown(a_full_atlas_gives_replacements, open_font, close_font),
        cmocka_unit_test(what_is_no_font_is_refused),
        cmocka_unit_test_setup_teardown(text_is_placed_by_its_alignment, open_font, close_font),
        cmocka_unit_test(shapes_without_ink_are_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
