// terrain/roam/roam_ground.h: what both ROAMs hold of the ground: squares, the mesh to begin with, pages, and what is
// drawn of each square.
// As terrain/lod/lod.h.
// A RoamGround owns all of it and borrows the terrain. roam_ground_draw may run side by side for different squares with
// different pools and scratches; all else by one thread.
#pragma once
#include "terrain/lod/lod_method.h"
#include "terrain/patches/index_list.h"
#include "terrain/roam/roam_base.h"
#include "terrain/roam/roam_emit.h"
#include "terrain/roam/roam_field.h"
#include "terrain/squares/square_page.h"

// Of a square: what is drawn, and what this frame found out.
typedef struct RoamDrawn {
    IndexList list;
    uint64_t revision;
    RoamEmitted shape;
    IndexList fresh_list; // drawn, but not adopted yet; NULL indices: as before
    RoamEmitted fresh;
    bool failed;  // no memory for the list
    bool rebuilt; // the list is not the one of the last cut
    uint16_t partition;
} RoamDrawn;

typedef struct RoamGround {
    LodOptions options;
    const Terrain *terrain;
    SquareGrid grid;
    RoamField field;
    RoamBase base;
    SquarePageStore pages;
    IndexStore lists; // a pool a partition
    RoamDrawn *drawn; // [grid.count]
    uint64_t next_revision;
} RoamGround;

// Squares are those of the terrain's pages, larger where the budget could not hold two triangles for each. MEMORY.
MUST_USE Result roam_ground_create(const LodOptions *options, const Terrain *terrain, RoamGround *out);
void roam_ground_destroy(RoamGround *ground);
void roam_ground_release(RoamGround *ground, uint64_t frame);

// The square's triangles as they are now in `mesh`, with an index list from `pool`. With options.reuse a list that has
// not changed stays as it was.
void roam_ground_draw(RoamGround *ground, const RoamMesh *mesh, int32_t root, int32_t square, int pool,
                      RoamScratch *scratch);

// After all squares that changed were drawn: pages, items and statistics of the cut. MEMORY: the frame is to be
// abandoned.
MUST_USE Result roam_ground_finish(RoamGround *ground, const LodCall *call, LodCut *cut);
// Of a frame that failed, wherever it did: gives back what was drawn. All squares are to be drawn for the next cut.
void roam_ground_abandon(RoamGround *ground);
