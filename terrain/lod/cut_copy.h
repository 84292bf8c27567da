// terrain/lod/cut_copy.h: a cut of one's own, which outlives the frame and the Lod it came from.
// As terrain/lod/lod.h.
// A CutCopy owns its memory and keeps it for the next cut; one thread at a time.
#pragma once
#include "terrain/lod/lod.h"

typedef struct CutCopy {
    LodCut cut; // its items, their pages, vertices and indices are below; it has no resident order
    LodItem *items;
    LodPage *pages; // of each item its own, as the next three
    LodVertex *vertices;
    uint16_t *indices;
    int64_t item_capacity, vertex_capacity, index_capacity;
} CutCopy;

// Takes the place of the cut before. BUDGET: that would take more than `bytes_max`, which is not logged; MEMORY. The
// copy is empty then.
MUST_USE Result cut_copy_take(CutCopy *copy, const LodCut *cut, size_t bytes_max);
// Puts the items nearest to the cut's eye first.
void cut_copy_sort(CutCopy *copy);
// Empties it.
void cut_copy_free(CutCopy *copy);
