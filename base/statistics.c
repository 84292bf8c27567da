#include "base/statistics.h"

#include <math.h>
#include <stdlib.h>

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

void statistics_sort(double *values, int count) {
    qsort(values, (size_t)count, sizeof *values, ascending);
}

double statistics_percentile(const double *sorted, int count, double share) {
    if (count <= 0)
        return 0.0;
    int rank = (int)ceil(share * count);
    return sorted[rank < 1 ? 0 : rank > count ? count - 1 : rank - 1];
}

void statistics_median_bounds(const double *sorted, int count, double *low, double *high) {
    *low = *high = 0.0;
    if (count < 1)
        return;
    // The chance that fewer than `rank` of `count` values lie below the median: 2.5 % at most.
    double term = pow(0.5, count), below = term;
    int rank = 0;
    for (; 2 * (rank + 1) <= count && below <= 0.025; rank++) {
        term *= (double)(count - rank) / (rank + 1);
        below += term;
    }
    rank = rank > 0 ? rank - 1 : 0;
    *low = sorted[rank];
    *high = sorted[count - 1 - rank];
}
