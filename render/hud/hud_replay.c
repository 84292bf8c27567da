// Where a recorded flight is: its time on a bar, how fast it goes and which way, and what of it is not recorded.
#include "render/hud/hud_paint.h"

#include "base/rate.h"

#include <math.h>
#include <stdio.h>

#define TIME_BYTES 32

// "12:34" or "1:02:34".
static void write_time(double t_s, char out[TIME_BYTES]) {
    long long seconds = isfinite(t_s) ? (long long)fmin(fmax(t_s, 0.0), 1e9) : 0;
    if (seconds >= 3600)
        snprintf(out, TIME_BYTES, "%lld:%02lld:%02lld", seconds / 3600, seconds / 60 % 60, seconds % 60);
    else
        snprintf(out, TIME_BYTES, "%lld:%02lld", seconds / 60, seconds % 60);
}

static void write_state(const RenderReplay *replay, char out[TIME_BYTES]) {
    if (replay->in_gap)
        snprintf(out, TIME_BYTES, "not recorded");
    else if (replay->paused)
        snprintf(out, TIME_BYTES, "paused");
    else
        rate_write(replay->rate, out);
}

static void paint_bar(const HudPainter *painter, const RenderReplay *replay, CanvasRect bar) {
    double share = replay->duration_s > 0.0 ? replay->t_s / replay->duration_s : 1.0;
    float u = painter->layout.unit, at = bar.x0 + (bar.x1 - bar.x0) * (float)fmin(fmax(share, 0.0), 1.0);
    CanvasRect done = {bar.x0, bar.y0, at, bar.y1},
               head = {at - 1.5f * u, bar.y0 - 4.0f * u, at + 1.5f * u, bar.y1 + 4.0f * u};
    canvas_box(painter->canvas, bar, 2.0f * u, hud_faded(HUD_INK, 0.25));
    canvas_box(painter->canvas, done, 2.0f * u, replay->in_gap ? HUD_WARN : HUD_ACCENT);
    canvas_box(painter->canvas, head, 1.0f * u, HUD_INK);
}

// The plate stands where "paused" does for who flies: left the times, right the rate, and above it what to mind.
void hud_paint_replay(const HudPainter *painter, const RenderReplay *replay) {
    HudReplayPlace place = hud_layout_replay(&painter->layout, replay->derived);
    CanvasRect plate = place.plate, bar = place.bar;
    float u = painter->layout.unit, size = painter->layout.small_px, inset = place.inset;
    char now[TIME_BYTES], all[TIME_BYTES], times[2 * TIME_BYTES + 4], rate[TIME_BYTES], state[TIME_BYTES + 24];
    write_time(replay->t_s, now);
    write_time(replay->duration_s, all);
    snprintf(times, sizeof times, "%s / %s", now, all);
    write_state(replay, rate);
    snprintf(state, sizeof state, "%s%s", replay->derived && !replay->in_gap ? "attitude derived, " : "", rate);
    canvas_box(painter->canvas, plate, 4.0f * u, HUD_PLATE_DENSE);
    float y = hud_baseline(painter, 0.5f * (plate.y0 + plate.y1), size);
    bool has_bar = bar.x1 > bar.x0;
    float right = has_bar ? bar.x1 + inset : bar.x0;
    float times_size = hud_fitting_size(painter, times, size, bar.x0 - plate.x0 - 2.0f * inset);
    float state_size = hud_fitting_size(painter, state, size, plate.x1 - inset - right);
    hud_text(painter, (CanvasPoint){plate.x0 + inset, y}, times_size, CANVAS_LEFT, HUD_INK, times);
    hud_text(painter, (CanvasPoint){plate.x1 - inset, y}, state_size, CANVAS_RIGHT, replay->in_gap ? HUD_WARN : HUD_INK,
             state);
    if (has_bar)
        paint_bar(painter, replay, bar);
}
