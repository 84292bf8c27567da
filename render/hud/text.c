#include "render/hud/text.h"

#include "base/log.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STBTT_STATIC
#define STB_TRUETYPE_IMPLEMENTATION
#include <stb/stb_truetype.h>

#define GLYPH_EM_PX 40.0f // size at which fields are drawn: thin strokes are 3 to 4 samples wide
#define GLYPHS_MAX 1024   // a power of two
#define FONT_BYTES_MAX (64l << 20)

typedef struct Slot {
    uint32_t character; // 0: free
    TextGlyph glyph;
} Slot;

struct Text {
    unsigned char *file;
    stbtt_fontinfo font;
    float scale; // font units to atlas pixels
    float cap_height;
    int shelf_x, shelf_y, shelf_height; // atlas pixels; glyphs are put side by side on shelves
    uint64_t revision;
    int glyph_count;
    TextGlyph replacement;
    Slot slots[GLYPHS_MAX]; // open addressing by character
    uint8_t atlas[TEXT_ATLAS_PX * TEXT_ATLAS_PX];
};

static Result read_bytes(FILE *file, const char *path, unsigned char **out) {
    long size = fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    if (size <= 0 || size > FONT_BYTES_MAX || fseek(file, 0, SEEK_SET) != 0) {
        log_error("%s: expected a font of 1 byte to %ld MiB, found %ld bytes", path, FONT_BYTES_MAX >> 20, size);
        return RESULT_FORMAT;
    }
    unsigned char *bytes = malloc((size_t)size);
    if (!bytes) {
        log_error("%s: no memory for %ld bytes of font", path, size);
        return RESULT_MEMORY;
    }
    if (fread(bytes, 1, (size_t)size, file) != (size_t)size) {
        log_error("%s: reading %ld bytes failed: %s", path, size, strerror(errno));
        free(bytes);
        return RESULT_IO;
    }
    *out = bytes;
    return RESULT_OK;
}

static Result read_file(const char *path, unsigned char **out) {
    FILE *file = fopen(path, "rb");
    if (!file) {
        log_error("%s: cannot open the font: %s; the package fonts-dejavu-core brings DejaVuSans.ttf", path,
                  strerror(errno));
        return RESULT_IO;
    }
    Result result = read_bytes(file, path, out);
    fclose(file);
    return result;
}

// True when the shelf, or a new one below it, has room.
static bool place_on_shelf(Text *text, int width, int height, int *x, int *y) {
    if (text->shelf_x + width > TEXT_ATLAS_PX) {
        text->shelf_x = 0;
        text->shelf_y += text->shelf_height;
        text->shelf_height = 0;
    }
    if (width > TEXT_ATLAS_PX || text->shelf_y + height > TEXT_ATLAS_PX)
        return false;
    *x = text->shelf_x;
    *y = text->shelf_y;
    text->shelf_x += width;
    text->shelf_height = height > text->shelf_height ? height : text->shelf_height;
    return true;
}

static void copy_field(Text *text, const unsigned char *field, int width, int height, int x, int y) {
    for (int row = 0; row < height; row++)
        memcpy(&text->atlas[(y + row) * TEXT_ATLAS_PX + x], field + row * width, (size_t)width);
    text->revision++;
}

static float advance_of(const Text *text, int index) {
    int advance, bearing;
    stbtt_GetGlyphHMetrics(&text->font, index, &advance, &bearing);
    return (float)advance * text->scale / GLYPH_EM_PX;
}

// False when the atlas is full or memory is short; then the glyph has its advance only.
static bool draw_glyph(Text *text, int index, TextGlyph *glyph) {
    *glyph = (TextGlyph){.advance = advance_of(text, index)};
    if (stbtt_IsGlyphEmpty(&text->font, index))
        return true;
    int width, height, left, top, x, y;
    int padding = (int)ceilf(TEXT_SPREAD_EM * GLYPH_EM_PX);
    float step = 128.0f / (TEXT_SPREAD_EM * GLYPH_EM_PX);
    unsigned char *field =
        stbtt_GetGlyphSDF(&text->font, text->scale, index, padding, 128, step, &width, &height, &left, &top);
    bool placed = field && place_on_shelf(text, width, height, &x, &y);
    if (placed) {
        copy_field(text, field, width, height, x, y);
        *glyph = (TextGlyph){.x0 = (float)left / GLYPH_EM_PX,
                             .y0 = (float)top / GLYPH_EM_PX,
                             .x1 = (float)(left + width) / GLYPH_EM_PX,
                             .y1 = (float)(top + height) / GLYPH_EM_PX,
                             .u0 = (float)x / TEXT_ATLAS_PX,
                             .v0 = (float)y / TEXT_ATLAS_PX,
                             .u1 = (float)(x + width) / TEXT_ATLAS_PX,
                             .v1 = (float)(y + height) / TEXT_ATLAS_PX,
                             .advance = glyph->advance};
    }
    stbtt_FreeSDF(field, NULL);
    return placed;
}

static float measure_cap_height(const Text *text) {
    int x0, y0, x1, y1 = 0;
    if (!stbtt_GetCodepointBox(&text->font, 'H', &x0, &y0, &x1, &y1))
        return 0.73f; // as most typefaces of this kind
    return (float)y1 * text->scale / GLYPH_EM_PX;
}

static Result open_font(Text *text, const char *path) {
    int offset = stbtt_GetFontOffsetForIndex(text->file, 0);
    if (offset < 0 || !stbtt_InitFont(&text->font, text->file, offset)) {
        log_error("%s: expected a TrueType font, found something else; name another file", path);
        return RESULT_FORMAT;
    }
    text->scale = stbtt_ScaleForMappingEmToPixels(&text->font, GLYPH_EM_PX);
    text->cap_height = measure_cap_height(text);
    int index = stbtt_FindGlyphIndex(&text->font, (int)TEXT_REPLACEMENT);
    draw_glyph(text, index, &text->replacement);
    return RESULT_OK;
}

Result text_create(const char *font_path, Text **out) {
    Text *text = calloc(1, sizeof *text);
    if (!text) {
        log_error("no memory for the text atlas of %zu bytes", sizeof *text);
        return RESULT_MEMORY;
    }
    Result result = read_file(font_path, &text->file);
    if (result != RESULT_OK)
        goto fail;
    result = open_font(text, font_path);
    if (result != RESULT_OK)
        goto fail;
    *out = text;
    return RESULT_OK;
fail:
    text_destroy(&text);
    return result;
}

void text_destroy(Text **text) {
    if (!*text)
        return;
    free((*text)->file);
    free(*text);
    *text = NULL;
}

// The slot that holds the character, or the free one where it belongs.
static Slot *find_slot(Text *text, uint32_t character) {
    uint32_t at = character * 2654435761u >> 22; // the upper 10 bits of a multiplicative hash
    while (text->slots[at].character != 0 && text->slots[at].character != character)
        at = (at + 1) % GLYPHS_MAX;
    return &text->slots[at];
}

static TextGlyph make_glyph(Text *text, uint32_t character) {
    int index = stbtt_FindGlyphIndex(&text->font, (int)character);
    TextGlyph glyph;
    if (index == 0 || !draw_glyph(text, index, &glyph))
        return text->replacement;
    return glyph;
}

const TextGlyph *text_find_glyph(Text *text, uint32_t character) {
    Slot *slot = find_slot(text, character);
    if (slot->character == character && character != 0)
        return &slot->glyph;
    // One slot in eight stays free, so that searches stay short and always end.
    if (character == 0 || text->glyph_count >= GLYPHS_MAX / 8 * 7)
        return &text->replacement;
    text->glyph_count++;
    *slot = (Slot){.character = character, .glyph = make_glyph(text, character)};
    return &slot->glyph;
}

float text_width_px(Text *text, const char *utf8, float size_px) {
    float width = 0.0f;
    for (uint32_t character; (character = text_next_character(&utf8)) != 0;)
        width += text_find_glyph(text, character)->advance;
    return width * size_px;
}

float text_cap_height(const Text *text) {
    return text->cap_height;
}

// Number of bytes that follow the first one, or -1.
static int count_followers(unsigned char first) {
    if (first < 0x80)
        return 0;
    if (first >= 0xC2 && first < 0xE0)
        return 1;
    if (first >= 0xE0 && first < 0xF0)
        return 2;
    return first >= 0xF0 && first < 0xF5 ? 3 : -1;
}

static bool is_character(uint32_t value, int followers) {
    static const uint32_t LEAST[] = {0, 0x80, 0x800, 0x10000};
    bool surrogate = value >= 0xD800 && value < 0xE000;
    return value >= LEAST[followers] && value <= 0x10FFFF && !surrogate;
}

uint32_t text_next_character(const char **utf8) {
    const unsigned char *bytes = (const unsigned char *)*utf8;
    if (bytes[0] == 0)
        return 0;
    *utf8 += 1;
    int followers = count_followers(bytes[0]);
    if (followers <= 0)
        return followers == 0 ? bytes[0] : TEXT_REPLACEMENT;
    uint32_t value = bytes[0] & (0x3Fu >> followers);
    for (int i = 1; i <= followers; i++) {
        if ((bytes[i] & 0xC0) != 0x80) // the terminating zero as well
            return TEXT_REPLACEMENT;
        value = value << 6 | (bytes[i] & 0x3Fu);
    }
    if (!is_character(value, followers))
        return TEXT_REPLACEMENT;
    *utf8 += followers;
    return value;
}

const uint8_t *text_atlas(const Text *text) {
    return text->atlas;
}

uint64_t text_atlas_revision(const Text *text) {
    return text->revision;
}
