#include "app/live/history.h"

#include "base/statistics.h"

#include <math.h>

#define PRESENT_FRAMES 120
#define PRESENT_S 1.0
#define PRESENT_FRAMES_LEAST 5 // of slow ones

void history_add(History *history, const PipelineFrame *frame) {
    history->frames[history->count++ % HISTORY_FRAMES] = *frame;
}

// Going back from the last one; NULL: there is none.
static const PipelineFrame *frame_before(const History *history, int64_t back) {
    bool kept = back < history->count && back < HISTORY_FRAMES;
    return kept ? &history->frames[(history->count - 1 - back) % HISTORY_FRAMES] : NULL;
}

double history_work_ms(const PipelineFrame *frame) {
    return (double)frame->select_ms + (double)frame->refine_ms + (double)frame->upload_ms + (double)frame->draw_ms;
}

static bool is_present(const PipelineFrame *frame, const PipelineFrame *last, int64_t back) {
    double age_s = (double)(last->end_ns - frame->end_ns) * 1e-9;
    return frame->tau_px == last->tau_px && frame->method == last->method && frame->split == last->split &&
           (age_s <= PRESENT_S || back < PRESENT_FRAMES_LEAST);
}

double history_present_ms(const History *history) {
    double work_ms[PRESENT_FRAMES];
    const PipelineFrame *last = frame_before(history, 0), *frame;
    int count = 0;
    for (; count < PRESENT_FRAMES && (frame = frame_before(history, count)) && is_present(frame, last, count); count++)
        work_ms[count] = history_work_ms(frame);
    statistics_sort(work_ms, count);
    return count > 0 ? statistics_percentile(work_ms, count, 0.5) : (double)NAN;
}

static RenderAccuracyFrame stages_of(const PipelineFrame *frame) {
    return (RenderAccuracyFrame){frame->select_ms, frame->refine_ms, frame->upload_ms, frame->draw_ms};
}

static void add_share(RenderAccuracyFrame *mean, const PipelineFrame *frame, float share) {
    mean->select_ms += frame->select_ms * share;
    mean->refine_ms += frame->refine_ms * share;
    mean->upload_ms += frame->upload_ms * share;
    mean->draw_ms += frame->draw_ms * share;
}

static int count_recent(const History *history, int64_t now_ns) {
    int64_t since_ns = now_ns - (int64_t)(HISTORY_S * 1e9);
    const PipelineFrame *frame;
    int count = 0;
    while ((frame = frame_before(history, count)) && frame->end_ns > since_ns)
        count++;
    return count;
}

// Where frames are so many that those of HISTORY_S are not kept.
static double seconds_kept(const History *history, int64_t now_ns) {
    return (double)(now_ns - frame_before(history, HISTORY_FRAMES - 1)->end_ns) * 1e-9;
}

void history_summarise(const History *history, int64_t now_ns, RenderAccuracy *out) {
    double frame_ms[HISTORY_FRAMES];
    int recent = count_recent(history, now_ns), count = 0;
    out->mean = (RenderAccuracyFrame){0};
    for (int i = 0; i < recent; i++) {
        const PipelineFrame *frame = frame_before(history, i);
        add_share(&out->mean, frame, 1.0f / (float)recent);
        if (frame->frame_ms > 0.0f)
            frame_ms[count++] = (double)frame->frame_ms;
    }
    statistics_sort(frame_ms, count);
    out->p50_ms = count > 0 ? statistics_percentile(frame_ms, count, 0.50) : (double)NAN;
    out->p99_ms = count > 0 ? statistics_percentile(frame_ms, count, 0.99) : (double)NAN;
    out->seconds = recent < HISTORY_FRAMES ? HISTORY_S : seconds_kept(history, now_ns);
}

void history_fill_frames(const History *history, RenderAccuracy *out) {
    int64_t kept = history->count < RENDER_ACCURACY_FRAMES ? history->count : RENDER_ACCURACY_FRAMES;
    out->frame_count = (int)kept;
    for (int64_t i = 0; i < kept; i++)
        out->frames[i] = stages_of(frame_before(history, kept - 1 - i));
}
