#include "render/hud/hud_paint.h"

#include <math.h>

CanvasColour hud_faded(CanvasColour colour, double opacity) {
    colour.a *= (float)opacity;
    return colour;
}

double hud_fade(double value, double from, double to) {
    double t = fmin(fmax((to - value) / (to - from), 0.0), 1.0);
    return t * t * (3.0 - 2.0 * t);
}

void hud_text(const HudPainter *painter, CanvasPoint baseline, float size_px, CanvasAlign align, CanvasColour colour,
              const char *utf8) {
    CanvasFont font = {.text = painter->text, .size_px = size_px, .align = align, .colour = colour};
    canvas_text(painter->canvas, &font, baseline, utf8);
}

void hud_paint_row(const HudPainter *painter, CanvasRect box, float top, const HudRow *row) {
    const HudLayout *layout = &painter->layout;
    float size = layout->small_px, y = hud_baseline(painter, top + layout->row_px * 0.5f, size);
    float inset = 10.0f * layout->unit, unit_x = box.x1 - inset - size * 1.9f;
    hud_text(painter, (CanvasPoint){box.x0 + inset, y}, size, CANVAS_LEFT, HUD_DIM, row->name);
    float room = unit_x - size * 0.8f - box.x0 - inset - text_width_px(painter->text, row->name, size);
    room = fmaxf(room, size);
    hud_text(painter, (CanvasPoint){unit_x - size * 0.3f, y}, hud_fitting_size(painter, row->value, size, room),
             CANVAS_RIGHT, row->colour, row->value);
    hud_text(painter, (CanvasPoint){unit_x, y}, size, CANVAS_LEFT, HUD_DIM, row->unit);
}

float hud_fitting_size(const HudPainter *painter, const char *utf8, float size_px, float width_px) {
    float width = text_width_px(painter->text, utf8, size_px);
    return width > width_px ? size_px * width_px / width : size_px;
}

float hud_baseline(const HudPainter *painter, float middle_y, float size_px) {
    return roundf(middle_y + text_cap_height(painter->text) * size_px * 0.5f);
}

// What lies over directions lies over those of each half.
static void paint_half(const HudPainter *painter, const RenderPacket *packet, float x0, float x1) {
    HudPainter half = *painter;
    half.layout.centre.x = 0.5f * (x0 + x1);
    half.view.centre_x = (double)half.layout.centre.x;
    hud_paint_attitude(&half, packet);
}

void hud_paint_flight(const HudPainter *painter, const RenderPacket *packet) {
    float width = painter->layout.width, middle = (float)render_left_width((int)width);
    if (packet->split) {
        paint_half(painter, packet, 0.0f, middle);
        paint_half(painter, packet, middle, width);
    } else {
        hud_paint_attitude(painter, packet);
    }
    hud_paint_scales(painter, &packet->hud);
}

static bool has_display(const HudLayout *layout) {
    return layout->width >= HUD_WIDTH_LEAST && layout->height >= HUD_HEIGHT_LEAST;
}

// Below the heading and the states, where these are shown.
void hud_paint_divider(const HudPainter *painter, const RenderPacket *packet) {
    const HudLayout *layout = &painter->layout;
    float x = (float)render_left_width((int)layout->width), width = 1.5f * layout->unit;
    float y = packet->hud.show_flight && has_display(layout) ? layout->states.y1 : 0.0f;
    CanvasColour colour = hud_faded(HUD_INK, 0.8);
    canvas_line(painter->canvas, (CanvasPoint){x, y}, (CanvasPoint){x, layout->height}, width, colour);
}

static bool wants_names(const RenderPacket *packet) {
    return packet->split && packet->hud.show_names && !packet->hud.show_numbers;
}

static bool wants_panels(const RenderPacket *packet) {
    return packet->hud.show_numbers || wants_names(packet) || hud_wants_legend(packet) || packet->hud.accuracy.show;
}

static void paint_panels(const HudPainter *painter, const RenderPacket *packet, const RenderStats *previous) {
    if (painter->layout.panel.x1 <= painter->layout.panel.x0)
        return;
    if (packet->hud.show_numbers)
        hud_paint_numbers(painter, packet, previous);
    if (wants_names(packet))
        hud_paint_names(painter, packet);
    if (hud_wants_legend(packet))
        hud_paint_legend(painter, packet);
}

static bool shows_accuracy(const RenderPacket *packet) {
    return packet->hud.accuracy.show && !packet->hud.show_help;
}

static HudPainter painter_of(Canvas *canvas, Text *text, const RenderPacket *packet, int width, int height) {
    HudPainter painter = {.canvas = canvas,
                          .text = text,
                          .layout = hud_layout_make(width, height, wants_panels(packet)),
                          .view = hud_view_make(&packet->camera, width, height)};
    if (packet->split)
        hud_layout_split(&painter.layout);
    if (shows_accuracy(packet))
        hud_layout_add_accuracy(&painter.layout, packet->split);
    return painter;
}

static void paint_most(const HudPainter *painter, const RenderPacket *packet, const RenderStats *previous) {
    const RenderHud *hud = &packet->hud;
    bool display = has_display(&painter->layout);
    if (display && hud->show_help) {
        hud_paint_help(painter, hud);
        return;
    }
    if (packet->split)
        hud_paint_divider(painter, packet);
    if (!display)
        return;
    if (hud->show_flight)
        hud_paint_flight(painter, packet);
    paint_panels(painter, packet, previous);
    hud_paint_message(painter, hud);
}

void hud_paint_most(Canvas *canvas, Text *text, const RenderPacket *packet, const RenderStats *previous, int width,
                    int height) {
    HudPainter painter = painter_of(canvas, text, packet, width, height);
    canvas_begin(canvas, painter.layout.unit);
    paint_most(&painter, packet, previous);
}

void hud_paint_accuracy_alone(Canvas *canvas, Text *text, const RenderPacket *packet, int width, int height) {
    HudPainter painter = painter_of(canvas, text, packet, width, height);
    canvas_begin(canvas, painter.layout.unit);
    hud_paint_accuracy(&painter, packet);
}

CanvasRect hud_accuracy_place(const RenderPacket *packet, int width, int height) {
    return shows_accuracy(packet) ? painter_of(NULL, NULL, packet, width, height).layout.accuracy : (CanvasRect){0};
}

int hud_accuracy_edge_px(const RenderPacket *packet, int width, int height) {
    return (int)ceilf(HUD_ACCURACY_CORNER * painter_of(NULL, NULL, packet, width, height).layout.unit) + 1;
}

void hud_paint(Canvas *canvas, Text *text, const RenderPacket *packet, const RenderStats *previous, int width,
               int height) {
    HudPainter painter = painter_of(canvas, text, packet, width, height);
    canvas_begin(canvas, painter.layout.unit);
    paint_most(&painter, packet, previous);
    if (shows_accuracy(packet))
        hud_paint_accuracy(&painter, packet);
}
