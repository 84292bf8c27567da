// app/live/history.h: the frames of the last seconds: their stages, and how evenly they came.
// Milliseconds; nanoseconds as base/clock.h counts.
// A value; one thread at a time.
#pragma once
#include "app/pipeline/pipeline_counts.h"
#include "render/accuracy.h"

#define HISTORY_FRAMES 600 // 5 s at 120 a second
#define HISTORY_S 5.0

typedef struct History {
    PipelineFrame frames[HISTORY_FRAMES]; // a ring
    int64_t count;                        // of all
} History;

void history_add(History *history, const PipelineFrame *frame);
// The stages of a frame, one after another.
double history_work_ms(const PipelineFrame *frame);
// The median work of the latest frames with the tolerance of the last one, a second of them at most. NaN: none.
double history_present_ms(const History *history);
// Percentiles and means of the last seconds.
void history_summarise(const History *history, int64_t now_ns, RenderAccuracy *out);
// The latest frames' stages.
void history_fill_frames(const History *history, RenderAccuracy *out);
