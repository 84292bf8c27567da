// terrain/lod/partition.h: divide patches among workers along the observer line.
// ECEF metres; directions around the eye as turns in [0, 1), clockwise from the direction of sight.
// Values; nothing owned.
//
// Sources: Biedermann, Rivara (the vertical plane of sight, two partitions); the N sectors of equal predicted work
// are the part that paper left open.
#pragma once
#include "base/base.h"
#include "base/vec.h"

#define PARTITION_MAX 64

typedef struct ObserverLine {
    Vec3d eye, ahead, right; // ahead and right: unit, horizontal at the eye
} ObserverLine;
ObserverLine partition_observer_line(Vec3d eye_ecef, Vec3d forward_ecef);

// A monotone measure of the direction, not an angle: 0 ahead, 0.25 right, 0.5 behind, 0.75 left.
double partition_turn(const ObserverLine *line, Vec3d point_ecef);

// Borders of `count` sectors, ascending, borders[0] = 0: sector k is from borders[k] to borders[k + 1] (1 for the
// last). Two: the plane of sight, at 0 and 0.5. More: sectors of equal work, of the items given. `order`: scratch,
// `item_count` long.
void partition_borders(int count, const double *turns, const double *work, int32_t item_count, int32_t *order,
                       double *borders);
int partition_of(const double *borders, int count, double turn);
