// base/statistics.h: order statistics of measured times.
// Whatever the values are in.
// Sorts the caller's array; owns nothing.
#pragma once
#include "base/base.h"

// Sorts ascending. NaN must not occur.
void statistics_sort(double *values, int count);
// Nearest rank: the smallest value that at least `share` (0..1) of all do not exceed. 0 for none.
double statistics_percentile(const double *sorted, int count, double share);
