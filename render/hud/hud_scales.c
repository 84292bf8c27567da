// The scales around the circle: heading on top, airspeed left, altitude right, and the lines of text by them.
#include "render/hud/hud_paint.h"

#include "terrain/geodesy.h"

#include <math.h>
#include <stdio.h>

#define RAD GEODESY_RAD_PER_DEG
#define LINE 1.4f          // units, width of marks
#define HEADING_STEP_DEG 5 // between marks; every second one is tall, every sixth has a label
#define HEADING_SPACE 5.2  // units a degree
#define DEG_PER_RAD 57.29577951308232
#define KMH_PER_M_S 3.6

static float middle_of(float a, float b) {
    return (a + b) * 0.5f;
}

static void paint_readout(const HudPainter *painter, CanvasRect box, const char *value, CanvasColour colour) {
    float u = painter->layout.unit, room = box.x1 - box.x0 - 8.0f * u;
    float size = hud_fitting_size(painter, value, roundf(painter->layout.text_px * 1.12f), room);
    canvas_box(painter->canvas, box, 4.0f * u, HUD_PLATE_DENSE);
    canvas_frame(painter->canvas, box, 4.0f * u, 1.2f * u, hud_faded(colour, 0.75));
    CanvasPoint at = {middle_of(box.x0, box.x1), hud_baseline(painter, middle_of(box.y0, box.y1), size)};
    hud_text(painter, at, size, CANVAS_CENTRE, colour, value);
}

static const char *heading_label(int degrees, char out[8]) {
    static const char *const POINTS[] = {"N", "E", "S", "W"};
    if (degrees % 90 == 0)
        return POINTS[degrees / 90];
    snprintf(out, 8, "%03d", degrees % 360);
    return out;
}

static void paint_heading_mark(const HudPainter *painter, int degrees, float x, double opacity) {
    const HudLayout *layout = &painter->layout;
    float u = layout->unit, top = layout->heading.y0 + 34.0f * u, length = degrees % 10 == 0 ? 9.0f * u : 5.0f * u;
    canvas_line(painter->canvas, (CanvasPoint){x, top}, (CanvasPoint){x, top + length}, LINE * u,
                hud_faded(HUD_INK, opacity));
    if (degrees % 30 != 0)
        return;
    char text[8];
    CanvasPoint at = {x, hud_baseline(painter, layout->heading.y1 - 8.0f * u, layout->small_px)};
    hud_text(painter, at, layout->small_px, CANVAS_CENTRE, hud_faded(HUD_INK, opacity), heading_label(degrees, text));
}

// Near the vertical the heading turns by half a circle, so its marks fade.
static void paint_heading(const HudPainter *painter, const RenderHud *hud) {
    const HudLayout *layout = &painter->layout;
    float u = layout->unit, half = (layout->heading.x1 - layout->heading.x0) * 0.5f;
    double steady = hud_steadiness(hud->pitch_rad);
    for (int degrees = 0; degrees < 360 && isfinite(hud->heading_rad); degrees += HEADING_STEP_DEG) {
        double off = remainder(degrees - hud->heading_rad / RAD, 360.0) * HEADING_SPACE * u;
        double opacity = steady * hud_fade(fabs(off), half * 0.6, half - 16.0 * u);
        if (opacity > 0.0)
            paint_heading_mark(painter, degrees, layout->centre.x + (float)off, opacity);
    }
    char value[HUD_NUMBER_BYTES + 4];
    hud_format_heading(value, hud->heading_rad);
    float x = layout->centre.x, y = layout->heading.y0;
    CanvasRect box = {roundf(x - 30.0f * u), y, roundf(x + 30.0f * u), roundf(y + 26.0f * u)};
    paint_readout(painter, box, value, HUD_INK);
    canvas_triangle(painter->canvas, (CanvasPoint){x - 5.0f * u, box.y1 + 1.5f * u},
                    (CanvasPoint){x + 5.0f * u, box.y1 + 1.5f * u}, (CanvasPoint){x, box.y1 + 7.5f * u}, HUD_INK);
}

// A vertical scale. `side` 1: its marks on the right edge, labels to their left; -1: mirrored.
typedef struct Scale {
    CanvasRect area, box;
    double value, per_unit; // what one unit of length means
    int step, label_step;   // of marks, in the value's unit
    float side;
    double least; // no mark below
} Scale;

static void paint_scale_mark(const HudPainter *painter, const Scale *scale, double mark, float y, double opacity) {
    float u = painter->layout.unit, size = painter->layout.small_px;
    float edge = scale->side > 0.0f ? scale->area.x1 : scale->area.x0;
    bool labelled = fmod(fabs(mark), scale->label_step) < 0.5;
    float length = labelled ? 11.0f * u : 6.0f * u;
    canvas_line(painter->canvas, (CanvasPoint){edge - scale->side * length, y}, (CanvasPoint){edge, y}, LINE * u,
                hud_faded(HUD_INK, opacity));
    if (!labelled)
        return;
    // The readout covers the middle of the scale.
    double covered = hud_fade(fabs(y - middle_of(scale->box.y0, scale->box.y1)), 22.0 * u, 32.0 * u);
    char label[HUD_NUMBER_BYTES];
    hud_format_fixed(label, mark, 0);
    CanvasPoint at = {edge - scale->side * 17.0f * u, y + text_cap_height(painter->text) * size * 0.5f};
    hud_text(painter, at, size, scale->side > 0.0f ? CANVAS_RIGHT : CANVAS_LEFT,
             hud_faded(HUD_INK, opacity * (1.0 - covered)), label);
}

static void paint_scale(const HudPainter *painter, const Scale *scale) {
    double u = painter->layout.unit, half = (scale->area.y1 - scale->area.y0) * 0.5;
    float middle = middle_of(scale->area.y0, scale->area.y1);
    // Far beyond what flies: marks would no longer tell apart in double.
    if (!(half > 0.0) || !(fabs(scale->value) < 1e9))
        return;
    double reach = half / u * scale->per_unit;
    double first = ceil((scale->value - reach) / scale->step) * scale->step;
    for (double mark = first; mark <= scale->value + reach; mark += scale->step) {
        double off = (mark - scale->value) / scale->per_unit * u;
        double opacity = hud_fade(fabs(off), half * 0.7, half - 4.0 * u);
        // The middle of the scale, where the readout lies, has no marks.
        opacity *= 1.0 - hud_fade(fabs(off), 19.0 * u, 24.0 * u);
        if (opacity > 0.0 && mark >= scale->least)
            paint_scale_mark(painter, scale, mark, middle - (float)off, opacity);
    }
}

// A line of text by a scale: a name on the left, what it is on the right.
typedef struct Note {
    const char *name, *value;
    CanvasColour colour; // of the value
} Note;

static void paint_note(const HudPainter *painter, CanvasRect box, int line, const Note *note) {
    float size = painter->layout.small_px, height = 20.0f * painter->layout.unit;
    float room = box.x1 - box.x0 - text_width_px(painter->text, note->name, size) - 0.4f * size;
    float value_size = hud_fitting_size(painter, note->value, size, room);
    float y = hud_baseline(painter, box.y0 + height * ((float)line + 0.5f), size);
    hud_text(painter, (CanvasPoint){box.x0, y}, size, CANVAS_LEFT, HUD_DIM, note->name);
    hud_text(painter, (CanvasPoint){box.x1, y}, value_size, CANVAS_RIGHT, note->colour, note->value);
}

// Above a scale, or close above its readout where there is no scale.
static void paint_title(const HudPainter *painter, CanvasRect box, CanvasAlign align, const char *text) {
    float size = painter->layout.small_px, y = middle_of(box.y0, box.y1) - painter->layout.unit;
    CanvasPoint at = {align == CANVAS_LEFT ? box.x0 : box.x1, hud_baseline(painter, y, size)};
    hud_text(painter, at, size, align, HUD_DIM, text);
}

static bool has_third_note(CanvasRect box, float unit) {
    return box.y1 - box.y0 >= 50.0f * unit;
}

static void paint_throttle(const HudPainter *painter, double throttle) {
    const HudLayout *layout = &painter->layout;
    float u = layout->unit, share = (float)fmin(fmax(throttle, 0.0), 1.0);
    char text[HUD_NUMBER_BYTES + 4], number[HUD_NUMBER_BYTES];
    hud_format_fixed(number, throttle * 100.0, 0);
    snprintf(text, sizeof text, "%s %%", number);
    paint_note(painter, layout->speed_notes, 0, &(Note){"THR", text, HUD_INK});
    CanvasRect bar = {layout->speed_notes.x0, layout->speed_notes.y0 + 24.0f * u, layout->speed_notes.x1,
                      layout->speed_notes.y0 + 29.0f * u};
    canvas_box(painter->canvas, bar, 2.0f * u, HUD_PLATE_DENSE);
    bar.x1 = bar.x0 + (bar.x1 - bar.x0) * share;
    canvas_box(painter->canvas, bar, 2.0f * u, HUD_ACCENT);
}

static void paint_speed(const HudPainter *painter, const RenderHud *hud) {
    const HudLayout *layout = &painter->layout;
    double speed = hud->speed_m_s * KMH_PER_M_S;
    Scale scale = {layout->speed_scale, layout->speed_box, speed, 0.5, 10, 20, 1.0f, 0.0};
    paint_scale(painter, &scale);
    char value[HUD_NUMBER_BYTES];
    hud_format_fixed(value, speed, 0);
    paint_readout(painter, layout->speed_box, value, HUD_INK);
    paint_title(painter, layout->speed_title, CANVAS_RIGHT, "km/h");
    if (!hud->no_engine)
        paint_throttle(painter, hud->throttle);
}

static void paint_altitude_notes(const HudPainter *painter, const RenderHud *hud) {
    const HudLayout *layout = &painter->layout;
    char number[HUD_NUMBER_BYTES], text[HUD_NUMBER_BYTES + 8];
    hud_format_fixed(number, hud->over_terrain ? hud->above_ground_m : (double)NAN, 0);
    snprintf(text, sizeof text, hud->over_terrain ? "%s m" : "%s", number);
    bool low = hud->over_terrain && hud->above_ground_m < 50.0;
    paint_note(painter, layout->altitude_notes, 0, &(Note){"AGL", text, low ? HUD_WARN : HUD_INK});
    hud_format_signed(number, hud->vertical_speed_m_s, 1);
    snprintf(text, sizeof text, "%s m/s", number);
    bool third = has_third_note(layout->altitude_notes, layout->unit), alarm = hud->stalls && !third;
    paint_note(painter, layout->altitude_notes, 1,
               &(Note){alarm ? "STALL" : "V/S", text, alarm ? HUD_WARN : HUD_INK}); // a warning always has a place
    if (!isfinite(hud->alpha_rad) || !third)
        return;
    hud_format_signed(number, hud->alpha_rad * DEG_PER_RAD, 1);
    snprintf(text, sizeof text, "%s\xC2\xB0", number);
    paint_note(painter, layout->altitude_notes, 2,
               &(Note){hud->stalls ? "STALL" : "AoA", text, hud->stalls ? HUD_WARN : HUD_INK});
}

static void paint_altitude(const HudPainter *painter, const RenderHud *hud) {
    const HudLayout *layout = &painter->layout;
    Scale scale = {layout->altitude_scale, layout->altitude_box, hud->altitude_m, 2.5, 50, 100, -1.0f, -INFINITY};
    paint_scale(painter, &scale);
    char value[HUD_NUMBER_BYTES], title[64];
    hud_format_fixed(value, hud->altitude_m, 0);
    paint_readout(painter, layout->altitude_box, value, HUD_INK);
    snprintf(title, sizeof title, "m %s", hud->datum ? hud->datum : "");
    paint_title(painter, layout->altitude_title, CANVAS_LEFT, title);
    paint_altitude_notes(painter, hud);
}

void hud_paint_scales(const HudPainter *painter, const RenderHud *hud) {
    paint_heading(painter, hud);
    paint_speed(painter, hud);
    paint_altitude(painter, hud);
    hud_paint_states(painter, hud);
}
