#include "app/pipeline/frame_times.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void frame_times_add(FrameTimes *times, double ms) {
    times->ms[times->count % FRAME_TIMES_KEPT] = (float)ms;
    times->count++;
    times->sum_ms += ms;
    times->max_ms = fmax(times->max_ms, ms);
}

static int compare(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

// The smallest value that at least `share` of all do not exceed.
static double percentile(const float *sorted, int count, double share) {
    int rank = (int)ceil(share * count);
    return (double)sorted[rank < 1 ? 0 : rank - 1];
}

FrameTimesSummary frame_times_summary(const FrameTimes *times, int latest) {
    float sorted[FRAME_TIMES_KEPT];
    int64_t kept = times->count < FRAME_TIMES_KEPT ? times->count : FRAME_TIMES_KEPT;
    int count = latest < kept ? latest : (int)kept;
    if (count <= 0)
        return (FrameTimesSummary){0};
    for (int i = 0; i < count; i++)
        sorted[i] = times->ms[(times->count - 1 - i) % FRAME_TIMES_KEPT];
    qsort(sorted, (size_t)count, sizeof *sorted, compare);
    return (FrameTimesSummary){.mean = times->sum_ms / (double)times->count,
                               .p50 = percentile(sorted, count, 0.50),
                               .p95 = percentile(sorted, count, 0.95),
                               .p99 = percentile(sorted, count, 0.99),
                               .max = times->max_ms};
}
