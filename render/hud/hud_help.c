// The page of keys: two columns of rows, as the packet gives them.
#include "render/hud/hud_paint.h"

#include <math.h>

// All in pixels, for text of the size `text_px`.
typedef struct HelpPage {
    float text_px, row_px, inset, gap;
    float keys_px, meaning_px; // widest of the rows
    int rows_left;             // in the left column; the rest stands right
} HelpPage;

static HelpPage page_measure(const HudPainter *painter, const RenderHud *hud, float text_px) {
    HelpPage page = {.text_px = text_px, .row_px = text_px * 1.75f, .inset = text_px * 1.6f, .gap = text_px * 1.2f};
    page.rows_left = (hud->help_count + 1) / 2;
    for (int i = 0; i < hud->help_count; i++) {
        page.keys_px = fmaxf(page.keys_px, text_width_px(painter->text, hud->help[i].keys, text_px));
        page.meaning_px = fmaxf(page.meaning_px, text_width_px(painter->text, hud->help[i].meaning, text_px));
    }
    return page;
}

static float page_width(const HelpPage *page) {
    return 2.0f * (page->inset + page->keys_px + page->gap + page->meaning_px) + 2.0f * page->gap;
}

// The title takes two rows.
static float page_height(const HelpPage *page) {
    return 2.0f * page->inset + page->row_px * (float)(page->rows_left + 2);
}

// As large as the display's text, or as the window allows.
static HelpPage page_fit(const HudPainter *painter, const RenderHud *hud) {
    const HudLayout *layout = &painter->layout;
    HelpPage page = page_measure(painter, hud, layout->text_px * 0.9f);
    float room_x = layout->help.x1 - layout->help.x0, room_y = layout->help.y1 - layout->help.y0;
    float scale = fminf(room_x / page_width(&page), room_y / page_height(&page));
    return scale < 1.0f ? page_measure(painter, hud, page.text_px * scale) : page;
}

static void paint_row(const HudPainter *painter, const HelpPage *page, const RenderHelpRow *row, CanvasPoint at) {
    CanvasPoint keys = {at.x, hud_baseline(painter, at.y + page->row_px * 0.5f, page->text_px)};
    CanvasPoint meaning = {at.x + page->keys_px + page->gap, keys.y};
    hud_text(painter, keys, page->text_px, CANVAS_LEFT, HUD_ACCENT, row->keys);
    hud_text(painter, meaning, page->text_px, CANVAS_LEFT, HUD_INK, row->meaning);
}

void hud_paint_help(const HudPainter *painter, const RenderHud *hud) {
    HelpPage page = page_fit(painter, hud);
    CanvasPoint centre = painter->layout.centre;
    float half_x = page_width(&page) * 0.5f, half_y = page_height(&page) * 0.5f;
    CanvasRect box = {roundf(centre.x - half_x), roundf(centre.y - half_y), roundf(centre.x + half_x),
                      roundf(centre.y + half_y)};
    canvas_box(painter->canvas, box, 8.0f * painter->layout.unit, HUD_PLATE_DENSE);
    CanvasPoint title = {box.x0 + page.inset,
                         hud_baseline(painter, box.y0 + page.inset + page.row_px * 0.5f, page.text_px * 1.3f)};
    hud_text(painter, title, page.text_px * 1.3f, CANVAS_LEFT, HUD_DIM, "Overfly \xE2\x80\x93 keys");
    for (int i = 0; i < hud->help_count; i++) {
        bool right = i >= page.rows_left;
        CanvasPoint at = {right ? centre.x + page.gap : box.x0 + page.inset,
                          box.y0 + page.inset + page.row_px * (float)(2 + i - (right ? page.rows_left : 0))};
        paint_row(painter, &page, &hud->help[i], at);
    }
}
