// The panel of numbers, and the lines of text at the bottom.
#include "render/hud_paint.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define ELLIPSIS "\xE2\x80\xA6"
#define MS_PER_NS 1e-6

// Where the panel's next row goes.
typedef struct Rows {
    const HudPainter *painter;
    CanvasRect box;
    float y; // top of the next row
} Rows;

static void add_row(Rows *rows, const char *name, const char *value, const char *unit, CanvasColour colour) {
    const HudLayout *layout = &rows->painter->layout;
    float size = layout->small_px, y = hud_baseline(rows->painter, rows->y + layout->row_px * 0.5f, size);
    float inset = 10.0f * layout->unit, unit_x = rows->box.x1 - inset - size * 1.9f;
    hud_text(rows->painter, (CanvasPoint){rows->box.x0 + inset, y}, size, CANVAS_LEFT, HUD_DIM, name);
    hud_text(rows->painter, (CanvasPoint){unit_x - size * 0.3f, y}, size, CANVAS_RIGHT, colour, value);
    hud_text(rows->painter, (CanvasPoint){unit_x, y}, size, CANVAS_LEFT, HUD_DIM, unit);
    rows->y += layout->row_px;
}

static void add_number(Rows *rows, const char *name, double value, int decimals, const char *unit) {
    char text[HUD_NUMBER_BYTES];
    hud_format_fixed(text, value, decimals);
    add_row(rows, name, text, unit, HUD_INK);
}

static void add_bytes(Rows *rows, const char *name, double bytes) {
    char text[HUD_NUMBER_BYTES];
    const char *unit;
    hud_format_bytes(text, bytes, &unit);
    add_row(rows, name, text, unit, HUD_INK);
}

static void add_gap(Rows *rows) {
    rows->y += rows->painter->layout.row_px * 0.5f;
}

static double share_percent(int64_t part, int64_t whole) {
    return whole > 0 ? 100.0 * (double)part / (double)whole : 0.0;
}

static void add_tolerance(Rows *rows, const LodCut *cut, const char *method) {
    add_row(rows, "method", method ? method : "---", "", HUD_ACCENT);
    add_number(rows, "tolerance \xCF\x84", cut->view.tau_px, 2, "px");
    if (cut->reached_px > cut->view.tau_px) {
        char text[HUD_NUMBER_BYTES];
        hud_format_fixed(text, cut->reached_px, 2);
        add_row(rows, "reached", text, "px", HUD_WARN);
    }
}

static void add_cut(Rows *rows, const LodStats *stats) {
    add_number(rows, "triangles", (double)stats->triangles, 0, "");
    add_number(rows, "patches", (double)stats->patches, 0, "");
    add_number(rows, "reused", share_percent(stats->patches_reused, stats->patches), 1, "%");
    add_number(rows, "retriangulated", share_percent(stats->triangles_rebuilt, stats->triangles), 1, "%");
}

static void add_times(Rows *rows, const LodStats *cut, const RenderStats *drawn, const RenderHud *hud) {
    add_number(rows, "refine", (double)(cut->select_ns + cut->refine_ns) * MS_PER_NS, 2, "ms");
    add_number(rows, "upload", drawn->upload_ms, 2, "ms");
    add_number(rows, drawn->software ? "draw (software)" : "draw", drawn->draw_ms, 2, "ms");
    add_number(rows, "frame", hud->frame_ms, 1, "ms");
    add_number(rows, "frame p99", hud->frame_p99_ms, 1, "ms");
}

void hud_paint_numbers(const HudPainter *painter, const RenderPacket *packet, const RenderStats *previous) {
    static const RenderStats NOTHING_DRAWN = {0};
    const RenderStats *drawn = previous ? previous : &NOTHING_DRAWN;
    Rows rows = {painter, painter->layout.panel, painter->layout.panel.y0 + 8.0f * painter->layout.unit};
    add_tolerance(&rows, &packet->cut, packet->hud.method);
    add_gap(&rows);
    add_cut(&rows, &packet->cut.stats);
    add_gap(&rows);
    add_times(&rows, &packet->cut.stats, drawn, &packet->hud);
    add_gap(&rows);
    add_bytes(&rows, "VRAM", (double)drawn->vram_bytes);
    add_bytes(&rows, "uploaded", (double)drawn->upload_bytes);
    rows.box.y1 = rows.y + 8.0f * painter->layout.unit;
    canvas_box(painter->canvas, rows.box, 5.0f * painter->layout.unit, HUD_PLATE);
}

// Copies what fits into `width_px`, with an ellipsis where something is left out.
static void fit_text(const HudPainter *painter, const char *text, float size_px, float width_px, char *out,
                     size_t bytes) {
    float room = width_px - text_width_px(painter->text, ELLIPSIS, size_px), used = 0.0f;
    size_t kept = 0;
    const char *at = text;
    for (uint32_t character; (character = text_next_character(&at)) != 0;) {
        used += text_find_glyph(painter->text, character)->advance * size_px;
        if (used <= room && (size_t)(at - text) + sizeof ELLIPSIS <= bytes)
            kept = (size_t)(at - text);
    }
    bool whole = used <= width_px && (size_t)(at - text) < bytes;
    snprintf(out, bytes, "%.*s%s", whole ? (int)(at - text) : (int)kept, text, whole ? "" : ELLIPSIS);
}

static void paint_plate(const HudPainter *painter, CanvasRect area, CanvasColour colour, const char *text) {
    char line[512];
    float u = painter->layout.unit, size = painter->layout.text_px * 0.9f, inset = 14.0f * u;
    fit_text(painter, text, size, area.x1 - area.x0 - 2.0f * inset, line, sizeof line);
    float half = text_width_px(painter->text, line, size) * 0.5f + inset, x = (area.x0 + area.x1) * 0.5f;
    CanvasRect plate = {roundf(x - half), area.y0, roundf(x + half), area.y1};
    canvas_box(painter->canvas, plate, 5.0f * u, HUD_PLATE_DENSE);
    CanvasPoint at = {x, hud_baseline(painter, (area.y0 + area.y1) * 0.5f, size)};
    hud_text(painter, at, size, CANVAS_CENTRE, colour, line);
}

void hud_paint_message(const HudPainter *painter, const RenderHud *hud) {
    const HudLayout *layout = &painter->layout;
    if (hud->crashed)
        paint_plate(painter, layout->note, HUD_WARN, "crashed \xE2\x80\x93 back in the air in a moment");
    else if (hud->paused)
        paint_plate(painter, layout->note, HUD_INK, "paused \xE2\x80\x93 press p to go on");
    if (hud->message && hud->message[0])
        paint_plate(painter, layout->message, HUD_INK, hud->message);
}
