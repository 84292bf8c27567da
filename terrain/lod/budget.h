// terrain/lod/budget.h: raise the tolerance until a cut keeps its triangle budget; lower it again when there is room.
// Tolerances in pixels.
// Values; nothing owned.
#pragma once
#include "terrain/lod/lod.h"

// Above this tolerance only what must be drawn is; nu is still above 0, so that nu times an infinite delta is infinite.
#define BUDGET_COARSEST_PX 1e12

typedef struct Budget {
    int64_t max_triangles;
    double raised_px; // the tolerance that the budget forced in the last frame; 0: none
} Budget;

// Refines at a tolerance and tells the triangles in `stats`. BUDGET: given up early, as far too many.
typedef Result BudgetRefine(void *user, double tau_px, LodStats *stats);

// Refines at the tolerance asked for, or, above the budget, at the smallest tried one that keeps it. Fills the cut's
// stats and reached_px. BUDGET: reached_px is above the view's tolerance; other results are those of `refine`.
MUST_USE Result budget_refine(Budget *budget, BudgetRefine *refine, void *user, LodCut *cut);
