// app/replay/timeline.h: where in a recorded flight a replay is, and how fast and which way it goes.
// Seconds from the flight's begin.
// A value.
#pragma once
#include "base/base.h"

#define TIMELINE_RATE_LEAST (-3) // of the binary logarithm: an eighth
#define TIMELINE_RATE_MOST 6     // 64 times

typedef struct Timeline {
    double t_s;        // 0..duration_s
    double carry_s;    // what rounding lost of t_s, so that the millionth frame of a film is where it belongs
    double duration_s; // >= 0
    int rate;          // binary logarithm
    bool backwards, paused;
} Timeline;

Timeline timeline_create(double duration_s);
double timeline_rate(const Timeline *timeline); // below 0: backwards
// Goes on; at either end it stays, and pauses.
void timeline_advance(Timeline *timeline, double passed_s);
void timeline_change_rate(Timeline *timeline, int by);
// To a time, or to the end next to it. NaN is let be.
void timeline_jump(Timeline *timeline, double t_s);
// Stops or goes on; from the end it would run into it begins at the other one.
void timeline_play_or_pause(Timeline *timeline);
void timeline_turn(Timeline *timeline);            // the other way round, and on
double timeline_left_s(const Timeline *timeline);  // of a clock's time, to the end of the way it goes
bool timeline_is_at_end(const Timeline *timeline); // of the way it goes
// "0:12:34.5"; at most TIMELINE_TEXT_BYTES with the ending 0.
#define TIMELINE_TEXT_BYTES 40
void timeline_write(double t_s, char out[TIMELINE_TEXT_BYTES]);
// Seconds, M:SS or H:MM:SS, each with or without decimals; false for anything else.
bool timeline_read(const char *text, double *t_s);
