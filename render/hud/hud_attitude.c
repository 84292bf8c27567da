// The parts that lie over the directions they mean: horizon, pitch ladder, flight path marker; and the bank scale.
#include "render/hud/hud_paint.h"

#include "terrain/geodesy.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define RAD GEODESY_RAD_PER_DEG
#define LINE 1.6f           // units, width of lines
#define CIRCLES_FROM_DEG 77 // rungs from here on are whole circles around the zenith, the same seen from any heading
#define CIRCLE_PIECES 48
#define SPAN_M 11.0          // of an aircraft, about
#define OUTSIDE_OPACITY 0.45 // of a flight path marker that stands on the edge

// Ladder parts near the bank scale fade, so that nothing is cut and nothing appears at once.
static double ladder_opacity(const HudPainter *painter, CanvasPoint at) {
    const HudLayout *layout = &painter->layout;
    float distance = hypotf(at.x - layout->centre.x, at.y - layout->centre.y);
    return hud_fade(distance, 0.68 * layout->radius, 0.9 * layout->radius);
}

static void paint_ladder_line(const HudPainter *painter, CanvasPoint a, CanvasPoint b, double opacity) {
    CanvasPoint middle = {(a.x + b.x) * 0.5f, (a.y + b.y) * 0.5f};
    CanvasColour colour = hud_faded(HUD_INK, opacity * ladder_opacity(painter, middle));
    canvas_line(painter->canvas, a, b, LINE * painter->layout.unit, colour);
}

// The horizon has a gap in its middle for what is drawn there.
static void paint_horizon(const HudPainter *painter) {
    const HudLayout *layout = &painter->layout;
    CanvasPoint a, b;
    if (!hud_view_horizon(&painter->view, layout->radius * 0.93f, &a, &b))
        return;
    float length = hypotf(b.x - a.x, b.y - a.y), gap = fminf(30.0f * layout->unit, length * 0.5f);
    float share = 0.5f - gap / fmaxf(length, 1e-3f);
    CanvasPoint left = {a.x + (b.x - a.x) * share, a.y + (b.y - a.y) * share};
    CanvasPoint right = {b.x + (a.x - b.x) * share, b.y + (a.y - b.y) * share};
    double opacity = hud_fade(-length, -40.0 * layout->unit, 0.0);
    canvas_line(painter->canvas, a, left, LINE * layout->unit, hud_faded(HUD_ACCENT, opacity));
    canvas_line(painter->canvas, b, right, LINE * layout->unit, hud_faded(HUD_ACCENT, opacity));
}

// One rung of the ladder: `pitch` its own, `scale` the azimuth per unit of length along it.
typedef struct Rung {
    const HudLadder *ladder;
    double pitch, scale, opacity;
    int degrees;
} Rung;

static bool rung_point(const HudPainter *painter, const Rung *rung, double along_units, CanvasPoint *out) {
    Vec3d direction = hud_ladder_direction(&painter->view, rung->ladder, rung->pitch, along_units * rung->scale);
    return hud_view_project(&painter->view, direction, out);
}

static void paint_rung_piece(const HudPainter *painter, const Rung *rung, double from_units, double to_units) {
    CanvasPoint a, b;
    if (rung_point(painter, rung, from_units, &a) && rung_point(painter, rung, to_units, &b))
        paint_ladder_line(painter, a, b, rung->opacity);
}

// The same rung, moved by so many units towards the horizon.
static Rung rung_lowered(const HudPainter *painter, const Rung *rung, double units) {
    double drop = units * painter->layout.unit / painter->view.focal_px;
    Rung lowered = *rung;
    lowered.pitch -= rung->pitch > 0.0 ? drop : -drop;
    return lowered;
}

// The foot at the outer end points to the horizon.
static void paint_rung_foot(const HudPainter *painter, const Rung *rung, double side) {
    Rung nearer = rung_lowered(painter, rung, 8.0);
    CanvasPoint a, b;
    if (rung_point(painter, rung, side * 92.0, &a) && rung_point(painter, &nearer, side * 92.0, &b))
        paint_ladder_line(painter, a, b, rung->opacity);
}

static void paint_rung_label(const HudPainter *painter, const Rung *rung, double along_units) {
    float size = painter->layout.small_px;
    char label[12];
    snprintf(label, sizeof label, "%d", abs(rung->degrees));
    CanvasPoint at;
    if (!rung_point(painter, rung, along_units, &at))
        return;
    CanvasColour colour = hud_faded(HUD_INK, rung->opacity * ladder_opacity(painter, at));
    at.y += text_cap_height(painter->text) * size * 0.5f;
    hud_text(painter, at, size, CANVAS_CENTRE, colour, label);
}

// Solid above the horizon, dashed below.
static void paint_rung_side(const HudPainter *painter, const Rung *rung, double side) {
    static const double DASHES[] = {42.0, 54.0, 61.0, 73.0, 80.0, 92.0};
    if (rung->pitch > 0.0) {
        paint_rung_piece(painter, rung, side * 42.0, side * 92.0);
    } else {
        for (size_t i = 0; i < COUNT_OF(DASHES); i += 2)
            paint_rung_piece(painter, rung, side * DASHES[i], side * DASHES[i + 1]);
    }
    paint_rung_foot(painter, rung, side);
    paint_rung_label(painter, rung, side * 108.0);
}

static void paint_rung_circle(const HudPainter *painter, const Rung *rung) {
    double step = 2.0 * GEODESY_PI / CIRCLE_PIECES / rung->scale;
    for (int i = 0; i < CIRCLE_PIECES; i++)
        paint_rung_piece(painter, rung, i * step, (i + 1) * step);
}

// A rung that is left behind turns with the ladder's frame, so it fades with its steadiness; a circle does not.
static void paint_rung(const HudPainter *painter, const HudLadder *ladder, int degrees) {
    double units_per_rad = painter->view.focal_px / painter->layout.unit;
    Rung rung = {.ladder = ladder,
                 .pitch = degrees * RAD,
                 .scale = 1.0 / (units_per_rad * cos(degrees * RAD)),
                 .opacity = ladder->steady,
                 .degrees = degrees};
    if (abs(degrees) < CIRCLES_FROM_DEG) {
        paint_rung_side(painter, &rung, -1.0);
        paint_rung_side(painter, &rung, 1.0);
        return;
    }
    Rung label = rung_lowered(painter, &rung, -11.0);
    paint_rung_label(painter, &label, 0.0);
    rung.opacity = 1.0;
    paint_rung_circle(painter, &rung);
}

static int ladder_step_deg(const HudPainter *painter) {
    static const int STEPS[] = {1, 2, 5, 10, 15, 30};
    double px_per_deg = painter->view.focal_px * RAD;
    size_t i = 0;
    while (i + 1 < COUNT_OF(STEPS) && STEPS[i] * px_per_deg < 44.0 * painter->layout.unit)
        i++;
    return STEPS[i];
}

static void paint_pole(const HudPainter *painter, double sign) {
    CanvasPoint at;
    if (!hud_view_project(&painter->view, vec3d_scale(painter->view.up, sign), &at))
        return;
    CanvasColour colour = hud_faded(HUD_INK, ladder_opacity(painter, at));
    float unit = painter->layout.unit;
    canvas_ring(painter->canvas, at, 5.0f * unit, LINE * unit, colour);
    if (sign < 0.0)
        canvas_ring(painter->canvas, at, 1.2f * unit, LINE * unit, colour);
}

static void paint_ladder(const HudPainter *painter) {
    HudLadder ladder = hud_view_ladder(&painter->view);
    int step = ladder_step_deg(painter);
    double seen = atan(painter->layout.radius / painter->view.focal_px) / RAD + step;
    for (int degrees = -90 + step; degrees < 90; degrees += step)
        if (degrees != 0 && fabs(degrees - ladder.pitch_rad / RAD) < seen)
            paint_rung(painter, &ladder, degrees);
    paint_pole(painter, 1.0);
    paint_pole(painter, -1.0);
}

// Where the nose points: the middle of the picture.
static void paint_nose(const HudPainter *painter) {
    CanvasPoint c = painter->layout.centre;
    float u = painter->layout.unit;
    const CanvasPoint bend[] = {{c.x - 24 * u, c.y},        {c.x - 12 * u, c.y}, {c.x - 6 * u, c.y + 8 * u}, {c.x, c.y},
                                {c.x + 6 * u, c.y + 8 * u}, {c.x + 12 * u, c.y}, {c.x + 24 * u, c.y}};
    for (size_t i = 0; i + 1 < COUNT_OF(bend); i++)
        canvas_line(painter->canvas, bend[i], bend[i + 1], LINE * u, HUD_INK);
}

static void paint_marker(const HudPainter *painter, CanvasPoint at, CanvasColour colour) {
    float u = painter->layout.unit, width = LINE * u;
    canvas_ring(painter->canvas, at, 7.0f * u, width, colour);
    canvas_line(painter->canvas, (CanvasPoint){at.x - 18 * u, at.y}, (CanvasPoint){at.x - 7 * u, at.y}, width, colour);
    canvas_line(painter->canvas, (CanvasPoint){at.x + 7 * u, at.y}, (CanvasPoint){at.x + 18 * u, at.y}, width, colour);
    canvas_line(painter->canvas, (CanvasPoint){at.x, at.y - 15 * u}, (CanvasPoint){at.x, at.y - 7 * u}, width, colour);
}

// A flight path outside the circle: a dim marker on its edge, towards it.
static void paint_marker_outside(const HudPainter *painter, Vec3d direction, double opacity) {
    double side = hypot(direction.x, direction.y);
    if (!(side > 0.0))
        return;
    const HudLayout *layout = &painter->layout;
    double reach = 0.86 * layout->radius / side;
    CanvasPoint at = {(float)(layout->centre.x + direction.x * reach), (float)(layout->centre.y - direction.y * reach)};
    // Straight behind there is no edge to prefer.
    double known = 1.0 - hud_fade(side / vec3d_length(direction), 0.05, 0.25) * (direction.z > 0.0);
    paint_marker(painter, at, hud_faded(HUD_ACCENT, opacity * known * OUTSIDE_OPACITY));
}

static void paint_flight_path(const HudPainter *painter, const RenderHud *hud) {
    Vec3d direction = mat3d_mul_vec(&painter->view.camera_from_ecef, hud->velocity_ecef);
    double speed = vec3d_length(direction);
    double opacity = isfinite(speed) ? 1.0 - hud_fade(speed, 2.0, 5.0) : 0.0;
    const HudLayout *layout = &painter->layout;
    CanvasPoint at;
    bool seen = hud_view_project(&painter->view, direction, &at);
    float distance = seen ? hypotf(at.x - layout->centre.x, at.y - layout->centre.y) : INFINITY;
    double dimmed =
        1.0 - (1.0 - OUTSIDE_OPACITY) * (1.0 - hud_fade(distance, 0.76 * layout->radius, 0.86 * layout->radius));
    if (distance <= 0.86f * layout->radius)
        paint_marker(painter, at, hud_faded(HUD_ACCENT, opacity * dimmed));
    else if (opacity > 0.0)
        paint_marker_outside(painter, direction, opacity);
}

// `angle_rad` from straight down to the right.
static CanvasPoint bank_point(const HudPainter *painter, double angle_rad, double radius_px) {
    return (CanvasPoint){(float)(painter->layout.centre.x + sin(angle_rad) * radius_px),
                         (float)(painter->layout.centre.y + cos(angle_rad) * radius_px)};
}

static void paint_bank_marks(const HudPainter *painter) {
    static const int MARKS[] = {-60, -45, -30, -20, -10, 0, 10, 20, 30, 45, 60};
    double radius = painter->layout.radius, u = painter->layout.unit;
    for (size_t i = 0; i < COUNT_OF(MARKS); i++) {
        double length = MARKS[i] % 30 == 0 ? 12.0 : 7.0, angle = MARKS[i] * RAD;
        canvas_line(painter->canvas, bank_point(painter, angle, radius),
                    bank_point(painter, angle, radius + length * u), LINE * painter->layout.unit, HUD_DIM);
    }
}

static void paint_bank(const HudPainter *painter, const RenderHud *hud) {
    paint_bank_marks(painter);
    double opacity = isfinite(hud->bank_rad) ? hud_steadiness(hud->pitch_rad) : 0.0;
    if (!(opacity > 0.0))
        return;
    double radius = painter->layout.radius, u = painter->layout.unit, half = 6.0 * u / radius;
    canvas_triangle(painter->canvas, bank_point(painter, hud->bank_rad, radius - 2.0 * u),
                    bank_point(painter, hud->bank_rad - half, radius - 13.0 * u),
                    bank_point(painter, hud->bank_rad + half, radius - 13.0 * u), hud_faded(HUD_INK, opacity));
}

// ---- the aircraft, seen from outside ----

typedef struct Symbol {
    CanvasPoint at;
    double nose_x, nose_y, wing_x, wing_y; // directions in the picture, as long as they are seen
} Symbol;

// Directions across the line of sight, as the eye sees them.
static void see_along(const HudPainter *painter, Vec3d direction_ecef, double *x, double *y) {
    Vec3d seen = mat3d_mul_vec(&painter->view.camera_from_ecef, direction_ecef);
    *x = seen.x;
    *y = -seen.y;
}

static CanvasPoint symbol_point(const HudPainter *painter, const Symbol *s, double ahead, double aside) {
    double u = painter->layout.unit;
    return (CanvasPoint){s->at.x + (float)((ahead * s->nose_x + aside * s->wing_x) * u),
                         s->at.y + (float)((ahead * s->nose_y + aside * s->wing_y) * u)};
}

static void paint_symbol_line(const HudPainter *painter, const Symbol *s, const double from[2], const double to[2],
                              CanvasColour colour) {
    canvas_line(painter->canvas, symbol_point(painter, s, from[0], from[1]), symbol_point(painter, s, to[0], to[1]),
                2.0f * LINE * painter->layout.unit, colour);
}

// A cross of fuselage, wing and tail, larger than life, until the aircraft itself is large enough.
static void paint_aircraft(const HudPainter *painter, const RenderHud *hud, Vec3d eye_ecef) {
    static const double NOSE[2] = {15, 0}, END[2] = {-12, 0}, WING[2] = {3, 0}, TAIL[2] = {-10, 0};
    Symbol s = {0};
    Vec3d to = vec3d_sub(hud->aircraft_ecef, eye_ecef);
    double away_m = vec3d_length(to), span_px = away_m > 0.0 ? SPAN_M * painter->view.focal_px / away_m : INFINITY;
    double opacity = hud_fade(span_px, 12.0 * painter->layout.unit, 30.0 * painter->layout.unit);
    if (!(opacity > 0.0) ||
        !hud_view_project(&painter->view, mat3d_mul_vec(&painter->view.camera_from_ecef, to), &s.at))
        return;
    see_along(painter, hud->nose_ecef, &s.nose_x, &s.nose_y);
    see_along(painter, hud->wing_ecef, &s.wing_x, &s.wing_y);
    CanvasColour colour = hud_faded(HUD_ACCENT, opacity);
    paint_symbol_line(painter, &s, NOSE, END, colour);
    paint_symbol_line(painter, &s, (double[]){WING[0], -14}, (double[]){WING[0], 14}, colour);
    paint_symbol_line(painter, &s, (double[]){TAIL[0], -6}, (double[]){TAIL[0], 6}, colour);
}

void hud_paint_attitude(const HudPainter *painter, const RenderPacket *packet) {
    if (packet->hud.outside) {
        if (packet->hud.map.show)
            hud_paint_map(painter, packet);
        paint_aircraft(painter, &packet->hud, packet->camera.eye_ecef);
        return;
    }
    if (painter->layout.radius <= 0.0f)
        return;
    paint_ladder(painter);
    paint_horizon(painter);
    paint_nose(painter);
    paint_flight_path(painter, &packet->hud);
    paint_bank(painter, &packet->hud);
}
