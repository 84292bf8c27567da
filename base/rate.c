#include "base/rate.h"

#include <math.h>
#include <stdio.h>

#define MINUS "\xE2\x88\x92"
#define TIMES "\xC3\x97"

void rate_write(double rate, char out[RATE_BYTES]) {
    const char *way = rate < 0.0 ? MINUS : "";
    double size = fmin(fabs(rate), 1e9), part = fmin(1.0 / size, 1e9);
    if (size >= 1.0)
        snprintf(out, RATE_BYTES, "%s%.0f " TIMES, way, size);
    else
        snprintf(out, RATE_BYTES, "%s1/%.0f " TIMES, way, part);
}
