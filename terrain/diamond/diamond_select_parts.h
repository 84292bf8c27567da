// terrain/diamond/diamond_select_parts.h: what a DiamondSelect consists of, for the files that write and bind it.
// Degrees and metres, as typed.
// The DiamondSelect owns all of it.
#pragma once
#include "terrain/diamond/diamond_select.h"

#define DIAMOND_ARGUMENTS_MAX 4

typedef struct DiamondSelectStep {
    DiamondOp op;
    double arguments[DIAMOND_ARGUMENTS_MAX];
} DiamondSelectStep;

struct DiamondSelect {
    int step_count;
    DiamondSelectStep steps[DIAMOND_STEPS_MAX]; // in postfix order
    bool promises, has_lens;
    DiamondLens lens;
    char text[]; // as typed, closed by 0
};

// Of the table: values taken from the stack, constants of the bound step.
int diamond_op_operands(DiamondOp op);
int diamond_op_constants(DiamondOp op);
