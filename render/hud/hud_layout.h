// render/hud/hud_layout.h: where the parts of the head-up display lie for a window size, and where directions appear.
// Pixels from the top left corner, y downwards; camera frame: x right, y up, z backwards.
// Values; pure functions, any thread.
#pragma once
#include "render/hud/canvas.h"
#include "render/render.h"

#define HUD_PANEL_ROWS 16 // at most, with three gaps between groups
#define HUD_WIDTH_LEAST 320
#define HUD_HEIGHT_LEAST 200

// Parts do not overlap and lie inside the window from HUD_WIDTH_LEAST x HUD_HEIGHT_LEAST up, and smaller windows have
// nothing but the line between the halves; but `ladder` parts move over the picture inside the circle, and `help`
// replaces all others.
typedef struct HudLayout {
    float width, height;
    float unit;              // 1 at 1280 x 800; thin lines are a unit and a half
    float text_px, small_px; // sizes of text
    float row_px;            // of the panel
    CanvasPoint centre;
    float radius;                           // of the bank scale; the ladder lies inside; 0: a half has no room
    CanvasRect heading;                     // the scale with its readout
    CanvasRect states;                      // gear, flaps and the like: one row below it, or two
    CanvasRect speed_scale, altitude_scale; // empty (y0 == y1) where there is no room for scales
    CanvasRect speed_box, altitude_box;     // the readouts
    CanvasRect speed_title, altitude_title; // one line above
    CanvasRect speed_notes, altitude_notes; // two lines below
    CanvasRect panel;                       // room for HUD_PANEL_ROWS; empty when not asked for, or no room
    CanvasRect legend;                      // as large, in the other corner; of a split picture the right half's panel
    CanvasRect
        legend_low;      // where the left legend of a split picture finds room, the right one mirrored; empty: nowhere
    CanvasRect accuracy; // of accuracy against time: hud_layout_add_accuracy; empty: not asked for, or no room
    CanvasRect note;     // "paused"
    CanvasRect message;
    CanvasRect help; // the most that the page of keys may take
} HudLayout;

// `width`, `height` >= 1. `show_panels`: the panel of numbers, the legend, or both; below 640 x 400 there is no room.
HudLayout hud_layout_make(int width, int height, bool show_panels);

// For two halves with a view each: the scales near the middle, the circle as it fits into a half, its centre the
// caller's matter.
void hud_layout_split(HudLayout *layout);

// After hud_layout_split, where that is called: makes room for the panel of accuracy against time, in the place of the
// legend, which moves below or loses its place; in a split picture under the panel of the left half, whose legend loses
// its place. A circle beside it gets smaller.
void hud_layout_add_accuracy(HudLayout *layout, bool split);

// Where a replay's time is told, and dragged along: the times left of the bar, what to mind right of it. The bar is
// empty (x0 == x1) where there is no room.
typedef struct HudReplayPlace {
    CanvasRect plate, bar;
    float inset; // between the plate's sides, the texts and the bar
} HudReplayPlace;
// `derived`: it is told that the attitude is.
HudReplayPlace hud_layout_replay(const HudLayout *layout, bool derived);
bool hud_replay_is_on(const HudReplayPlace *place, double x, double y); // on the bar, or near enough to take hold of it
double hud_replay_share(const HudReplayPlace *place, double x);         // 0..1, also beside the bar

// The camera as the display needs it.
typedef struct HudView {
    Vec3d up; // unit: the geodetic normal at the eye, camera frame
    Mat3d camera_from_ecef;
    double focal_px; // pixels per radian at the centre
    double centre_x, centre_y;
} HudView;

HudView hud_view_make(const RenderCamera *camera, int width, int height);

// The point where a direction of the camera frame (any length) appears; false when it is behind the camera or so far
// to the side that no window shows it.
bool hud_view_project(const HudView *view, Vec3d direction, CanvasPoint *out);

// The part of the horizon (all directions at right angles to `up`) inside a circle around the view's centre; false when
// it passes outside.
bool hud_view_horizon(const HudView *view, float radius_px, CanvasPoint *a, CanvasPoint *b);

// The frame of the pitch ladder in camera coordinates: `ahead` and `right` are level, `ahead` below or above the middle
// of the view. `pitch_rad` is that of the view; towards the zenith `ahead` turns as fast as it likes, and `steady`
// falls from 1 at 84 degrees to 0 at 89, to fade by it what turns.
typedef struct HudLadder {
    Vec3d ahead, right;
    double pitch_rad;
    double steady;
} HudLadder;
HudLadder hud_view_ladder(const HudView *view);
// The direction at a pitch, and at an azimuth from `ahead` to the right.
Vec3d hud_ladder_direction(const HudView *view, const HudLadder *ladder, double pitch_rad, double azimuth_rad);

// As HudLadder.steady for a pitch told by somebody else.
double hud_steadiness(double pitch_rad);
