// terrain/lod/budget.h: raise the tolerance until a cut keeps its triangle budget; come back when there is room.
// Tolerances in pixels.
// Values; nothing owned. Zeroed but for max_triangles, a Budget is ready.
#pragma once
#include "terrain/lod/lod.h"

// Above this tolerance only what must be drawn is; nu is still above 0, so that nu times an infinite delta is infinite.
#define BUDGET_COARSEST_PX 1e12

typedef struct Budget {
    int64_t max_triangles;
    double raised_px;   // where the next frame begins, above what is asked for; 0: not raised
    double fitted_px;   // the last raised tolerance that kept the budget; 0: none
    double overflow_px; // the greatest tolerance that did not, in this view; 0: none
    int64_t floor;      // triangles, about what no tolerance takes away, where that is above the budget; 0: not known
    Vec3d eye_ecef;     // of the last frame, with px_per_rad: what the number of triangles depends on
    double px_per_rad;
    bool still;         // the view is that of the frame before
    int patience, wait; // frames between tries at a smaller tolerance while the view moves; until the next one
} Budget;

// Whether a refinement may be given up early: not where what it takes is to be known, however much.
static inline bool budget_may_give_up(const Budget *budget, double tau_px) {
    return tau_px <= BUDGET_COARSEST_PX && budget->floor == 0;
}

// Refines at a tolerance and tells the triangles in `stats`. BUDGET: given up early, as far too many.
typedef Result BudgetRefine(void *user, double tau_px, LodStats *stats);

// Refines at the tolerance asked for, or, above the budget, at one that keeps it, found in this frame and the next
// ones: a still view gets the one asked for where that fits. Where none keeps the budget, at one beyond which little is
// saved. Fills the cut's stats and reached_px. BUDGET: reached_px is above the view's tolerance; other results are
// those of `refine`.
MUST_USE Result budget_refine(Budget *budget, BudgetRefine *refine, void *user, LodCut *cut);

// The two steps of budget_refine, for counts that come later. The tolerance to begin a frame with:
double budget_begin(Budget *budget, const LodView *view);
// What a count at a tolerance means for the next one: that is returned, and kept for the next frame.
double budget_learn(Budget *budget, double asked_px, double tau_px, int64_t triangles);
