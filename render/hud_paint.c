#include "render/hud_paint.h"

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

float hud_fitting_size(const HudPainter *painter, const char *utf8, float size_px, float width_px) {
    float width = text_width_px(painter->text, utf8, size_px);
    return width > width_px ? size_px * width_px / width : size_px;
}

float hud_baseline(const HudPainter *painter, float middle_y, float size_px) {
    return roundf(middle_y + text_cap_height(painter->text) * size_px * 0.5f);
}

void hud_paint_flight(const HudPainter *painter, const RenderPacket *packet) {
    hud_paint_attitude(painter, packet);
    hud_paint_scales(painter, &packet->hud);
}

void hud_paint(Canvas *canvas, Text *text, const RenderPacket *packet, const RenderStats *previous, int width,
               int height) {
    const RenderHud *hud = &packet->hud;
    HudPainter painter = {.canvas = canvas,
                          .text = text,
                          .layout = hud_layout_make(width, height, hud->show_numbers || hud_wants_legend(packet)),
                          .view = hud_view_make(&packet->camera, width, height)};
    canvas_begin(canvas, painter.layout.unit);
    if (hud->show_help) {
        hud_paint_help(&painter, hud);
        return;
    }
    if (hud->show_flight)
        hud_paint_flight(&painter, packet);
    bool room = painter.layout.panel.x1 > painter.layout.panel.x0;
    if (hud->show_numbers && room)
        hud_paint_numbers(&painter, packet, previous);
    if (hud_wants_legend(packet) && room)
        hud_paint_legend(&painter, packet);
    hud_paint_message(&painter, hud);
}
