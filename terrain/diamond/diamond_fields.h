// terrain/diamond/diamond_fields.h: numbers of a vertex that only some predicates read.
// Metres above the DEM's own datum; degrees from the model's middle.
// They belong to the DiamondModel.
#pragma once
#include "terrain/diamond/diamond.h"

// Fills those of datum_m, east_deg and north_deg that the model has room for. MEMORY.
MUST_USE Result diamond_fields_fill(DiamondModel *model, Jobs *jobs);
