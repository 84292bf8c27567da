// Over the map: the way flown and the way to be flown, a scale, and where north is.
#include "render/hud/hud_paint.h"

#include "terrain/geodesy.h"

#include <math.h>
#include <stdio.h>

#define LINE 1.6f         // units, of the scale
#define ROUTE_LINE 1.6f   // units
#define TRAIL_LINE 2.6f   // units
#define CASING 2.4f       // units that the dark edge of a way is wider
#define STOP_RADIUS 5.0f  // units
#define STEP_PX 2.5f      // shorter pieces of a way are put together
#define OLDEST 0.3        // opacity of the trail's end
#define NEAREST_M 1.0     // before the eye: what is drawn
#define SCALE_MOST 200.0f // units, of the scale's bar
#define ARROW_ROOM 34.0f  // units left of the bar
#define DARK ((CanvasColour){0.02f, 0.04f, 0.06f, 0.6f})

// A way as it is painted: once as a dark edge, once as itself.
typedef struct Way {
    const HudPainter *painter;
    const RenderCamera *camera;
    CanvasRect room; // the picture, or its half
    float width;     // units
    CanvasColour colour;
} Way;

static Vec3d seen_from(const Way *way, Vec3d ecef) {
    return mat3d_mul_vec(&way->painter->view.camera_from_ecef, vec3d_sub(ecef, way->camera->eye_ecef));
}

// Keeps the part of from..to, shares of a line, in which `at + share * by` is at most `most`.
static void clip_below(float at, float by, float most, float *from, float *to) {
    float share = by != 0.0f ? (most - at) / by : 0.0f;
    if (by > 0.0f)
        *to = fminf(*to, share);
    else if (by < 0.0f)
        *from = fmaxf(*from, share);
    else if (at > most)
        *to = -1.0f;
}

// Paints the part of a line that lies in the room.
static void paint_inside(const Way *way, CanvasPoint a, CanvasPoint b, CanvasColour colour) {
    float from = 0.0f, to = 1.0f, x = b.x - a.x, y = b.y - a.y;
    clip_below(a.x, x, way->room.x1, &from, &to);
    clip_below(-a.x, -x, -way->room.x0, &from, &to);
    clip_below(a.y, y, way->room.y1, &from, &to);
    clip_below(-a.y, -y, -way->room.y0, &from, &to);
    if (from < to)
        canvas_line(way->painter->canvas, (CanvasPoint){a.x + from * x, a.y + from * y},
                    (CanvasPoint){a.x + to * x, a.y + to * y}, way->width * way->painter->layout.unit, colour);
}

// Ground as high as the eye is left out.
static bool project(const Way *way, Vec3d ecef, CanvasPoint *out) {
    Vec3d seen = seen_from(way, ecef);
    return -seen.z > NEAREST_M && hud_view_project(&way->painter->view, seen, out);
}

static void paint_way(const Way *way, const RenderMapPlace *places, int count, double oldest) {
    CanvasPoint last = {0}, now;
    bool has_last = false;
    for (int i = 0; i < count; i++) {
        bool shown = project(way, places[i].ecef, &now), joined = has_last && shown && !places[i].apart;
        bool ends = i + 1 == count || places[i + 1].apart;
        if (joined && !ends && hypotf(now.x - last.x, now.y - last.y) < STEP_PX)
            continue;
        double age = 1.0 - (double)i / count;
        if (joined)
            paint_inside(way, last, now, hud_faded(way->colour, 1.0 - (1.0 - oldest) * age));
        last = now;
        has_last = shown;
    }
}

static void paint_with_edge(const Way *way, const RenderMapPlace *places, int count, double oldest) {
    Way edge = *way;
    edge.width += CASING;
    edge.colour = DARK;
    paint_way(&edge, places, count, oldest);
    paint_way(way, places, count, oldest);
}

static void paint_stops(const Way *way, const RenderMap *map) {
    float u = way->painter->layout.unit, radius = STOP_RADIUS * u;
    for (int i = 0; i < map->route_count; i++) {
        CanvasPoint at;
        if (!map->route[i].stop || !project(way, map->route[i].ecef, &at) || at.x < way->room.x0 + radius ||
            at.x > way->room.x1 - radius || at.y < way->room.y0 || at.y > way->room.y1)
            continue;
        bool next = i == map->next;
        canvas_ring(way->painter->canvas, at, radius, (way->width + CASING) * u, DARK);
        canvas_ring(way->painter->canvas, at, radius, way->width * u, next ? HUD_ACCENT : HUD_INK);
    }
}

static void paint_ways(const HudPainter *painter, const RenderPacket *packet) {
    const RenderMap *map = &packet->hud.map;
    const HudLayout *layout = &painter->layout;
    float half = layout->width * (packet->split ? 0.25f : 0.5f);
    CanvasRect room = {layout->centre.x - half, 0.0f, layout->centre.x + half, layout->height};
    const Way route = {painter, &packet->camera, room, ROUTE_LINE, hud_faded(HUD_INK, 0.8)};
    const Way trail = {painter, &packet->camera, room, TRAIL_LINE, HUD_ACCENT};
    canvas_set_lower(painter->canvas, true); // what is written over it stays readable
    paint_with_edge(&route, map->route, map->route_count, 1.0);
    paint_with_edge(&trail, map->trail, map->trail_count, OLDEST);
    paint_stops(&route, map);
    canvas_set_lower(painter->canvas, false);
}

// The greatest of 1, 2, 5, 10 ... that is not longer.
static double round_length(double most_m) {
    static const double DIGITS[] = {5.0, 2.0, 1.0};
    double decade = pow(10.0, floor(log10(most_m)));
    size_t i = 0;
    while (i + 1 < COUNT_OF(DIGITS) && DIGITS[i] * decade > most_m)
        i++;
    return DIGITS[i] * decade;
}

// As long as `length_m` on the ground in the picture's middle.
static void paint_scale_bar(const HudPainter *painter, double length_m, CanvasPoint from, float length_px) {
    const HudLayout *layout = &painter->layout;
    float u = layout->unit, size = layout->small_px, y = from.y, x1 = from.x + length_px;
    canvas_line(painter->canvas, from, (CanvasPoint){x1, y}, LINE * u, HUD_INK);
    for (int end = 0; end < 2; end++) {
        float x = end ? x1 - 0.5f * LINE * u : from.x + 0.5f * LINE * u;
        canvas_line(painter->canvas, (CanvasPoint){x, y - 5.0f * u}, (CanvasPoint){x, y}, LINE * u, HUD_INK);
    }
    char text[HUD_NUMBER_BYTES];
    bool far = length_m >= 1000.0;
    snprintf(text, sizeof text, "%g %s", far ? length_m / 1000.0 : length_m, far ? "km" : "m");
    hud_text(painter, (CanvasPoint){0.5f * (from.x + x1), y - 7.0f * u}, size, CANVAS_CENTRE, HUD_INK, text);
}

// Points to where north is in the picture's middle.
static void paint_north(const HudPainter *painter, const RenderCamera *camera, CanvasPoint middle) {
    Geodetic eye = geodesy_from_ecef(camera->eye_ecef);
    Mat3d enu = geodesy_enu_from_ecef(eye.lat_rad, eye.lon_rad);
    Vec3d seen = mat3d_mul_vec(&camera->camera_from_ecef, vec3d(enu.m[1][0], enu.m[1][1], enu.m[1][2]));
    double flat = hypot(seen.x, seen.y);
    if (!(flat > 0.0))
        return;
    float u = painter->layout.unit, size = painter->layout.small_px, x = (float)(seen.x / flat),
          y = (float)(-seen.y / flat);
    CanvasPoint tip = {middle.x + x * 8.0f * u, middle.y + y * 8.0f * u};
    CanvasPoint left = {middle.x - (x * 8.0f + y * 5.0f) * u, middle.y - (y * 8.0f - x * 5.0f) * u};
    CanvasPoint right = {middle.x - (x * 8.0f - y * 5.0f) * u, middle.y - (y * 8.0f + x * 5.0f) * u};
    canvas_triangle(painter->canvas, tip, left, right, HUD_INK);
    CanvasPoint letter = {middle.x + x * 17.0f * u, middle.y + y * 17.0f * u};
    letter.y = hud_baseline(painter, letter.y, size);
    hud_text(painter, letter, size, CANVAS_CENTRE, HUD_INK, "N");
}

// Where on other views the circle has its lower edge, which keeps clear of all else: the arrow, and the bar beside it.
static void paint_legend(const HudPainter *painter, const RenderPacket *packet) {
    const HudLayout *layout = &painter->layout;
    float u = layout->unit, y = layout->centre.y + layout->radius + 4.0f * u, room = ARROW_ROOM * u;
    float most = fminf(SCALE_MOST * u, 2.0f * (layout->radius + 18.0f * u) - room);
    double px_per_m = painter->view.focal_px / packet->hud.map.ground_m;
    bool has_scale = isfinite(px_per_m) && px_per_m > 0.0;
    double length_m = has_scale ? round_length((double)most / px_per_m) : 0.0;
    float length = (float)(length_m * px_per_m), left = layout->centre.x - 0.5f * (length + room);
    if (has_scale)
        paint_scale_bar(painter, length_m, (CanvasPoint){left + room, y}, length);
    paint_north(painter, &packet->camera, (CanvasPoint){left + 10.0f * u, y - 8.0f * u});
}

void hud_paint_map(const HudPainter *painter, const RenderPacket *packet) {
    paint_ways(painter, packet);
    if (painter->layout.radius > 0.0f)
        paint_legend(painter, packet);
}
