// app/pipeline/frame_times.h: how long frames took, and what percentiles that gives.
// Milliseconds.
// A value; one thread at a time.
#pragma once
#include "base/base.h"

#define FRAME_TIMES_KEPT 16384 // the latest; the maximum is of all

typedef struct FrameTimes {
    float ms[FRAME_TIMES_KEPT];
    int64_t count; // of all
    double max_ms, sum_ms;
} FrameTimes;

typedef struct FrameTimesSummary {
    double mean, p50, p95, p99, max; // 0 without frames
} FrameTimesSummary;

void frame_times_add(FrameTimes *times, double ms);
// Percentiles over the latest `latest` frames (at most FRAME_TIMES_KEPT); mean and maximum over all.
FrameTimesSummary frame_times_summary(const FrameTimes *times, int latest);
