// The panel of accuracy against time: the error as it was measured, frame time over the tolerance, the stages' times.
#include "render/hud/hud_paint.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define TAU "\xCF\x84"
#define LEAST_PX 0.25 // the axis of tolerances, which grows where it must
#define MOST_PX 16.0
#define OCTAVE_LEAST (-10.0) // and no further
#define OCTAVE_MOST 16.0
#define ROWS_FULL 24.0f   // from so many on nothing is left out
#define ROWS_STACK 14.0f  // below: no stages
#define ROWS_CHART 9.0f   // below: no curve
#define FRAMES_A_COLUMN 2 // of the stages

// The stages, in the order in which a frame passes them.
enum { STAGES = 4 };
static const char *const STAGE_NAMES[STAGES] = {"select", "refine", "upload", "draw"};
static const CanvasColour STAGE_COLOURS[STAGES] = {{0.40f, 0.70f, 1.00f, 0.95f},
                                                   {0.45f, 0.95f, 0.62f, 0.95f},
                                                   {1.00f, 0.76f, 0.30f, 0.95f},
                                                   {0.72f, 0.62f, 0.95f, 0.90f}};

// Where the next row of the panel goes.
typedef struct Board {
    const HudPainter *painter;
    const RenderAccuracy *told;
    CanvasRect box; // the plate
    float y;
    bool full; // nothing is left out for want of room
} Board;

static float row_px(const Board *board) {
    return board->painter->layout.row_px;
}

static void add_row(Board *board, const char *name, const char *value, const char *unit, CanvasColour colour) {
    hud_paint_row(board->painter, board->box, board->y, &(HudRow){name, value, unit, colour});
    board->y += row_px(board);
}

static void add_number(Board *board, const char *name, double value, int decimals, const char *unit,
                       CanvasColour colour) {
    char text[HUD_NUMBER_BYTES];
    hud_format_fixed(text, value, decimals);
    add_row(board, name, text, unit, colour);
}

static void add_text(const Board *board, float x, CanvasAlign align, CanvasColour colour, const char *text) {
    float size = board->painter->layout.small_px;
    CanvasPoint at = {x, hud_baseline(board->painter, board->y + row_px(board) * 0.5f, size)};
    hud_text(board->painter, at, size, align, colour, text);
}

static float inner_x0(const Board *board) {
    return board->box.x0 + 10.0f * board->painter->layout.unit;
}

static float inner_x1(const Board *board) {
    return board->box.x1 - 10.0f * board->painter->layout.unit;
}

// ---- the error ----

static const char *why_not_measured(RenderAccuracyState state) {
    static const char *const WHY[RENDER_ACCURACY_STATE_COUNT] = {
        "measuring", "", "", "on the GPU only", "not drawn whole", "too many triangles", "failed: see log"};
    return WHY[state];
}

static bool is_measured(const RenderAccuracyError *error) {
    return error->state == RENDER_ACCURACY_MEASURED;
}

static bool is_begun(const RenderAccuracyError *error) {
    return is_measured(error) || error->state == RENDER_ACCURACY_SO_FAR;
}

static void add_largest(Board *board, const RenderAccuracyError *error) {
    if (!is_begun(error)) {
        add_row(board, "largest error", why_not_measured(error->state), "", HUD_DIM);
        return;
    }
    bool kept = error->promises && error->max_px <= error->promised_px;
    const char *name = is_measured(error) ? "largest error" : "largest so far";
    add_number(board, name, error->max_px, 2, "px", kept ? HUD_ACCENT : HUD_WARN);
}

static void add_promise(Board *board, const RenderAccuracyError *error) {
    bool begun = is_begun(error);
    if (begun && !error->promises)
        add_row(board, "promised", "no bound", "", HUD_WARN);
    else
        add_number(board, "promised, at most", begun ? error->promised_px : (double)NAN, 2, "px", HUD_INK);
}

static void add_age(Board *board, const RenderAccuracyError *error) {
    char name[HUD_NUMBER_BYTES + 16], tau[HUD_NUMBER_BYTES];
    if (error->state == RENDER_ACCURACY_SO_FAR) {
        add_number(board, "measured of the terrain", 100.0 * error->share, 0, "%", HUD_INK);
        return;
    }
    bool other = is_measured(error) && error->tau_px != board->told->tau_px;
    hud_format_fixed(tau, error->tau_px, 2);
    snprintf(name, sizeof name, other ? "measured at " TAU " %s" : "measured, ago", tau);
    add_number(board, name, is_measured(error) ? error->age_s : (double)NAN, 1, "s", other ? HUD_WARN : HUD_INK);
}

static void add_details(Board *board, const RenderAccuracyError *error) {
    bool measured = is_measured(error);
    double above = measured ? 100.0 * error->above_tau_share : (double)NAN;
    double cracks = measured ? (double)error->cracks : (double)NAN;
    add_number(board, "99.9 % within", measured ? error->p999_px : (double)NAN, 2, "px", HUD_INK);
    add_number(board, "samples above " TAU, above, 3, "%", measured && above > 0.0 ? HUD_WARN : HUD_INK);
    add_number(board, "cracks", cracks, 0, "", measured && cracks > 0.0 ? HUD_WARN : HUD_INK);
}

static void add_error(Board *board) {
    const RenderAccuracyError *error = &board->told->error;
    add_largest(board, error);
    add_promise(board, error);
    if (board->full)
        add_details(board, error);
    add_age(board, error);
}

// ---- frame time over the tolerance ----

typedef struct Chart {
    CanvasRect area;
    double log_least, log_most; // binary, of the tolerance
    double axis_ms;
} Chart;

static double octave_within(double tau_px, double otherwise) {
    double octave = isfinite(tau_px) && tau_px > 0.0 ? log2(tau_px) : log2(otherwise);
    return fmin(fmax(octave, OCTAVE_LEAST), OCTAVE_MOST);
}

static Chart chart_of(const Board *board, CanvasRect area) {
    const RenderAccuracy *told = board->told;
    double axis_ms = isfinite(told->axis_ms) && told->axis_ms > 0.0 ? told->axis_ms : 1.0;
    return (Chart){area, fmin(log2(LEAST_PX), floor(octave_within(told->tau_px, LEAST_PX))),
                   fmax(log2(MOST_PX), ceil(octave_within(told->tau_px, MOST_PX))), axis_ms};
}

static float chart_x(const Chart *chart, double tau_px) {
    double share = (log2(tau_px) - chart->log_least) / (chart->log_most - chart->log_least);
    return chart->area.x0 + (chart->area.x1 - chart->area.x0) * (float)share;
}

// What is above the axis lies on its end.
static float chart_y(const Chart *chart, double ms) {
    double share = fmin(fmax(ms / chart->axis_ms, 0.0), 1.0);
    return chart->area.y1 - (chart->area.y1 - chart->area.y0) * (float)share;
}

static bool is_in_chart(const Chart *chart, double tau_px, double ms) {
    bool within = isfinite(tau_px) && tau_px > 0.0 && isfinite(ms) && ms >= 0.0 && ms <= chart->axis_ms;
    return within && log2(tau_px) >= chart->log_least && log2(tau_px) <= chart->log_most;
}

// A line without a halo, for what lies behind.
static void paint_thin(const Board *board, float x0, float y0, float x1, float y1, CanvasColour colour) {
    float half = 0.5f * fmaxf(board->painter->layout.unit, 1.0f);
    CanvasRect box = {x0 - (x0 == x1 ? half : 0.0f), y0 - (y0 == y1 ? half : 0.0f), x1 + (x0 == x1 ? half : 0.0f),
                      y1 + (y0 == y1 ? half : 0.0f)};
    canvas_box(board->painter->canvas, box, 0.0f, colour);
}

static void name_tau(int octave, char out[HUD_NUMBER_BYTES]) {
    static const char *const SHARES[] = {"\xE2\x85\x9B", "\xC2\xBC", "\xC2\xBD"}; // an eighth, a quarter, a half
    if (octave >= -3 && octave < 0)
        snprintf(out, HUD_NUMBER_BYTES, "%s", SHARES[octave + 3]);
    else if (octave < 0)
        snprintf(out, HUD_NUMBER_BYTES, "1/%.0f", exp2(-octave));
    else
        hud_format_fixed(out, exp2(octave), 0);
}

static void paint_tau_axis(const Board *board, const Chart *chart) {
    int octaves = (int)(chart->log_most - chart->log_least), step = octaves > 9 ? 3 : octaves > 7 ? 2 : 1;
    float size = board->painter->layout.small_px;
    float y = hud_baseline(board->painter, chart->area.y1 + row_px(board) * 0.55f, size);
    for (int i = 0; i <= octaves; i++) {
        char label[HUD_NUMBER_BYTES];
        int octave = (int)chart->log_least + i;
        float x = chart_x(chart, exp2(octave));
        paint_thin(board, x, chart->area.y0, x, chart->area.y1, hud_faded(HUD_INK, 0.12));
        name_tau(octave, label);
        float most = inner_x1(board) - 0.5f * text_width_px(board->painter->text, label, size);
        if (i % step == 0)
            hud_text(board->painter, (CanvasPoint){fminf(x, most), y}, size, CANVAS_CENTRE, HUD_DIM, label);
    }
}

static void paint_time_axis(const Board *board, const Chart *chart) {
    const HudPainter *painter = board->painter;
    float size = painter->layout.small_px, room = chart->area.x0 - inner_x0(board) - 0.4f * size;
    for (int i = 0; i <= 2; i++) {
        char label[HUD_NUMBER_BYTES];
        double ms = chart->axis_ms * 0.5 * i;
        float y = chart_y(chart, ms);
        paint_thin(board, chart->area.x0, y, chart->area.x1, y, hud_faded(HUD_INK, i == 0 ? 0.5 : 0.12));
        hud_format_fixed(label, ms, i == 0 || ms >= 5.0 ? 0 : ms >= 0.5 ? 1 : 2);
        CanvasPoint at = {chart->area.x0 - 0.4f * size, hud_baseline(painter, y, size)};
        hud_text(painter, at, hud_fitting_size(painter, label, size, room), CANVAS_RIGHT, HUD_DIM, label);
    }
}

static void paint_disc(const Board *board, CanvasPoint at, float radius_px, CanvasColour colour) {
    canvas_ring(board->painter->canvas, at, radius_px * 0.5f, radius_px, colour);
}

static void paint_sample(const Board *board, const Chart *chart, const RenderAccuracyPoint *point) {
    float x = chart_x(chart, (double)point->tau_px), u = board->painter->layout.unit;
    CanvasColour colour = hud_faded(HUD_INK, 0.35 + 0.5 * (double)point->freshness);
    if (!board->told->slope_known)
        colour = hud_faded(colour, 0.55);
    paint_thin(board, x, chart_y(chart, (double)point->most_ms), x, chart_y(chart, (double)point->least_ms),
               hud_faded(colour, 0.55));
    if (is_in_chart(chart, (double)point->tau_px, (double)point->frame_ms))
        canvas_ring(board->painter->canvas, (CanvasPoint){x, chart_y(chart, (double)point->frame_ms)}, 2.6f * u,
                    1.2f * u, colour);
}

static bool is_usable(const RenderAccuracyPoint *point) {
    return point->tau_px > 0.0f && isfinite(point->tau_px) && isfinite(point->frame_ms) && isfinite(point->least_ms) &&
           isfinite(point->most_ms) && isfinite(point->freshness);
}

// Through the samples, from one to the next, once frames tell how they lie; till then they are guesses, and no line.
static void paint_curve(const Board *board, const Chart *chart) {
    const RenderAccuracyPoint *before = NULL;
    for (int i = 0; i < board->told->point_count; i++) {
        const RenderAccuracyPoint *point = &board->told->points[i];
        bool sampled = is_usable(point) && !point->flown &&
                       is_in_chart(chart, (double)point->tau_px, fmin((double)point->frame_ms, chart->axis_ms));
        if (!sampled)
            continue;
        CanvasPoint at = {chart_x(chart, (double)point->tau_px), chart_y(chart, (double)point->frame_ms)};
        if (before && board->told->slope_known) {
            CanvasPoint from = {chart_x(chart, (double)before->tau_px), chart_y(chart, (double)before->frame_ms)};
            canvas_line(board->painter->canvas, from, at, 1.2f * board->painter->layout.unit, hud_faded(HUD_INK, 0.55));
        }
        paint_sample(board, chart, point);
        before = point;
    }
}

static void paint_flown(const Board *board, const Chart *chart) {
    float u = board->painter->layout.unit;
    for (int i = 0; i < board->told->point_count; i++) {
        const RenderAccuracyPoint *point = &board->told->points[i];
        if (!point->flown || !is_usable(point) || !is_in_chart(chart, (double)point->tau_px, (double)point->frame_ms))
            continue;
        CanvasPoint at = {chart_x(chart, (double)point->tau_px), chart_y(chart, (double)point->frame_ms)};
        paint_disc(board, at, 3.0f * u, hud_faded(HUD_INK, 0.4 + 0.6 * (double)point->freshness));
    }
}

// With lines to both axes.
static void paint_present(const Board *board, const Chart *chart) {
    const RenderAccuracy *told = board->told;
    if (!is_in_chart(chart, told->tau_px, fmin(told->frame_ms, chart->axis_ms)) || !isfinite(told->frame_ms))
        return;
    CanvasPoint at = {chart_x(chart, told->tau_px), chart_y(chart, told->frame_ms)};
    CanvasColour faint = hud_faded(HUD_ACCENT, 0.45);
    paint_thin(board, chart->area.x0, at.y, at.x, at.y, faint);
    paint_thin(board, at.x, at.y, at.x, chart->area.y1, faint);
    paint_disc(board, at, 5.0f * board->painter->layout.unit, HUD_ACCENT);
}

static void paint_target(const Board *board, const Chart *chart) {
    double target_ms = board->told->target_ms;
    if (!isfinite(target_ms) || target_ms <= 0.0 || target_ms > chart->axis_ms)
        return;
    float y = chart_y(chart, target_ms), dash = 5.0f * board->painter->layout.unit;
    for (float x = chart->area.x0; x + dash <= chart->area.x1; x += 2.0f * dash)
        paint_thin(board, x, y, x + dash, y, HUD_WARN);
}

static void add_key(Board *board) {
    const HudPainter *painter = board->painter;
    float u = painter->layout.unit, size = painter->layout.small_px, x = inner_x0(board);
    float y = roundf(board->y + row_px(board) * 0.5f);
    paint_disc(board, (CanvasPoint){x + 5.0f * u, y}, 5.0f * u, HUD_ACCENT);
    add_text(board, x + 14.0f * u, CANVAS_LEFT, HUD_DIM, "now");
    x += 14.0f * u + 3.4f * size;
    paint_disc(board, (CanvasPoint){x + 3.0f * u, y}, 3.0f * u, HUD_INK);
    add_text(board, x + 10.0f * u, CANVAS_LEFT, HUD_DIM, "flown");
    x += 10.0f * u + 4.1f * size;
    canvas_ring(painter->canvas, (CanvasPoint){x + 3.0f * u, y}, 2.6f * u, 1.2f * u, HUD_INK);
    add_text(board, x + 10.0f * u, CANVAS_LEFT, HUD_DIM, "sampled");
    board->y += row_px(board);
}

static void add_chart(Board *board, float height_px) {
    float size = board->painter->layout.small_px, bottom = board->y + height_px;
    add_text(board, inner_x0(board), CANVAS_LEFT, HUD_DIM, "frame time over " TAU);
    add_text(board, inner_x1(board), CANVAS_RIGHT, HUD_DIM, "ms, px");
    board->y += row_px(board);
    if (board->full)
        bottom -= row_px(board); // of the key
    CanvasRect area = {inner_x0(board) + 2.6f * size, board->y + 0.5f * row_px(board), inner_x1(board) - 0.6f * size,
                       bottom - 1.1f * row_px(board)};
    area = (CanvasRect){roundf(area.x0), roundf(area.y0), roundf(area.x1), roundf(area.y1)};
    const Chart chart = chart_of(board, area);
    paint_tau_axis(board, &chart);
    paint_time_axis(board, &chart);
    paint_target(board, &chart);
    paint_curve(board, &chart);
    paint_flown(board, &chart);
    paint_present(board, &chart);
    board->y = bottom;
    if (board->full)
        add_key(board);
}

// ---- where the time goes ----

static float stage_ms(float ms) {
    return isfinite(ms) ? fmaxf(ms, 0.0f) : 0.0f;
}

static void stages_of(const RenderAccuracyFrame *frame, float out[STAGES]) {
    const float stages[STAGES] = {frame->select_ms, frame->refine_ms, frame->upload_ms, frame->draw_ms};
    for (int i = 0; i < STAGES; i++)
        out[i] = stage_ms(stages[i]);
}

static void paint_column(const Board *board, const float stages[STAGES], CanvasRect column, float px_per_ms) {
    float y = column.y1;
    for (int i = 0; i < STAGES && y > column.y0; i++) {
        float top = fmaxf(y - stages[i] * px_per_ms, column.y0);
        if (y - top > 0.05f)
            canvas_box(board->painter->canvas, (CanvasRect){column.x0, top, column.x1, y}, 0.0f, STAGE_COLOURS[i]);
        y = top;
    }
}

// The mean of a column's frames.
static void mean_of(const RenderAccuracyFrame *frames, int count, float out[STAGES]) {
    memset(out, 0, sizeof *out * STAGES);
    for (int i = 0; i < count; i++) {
        float stages[STAGES];
        stages_of(&frames[i], stages);
        for (int k = 0; k < STAGES; k++)
            out[k] += stages[k] / (float)count;
    }
}

// Nearly all frames fit below it.
static float stack_axis_ms(const RenderAccuracy *told) {
    bool known = isfinite(told->p99_ms) && told->p99_ms > 0.0;
    return known ? 1.15f * (float)told->p99_ms : 1.0f;
}

// The latest frames, the last ones at the right edge.
static void paint_stack(const Board *board, CanvasRect area) {
    const RenderAccuracy *told = board->told;
    float step = (area.x1 - area.x0) / (RENDER_ACCURACY_FRAMES / FRAMES_A_COLUMN);
    float axis_ms = stack_axis_ms(told), x = area.x1;
    for (int end = told->frame_count; end >= FRAMES_A_COLUMN; end -= FRAMES_A_COLUMN, x -= step) {
        float stages[STAGES];
        mean_of(&told->frames[end - FRAMES_A_COLUMN], FRAMES_A_COLUMN, stages);
        paint_column(board, stages, (CanvasRect){x - step, area.y0, x, area.y1}, (area.y1 - area.y0) / axis_ms);
    }
    paint_thin(board, area.x0, area.y1, area.x1, area.y1, hud_faded(HUD_INK, 0.5));
}

static void paint_stage(const Board *board, int stage, float ms, float x0, float x1) {
    const HudPainter *painter = board->painter;
    float u = painter->layout.unit, size = painter->layout.small_px, middle = board->y + row_px(board) * 0.5f;
    char text[HUD_NUMBER_BYTES];
    CanvasRect swatch = {roundf(x0), roundf(middle - 4.0f * u), roundf(x0 + 8.0f * u), roundf(middle + 4.0f * u)};
    canvas_box(painter->canvas, swatch, 1.5f * u, STAGE_COLOURS[stage]);
    add_text(board, swatch.x1 + 5.0f * u, CANVAS_LEFT, HUD_DIM, STAGE_NAMES[stage]);
    hud_format_fixed(text, (double)ms, ms < 99.95f ? 2 : 0);
    float room = x1 - swatch.x1 - 5.0f * u - text_width_px(painter->text, STAGE_NAMES[stage], size) - 0.4f * size;
    CanvasPoint at = {x1, hud_baseline(painter, middle, size)};
    hud_text(painter, at, hud_fitting_size(painter, text, size, room), CANVAS_RIGHT, HUD_INK, text);
}

// Two rows of two.
static void add_stages(Board *board) {
    float stages[STAGES], x0 = inner_x0(board), x1 = inner_x1(board), middle = 0.5f * (x0 + x1);
    stages_of(&board->told->mean, stages);
    for (int i = 0; i < STAGES; i += 2) {
        paint_stage(board, i, stages[i], x0, middle - 6.0f * board->painter->layout.unit);
        paint_stage(board, i + 1, stages[i + 1], middle + 6.0f * board->painter->layout.unit, x1);
        board->y += row_px(board);
    }
}

static void add_percentiles(Board *board) {
    char name[HUD_NUMBER_BYTES + 16], p50[HUD_NUMBER_BYTES], p99[HUD_NUMBER_BYTES], both[2 * HUD_NUMBER_BYTES + 4];
    const RenderAccuracy *told = board->told;
    int decimals = isfinite(told->p99_ms) && told->p99_ms < 100.0 ? 1 : 0;
    hud_format_fixed(p50, told->p50_ms, decimals);
    hud_format_fixed(p99, told->p99_ms, decimals);
    snprintf(name, sizeof name, "p50, p99 of %.0f s", isfinite(told->seconds) ? fmin(told->seconds, 999.0) : 0.0);
    snprintf(both, sizeof both, "%s, %s", p50, p99);
    add_row(board, name, both, "ms", HUD_INK);
}

static void add_stack(Board *board, float height_px) {
    char text[HUD_NUMBER_BYTES];
    float bottom = board->y + height_px;
    hud_format_fixed(text, board->told->frame_ms, 1);
    add_row(board, "where the time goes", text, "ms", HUD_ACCENT);
    CanvasRect area = {inner_x0(board), board->y + 2.0f, inner_x1(board), bottom - 3.2f * row_px(board)};
    paint_stack(board, area);
    board->y = bottom - 3.0f * row_px(board);
    add_stages(board);
    add_percentiles(board);
}

// ---- all of it ----

static void add_title(Board *board, const RenderPacket *packet) {
    char method[64];
    const char *name = packet->hud.method ? packet->hud.method : "---";
    snprintf(method, sizeof method, packet->split ? "left: %s" : "%s", name);
    float size = board->painter->layout.small_px, x0 = inner_x0(board), x1 = inner_x1(board);
    const char *title = "accuracy and time";
    float room = x1 - x0 - text_width_px(board->painter->text, title, size) - 0.6f * size;
    CanvasPoint at = {x1, hud_baseline(board->painter, board->y + row_px(board) * 0.5f, size)};
    add_text(board, x0, CANVAS_LEFT, HUD_INK, title);
    hud_text(board->painter, at, hud_fitting_size(board->painter, method, size, room), CANVAS_RIGHT, HUD_ACCENT,
             method);
    board->y += row_px(board);
}

static Board board_of(const HudPainter *painter, const RenderPacket *packet) {
    CanvasRect box = painter->layout.accuracy;
    float u = painter->layout.unit, rows = (box.y1 - box.y0 - 16.0f * u) / painter->layout.row_px;
    return (Board){painter, &packet->hud.accuracy, box, box.y0 + 8.0f * u, rows >= ROWS_FULL};
}

// Two thirds of what is left for the curve, the rest for the stages.
static void add_charts(Board *board) {
    float u = board->painter->layout.unit, row = row_px(board), room = board->box.y1 - 8.0f * u - board->y;
    float rows = (board->box.y1 - board->box.y0 - 16.0f * u) / row;
    if (rows < ROWS_CHART)
        return;
    float gap = 0.4f * row, stack = rows < ROWS_STACK ? 0.0f : fmaxf(5.6f * row, 0.4f * room);
    board->y += gap;
    add_chart(board, room - gap - (stack > 0.0f ? stack + gap : 0.0f));
    board->y = board->box.y1 - 8.0f * u - stack;
    if (stack > 0.0f)
        add_stack(board, stack);
}

void hud_paint_accuracy(const HudPainter *painter, const RenderPacket *packet) {
    CanvasRect box = painter->layout.accuracy;
    if (box.x1 <= box.x0)
        return;
    Board board = board_of(painter, packet);
    canvas_box(painter->canvas, box, HUD_ACCURACY_CORNER * painter->layout.unit, HUD_PLATE_OPAQUE);
    canvas_set_halos(painter->canvas, false); // half the price of painting
    add_title(&board, packet);
    if (box.y1 - board.y >= 3.0f * row_px(&board))
        add_error(&board);
    else
        add_largest(&board, &board.told->error);
    add_charts(&board);
    canvas_set_halos(painter->canvas, true);
}
