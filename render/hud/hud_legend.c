// What the colours of patches mean.
#include "render/hud/hud_paint.h"
#include "terrain/diamond/diamond.h"

#include <math.h>
#include <stdio.h>

#define NUMBERS 256 // of levels, and of partitions

typedef struct Legend {
    const char *title, *entry; // `entry`: with the number after it
    int count;
    uint8_t numbers[NUMBERS]; // that occur, ascending
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

static void mark_numbers(const LodCut *cut, bool levels, bool occurs[NUMBERS]) {
    for (int32_t i = 0; i < cut->item_count; i++)
        occurs[(levels ? cut->items[i].level : cut->items[i].partition) % NUMBERS] = true;
    // Of resident cuts only the GPU knows which triangles there are.
    for (int n = 0; cut->resident && levels && n <= 2 * cut->resident->model->layout.level_count; n++)
        occurs[n] = true;
}

// The numbers that occur among a cut's patches, and another's if there is one.
static Legend legend_of(const LodCut *cut, const LodCut *other, bool levels) {
    Legend legend = {.title = levels ? "level in its tile" : "partition", .entry = levels ? "level" : "partition"};
    bool occurs[NUMBERS] = {false};
    mark_numbers(cut, levels, occurs);
    if (other)
        mark_numbers(other, levels, occurs);
    for (int n = 0; n < NUMBERS; n++)
        if (occurs[n])
            legend.numbers[legend.count++] = (uint8_t)n;
    return legend;
}

// A plate for so many rows below the title, or as many as there is room for.
typedef struct Plate {
    CanvasRect box;
    int rows;
} Plate;

// `low`: its lower edge stays.
static Plate plate_of(const HudPainter *painter, CanvasRect room, bool low, int rows) {
    const HudLayout *layout = &painter->layout;
    float inset = 16.0f * layout->unit;
    int most = (int)((room.y1 - room.y0 - inset) / layout->row_px) - 1;
    rows = rows < most ? rows : most;
    float height = (float)(rows + 1) * layout->row_px + inset, top = low ? room.y1 - height : room.y0;
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

// Where not all have room, the last ones: the levels close to the eye.
static void paint_numbered(const HudPainter *painter, const Plate *plate, const Legend *legend) {
    int skipped = legend->count - plate->rows;
    for (int row = 1; row <= plate->rows; row++) {
        char text[32];
        int n = legend->numbers[skipped + row - 1];
        snprintf(text, sizeof text, "%s %d", legend->entry, n);
        paint_entry(painter, plate, row, cycle_colour(n), text);
    }
}

// What is explained: one cut, or two together; in which colours and where.
typedef struct Explained {
    const LodCut *cut, *other; // `other` may be NULL
    RenderColouring colouring;
    CanvasRect room;
    bool low;
} Explained;

static void paint_cut(const HudPainter *painter, const Explained *explained) {
    RenderColouring colouring = explained->colouring;
    const HudLayout *layout = &painter->layout;
    bool states = colouring == RENDER_COLOUR_CACHE;
    Legend legend = states ? (Legend){.title = "patches in this frame", .count = 3}
                           : legend_of(explained->cut, explained->other, colouring == RENDER_COLOUR_LEVEL);
    Plate plate = plate_of(painter, explained->room, explained->low, legend.count);
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

void hud_paint_legend(const HudPainter *painter, const RenderPacket *packet) {
    const HudLayout *layout = &painter->layout;
    if (!packet->split) {
        paint_cut(painter, &(Explained){&packet->cut, NULL, packet->colouring, layout->legend, false});
        return;
    }
    CanvasRect left = layout->legend_low, right = {layout->width - left.x1, left.y0, layout->width - left.x0, left.y1};
    // Where accuracy has the left one's place, the right one tells of both.
    bool alone = layout->accuracy.x1 <= layout->accuracy.x0;
    if (alone)
        paint_cut(painter, &(Explained){&packet->cut, NULL, packet->colouring, left, true});
    paint_cut(painter, &(Explained){&packet->right, alone ? NULL : &packet->cut, packet->colouring, right, true});
}
