// render/hud/text.h: one typeface as a distance-field atlas, and the measures of text. Knows no GL.
// Lengths are in em (the text size) unless named _px; y grows downwards; texture coordinates 0..1.
// A Text owns its font file and its atlas; one thread at a time.
#pragma once
#include "base/base.h"

#define TEXT_ATLAS_PX 1024       // the atlas is a square of single bytes
#define TEXT_REPLACEMENT 0xFFFDu // stands for what is not valid UTF-8, or not in the font

// The distance at which the atlas' field ends, inside and outside of an outline. A byte b of the atlas means
// (b - 128) / 128 * TEXT_SPREAD_EM, positive inside.
#define TEXT_SPREAD_EM 0.2f

typedef struct TextGlyph {
    float x0, y0, x1, y1; // box of the field around the pen position on the baseline; x1 <= x0: nothing to draw
    float u0, v0, u1, v1; // the same box in the atlas
    float advance;        // > 0
} TextGlyph;

typedef struct Text Text;

// Reads the TrueType file `font_path`. IO: not readable; FORMAT: not a font of this kind; MEMORY.
MUST_USE Result text_create(const char *font_path, Text **out);
void text_destroy(Text **text);

// The glyph of a character, drawn into the atlas when it is first asked for; then without allocation. The replacement
// when the font lacks it or the atlas is full. Lives as long as `text`.
const TextGlyph *text_find_glyph(Text *text, uint32_t character);

// Width of `utf8` on one line, pixels; control characters show as the replacement.
float text_width_px(Text *text, const char *utf8, float size_px);
// Height of capitals and digits above the baseline, em.
float text_cap_height(const Text *text);

// Takes the next character of a UTF-8 string and moves on; 0 at the end. Bytes that are no valid, shortest form of a
// character give TEXT_REPLACEMENT, one at a time.
uint32_t text_next_character(const char **utf8);

// TEXT_ATLAS_PX rows of TEXT_ATLAS_PX bytes; constant place, as long as `text`.
const uint8_t *text_atlas(const Text *text);
// Counts up whenever the atlas changes.
uint64_t text_atlas_revision(const Text *text);
