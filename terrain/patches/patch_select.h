// terrain/patches/patch_select.h: a cut through the patch hierarchy.
// As terrain/patches/patch_forest.h.
// A PatchSelection owns its choices and keeps the memory from call to call.
//
// Source: Loeffler, Schwanke, Schumann 2010, section 4.1.
#pragma once
#include "terrain/patches/patch_forest.h"
#include "terrain/patches/refine.h"

typedef struct PatchChoice {
    PatchTriangle triangle;
    int32_t node;           // of the patch forest
    uint8_t level;          // in the tile's bintree
    uint8_t template_index; // of its page
} PatchChoice;

typedef struct PatchSelection {
    PatchChoice *choices; // tile by tile, depth first
    int32_t count, capacity;
} PatchSelection;

// The coarsest patches whose pages can show all that is active in `view`. BUDGET: there are more than `count_max`, and
// the selection is incomplete; MEMORY.
MUST_USE Result patch_select(const PatchForest *forest, const RefineView *view, int32_t count_max, PatchSelection *out);
// Whether the patches of this tile split at `middle`; asked from the coarsest down.
typedef bool PatchSplits(void *user, const PatchTile *tile, PatchCorner middle);
// The coarsest patches that do not split. Results as above.
MUST_USE Result patch_select_where(const PatchForest *forest, PatchSplits *where, void *user, int32_t count_max,
                                   PatchSelection *out);
// The finest patches.
MUST_USE Result patch_select_finest(const PatchForest *forest, PatchSelection *out);
void patch_selection_destroy(PatchSelection *selection);
