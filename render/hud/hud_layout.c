#include "render/hud/hud_layout.h"

#include "terrain/geodesy.h"

#include <math.h>

#define UNIT_LEAST 0.72f // below it text could not be read
#define PANEL_TEXT_LEAST_PX 10.5f
#define PANEL_WIDTH_LEAST_PX 640 // of the window
#define PANEL_HEIGHT_LEAST_PX 400
#define STATES_EM 28.0f // of text: what nearly all states take in one row; smaller text does the rest
#define LEGEND_ROWS_LEAST 4
#define ACCURACY_ROWS 26.5f
#define ACCURACY_ROWS_LEAST 2.0f
#define ACCURACY_WIDTH 1.35f // of the panel's, at most
#define MARGIN 12.0f         // units, as all sizes below
#define REPLAY_WIDTH 620.0f
#define REPLAY_TIMES_EM 10.2f   // of text: "00:00:00 / 00:00:00"
#define REPLAY_STATE_EM 6.8f    // "not recorded"
#define REPLAY_DERIVED_EM 12.6f // "attitude derived, paused"
#define TITLE_ALONE 23.0f       // of a title's height with its distance, right above a readout

static CanvasRect rect_round(CanvasRect rect) {
    return (CanvasRect){roundf(rect.x0), roundf(rect.y0), roundf(rect.x1), roundf(rect.y1)};
}

static void place_panel(HudLayout *layout) {
    float u = layout->unit, width = layout->small_px * 17.5f;
    float height = layout->row_px * (HUD_PANEL_ROWS + 1.5f) + 16.0f * u;
    layout->panel = rect_round((CanvasRect){MARGIN * u, MARGIN * u, MARGIN * u + width, MARGIN * u + height});
}

// What lies left and right of the centre keeps clear of the panel, on both sides alike.
static float free_half_width(const HudLayout *layout) {
    return layout->centre.x - layout->panel.x1 - MARGIN * layout->unit;
}

static void place_heading(HudLayout *layout) {
    float u = layout->unit, half = fminf(230.0f * u, free_half_width(layout));
    layout->heading = rect_round((CanvasRect){layout->centre.x - half, 10.0f * u, layout->centre.x + half, 70.0f * u});
}

// Between what stands in the corners; two rows where one would be too short.
static void place_states(HudLayout *layout) {
    float u = layout->unit, half = free_half_width(layout), top = layout->heading.y1;
    float rows = 2.0f * half < STATES_EM * layout->small_px ? 2.0f : 1.0f;
    layout->states = rect_round(
        (CanvasRect){layout->centre.x - half, top, layout->centre.x + half, top + rows * layout->row_px + 1.0f * u});
}

static void place_lines(HudLayout *layout) {
    float u = layout->unit, left = MARGIN * u, right = layout->width - MARGIN * u, bottom = layout->height - 10.0f * u;
    layout->message = rect_round((CanvasRect){left, bottom - 28.0f * u, right, bottom});
    bottom -= 34.0f * u;
    layout->note = rect_round((CanvasRect){left, bottom - 32.0f * u, right, bottom});
}

static float scale_width(const HudLayout *layout) {
    return fmaxf(88.0f * layout->unit, 7.2f * layout->small_px);
}

static void place_circle(HudLayout *layout) {
    float u = layout->unit;
    float below = layout->note.y0 - layout->centre.y - 18.0f * u;
    float above = layout->centre.y - layout->states.y1 - 12.0f * u;   // no marks there, they are below
    float aside = layout->centre.x - scale_width(layout) - 48.0f * u; // the scales stand beside it
    float room = fminf(fminf(236.0f * u, fminf(aside, free_half_width(layout))), fminf(above, below));
    layout->radius = fmaxf(room, 20.0f * u); // in windows too small for all parts it still has a size
}

static CanvasRect mirrored(const HudLayout *layout, CanvasRect rect) {
    return (CanvasRect){layout->width - rect.x1, rect.y0, layout->width - rect.x0, rect.y1};
}

// The speed's column left of the circle; under the panel where the window is too narrow for both side by side.
static void place_speed(HudLayout *layout) {
    float u = layout->unit, right = layout->centre.x - layout->radius - 40.0f * u, left = right - scale_width(layout);
    bool under_panel = layout->panel.x1 + 8.0f * u > left;
    float top = under_panel ? layout->panel.y1 + 8.0f * u : layout->states.y1;
    float middle = fmaxf(layout->centre.y, top + (TITLE_ALONE + 16.0f) * u);
    float half = fminf(150.0f * u, fminf(middle - top - 18.0f * u, layout->note.y0 - 50.0f * u - middle));
    bool scale = half >= 48.0f * u;
    half = scale ? half : 16.0f * u;
    layout->speed_box = rect_round((CanvasRect){left, middle - 16.0f * u, right, middle + 16.0f * u});
    float title = middle - half - (scale ? 18.0f : TITLE_ALONE) * u;
    layout->speed_title = rect_round((CanvasRect){left, title, right, title + 18.0f * u});
    float rows = middle + half + 66.0f * u <= layout->note.y0 ? 60.0f : 40.0f; // three, or two where room is short
    layout->speed_notes =
        rect_round((CanvasRect){left, middle + half + 6.0f * u, right, middle + half + (6.0f + rows) * u});
    half = scale ? half : 0.0f;
    layout->speed_scale = rect_round((CanvasRect){left, middle - half, right, middle + half});
}

static void place_altitude(HudLayout *layout) {
    layout->altitude_scale = mirrored(layout, layout->speed_scale);
    layout->altitude_box = mirrored(layout, layout->speed_box);
    layout->altitude_title = mirrored(layout, layout->speed_title);
    layout->altitude_notes = mirrored(layout, layout->speed_notes);
}

static float least_legend(const HudLayout *layout) {
    return layout->row_px * LEGEND_ROWS_LEAST + 16.0f * layout->unit;
}

// Of a split picture, whose panels take both upper corners: under the left one, and under the speed where the window is
// too narrow for both side by side.
static void place_legend_low(HudLayout *layout) {
    float u = layout->unit, least = least_legend(layout);
    CanvasRect room = {layout->panel.x0, layout->panel.y1 + 8.0f * u, layout->panel.x1, layout->note.y0 - 8.0f * u};
    if (room.x1 + 8.0f * u > layout->speed_title.x0)
        room.y0 = fmaxf(room.y0, layout->speed_notes.y1 + 8.0f * u);
    room.y0 = fmaxf(room.y0, room.y1 - (layout->panel.y1 - layout->panel.y0));
    bool fits = room.x1 > room.x0 && room.y1 - room.y0 >= least;
    layout->legend_low = fits ? rect_round(room) : (CanvasRect){0};
}

static CanvasRect moved(CanvasRect rect, float x) {
    return (CanvasRect){rect.x0 + x, rect.y0, rect.x1 + x, rect.y1};
}

// The scales go to the middle, where neither half has its own.
static void place_scales_inside(HudLayout *layout) {
    float x = roundf(layout->centre.x - 16.0f * layout->unit - layout->speed_box.x1);
    layout->speed_scale = moved(layout->speed_scale, x);
    layout->speed_box = moved(layout->speed_box, x);
    layout->speed_title = moved(layout->speed_title, x);
    layout->speed_notes = moved(layout->speed_notes, x);
    place_altitude(layout);
}

void hud_layout_split(HudLayout *layout) {
    place_scales_inside(layout);
    float u = layout->unit, x = layout->width * 0.25f, y = layout->centre.y;
    float beside = layout->speed_box.x0 - x - 20.0f * u;
    float above = hypotf(fmaxf(x - layout->panel.x1, 0.0f), y - layout->panel.y1) - 4.0f * u;
    bool fits = beside >= 20.0f * u;
    layout->radius = fits ? fmaxf(fminf(fminf(layout->radius, beside), above), 20.0f * u) : 0.0f;
    if (layout->panel.x1 > layout->panel.x0)
        place_legend_low(layout);
}

// The whole height beside the altitude, or no more than the legend's place above it.
static void place_accuracy(HudLayout *layout) {
    float u = layout->unit, beside = layout->altitude_title.x1 + 8.0f * u;
    CanvasRect room = layout->legend;
    bool above = beside > room.x0;
    if (!above) {
        room.x0 = fmaxf(beside, room.x1 - ACCURACY_WIDTH * (room.x1 - room.x0));
        room.y1 = fminf(room.y0 + ACCURACY_ROWS * layout->row_px + 16.0f * u, layout->note.y0 - 8.0f * u);
    }
    layout->accuracy = rect_round(room);
    layout->states.x1 = fminf(layout->states.x1, layout->accuracy.x0 - 8.0f * u);
    layout->states.x0 = layout->width - layout->states.x1;
    CanvasRect legend = {layout->legend.x0, room.y1 + 8.0f * u, room.x1, layout->note.y0 - 8.0f * u};
    bool fits = !above && legend.y1 - legend.y0 >= least_legend(layout);
    layout->legend = fits ? rect_round(legend) : (CanvasRect){0};
}

// As place_legend_low, with all the room there is.
static void place_accuracy_low(HudLayout *layout) {
    float u = layout->unit, middle = layout->width * 0.25f;
    CanvasRect room = {layout->panel.x0, layout->panel.y1 + 8.0f * u, layout->panel.x1, layout->note.y0 - 8.0f * u};
    if (room.x1 + 8.0f * u > layout->speed_title.x0)
        room.y0 = fmaxf(room.y0, layout->speed_notes.y1 + 8.0f * u);
    if (room.y1 - room.y0 < ACCURACY_ROWS_LEAST * layout->row_px + 16.0f * u)
        return;
    room.y0 = fmaxf(room.y0, room.y1 - ACCURACY_ROWS * layout->row_px - 16.0f * u);
    layout->accuracy = rect_round(room);
    layout->radius = fmaxf(fminf(layout->radius, middle - room.x1 - 12.0f * u), 20.0f * u);
}

void hud_layout_add_accuracy(HudLayout *layout, bool split) {
    if (layout->panel.x1 <= layout->panel.x0)
        return;
    if (split)
        place_accuracy_low(layout);
    else
        place_accuracy(layout);
}

static void place_help(HudLayout *layout) {
    float margin = 8.0f * layout->unit;
    layout->help = (CanvasRect){margin, margin, layout->width - margin, layout->height - margin};
}

HudLayout hud_layout_make(int width, int height, bool show_panels) {
    HudLayout layout = {.width = (float)width, .height = (float)height};
    layout.unit = fmaxf(fminf(layout.width / 1280.0f, layout.height / 800.0f), UNIT_LEAST);
    layout.text_px = roundf(17.0f * layout.unit);
    layout.small_px = fmaxf(roundf(13.0f * layout.unit), PANEL_TEXT_LEAST_PX);
    layout.row_px = roundf(layout.small_px * 1.34f);
    layout.centre = (CanvasPoint){layout.width * 0.5f, layout.height * 0.5f};
    if (show_panels && width >= PANEL_WIDTH_LEAST_PX && height >= PANEL_HEIGHT_LEAST_PX)
        place_panel(&layout);
    place_heading(&layout);
    place_states(&layout);
    place_lines(&layout);
    place_circle(&layout);
    place_speed(&layout);
    place_altitude(&layout);
    layout.legend = layout.panel.x1 > layout.panel.x0 ? mirrored(&layout, layout.panel) : layout.panel;
    place_legend_low(&layout);
    place_help(&layout);
    return layout;
}

// Of constant lengths, whatever the texts say now: the bar stays where it is, and is found without a font.
HudReplayPlace hud_layout_replay(const HudLayout *layout, bool derived) {
    const CanvasRect *note = &layout->note;
    float u = layout->unit, inset = 10.0f * u, x = 0.5f * (note->x0 + note->x1), y = 0.5f * (note->y0 + note->y1);
    float half = 0.5f * fminf(REPLAY_WIDTH * u, note->x1 - note->x0);
    float times = REPLAY_TIMES_EM * layout->small_px;
    float state = (derived ? REPLAY_DERIVED_EM : REPLAY_STATE_EM) * layout->small_px;
    float left = x - half + 2.0f * inset + times, right = x + half - 2.0f * inset - state;
    return (HudReplayPlace){.plate = {x - half, note->y0, x + half, note->y1},
                            .bar = {left, y - 2.5f * u, fmaxf(left, right), y + 2.5f * u},
                            .inset = inset};
}

bool hud_replay_is_on(const HudReplayPlace *place, double x, double y) {
    const CanvasRect *bar = &place->bar, *plate = &place->plate;
    float beside = 0.5f * place->inset;
    return bar->x1 > bar->x0 && x >= bar->x0 - beside && x <= bar->x1 + beside && y >= plate->y0 && y <= plate->y1;
}

double hud_replay_share(const HudReplayPlace *place, double x) {
    double left = place->bar.x0, length = place->bar.x1 - place->bar.x0;
    return length > 0.0 ? fmin(fmax((x - left) / length, 0.0), 1.0) : 0.0;
}

HudView hud_view_make(const RenderCamera *camera, int width, int height) {
    Geodetic eye = geodesy_from_ecef(camera->eye_ecef);
    Vec3d up = geodesy_up(eye.lat_rad, eye.lon_rad);
    return (HudView){.up = mat3d_mul_vec(&camera->camera_from_ecef, up),
                     .camera_from_ecef = camera->camera_from_ecef,
                     .focal_px = height * 0.5 / tan(camera->fov_y_rad * 0.5),
                     .centre_x = width * 0.5,
                     .centre_y = height * 0.5};
}

bool hud_view_project(const HudView *view, Vec3d direction, CanvasPoint *out) {
    double depth = -direction.z;
    double side = fmax(fabs(direction.x), fabs(direction.y));
    // 1e5: 89.999 degrees off the axis. Far beyond any window, and well within what float pixels can say.
    if (!(depth > 0.0) || side > depth * 1e5)
        return false;
    out->x = (float)(view->centre_x + view->focal_px * direction.x / depth);
    out->y = (float)(view->centre_y - view->focal_px * direction.y / depth);
    return true;
}

// The horizon's image is the line X up.x + Y up.y = up.z, with X to the right and Y upwards in units of the focal
// length.
bool hud_view_horizon(const HudView *view, float radius_px, CanvasPoint *a, CanvasPoint *b) {
    double flat = hypot(view->up.x, view->up.y);
    double distance = view->focal_px * view->up.z; // from the centre to the line, times `flat`
    if (!(fabs(distance) < radius_px * flat))
        return false;
    double normal_x = view->up.x / flat, normal_y = -view->up.y / flat; // in pixels, y downwards
    double foot = distance / flat, half = sqrt(radius_px * (double)radius_px - foot * foot);
    double x = view->centre_x + normal_x * foot, y = view->centre_y + normal_y * foot;
    *a = (CanvasPoint){(float)(x + normal_y * half), (float)(y - normal_x * half)};
    *b = (CanvasPoint){(float)(x - normal_y * half), (float)(y + normal_x * half)};
    return true;
}

double hud_steadiness(double pitch_rad) {
    double full = cos(84.0 * GEODESY_RAD_PER_DEG), none = cos(89.0 * GEODESY_RAD_PER_DEG);
    double t = fmin(fmax((fabs(cos(pitch_rad)) - none) / (full - none), 0.0), 1.0);
    return t * t * (3.0 - 2.0 * t);
}

HudLadder hud_view_ladder(const HudView *view) {
    Vec3d forward = {0.0, 0.0, -1.0};
    double climb = vec3d_dot(forward, view->up);
    Vec3d level = vec3d_mad(forward, view->up, -climb);
    // At the zenith no level direction is ahead; the top of the picture leans backwards there.
    if (vec3d_length(level) < 1e-9)
        level = vec3d(0.0, climb > 0.0 ? -1.0 : 1.0, 0.0);
    HudLadder ladder = {.ahead = vec3d_normalize(level)};
    ladder.right = vec3d_cross(ladder.ahead, view->up);
    ladder.pitch_rad = atan2(climb, hypot(view->up.x, view->up.y));
    ladder.steady = hud_steadiness(ladder.pitch_rad);
    return ladder;
}

Vec3d hud_ladder_direction(const HudView *view, const HudLadder *ladder, double pitch_rad, double azimuth_rad) {
    Vec3d level = vec3d_mad(vec3d_scale(ladder->ahead, cos(azimuth_rad)), ladder->right, sin(azimuth_rad));
    return vec3d_mad(vec3d_scale(level, cos(pitch_rad)), view->up, sin(pitch_rad));
}
