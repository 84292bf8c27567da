#include "terrain/lod/budget.h"

#include <math.h>

// The tolerance is raised by powers of this, so that it takes the same values again and again.
#define RAISE 1.25
#define RAISES_MAX 6 // at once
// It comes back by this at least, and where few triangles are drawn by more.
#define LOWER 1.1
#define LOWER_MOST 4.0
// While the view moves, each try that fails doubles the frames until the next one, up to this.
#define PATIENCE_MAX 16
// So many counts in one frame that fall by less than a share: perhaps none ever falls enough.
#define STALLS_MAX 3
#define SHARE 16

static bool is_same_view(const Budget *b, const LodView *view) {
    return b->eye_ecef.x == view->eye_ecef.x && b->eye_ecef.y == view->eye_ecef.y &&
           b->eye_ecef.z == view->eye_ecef.z && b->px_per_rad == view->px_per_rad;
}

double budget_begin(Budget *budget, const LodView *view) {
    budget->still = is_same_view(budget, view);
    budget->eye_ecef = view->eye_ecef;
    budget->px_per_rad = view->px_per_rad;
    if (!budget->still) {
        budget->overflow_px = 0.0;
        budget->wait -= budget->wait > 0;
        if (!budget->wait)
            budget->floor = 0;
    }
    return view->tau_px > budget->raised_px ? view->tau_px : budget->raised_px;
}

// Triangles grow with the tolerance's inverse, at most about as its square: their share of the budget, under the root,
// is a step that hardly ever goes too far.
static double step_of(double triangles, double wanted) {
    return sqrt(triangles / wanted);
}

static double raised(const Budget *b, double tau_px, int64_t triangles) {
    double step = step_of((double)triangles, (double)b->max_triangles);
    for (int i = 0; i < RAISES_MAX; i++) {
        tau_px *= RAISE;
        step /= RAISE;
        if (step < RAISE)
            break;
    }
    return tau_px;
}

static double lowered(const Budget *b, double asked_px, double tau_px, int64_t triangles) {
    double step = step_of((double)b->max_triangles, fmax((double)triangles, 1.0));
    step = b->overflow_px > 0.0 ? LOWER : fmin(fmax(step, LOWER), LOWER_MOST);
    return fmax(asked_px, tau_px / step);
}

static void lose_patience(Budget *b) {
    b->patience = b->patience < PATIENCE_MAX / 2 ? 2 * b->patience + 1 : PATIENCE_MAX;
    b->wait = b->patience;
}

// Back to what was kept before the try, where this is one. Counts that come later are not news once it is raised.
static double learn_overflow(Budget *b, double tau_px, int64_t triangles) {
    b->overflow_px = fmax(b->overflow_px, tau_px);
    if (tau_px < b->raised_px)
        return b->raised_px;
    lose_patience(b);
    double fitted = b->fitted_px;
    b->fitted_px = 0.0;
    if (fitted > tau_px)
        return fitted;
    return tau_px <= BUDGET_COARSEST_PX ? raised(b, tau_px, triangles) : tau_px;
}

static double learn_fit(Budget *b, double asked_px, double tau_px, int64_t triangles) {
    b->floor = 0;
    if (tau_px <= asked_px) {
        b->fitted_px = 0.0;
        b->patience = b->wait = 0;
        return 0.0;
    }
    if (tau_px < b->fitted_px) // a try that came out well
        b->patience /= 2;
    b->fitted_px = tau_px;
    double lower = lowered(b, asked_px, tau_px, triangles);
    return lower > b->overflow_px && (b->still || !b->wait) ? lower : tau_px;
}

double budget_learn(Budget *budget, double asked_px, double tau_px, int64_t triangles) {
    bool over = triangles > budget->max_triangles;
    budget->raised_px =
        over ? learn_overflow(budget, tau_px, triangles) : learn_fit(budget, asked_px, tau_px, triangles);
    return budget->raised_px;
}

// ---- one frame ----

typedef struct Search {
    Budget *budget;
    BudgetRefine *refine;
    void *user;
    LodCut *cut;
    double tau_px;
    int64_t triangles; // there; INT64_MAX: given up
    int stalls;
} Search;

static Result try_at(Search *s, double tau_px) {
    Result result = s->refine(s->user, tau_px, &s->cut->stats);
    int64_t before = s->triangles;
    s->triangles = result == RESULT_BUDGET ? INT64_MAX : s->cut->stats.triangles;
    s->stalls = s->triangles >= before - before / SHARE ? s->stalls + 1 : 0;
    s->tau_px = tau_px;
    return result == RESULT_BUDGET ? RESULT_OK : result;
}

static bool is_done(const Search *s) {
    const Budget *b = s->budget;
    return s->triangles <= b->max_triangles || s->triangles <= b->floor || s->tau_px > BUDGET_COARSEST_PX;
}

// Not even the coarsest cut keeps the budget: the first tolerance whose cut takes little more.
static Result settle_at_floor(Search *s, double tau_px) {
    Budget *b = s->budget;
    b->floor = s->triangles + s->triangles / SHARE;
    double step = RAISE; // grows, as the way may be long
    Result result = try_at(s, tau_px);
    for (; result == RESULT_OK && !is_done(s); step *= RAISE)
        result = try_at(s, tau_px *= step);
    b->patience = b->wait = PATIENCE_MAX;
    return result;
}

// Where counts do not fall, the coarsest cut's tells whether to go on.
static Result look_at_floor(Search *s, double asked_px) {
    double tau = s->tau_px;
    int64_t triangles = s->triangles;
    Result result = try_at(s, 2.0 * BUDGET_COARSEST_PX);
    if (result == RESULT_OK && s->triangles > s->budget->max_triangles)
        return settle_at_floor(s, asked_px * RAISE);
    s->stalls = INT32_MIN; // asked once
    s->tau_px = tau;
    s->triangles = triangles;
    return result;
}

static Result search(Search *s, double asked_px) {
    Result result = try_at(s, budget_begin(s->budget, &s->cut->view));
    s->stalls = 0;
    while (result == RESULT_OK && !is_done(s)) {
        s->budget->floor = 0;
        if (s->stalls >= STALLS_MAX)
            result = look_at_floor(s, asked_px);
        if (result == RESULT_OK && !is_done(s))
            result = try_at(s, budget_learn(s->budget, asked_px, s->tau_px, s->triangles));
    }
    return result;
}

Result budget_refine(Budget *budget, BudgetRefine *refine, void *user, LodCut *cut) {
    Search s = {.budget = budget, .refine = refine, .user = user, .cut = cut};
    double asked = cut->view.tau_px;
    Result result = search(&s, asked);
    if (result != RESULT_OK)
        return result;
    cut->reached_px = s.tau_px;
    bool over = s.tau_px > asked;
    if (s.triangles <= budget->max_triangles)
        (void)budget_learn(budget, asked, s.tau_px, s.triangles);
    else
        budget->raised_px = over ? s.tau_px : 0.0;
    return over ? RESULT_BUDGET : RESULT_OK;
}
