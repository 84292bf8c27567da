// Yalcin, Weiss, De Floriani 2011, section 6: the selection criterion asked of every diamond in one pass; a word of
// split bits a super-square. Our own: the criterion is a program over runs of super-squares, an operation at a time,
// a slot at a time, so that each is a loop over contiguous numbers; and the one of every flight is written out.
#include "terrain/diamond/diamond_internal.h"
#include "terrain/diamond/diamond_rules.h"
#include "terrain/diamond/diamond_select_parts.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Of what is computed with positions: roundings of 2^-24, relative to the largest coordinate.
#define VIEW_ROUNDING 5e-7

// ---- the view ----

static void set_planes(DiamondView *out, const LodView *view, const DiamondLens *lens) {
    Vec3d ahead = view->forward_ecef, up = vec3d_normalize(view->eye_ecef);
    Vec3d right = vec3d_normalize(vec3d_cross(ahead, up));
    up = vec3d_cross(right, ahead);
    Vec3d across = vec3d_scale(ahead, lens->tan_right), along = vec3d_scale(ahead, lens->tan_up);
    const Vec3d normals[DIAMOND_PLANES] = {
        ahead, vec3d_normalize(vec3d_add(across, right)), vec3d_normalize(vec3d_sub(across, right)),
        vec3d_normalize(vec3d_add(along, up)), vec3d_normalize(vec3d_sub(along, up))};
    for (int i = 0; i < DIAMOND_PLANES; i++) {
        out->plane[i][0] = (float)normals[i].x;
        out->plane[i][1] = (float)normals[i].y;
        out->plane[i][2] = (float)normals[i].z;
    }
}

static float clamped(double value, double low, double high) {
    return (float)fmin(fmax(value, low), high);
}

DiamondView diamond_view(const DiamondModel *model, const LodView *view, double tau_px, const DiamondLens *lens) {
    Vec3d eye = vec3d_sub(view->eye_ecef, model->origin_ecef);
    DiamondView out = {.eye = {clamped(eye.x, -1e18, 1e18), clamped(eye.y, -1e18, 1e18), clamped(eye.z, -1e18, 1e18)},
                       .nu = clamped(view->px_per_rad / tau_px, 1e-18, 1e15),
                       .px_per_rad = clamped(view->px_per_rad, 1e-18, 1e15),
                       .tau_px = clamped(tau_px, 1e-18, 1e18)};
    double extent = (double)model->extent_m + fmin(vec3d_length(eye), 1e18);
    out.slack_m = (float)((double)model->position_slack_m + VIEW_ROUNDING * extent) * DIAMOND_GROW;
    if (lens)
        set_planes(&out, view, lens);
    return out;
}

// ---- the tolerance alone ----

typedef struct Numbers { // of one slot of a run
    const float *error_m, *reach_m, *x, *y, *z;
    const float *datum_m, *east_deg, *north_deg; // NULL where the model has none
    int count;
} Numbers;

SIMD_CLONES
static void add_tolerance(const float *restrict error_m, const float *restrict reach_m, const float *restrict x,
                          const float *restrict y, const float *restrict z, const DiamondView *view, uint32_t mask,
                          uint32_t *restrict bits, int count) {
    float ex = view->eye[0], ey = view->eye[1], ez = view->eye[2], nu = view->nu, slack_m = view->slack_m;
    for (int i = 0; i < count; i++) {
        float distance2 = diamond_distance2(x[i] - ex, y[i] - ey, z[i] - ez);
        bits[i] |= diamond_tolerance(error_m[i], reach_m[i], distance2, nu, slack_m) ? mask : 0;
    }
}

// ---- programs ----

typedef struct Machine {
    const DiamondView *view;
    Numbers n;
    float level, step;
    float square[DIAMOND_RUN]; // of the distance from the eye
    float stack[DIAMOND_STACK_MAX][DIAMOND_RUN];
    int depth;
} Machine;

static void push_constant(Machine *m, float value) {
    float *top = m->stack[m->depth++];
    for (int i = 0; i < m->n.count; i++)
        top[i] = value;
}

static void push_copy(Machine *m, const float *values) {
    memcpy(m->stack[m->depth++], values, sizeof *values * (size_t)m->n.count);
}

SIMD_CLONES
static void push_px(Machine *m) {
    float *top = m->stack[m->depth++];
    for (int i = 0; i < m->n.count; i++)
        top[i] = diamond_px(m->n.error_m[i], m->n.reach_m[i], m->square[i], m->view->px_per_rad, m->view->slack_m);
}

SIMD_CLONES
static void push_distance(Machine *m) {
    float *top = m->stack[m->depth++];
    for (int i = 0; i < m->n.count; i++)
        top[i] = diamond_root(m->square[i]);
}

SIMD_CLONES
static void push_tolerance(Machine *m) {
    float *top = m->stack[m->depth++];
    for (int i = 0; i < m->n.count; i++)
        top[i] = diamond_truth(
            diamond_tolerance(m->n.error_m[i], m->n.reach_m[i], m->square[i], m->view->nu, m->view->slack_m));
}

SIMD_CLONES
static void push_inview(Machine *m) {
    const float *eye = m->view->eye;
    float *top = m->stack[m->depth++];
    for (int i = 0; i < m->n.count; i++)
        top[i] = diamond_truth(diamond_inview(m->n.x[i] - eye[0], m->n.y[i] - eye[1], m->n.z[i] - eye[2],
                                              m->n.reach_m[i], m->view->slack_m, m->view->plane));
}

SIMD_CLONES
static void push_within(Machine *m, const float *c) {
    float *top = m->stack[m->depth++];
    for (int i = 0; i < m->n.count; i++)
        top[i] = diamond_truth(diamond_within(m->n.x[i], m->n.y[i], m->n.z[i], m->n.reach_m[i], m->view->slack_m, c));
}

SIMD_CLONES
static void push_box(Machine *m, const float *c) {
    float *top = m->stack[m->depth++];
    for (int i = 0; i < m->n.count; i++)
        top[i] = diamond_truth(diamond_box(m->n.east_deg[i], m->n.north_deg[i], m->n.reach_m[i], c));
}

static void run_operand(Machine *m, DiamondOp op, const float *c) {
    switch (op) {
    case DIAMOND_OP_CONSTANT:
        push_constant(m, c[0]);
        break;
    case DIAMOND_OP_ERROR:
        push_copy(m, m->n.error_m);
        break;
    case DIAMOND_OP_PX:
        push_px(m);
        break;
    case DIAMOND_OP_DISTANCE:
        push_distance(m);
        break;
    case DIAMOND_OP_HEIGHT:
        push_copy(m, m->n.datum_m);
        break;
    case DIAMOND_OP_LEVEL:
        push_constant(m, m->level);
        break;
    case DIAMOND_OP_STEP:
        push_constant(m, m->step);
        break;
    case DIAMOND_OP_TAU:
        push_constant(m, m->view->tau_px);
        break;
    case DIAMOND_OP_TOLERANCE:
        push_tolerance(m);
        break;
    case DIAMOND_OP_INVIEW:
        push_inview(m);
        break;
    case DIAMOND_OP_WITHIN:
        push_within(m, c);
        break;
    default: // BOX: the others take operands
        push_box(m, c);
        break;
    }
}

SIMD_CLONES
static void run_unary(Machine *m, DiamondOp op) {
    float *a = m->stack[m->depth - 1];
    for (int i = 0; i < m->n.count; i++)
        a[i] = diamond_altered(op, a[i]);
}

SIMD_CLONES
static void run_binary(Machine *m, DiamondOp op) {
    const float *b = m->stack[--m->depth];
    float *a = m->stack[m->depth - 1];
    for (int i = 0; i < m->n.count; i++)
        a[i] = diamond_joined(op, a[i], b[i]);
}

SIMD_CLONES
static void add_program(Machine *m, const DiamondProgram *program, uint32_t mask, uint32_t *bits) {
    const float *eye = m->view->eye;
    for (int i = 0; i < m->n.count; i++)
        m->square[i] = diamond_distance2(m->n.x[i] - eye[0], m->n.y[i] - eye[1], m->n.z[i] - eye[2]);
    m->depth = 0;
    for (int s = 0; s < program->step_count; s++) {
        DiamondOp op = (DiamondOp)program->steps[s].op;
        int operands = diamond_op_operands(op);
        if (operands == 0)
            run_operand(m, op, program->constants + program->steps[s].first);
        else if (operands == 1)
            run_unary(m, op);
        else
            run_binary(m, op);
    }
    for (int i = 0; i < m->n.count; i++)
        bits[i] |= m->stack[0][i] != 0.0f ? mask : 0;
}

// ---- all super-squares ----

typedef struct Evaluation {
    const DiamondModel *model;
    const DiamondProgram *program;
    const DiamondView *view;
    uint32_t *bits;
    bool plain; // the tolerance alone
} Evaluation;

static Numbers numbers_of(const DiamondModel *model, int slot, uint32_t word, int count) {
    size_t entry = diamond_entry(&model->layout, slot, word);
    return (Numbers){.error_m = model->error_m + entry,
                     .reach_m = model->reach_m + (diamond_is_centre(slot) ? 0 : model->layout.word_count) + word,
                     .x = model->x + entry,
                     .y = model->y + entry,
                     .z = model->z + entry,
                     .datum_m = model->datum_m ? model->datum_m + entry : NULL,
                     .east_deg = model->east_deg ? model->east_deg + entry : NULL,
                     .north_deg = model->north_deg ? model->north_deg + entry : NULL,
                     .count = count};
}

static void evaluate_plain(const Evaluation *e, uint32_t word, int count, uint32_t *bits) {
    for (int slot = 0; slot < DIAMOND_SLOTS; slot++) {
        Numbers n = numbers_of(e->model, slot, word, count);
        add_tolerance(n.error_m, n.reach_m, n.x, n.y, n.z, e->view, UINT32_C(1) << diamond_slot_bit(slot), bits, count);
    }
}

static void evaluate_program(const Evaluation *e, int plane, uint32_t word, int count, uint32_t *bits) {
    Machine machine;
    machine.view = e->view;
    machine.step = (float)(1 << plane);
    for (int slot = 0; slot < DIAMOND_SLOTS; slot++) {
        machine.n = numbers_of(e->model, slot, word, count);
        machine.level = (float)diamond_level(&e->model->layout, plane, slot);
        add_program(&machine, e->program, UINT32_C(1) << diamond_slot_bit(slot), bits);
    }
}

static void evaluate_run(const Evaluation *e, uint32_t run) {
    const DiamondModel *model = e->model;
    DiamondSpan span = diamond_run_span(model, run);
    uint32_t bits[DIAMOND_RUN] = {0};
    DiamondAnswer answer = model->runs
                               ? diamond_forecast(e->program, e->view, &model->runs[run], (float)(1 << span.plane))
                               : DIAMOND_ANSWER_ASK;
    if (answer == DIAMOND_ANSWER_ALL)
        memset(bits, 0xFF, sizeof bits);
    else if (answer == DIAMOND_ANSWER_ASK && e->plain)
        evaluate_plain(e, span.begin, span.count, bits);
    else if (answer == DIAMOND_ANSWER_ASK)
        evaluate_program(e, span.plane, span.begin, span.count, bits);
    for (int i = 0; i < span.count; i++) {
        uint32_t word = span.begin + (uint32_t)i;
        e->bits[word] = (bits[i] & model->valid[word]) | model->always[word];
    }
}

static void evaluate_task(void *user, int64_t begin, int64_t end, int worker) {
    (void)worker;
    for (int64_t run = begin; run < end; run++)
        evaluate_run(user, (uint32_t)run);
}

void diamond_evaluate(const DiamondModel *model, const DiamondProgram *program, const DiamondView *view, Jobs *jobs,
                      uint32_t *bits) {
    Evaluation e = {.model = model, .program = program, .view = view, .bits = bits};
    e.plain = program->step_count == 1 && program->steps[0].op == DIAMOND_OP_TOLERANCE;
    jobs_run(jobs, diamond_run_count(model), 32, evaluate_task, &e);
}
