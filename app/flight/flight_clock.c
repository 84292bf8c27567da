#include "app/flight/flight_clock.h"

#include <math.h>

FlightClock flight_clock_create(int rate) {
    return (FlightClock){.rate = rate};
}

double flight_clock_rate(const FlightClock *clock) {
    return ldexp(1.0, clock->rate - FLIGHT_CLOCK_NORMAL);
}

void flight_clock_change_rate(FlightClock *clock, int by) {
    int rate = clock->rate + by;
    clock->rate = rate < 0 ? 0 : rate >= FLIGHT_CLOCK_RATES ? FLIGHT_CLOCK_RATES - 1 : rate;
}

int flight_clock_steps(FlightClock *clock, double passed_s, double step_s) {
    if (clock->paused || !(passed_s > 0.0))
        return 0;
    clock->owed_s += fmin(passed_s, FLIGHT_CLOCK_SPIKE_S) * flight_clock_rate(clock);
    // Frames of exactly two steps must not sometimes give one and then three for a rounding error.
    int steps = (int)floor(clock->owed_s / step_s + 1e-6);
    clock->owed_s = fmax(clock->owed_s - steps * step_s, 0.0);
    return steps;
}
