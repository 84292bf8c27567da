#define _GNU_SOURCE // qsort_r
#include "terrain/lod/partition.h"

#include <stdlib.h>

ObserverLine partition_observer_line(Vec3d eye_ecef, Vec3d forward_ecef) {
    Vec3d up = vec3d_normalize(eye_ecef);
    Vec3d right = vec3d_cross(forward_ecef, up);
    if (vec3d_dot(right, right) < 1e-12) // straight up or down: any line does
        right = vec3d_cross(up.z * up.z < 0.5 ? vec3d(0, 0, 1) : vec3d(1, 0, 0), up);
    right = vec3d_normalize(right);
    return (ObserverLine){eye_ecef, vec3d_cross(up, right), right};
}

double partition_turn(const ObserverLine *line, Vec3d point_ecef) {
    Vec3d d = vec3d_sub(point_ecef, line->eye);
    double x = vec3d_dot(d, line->right), y = vec3d_dot(d, line->ahead);
    double sum = fabs(x) + fabs(y);
    if (!(sum > 0.0))
        return 0.0;
    double t = y / sum; // 1 ahead, -1 behind
    double turn = x >= 0.0 ? 0.25 * (1.0 - t) : 0.75 + 0.25 * t;
    return turn < 1.0 ? turn : 0.0;
}

static int by_turn(const void *a, const void *b, void *turns) {
    int32_t i = *(const int32_t *)a, j = *(const int32_t *)b;
    double x = ((const double *)turns)[i], y = ((const double *)turns)[j];
    return x < y ? -1 : x > y ? 1 : i < j ? -1 : i > j;
}

static void equal_work_borders(int count, const double *turns, const double *work, int32_t item_count, int32_t *order,
                               double *borders) {
    double total = 0.0, sum = 0.0;
    for (int32_t i = 0; i < item_count; i++) {
        order[i] = i;
        total += work[i];
    }
    qsort_r(order, (size_t)item_count, sizeof *order, by_turn, (void *)(uintptr_t)turns);
    int border = 1;
    for (int32_t i = 0; i < item_count && border < count; i++) {
        double half = 0.5 * work[order[i]]; // an item is on the side where its larger part would be
        while (border < count && sum + half >= total * border / count)
            borders[border++] = turns[order[i]];
        sum += work[order[i]];
    }
    while (border < count)
        borders[border++] = 1.0;
}

void partition_borders(int count, const double *turns, const double *work, int32_t item_count, int32_t *order,
                       double *borders) {
    borders[0] = 0.0;
    if (count == 2)
        borders[1] = 0.5;
    else if (count > 2)
        equal_work_borders(count, turns, work, item_count, order, borders);
}

int partition_of(const double *borders, int count, double turn) {
    int sector = count - 1;
    while (sector > 0 && turn < borders[sector])
        sector--;
    return sector;
}
