// app/flight/flight_clock.h: from the time that passed to whole simulation steps.
// Seconds.
// A value.
#pragma once
#include "base/base.h"

#define FLIGHT_CLOCK_RATES 7      // 1/4 1/2 1 2 4 8 16
#define FLIGHT_CLOCK_NORMAL 2     // index of rate 1
#define FLIGHT_CLOCK_SPIKE_S 0.25 // of passed time counts at most so much: a stall does not become a leap

typedef struct FlightClock {
    double owed_s; // simulated time not yet stepped, less than a step
    int rate;      // index
    bool paused;
} FlightClock;

// `rate`: an index, 0 .. FLIGHT_CLOCK_RATES - 1.
FlightClock flight_clock_create(int rate);
double flight_clock_rate(const FlightClock *clock); // 0.25 .. 16
void flight_clock_change_rate(FlightClock *clock, int by);
// How many steps of `step_s` to take now that `passed_s` went by; at most rate * FLIGHT_CLOCK_SPIKE_S / step_s + 1.
int flight_clock_steps(FlightClock *clock, double passed_s, double step_s);
