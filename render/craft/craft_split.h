// render/craft/craft_split.h: an aircraft as a few boxes that hold all of it, and little more.
// Body axes, metres.
// Values only.
#pragma once
#include "render/craft/craft_model.h"

#define CRAFT_SPLIT_MAX 10

typedef struct CraftSplit {
    int count;
    Vec3d low[CRAFT_SPLIT_MAX], high[CRAFT_SPLIT_MAX];
} CraftSplit;

// However its joints turn, the propeller as well. MEMORY.
MUST_USE Result craft_split_find(const CraftModel *model, CraftSplit *split);
