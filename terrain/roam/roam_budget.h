// terrain/roam/roam_budget.h: the best mesh that a number of triangles allows.
// Priorities in pixels at the image centre.
// A RoamBudget owns its queues and keeps their memory; one thread at a time. Zero is an empty one.
//
// Source: Duchaineau et al. 1997, section 5: two queues, the triangle with the highest priority is split, the diamond
// with the lowest merged, until neither helps.
#pragma once
#include "terrain/roam/roam_heap.h"
#include "terrain/roam/roam_refine.h"

typedef struct RoamBudget {
    RoamHeap splits, merges;
    double reached_px; // by the last balance; 0: none yet
} RoamBudget;

void roam_budget_destroy(RoamBudget *budget);

// Splits and merges until no active triangle is left whole, or none can be split for the mesh's triangles_max but by
// merging what matters more. `tau_px` is the tolerance of refiner->view. *reached_px: the largest error among the
// splits that were not made, above tau_px; tau_px if there are none. DONE or FAILED.
RoamStop roam_budget_balance(RoamBudget *budget, RoamRefiner *refiner, double tau_px, double *reached_px);
