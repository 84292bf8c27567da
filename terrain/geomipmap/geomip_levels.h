// terrain/geomipmap/geomip_levels.h: which level each tile is drawn at, for one view.
// Metres; levels in units of 1 / GEOMIP_LEVEL: level 2 morphed half-way to level 3 is 2.5 GEOMIP_LEVEL.
// A GeomipLevels owns its tables; one thread at a time may use it.
//
// Sources: de Boer 2000, D_m^2 <= d^2; Ye, Wang, sections 3.1 (level) and 3.3 (morph).
#pragma once
#include "terrain/geomipmap/geomip_tiles.h"

#define GEOMIP_LEVEL 256

typedef struct GeomipRule {
    bool ye;       // the level rule and the morph of Ye, Wang; false: de Boer's
    bool bounds;   // every sample within the tolerance; the tiles have been created with bounds
    double unit_m; // of length, whose choice Ye's rule depends on
} GeomipRule;

typedef struct GeomipLevels {
    int16_t *drawn;    // [tile]
    int16_t *wanted;   // [tile] before what neighbours ask for
    int16_t *limited;  // [tile] with the borders that its neighbours stand
    double *allowed_m; // [tile] the error that a tile may have
    int64_t triangles; // of the whole cut
    bool coarsest;     // every tile is at its cap
} GeomipLevels;
// MEMORY.
MUST_USE Result geomip_levels_create(int32_t tiles, GeomipLevels *out);
void geomip_levels_destroy(GeomipLevels *levels);

// Pure but for `levels`: the same for any number of workers.
void geomip_levels_choose(const GeomipTiles *tiles, GeomipRule rule, Vec3d eye_ecef, double px_per_rad, double tau_px,
                          Jobs *jobs, GeomipLevels *levels);

// How a link's piece of border is drawn, seen from a tile at `own` with the other one at `other`: its stride in
// samples, and its level, which is the coarser of the two, so that neither side's surface ever jumps.
static inline int geomip_border_level(int own, int other) {
    return own > other ? own : other;
}
static inline int geomip_border_stride(GeomipBorder border, int own, int other) {
    int a = own / GEOMIP_LEVEL, b = other / GEOMIP_LEVEL;
    return 1 << ((border == GEOMIP_FANNED) == (a < b) ? a : b);
}
static inline int geomip_level_beyond(const int16_t *drawn, const GeomipLink *link, int own) {
    return link->tile == GEOMIP_OUTSIDE ? own : drawn[link->tile];
}
