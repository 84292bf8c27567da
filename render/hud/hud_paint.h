// render/hud/hud_paint.h: paint the head-up display onto a canvas. No GL: hud.c draws the canvas, tests look at it.
// Pixels; radians, metres, seconds as in render/render.h.
// Everything is borrowed for the call. One thread at a time for a Canvas and its Text.
#pragma once
#include "render/hud/canvas.h"
#include "render/hud/hud_layout.h"
#include "render/render.h"

typedef struct HudPainter {
    Canvas *canvas;
    Text *text;
    HudLayout layout;
    HudView view;
} HudPainter;

// All of it, as hud_draw does. `previous` may be NULL.
void hud_paint(Canvas *canvas, Text *text, const RenderPacket *packet, const RenderStats *previous, int width,
               int height);
// The same in two: all but the panel of accuracy against time, and that panel alone. `place`: where it lies; empty: it
// is not shown.
void hud_paint_most(Canvas *canvas, Text *text, const RenderPacket *packet, const RenderStats *previous, int width,
                    int height);
void hud_paint_accuracy_alone(Canvas *canvas, Text *text, const RenderPacket *packet, int width, int height);
CanvasRect hud_accuracy_place(const RenderPacket *packet, int width, int height);
// Rows at its top and bottom where it has round corners; it is opaque between.
#define HUD_ACCURACY_CORNER 5.0f // units
int hud_accuracy_edge_px(const RenderPacket *packet, int width, int height);

// The parts.
void hud_paint_flight(const HudPainter *painter, const RenderPacket *packet);   // with the following two
void hud_paint_attitude(const HudPainter *painter, const RenderPacket *packet); // hud_attitude.c
void hud_paint_map(const HudPainter *painter, const RenderPacket *packet);      // hud_map.c
void hud_paint_scales(const HudPainter *painter, const RenderHud *hud);         // hud_scales.c, with the next one
void hud_paint_states(const HudPainter *painter, const RenderHud *hud);         // hud_states.c
void hud_paint_numbers(const HudPainter *painter, const RenderPacket *packet,
                       const RenderStats *previous);                           // hud_panel.c
void hud_paint_names(const HudPainter *painter, const RenderPacket *packet);   // the same without times
void hud_paint_divider(const HudPainter *painter, const RenderPacket *packet); // between the halves of a split picture
// Whether there are colours to explain.
bool hud_wants_legend(const RenderPacket *packet);
void hud_paint_legend(const HudPainter *painter, const RenderPacket *packet);   // hud_legend.c
void hud_paint_accuracy(const HudPainter *painter, const RenderPacket *packet); // hud_accuracy.c
void hud_paint_message(const HudPainter *painter, const RenderHud *hud);
void hud_paint_replay(const HudPainter *painter, const RenderReplay *replay); // hud_replay.c
void hud_paint_help(const HudPainter *painter, const RenderHud *hud);         // hud_help.c

// What they share: colours of the display, and text.
#define HUD_INK ((CanvasColour){0.93f, 0.98f, 0.95f, 1.0f})
#define HUD_DIM ((CanvasColour){0.78f, 0.86f, 0.84f, 0.95f})
#define HUD_ACCENT ((CanvasColour){0.45f, 0.95f, 0.62f, 1.0f})
#define HUD_WARN ((CanvasColour){1.0f, 0.76f, 0.30f, 1.0f})
#define HUD_PLATE ((CanvasColour){0.03f, 0.06f, 0.08f, 0.52f})
#define HUD_PLATE_DENSE ((CanvasColour){0.03f, 0.06f, 0.08f, 0.78f})
#define HUD_PLATE_OPAQUE ((CanvasColour){0.08f, 0.11f, 0.15f, 1.0f}) // as the one before over land and sky

CanvasColour hud_faded(CanvasColour colour, double opacity); // opacity 0..1 times what it was
// 1 below `from`, 0 above `to`, smooth between.
double hud_fade(double value, double from, double to);
// `baseline`: as for canvas_text.
void hud_text(const HudPainter *painter, CanvasPoint baseline, float size_px, CanvasAlign align, CanvasColour colour,
              const char *utf8);
// A line of a panel: a name on the left, a value and its unit on the right.
typedef struct HudRow {
    const char *name, *value, *unit;
    CanvasColour colour; // of the value
} HudRow;
// `top`: of the row in the panel's `box`.
void hud_paint_row(const HudPainter *painter, CanvasRect box, float top, const HudRow *row);
// `size_px`, or less where the text would be wider than `width_px`.
float hud_fitting_size(const HudPainter *painter, const char *utf8, float size_px, float width_px);
// The baseline that centres capitals and digits of this size on `middle_y`, on a whole pixel.
float hud_baseline(const HudPainter *painter, float middle_y, float size_px);

// Numbers as text, always ended; "---" for what is not finite. The thousands are apart by thin spaces.
#define HUD_NUMBER_BYTES 48
void hud_format_fixed(char out[HUD_NUMBER_BYTES], double value, int decimals);
void hud_format_signed(char out[HUD_NUMBER_BYTES], double value, int decimals); // a real minus, a plus above zero
void hud_format_heading(char out[HUD_NUMBER_BYTES], double heading_rad);        // "001" .. "360"
// Bytes as B, kB, MB or GB of 1000s.
void hud_format_bytes(char out[HUD_NUMBER_BYTES], double bytes, const char **unit);
