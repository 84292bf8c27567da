// base/statistics.h: order statistics of measured times.
// Whatever the values are in.
// Sorts the caller's array; owns nothing.
#pragma once
#include "base/base.h"

// Sorts ascending. NaN must not occur.
void statistics_sort(double *values, int count);
// Nearest rank: the smallest value that at least `share` (0..1) of all do not exceed. 0 for none.
double statistics_percentile(const double *sorted, int count, double share);
// Where the median of all that could have been measured lies with at least 95 % certainty, whatever its distribution:
// the values of the ranks that a binomial leaves. Fewer than six values: from the first to the last, with less.
void statistics_median_bounds(const double *sorted, int count, double *low, double *high);
