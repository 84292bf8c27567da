// terrain/diamond/diamond_internal.h: what the files of this folder share: the corners of a diamond, and ways through
// the words of a layout. Columns and rows in samples.
// Values; nothing owned.
#pragma once
#include "terrain/diamond/diamond.h"

typedef struct DiamondPoint {
    int32_t col, row;
} DiamondPoint;

// Corner order: the hypotenuse's ends, west or north first, then the parents, west or north first.
typedef struct DiamondCorners {
    DiamondPoint ends[2], parents[2];
} DiamondCorners;

static inline bool diamond_is_centre(int slot) {
    return slot < DIAMOND_CENTRE_SLOTS;
}

// A centre whose hypotenuse runs from south-west to north-east. The same in every super-square.
static inline bool diamond_is_rising(int slot) {
    int bit = diamond_slot_bit(slot);
    return ((bit & 3) / 2 + bit / 8) & 1;
}

// An edge midpoint whose hypotenuse runs from west to east.
static inline bool diamond_is_horizontal(int slot) {
    return diamond_slot_bit(slot) & 1;
}

static inline DiamondCorners diamond_corners(int slot, DiamondPoint v, int step) {
    int32_t s = step;
    if (!diamond_is_centre(slot)) {
        int32_t dx = diamond_is_horizontal(slot) ? s : 0, dy = s - dx;
        return (DiamondCorners){{{v.col - dx, v.row - dy}, {v.col + dx, v.row + dy}},
                                {{v.col - dy, v.row - dx}, {v.col + dy, v.row + dx}}};
    }
    DiamondPoint nw = {v.col - s, v.row - s}, ne = {v.col + s, v.row - s};
    DiamondPoint sw = {v.col - s, v.row + s}, se = {v.col + s, v.row + s};
    return diamond_is_rising(slot) ? (DiamondCorners){{sw, ne}, {nw, se}} : (DiamondCorners){{nw, se}, {sw, ne}};
}

static inline bool diamond_is_inside(const DiamondLayout *layout, DiamondPoint p) {
    return p.col >= 0 && p.row >= 0 && p.col < layout->width && p.row < layout->height;
}

static inline size_t diamond_sample(const DiamondLayout *layout, DiamondPoint p) {
    return (size_t)p.row * (size_t)layout->width + (size_t)p.col;
}

// The vertex of a slot of super-square (i, j) of a plane; it may lie outside the DEM.
static inline DiamondPoint diamond_vertex(int plane, uint32_t i, uint32_t j, int slot) {
    int bit = diamond_slot_bit(slot);
    return (DiamondPoint){((int32_t)(4 * i) + (bit & 3)) << plane, ((int32_t)(4 * j) + (bit >> 2)) << plane};
}

static inline uint32_t diamond_plane_words(const DiamondLayout *layout, int plane) {
    return layout->across[plane] * layout->down[plane];
}

// Runs `task` over the rows of super-squares of one plane, 256 super-squares or more at a time.
static inline void diamond_run_rows(Jobs *jobs, const DiamondLayout *layout, int plane, JobsTask *task, void *user) {
    int64_t grain = 256 / layout->across[plane] + 1;
    jobs_run(jobs, layout->down[plane], grain, task, user);
}

// Makes the model's runs, when its errors are there. MEMORY.
MUST_USE Result diamond_runs_create(DiamondModel *model, Jobs *jobs);

static inline uint32_t diamond_run_count(const DiamondModel *model) {
    return model->run_first[model->layout.level_count];
}

// The words of one run: `begin` of `count`.
typedef struct DiamondSpan {
    int plane, count;
    uint32_t begin;
} DiamondSpan;

static inline DiamondSpan diamond_run_span(const DiamondModel *model, uint32_t run) {
    int plane = 0;
    while (run >= model->run_first[plane + 1])
        plane++;
    uint32_t first = (run - model->run_first[plane]) * DIAMOND_RUN;
    uint32_t words = diamond_plane_words(&model->layout, plane);
    int count = (int)(words - first < DIAMOND_RUN ? words - first : DIAMOND_RUN);
    return (DiamondSpan){plane, count, model->layout.offset[plane] + first};
}

// Of a word of split bits.
static inline uint32_t diamond_popcount(uint32_t word) {
    word = word - (word >> 1 & 0x5555);
    word = (word & 0x3333) + (word >> 2 & 0x3333);
    word = (word + (word >> 4)) & 0x0F0F;
    return (word + (word >> 8)) & 0x1F;
}

static inline float diamond_truth(bool value) {
    return value ? 1.0f : 0.0f;
}

// What an operation with one operand leaves on the stack, and one with two.
static inline float diamond_altered(DiamondOp op, float a) {
    return op == DIAMOND_OP_NEGATE ? -a : diamond_truth(a == 0.0f);
}
static inline float diamond_joined(DiamondOp op, float a, float b) {
    switch (op) {
    case DIAMOND_OP_ADD:
        return a + b;
    case DIAMOND_OP_SUBTRACT:
        return a - b;
    case DIAMOND_OP_MULTIPLY:
        return a * b;
    case DIAMOND_OP_LESS:
        return diamond_truth(a < b);
    case DIAMOND_OP_LESS_EQUAL:
        return diamond_truth(a <= b);
    case DIAMOND_OP_GREATER:
        return diamond_truth(a > b);
    case DIAMOND_OP_GREATER_EQUAL:
        return diamond_truth(a >= b);
    case DIAMOND_OP_AND:
        return diamond_truth(a != 0.0f && b != 0.0f);
    default: // OR
        return diamond_truth(a != 0.0f || b != 0.0f);
    }
}

// What a program says of all diamonds of a run that are not split anyway.
typedef enum DiamondAnswer { DIAMOND_ANSWER_NONE, DIAMOND_ANSWER_ALL, DIAMOND_ANSWER_ASK } DiamondAnswer;
DiamondAnswer diamond_forecast(const DiamondProgram *program, const DiamondView *view, const DiamondRun *run,
                               float step);
