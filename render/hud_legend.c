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
    bool names = packet->split && hud->show_names;
    return packet->colouring != RENDER_COLOUR_LAND && (hud->show_flight || hud->show_numbers || names);
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

// The numbers that occur among a cut's patches, and those from before.
static void widen(Legend *legend, const LodCut *cut, bool levels) {
    int least = legend->first, end = legend->first + legend->count;
    for (int32_t i = 0; i < cut->item_count; i++) {
        const LodItem *item = &cut->items[i];
        int n = levels ? item->level : item->partition;
        least = end == 0 || n < least ? n : least;
        end = n >= end ? n + 1 : end;
    }
    legend->first = least;
    legend->count = end - least;
}

// Of both cuts, where there are two: the same colour means the same in both.
static Legend legend_of(const RenderPacket *packet) {
    bool levels = packet->colouring == RENDER_COLOUR_LEVEL;
    Legend legend = {levels ? "level in its tile" : "partition", levels ? "level" : "partition", 0, 0};
    widen(&legend, &packet->cut, levels);
    if (packet->split)
        widen(&legend, &packet->right, levels);
    legend.count = legend.count < ENTRIES_MAX ? legend.count : ENTRIES_MAX;
    return legend;
}

// A plate for so many rows below the title, or as many as there is room for.
typedef struct Plate {
    CanvasRect box;
    int rows;
} Plate;

static Plate plate_of(const HudPainter *painter, const RenderPacket *packet, int rows) {
    const HudLayout *layout = &painter->layout;
    CanvasRect room = packet->split ? layout->legend_low : layout->legend;
    float inset = 16.0f * layout->unit;
    int most = (int)((room.y1 - room.y0 - inset) / layout->row_px) - 1;
    rows = rows < most ? rows : most;
    float height = (float)(rows + 1) * layout->row_px + inset;
    float top = packet->split ? room.y1 - height : room.y0;
    return (Plate){{room.x0, top, room.x1, top + height}, rows};
}

static float row_middle(const HudPainter *painter, const Plate *plate, int row) {
    const HudLayout *layout = &painter->layout;
    return plate->box.y0 + 8.0f * layout->unit + ((float)row + 0.5f) * layout->row_px;
}

// Row 0 is the title.
static void paint_entry(const HudPainter *painter, const Plate *plate, int row, CanvasColour colour, const char *text) {
    const HudLayout *layout = &painter->layout;
    if (row > plate->rows)
        return;
    float size = layout->small_px, middle = row_middle(painter, plate, row), x = plate->box.x0 + 10.0f * layout->unit;
    CanvasRect swatch = {roundf(x), roundf(middle - size * 0.42f), roundf(x + size * 1.6f),
                         roundf(middle + size * 0.42f)};
    canvas_box(painter->canvas, swatch, 2.0f * layout->unit, colour);
    CanvasPoint at = {swatch.x1 + size * 0.7f, hud_baseline(painter, middle, size)};
    hud_text(painter, at, size, CANVAS_LEFT, HUD_INK, text);
}

static void paint_states(const HudPainter *painter, const Plate *plate) { // the twin of tint_of in shaders/tint.glsl
    static const float REUSED[3] = {0.10f, 0.22f, 0.10f}, REBUILT[3] = {0.45f, 0.32f, 0.05f},
                       UPLOADED[3] = {0.45f, 0.06f, 0.05f};
    paint_entry(painter, plate, 1, swatch_of(REUSED), "reused");
    paint_entry(painter, plate, 2, swatch_of(REBUILT), "retriangulated");
    paint_entry(painter, plate, 3, swatch_of(UPLOADED), "uploaded now");
}

static void paint_numbered(const HudPainter *painter, const Plate *plate, const Legend *legend) {
    for (int i = 0; i < legend->count; i++) {
        char text[32];
        int n = legend->first + i;
        snprintf(text, sizeof text, "%s %d", legend->entry, n);
        paint_entry(painter, plate, i + 1, cycle_colour(n), text);
    }
}

void hud_paint_legend(const HudPainter *painter, const RenderPacket *packet) {
    const HudLayout *layout = &painter->layout;
    bool states = packet->colouring == RENDER_COLOUR_CACHE;
    Legend legend = states ? (Legend){.title = "patches in this frame", .count = 3} : legend_of(packet);
    Plate plate = plate_of(painter, packet, legend.count);
    if (plate.rows < 0)
        return;
    // Before its entries, whose boxes lie on it.
    canvas_box(painter->canvas, plate.box, 5.0f * layout->unit, HUD_PLATE);
    CanvasPoint at = {plate.box.x0 + 10.0f * layout->unit,
                      hud_baseline(painter, row_middle(painter, &plate, 0), layout->small_px)};
    hud_text(painter, at, layout->small_px, CANVAS_LEFT, HUD_DIM, legend.title);
    if (states)
        paint_states(painter, &plate);
    else
        paint_numbered(painter, &plate, &legend);
}
