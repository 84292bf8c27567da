// render/timing.h: how long the GPU works on a frame: timer queries on hardware, glFinish and the clock on a
// software renderer, whose timer queries are nonsense.
// Milliseconds.
// A Timing owns its queries; thread of the context.
#pragma once
#include "base/base.h"

#define TIMING_QUERIES 4

typedef struct Timing {
    bool software;
    int64_t begin_ns;
    unsigned queries[TIMING_QUERIES];
    uint64_t begun; // frames
    uint64_t read;  // frames whose query was read
    double last_ms;
} Timing;

Timing timing_create(bool software);
void timing_destroy(Timing *timing);
void timing_begin(Timing *timing);
// `wait`: the figure is of this very frame; else, on hardware, of the newest frame that is ready.
double timing_end(Timing *timing, bool wait);
