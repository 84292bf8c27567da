// Our own: what a program says of a whole run of super-squares, from its sphere and largest error: Kleene's logic, in
// which a condition is true, false or unknown. Yalcin, Weiss, De Floriani 2011, section 6, ask every diamond; what is
// the same for all of a run need not be asked, nor read from memory.
#include "terrain/diamond/diamond_internal.h"
#include "terrain/diamond/diamond_rules.h"
#include "terrain/diamond/diamond_select_parts.h"

// Relative, of a bound of many diamonds beside the rounding of each.
#define RUN_GROW 1.0002f

typedef struct Guess {
    bool known; // the same number for every diamond of the run
    float value;
} Guess;

typedef struct Forecast {
    const DiamondRun *run;
    const DiamondView *view;
    float step;
} Forecast;

static Guess known(float value) {
    return (Guess){true, value};
}

// False for all, or unknown.
static Guess possible(bool possible) {
    return (Guess){!possible, 0.0f};
}

static bool may_split(const DiamondRun *run, const DiamondView *view) {
    float x = run->x - view->eye[0], y = run->y - view->eye[1], z = run->z - view->eye[2];
    float limit = view->nu * run->error_m + diamond_reach(run->error_m, run->radius_m, view->slack_m);
    return !((limit * limit) * RUN_GROW < diamond_distance2(x, y, z));
}

static bool may_be_in_view(const DiamondRun *run, const DiamondView *view) {
    float x = run->x - view->eye[0], y = run->y - view->eye[1], z = run->z - view->eye[2];
    return diamond_inview(x, y, z, run->radius_m * RUN_GROW, 2.0f * view->slack_m, view->plane);
}

static bool may_be_within(const DiamondRun *run, const DiamondView *view, const float *c) {
    return diamond_within(run->x, run->y, run->z, run->radius_m * RUN_GROW, 2.0f * view->slack_m, c);
}

static Guess guess_operand(const Forecast *f, DiamondOp op, const float *c) {
    switch (op) {
    case DIAMOND_OP_CONSTANT:
        return known(c[0]);
    case DIAMOND_OP_STEP:
        return known(f->step);
    case DIAMOND_OP_TAU:
        return known(f->view->tau_px);
    case DIAMOND_OP_TOLERANCE:
        return possible(may_split(f->run, f->view));
    case DIAMOND_OP_INVIEW:
        return possible(may_be_in_view(f->run, f->view));
    case DIAMOND_OP_WITHIN:
        return possible(may_be_within(f->run, f->view, c));
    default:
        return possible(true);
    }
}

static bool is(Guess a, bool truth) {
    return a.known && (a.value != 0.0f) == truth;
}

static Guess guess_joined(DiamondOp op, Guess a, Guess b) {
    if (op == DIAMOND_OP_AND && (is(a, false) || is(b, false)))
        return known(0.0f);
    if (op == DIAMOND_OP_OR && (is(a, true) || is(b, true)))
        return known(1.0f);
    return (Guess){a.known && b.known, diamond_joined(op, a.value, b.value)};
}

static Guess guess_unary(DiamondOp op, Guess a) {
    return (Guess){a.known, diamond_altered(op, a.value)};
}

DiamondAnswer diamond_forecast(const DiamondProgram *program, const DiamondView *view, const DiamondRun *run,
                               float step) {
    Forecast f = {run, view, step};
    Guess stack[DIAMOND_STACK_MAX] = {{false, 0.0f}};
    int depth = 0;
    if (run->error_m < 0.0f)
        return DIAMOND_ANSWER_NONE;
    for (int s = 0; s < program->step_count; s++) {
        DiamondOp op = (DiamondOp)program->steps[s].op;
        int operands = diamond_op_operands(op);
        if (operands == 2)
            depth--;
        Guess *top = &stack[operands ? depth - 1 : depth++];
        *top = operands == 0   ? guess_operand(&f, op, program->constants + program->steps[s].first)
               : operands == 1 ? guess_unary(op, *top)
                               : guess_joined(op, *top, stack[depth]);
    }
    return is(stack[0], false) ? DIAMOND_ANSWER_NONE : is(stack[0], true) ? DIAMOND_ANSWER_ALL : DIAMOND_ANSWER_ASK;
}
