// app/live/pace.h: work beside a flight that takes a small share of a processor.
// Nanoseconds.
// A value, owned by the thread that works.
#pragma once
#include "base/base.h"

#define PACE_HURRY 8

typedef struct Pace {
    double share;         // of one processor's time, 0..1
    int64_t hurry_ns;     // of work, that is left to do in PACE_HURRY times the share
    int64_t rested_at_ns; // the thread's own time when it rested last
} Pace;

// For the calling thread, whose priority becomes the lowest. `share` of all processors' time, at most half of one.
Pace pace_begin(double share);
// The thread's own time since it rested.
int64_t pace_worked_ns(const Pace *pace);
// How long it has to rest now, for what it worked; counts anew from here.
int64_t pace_rest_ns(Pace *pace);
// What the calling thread has used of a processor in its life.
int64_t pace_thread_ns(void);
