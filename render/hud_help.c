// The page of keys.
#include "render/hud_paint.h"

#include <math.h>
#include <stddef.h>

typedef struct HelpRow {
    const char *keys, *meaning; // no keys: a heading
} HelpRow;

#define UP_DOWN "\xE2\x86\x91 \xE2\x86\x93"
#define LEFT_RIGHT "\xE2\x86\x90 \xE2\x86\x92"

static const HelpRow FLYING[] = {
    {NULL, "Flying"},
    {UP_DOWN, "nose down, nose up"},
    {LEFT_RIGHT, "roll left, right"},
    {"5", "stick and rudder to the centre"},
    {"0  Enter", "rudder left, right"},
    {"PgUp  PgDn", "throttle"},
    {"P", "pause"},
    {"A  Shift A", "time faster, slower"},
    {"Home", "back to the start"},
    {"Esc", "leave"},
};
static const HelpRow PICTURE[] = {
    {NULL, "Picture"},
    {"X  Shift X", "zoom in, out"},
    {"T  Shift T", "tolerance finer, coarser"},
    {"M", "next method"},
    {"W", "wireframe"},
    {"L", "colours: land, level, cache, partition"},
    {"H", "flight instruments"},
    {"F1", "this page"},
    {"F2", "panel of numbers"},
    {"F3", "screenshot"},
};

typedef struct HelpColumn {
    const HelpRow *rows;
    size_t count;
    float x0, keys_px; // left edge, width of the keys
} HelpColumn;

static void paint_column(const HudPainter *painter, const HelpColumn *column, float top, float row_px) {
    float size = painter->layout.small_px * 1.08f;
    for (size_t i = 0; i < column->count; i++) {
        const HelpRow *row = &column->rows[i];
        float y = hud_baseline(painter, top + row_px * ((float)i + 0.5f), size);
        CanvasPoint keys = {column->x0, y}, meaning = {column->x0 + (row->keys ? column->keys_px : 0.0f), y};
        if (row->keys)
            hud_text(painter, keys, size, CANVAS_LEFT, HUD_ACCENT, row->keys);
        hud_text(painter, meaning, size, CANVAS_LEFT, row->keys ? HUD_INK : HUD_DIM, row->meaning);
    }
}

void hud_paint_help(const HudPainter *painter) {
    const HudLayout *layout = &painter->layout;
    float u = layout->unit, inset = 24.0f * u, gap = 20.0f * u;
    CanvasRect page = layout->help;
    float half = (page.x1 - page.x0 - 2.0f * inset - gap) * 0.5f;
    float row_px = roundf(fminf(30.0f * u, (page.y1 - page.y0 - 2.0f * inset) / (COUNT_OF(FLYING) + 1.5f)));
    canvas_box(painter->canvas, page, 8.0f * u, HUD_PLATE_DENSE);
    float title = hud_baseline(painter, page.y0 + inset + 6.0f * u, layout->text_px * 1.2f);
    hud_text(painter, (CanvasPoint){page.x0 + inset, title}, layout->text_px * 1.2f, CANVAS_LEFT, HUD_INK,
             "Overfly \xE2\x80\x93 keys");
    HelpColumn flying = {FLYING, COUNT_OF(FLYING), page.x0 + inset, 6.4f * layout->small_px};
    HelpColumn picture = {PICTURE, COUNT_OF(PICTURE), page.x0 + inset + half + gap, 6.0f * layout->small_px};
    paint_column(painter, &flying, page.y0 + inset + 26.0f * u, row_px);
    paint_column(painter, &picture, page.y0 + inset + 26.0f * u, row_px);
}
