// What the colours of patches mean.
#include "render/hud_paint.h"

#include <math.h>
#include <stdio.h>

#define ENTRIES_MAX 12 // of levels and partitions; more of them repeat what the first ones show

typedef struct Legend {
    const char *title, *entry; // `entry`: with the number after it
    int first, count;
} Legend;

bool hud_wants_legend(const RenderPacket *packet) {
    const RenderHud *hud = &packet->hud;
    return packet->colouring != RENDER_COLOUR_LAND && (hud->show_flight || hud->show_numbers);
}

// As a screen shows an albedo in full light.
static CanvasColour swatch_of(const float albedo[3]) {
    float shown[3];
    for (int i = 0; i < 3; i++)
        shown[i] = powf(fminf(albedo[i] * 1.6f, 1.0f), 1.0f / 2.2f);
    return (CanvasColour){shown[0], shown[1], shown[2], 1.0f};
}

// The twin of tint_cycle in shaders/tint.glsl.
static CanvasColour cycle_colour(int n) {
    static const float PHASES[3] = {0.0f, 0.33f, 0.67f};
    float albedo[3];
    for (int i = 0; i < 3; i++)
        albedo[i] = 0.22f + 0.18f * cosf(6.2832f * ((float)n * 0.381966f + PHASES[i]));
    return swatch_of(albedo);
}

// The numbers that occur among the patches.
static Legend legend_of(const RenderPacket *packet) {
    bool levels = packet->colouring == RENDER_COLOUR_LEVEL;
    int least = 0, most = -1;
    for (int32_t i = 0; i < packet->cut.item_count; i++) {
        const LodItem *item = &packet->cut.items[i];
        int n = levels ? item->level : item->partition;
        least = i == 0 || n < least ? n : least;
        most = n > most ? n : most;
    }
    int count = most < least ? 0 : most - least + 1;
    return (Legend){levels ? "level in its tile" : "partition", levels ? "level" : "partition", least,
                    count < ENTRIES_MAX ? count : ENTRIES_MAX};
}

static float row_middle(const HudPainter *painter, int row) {
    const HudLayout *layout = &painter->layout;
    return layout->legend.y0 + 8.0f * layout->unit + ((float)row + 0.5f) * layout->row_px;
}

// Row 0 is the title.
static void paint_entry(const HudPainter *painter, int row, CanvasColour colour, const char *text) {
    const HudLayout *layout = &painter->layout;
    float size = layout->small_px, middle = row_middle(painter, row), x = layout->legend.x0 + 10.0f * layout->unit;
    CanvasRect swatch = {roundf(x), roundf(middle - size * 0.42f), roundf(x + size * 1.6f),
                         roundf(middle + size * 0.42f)};
    canvas_box(painter->canvas, swatch, 2.0f * layout->unit, colour);
    CanvasPoint at = {swatch.x1 + size * 0.7f, hud_baseline(painter, middle, size)};
    hud_text(painter, at, size, CANVAS_LEFT, HUD_INK, text);
}

static void paint_states(const HudPainter *painter) { // the twin of tint_of in shaders/tint.glsl
    static const float REUSED[3] = {0.10f, 0.22f, 0.10f}, REBUILT[3] = {0.45f, 0.32f, 0.05f},
                       UPLOADED[3] = {0.45f, 0.06f, 0.05f};
    paint_entry(painter, 1, swatch_of(REUSED), "reused");
    paint_entry(painter, 2, swatch_of(REBUILT), "retriangulated");
    paint_entry(painter, 3, swatch_of(UPLOADED), "uploaded now");
}

static void paint_numbered(const HudPainter *painter, const Legend *legend) {
    for (int i = 0; i < legend->count; i++) {
        char text[32];
        int n = legend->first + i;
        snprintf(text, sizeof text, "%s %d", legend->entry, n);
        paint_entry(painter, i + 1, cycle_colour(n), text);
    }
}

void hud_paint_legend(const HudPainter *painter, const RenderPacket *packet) {
    const HudLayout *layout = &painter->layout;
    bool states = packet->colouring == RENDER_COLOUR_CACHE;
    CanvasRect plate = layout->legend;
    Legend legend = states ? (Legend){.title = "patches in this frame"} : legend_of(packet);
    int rows = states ? 3 : legend.count;
    plate.y1 = row_middle(painter, rows) + layout->row_px * 0.5f + 8.0f * layout->unit;
    canvas_box(painter->canvas, plate, 5.0f * layout->unit, HUD_PLATE);
    CanvasPoint at = {plate.x0 + 10.0f * layout->unit, hud_baseline(painter, row_middle(painter, 0), layout->small_px)};
    hud_text(painter, at, layout->small_px, CANVAS_LEFT, HUD_DIM, legend.title);
    if (states)
        paint_states(painter);
    else
        paint_numbered(painter, &legend);
}
