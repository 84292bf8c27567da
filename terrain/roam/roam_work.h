// terrain/roam/roam_work.h: which partition refines which squares, by the work they are likely to be.
// Work in triangles; places in ECEF metres.
// A RoamWork owns its tables and borrows the ground; one thread at a time.
//
// Source: Biedermann, Rivara, section 4 (two halves along the observer line); predicted work is what that paper left
// open.
#pragma once
#include "terrain/roam/roam_ground.h"

typedef struct RoamWork {
    const RoamGround *ground;
    Vec3d *centres;         // [squares] ECEF metres
    double *turns, *work;   // [squares] around the observer line; triangles
    int32_t *order;         // [squares] scratch
    int32_t *grouped;       // [squares] by partition, in ascending order within each
    uint16_t *partition_of; // [squares]
    int32_t begins[LOD_PARTITIONS_MAX + 1];
    bool has_history; // a frame was drawn, whose triangles tell the work
} RoamWork;

MUST_USE Result roam_work_create(const RoamGround *ground, RoamWork *out);
void roam_work_destroy(RoamWork *work);

// Divides the squares among `partitions`: partition p refines grouped[begins[p]] .. grouped[begins[p + 1] - 1]. The
// work is that of the frame before; at first an estimate from a few vertices of each square.
void roam_work_divide(RoamWork *work, const LodView *view, int partitions);
