// The panel of numbers, and the lines of text at the bottom.
#include "render/hud/hud_paint.h"

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
    hud_paint_row(rows->painter, rows->box, rows->y, &(HudRow){name, value, unit, colour});
    rows->y += rows->painter->layout.row_px;
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

// One cut with what drawing it cost.
typedef struct Side {
    const LodCut *cut;
    const char *method;
    double upload_ms, draw_ms;
    bool governed; // the tolerance is what a frame time affords
} Side;

static Side left_side(const RenderPacket *packet, const RenderStats *drawn) {
    return (Side){&packet->cut, packet->hud.method, drawn->upload_ms, drawn->draw_ms, packet->hud.target_ms > 0.0};
}

static Side right_side(const RenderPacket *packet, const RenderStats *drawn) {
    return (Side){&packet->right, packet->hud.right_method, drawn->right.upload_ms, drawn->right.draw_ms,
                  packet->hud.target_ms > 0.0};
}

static void add_promise(Rows *rows, const LodCut *cut) {
    char text[HUD_NUMBER_BYTES];
    bool raised = cut->reached_px > cut->view.tau_px;
    hud_format_fixed(text, cut->reached_px, 2);
    if (cut->promises)
        add_row(rows, "error at most", text, "px", raised ? HUD_WARN : HUD_INK);
    else
        add_row(rows, "error at most", "no bound", "", HUD_WARN);
}

static void add_tolerance(Rows *rows, const Side *side) {
    add_row(rows, "method", side->method ? side->method : "---", "", HUD_ACCENT);
    add_number(rows, side->governed ? "affords \xCF\x84" : "tolerance \xCF\x84", side->cut->view.tau_px, 2, "px");
    add_promise(rows, side->cut);
}

static void add_size(Rows *rows, const LodStats *stats) {
    add_number(rows, "triangles", (double)stats->triangles, 0, "");
    add_number(rows, "patches", (double)stats->patches, 0, "");
}

static void add_cut(Rows *rows, const LodStats *stats) {
    add_size(rows, stats);
    add_number(rows, "reused", share_percent(stats->patches_reused, stats->patches), 1, "%");
    add_number(rows, "retriangulated", share_percent(stats->triangles_rebuilt, stats->triangles), 1, "%");
}

static void add_partitions(Rows *rows, const LodStats *stats) {
    if (stats->partitions > 0)
        add_number(rows, "partitions", stats->partitions, 0, "");
    if (stats->balance > 0.0)
        add_number(rows, "balance", stats->balance, 2, "");
}

static void add_times(Rows *rows, const Side *side, bool software) {
    add_number(rows, "refine", (double)(side->cut->stats.select_ns + side->cut->stats.refine_ns) * MS_PER_NS, 2, "ms");
    add_number(rows, "upload", side->upload_ms, 2, "ms");
    add_number(rows, software ? "draw (software)" : "draw", side->draw_ms, 2, "ms");
}

// Beside what the tolerance affords: what for. Takes the place of the slowest frames, so that no panel grows.
static void add_target(Rows *rows, const RenderHud *hud) {
    char name[64];
    if (!hud->target_out_of_reach && !hud->target_missed) {
        add_number(rows, "target", hud->target_ms, 1, "ms");
        return;
    }
    snprintf(name, sizeof name, "target %.1f ms", hud->target_ms);
    add_row(rows, name, hud->target_missed ? "not met" : "out of reach", "", HUD_WARN);
}

static void add_frame(Rows *rows, const RenderHud *hud) {
    add_number(rows, "frame", hud->frame_ms, 1, "ms");
    if (hud->target_ms > 0.0)
        add_target(rows, hud);
    else
        add_number(rows, "frame p99", hud->frame_p99_ms, 1, "ms");
}

static void add_memory(Rows *rows, const RenderStats *drawn) {
    add_bytes(rows, "VRAM", (double)drawn->vram_bytes);
    add_bytes(rows, "uploaded", (double)(drawn->upload_bytes + drawn->right.upload_bytes));
}

static Rows begin_panel(const HudPainter *painter, CanvasRect box) {
    return (Rows){painter, box, box.y0 + 8.0f * painter->layout.unit};
}

static void end_panel(Rows *rows) {
    float unit = rows->painter->layout.unit;
    rows->box.y1 = rows->y + 8.0f * unit;
    canvas_box(rows->painter->canvas, rows->box, 5.0f * unit, HUD_PLATE);
}

// What one method tells; who calls adds what both share, and ends the panel.
static Rows paint_side(const HudPainter *painter, CanvasRect box, const Side *side, bool software) {
    Rows rows = begin_panel(painter, box);
    add_tolerance(&rows, side);
    add_gap(&rows);
    add_cut(&rows, &side->cut->stats);
    add_partitions(&rows, &side->cut->stats);
    add_gap(&rows);
    add_times(&rows, side, software);
    add_gap(&rows);
    return rows;
}

static void paint_both(const HudPainter *painter, const RenderPacket *packet, const RenderStats *drawn) {
    Side left = left_side(packet, drawn), right = right_side(packet, drawn);
    Rows rows = paint_side(painter, painter->layout.panel, &left, drawn->software);
    add_frame(&rows, &packet->hud);
    end_panel(&rows);
    rows = paint_side(painter, painter->layout.legend, &right, drawn->software);
    add_memory(&rows, drawn);
    end_panel(&rows);
}

void hud_paint_numbers(const HudPainter *painter, const RenderPacket *packet, const RenderStats *previous) {
    static const RenderStats NOTHING_DRAWN = {0};
    const RenderStats *drawn = previous ? previous : &NOTHING_DRAWN;
    if (packet->split) {
        paint_both(painter, packet, drawn);
        return;
    }
    Side side = left_side(packet, drawn);
    Rows rows = begin_panel(painter, painter->layout.panel);
    add_tolerance(&rows, &side);
    add_gap(&rows);
    add_cut(&rows, &packet->cut.stats);
    add_partitions(&rows, &packet->cut.stats);
    add_gap(&rows);
    add_times(&rows, &side, drawn->software);
    add_frame(&rows, &packet->hud);
    add_gap(&rows);
    add_memory(&rows, drawn);
    end_panel(&rows);
}

static void paint_name(const HudPainter *painter, CanvasRect box, const Side *side) {
    Rows rows = begin_panel(painter, box);
    add_tolerance(&rows, side);
    add_size(&rows, &side->cut->stats);
    end_panel(&rows);
}

void hud_paint_names(const HudPainter *painter, const RenderPacket *packet) {
    static const RenderStats NOTHING_DRAWN = {0};
    Side left = left_side(packet, &NOTHING_DRAWN), right = right_side(packet, &NOTHING_DRAWN);
    paint_name(painter, painter->layout.panel, &left);
    paint_name(painter, painter->layout.legend, &right);
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
        paint_plate(painter, layout->note, HUD_WARN, "crashed \xE2\x80\x93 starting anew in a moment");
    else if (hud->replay.show && hud->show_flight)
        hud_paint_replay(painter, &hud->replay);
    else if (hud->paused)
        paint_plate(painter, layout->note, HUD_INK, "paused \xE2\x80\x93 press p to go on");
    else if (hud->warning)
        paint_plate(painter, layout->note, HUD_WARN, hud->warning);
    if (hud->message && hud->message[0])
        paint_plate(painter, layout->message, HUD_INK, hud->message);
}
