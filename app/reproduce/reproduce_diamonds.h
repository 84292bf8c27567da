// app/reproduce/reproduce_diamonds.h: what the phases over a hierarchy of diamonds take, on the workers and on a GPU.
// Milliseconds.
// The caller owns terrain, model and context; one thread.
//
// Source: Yalcin, Weiss, De Floriani 2011, section 9.
#pragma once
#include "app/reproduce/reproduce.h"
#include "terrain/diamond/diamond.h"

#define DIAMONDS_VIEWS_MAX 64
#define DIAMONDS_CLOSURES 5 // of all bits

// What is timed: a model without errors, a criterion, and views round a circuit.
typedef struct Diamonds {
    Jobs *jobs;
    const Circuit *circuit;
    DiamondModel *model;
    DiamondProgram program;
    DiamondLens lens;
    double px_per_rad, tau_px;
    int views; // 1 .. DIAMONDS_VIEWS_MAX
} Diamonds;

typedef enum DiamondsPhase {
    DIAMONDS_EVALUATION,
    DIAMONDS_CLOSURE,
    DIAMONDS_INDICES,
    DIAMONDS_DYNAMIC, // the three together
    DIAMONDS_PHASE_COUNT
} DiamondsPhase;

typedef struct DiamondsTimes {
    double generation_ms, root_ms, deepest_ms; // all depths; the root diamond; the finest depth
    double closure_max_ms;                     // of bits that are all set, median
    double p50_ms[DIAMONDS_PHASE_COUNT], p99_ms[DIAMONDS_PHASE_COUNT];
    double triangles; // mean
} DiamondsTimes;

// Generates the model's errors, and times everything on the workers. MEMORY.
MUST_USE Result diamonds_time_workers(Diamonds *diamonds, DiamondsTimes *out);
// The same in compute shaders; the model has no errors yet, and gets none. UNSUPPORTED: there is no room for it, and
// `why` is text for people, else NULL; what diamond_gpu_create fails with.
MUST_USE Result diamonds_time_gpu(Diamonds *diamonds, Context *context, DiamondsTimes *out, const char **why);

// For both: the view of one of the diamonds' positions; the percentiles of what was counted, `ms` [phase][view].
DiamondView diamonds_view(const Diamonds *diamonds, int view);
void diamonds_summarize(double ms[DIAMONDS_PHASE_COUNT][DIAMONDS_VIEWS_MAX], int views, DiamondsTimes *out);
