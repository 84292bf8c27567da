// render/diamond/diamond_program.h: predicates as GLSL: a DiamondProgram becomes a compute shader once, its constants
// are uniforms. No units.
// A DiamondPrograms owns its GL programs; thread of the context.
#pragma once
#include "base/base.h"
#include "terrain/diamond/diamond_select.h"

#define DIAMOND_PROGRAMS 4 // kept; more of them are compiled anew

// What a program is known by: its steps, without the constants' values.
typedef struct DiamondCompiled {
    unsigned program; // GL name; 0: none
    int step_count;
    DiamondStep steps[DIAMOND_STEPS_MAX];
} DiamondCompiled;

typedef struct DiamondPrograms {
    DiamondCompiled compiled[DIAMOND_PROGRAMS];
    unsigned next; // to be replaced
} DiamondPrograms;

// DIAMOND_FIELD_* that the program's steps read.
unsigned diamond_program_fields(const DiamondProgram *program);
// The text that shaders/diamond_evaluate.comp includes, to be freed; NULL when memory is out.
char *diamond_program_source(const DiamondProgram *program);
// The GL program that evaluates it, compiled or at hand. DEVICE, MEMORY, NOT_FOUND.
MUST_USE Result diamond_programs_find(DiamondPrograms *programs, const DiamondProgram *program, unsigned *out);
void diamond_programs_destroy(DiamondPrograms *programs);
