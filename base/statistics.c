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
