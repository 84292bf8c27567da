#include "terrain/lod/budget.h"

// Above the budget the tolerance grows by this; it shrinks again when the count is well below.
#define RAISE 1.25
#define RAISE_FAST 4.0
#define LOWER 1.1
#define LOWER_BELOW 0.7

Result budget_refine(Budget *budget, BudgetRefine *refine, void *user, LodCut *cut) {
    double asked = cut->view.tau_px, tau = asked > budget->raised_px ? asked : budget->raised_px;
    for (;;) {
        Result result = refine(user, tau, &cut->stats);
        bool gave_up = result == RESULT_BUDGET;
        if (result != RESULT_OK && !gave_up)
            return result;
        if (!gave_up && (cut->stats.triangles <= budget->max_triangles || tau > BUDGET_COARSEST_PX))
            break;
        tau *= gave_up ? RAISE_FAST : RAISE;
    }
    cut->reached_px = tau;
    bool over = tau > asked;
    bool roomy = (double)cut->stats.triangles < LOWER_BELOW * (double)budget->max_triangles;
    budget->raised_px = over ? roomy ? tau / LOWER : tau : 0.0;
    return over ? RESULT_BUDGET : RESULT_OK;
}
