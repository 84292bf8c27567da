// Yalcin, Weiss, De Floriani 2011, section 6: any predicate. Our own: it is text, compiled to postfix steps for the
// CPU, and those to straight-line GLSL, one statement a step, so that both sides do the same operations in the same
// order.
#include "render/diamond/diamond_program.h"

#include "base/log.h"
#include "render/gl.h"
#include "render/shader.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINE_BYTES 96

static const struct {
    const char *name;
    int operands;
} OPS[DIAMOND_OP_COUNT] = {
#define DIAMOND_OP_ROW(id, operands, constants, meaning) {"DIAMOND_OP_" #id, operands},
    DIAMOND_OP_TABLE(DIAMOND_OP_ROW)
#undef DIAMOND_OP_ROW
};

unsigned diamond_program_fields(const DiamondProgram *program) {
    unsigned fields = 0;
    for (int i = 0; i < program->step_count; i++) {
        fields |= program->steps[i].op == DIAMOND_OP_HEIGHT ? DIAMOND_FIELD_DATUM : 0;
        fields |= program->steps[i].op == DIAMOND_OP_BOX ? DIAMOND_FIELD_DEGREES : 0;
    }
    return fields;
}

// One statement; `stack` holds the numbers of the steps whose results lie there.
static int print_step(char line[LINE_BYTES], const DiamondProgram *program, int step, int *stack, int depth) {
    const DiamondStep *s = &program->steps[step];
    const char *name = OPS[s->op].name;
    int operands = OPS[s->op].operands;
    if (operands == 0)
        snprintf(line, LINE_BYTES, "    precise float t%d = %s(vertex, %d);\n", step, name, s->first);
    else if (operands == 1)
        snprintf(line, LINE_BYTES, "    precise float t%d = %s(t%d);\n", step, name, stack[depth - 1]);
    else
        snprintf(line, LINE_BYTES, "    precise float t%d = %s(t%d, t%d);\n", step, name, stack[depth - 2],
                 stack[depth - 1]);
    depth -= operands;
    stack[depth] = step;
    return depth + 1;
}

char *diamond_program_source(const DiamondProgram *program) {
    size_t bytes = LINE_BYTES * ((size_t)program->step_count + 4), length = 0;
    char *text = malloc(bytes);
    if (!text)
        return NULL;
    int stack[DIAMOND_STACK_MAX + 1], depth = 0;
    length += (size_t)snprintf(text, bytes, "bool selects(Vertex vertex) {\n");
    for (int i = 0; i < program->step_count; i++) {
        depth = print_step(text + length, program, i, stack, depth);
        length += strlen(text + length);
    }
    snprintf(text + length, bytes - length, "    return t%d != 0.0;\n}\n", stack[0]);
    return text;
}

static bool is_same(const DiamondCompiled *compiled, const DiamondProgram *program) {
    if (!compiled->program || compiled->step_count != program->step_count)
        return false;
    for (int i = 0; i < program->step_count; i++)
        if (compiled->steps[i].op != program->steps[i].op || compiled->steps[i].first != program->steps[i].first)
            return false;
    return true;
}

static Result compile(const DiamondProgram *program, unsigned *out) {
    char *text = diamond_program_source(program);
    if (!text) {
        log_error("out of memory for the shader of a predicate");
        return RESULT_MEMORY;
    }
    unsigned fields = diamond_program_fields(program);
    char defines[64];
    snprintf(defines, sizeof defines, "%s%s", fields & DIAMOND_FIELD_DATUM ? "FIELD_DATUM " : "",
             fields & DIAMOND_FIELD_DEGREES ? "FIELD_DEGREES" : "");
    const ShaderInsert insert = {"diamond_program.glsl", text};
    const ShaderSpec spec = {.stages = {"diamond_evaluate.comp"}, .defines = defines, .insert = &insert};
    Result result = shader_create_program(&spec, out);
    free(text);
    return result;
}

Result diamond_programs_find(DiamondPrograms *programs, const DiamondProgram *program, unsigned *out) {
    for (int i = 0; i < DIAMOND_PROGRAMS; i++)
        if (is_same(&programs->compiled[i], program)) {
            *out = programs->compiled[i].program;
            return RESULT_OK;
        }
    Result result = compile(program, out);
    if (result != RESULT_OK)
        return result;
    DiamondCompiled *slot = &programs->compiled[programs->next++ % DIAMOND_PROGRAMS];
    glDeleteProgram(slot->program);
    *slot = (DiamondCompiled){.program = *out, .step_count = program->step_count};
    memcpy(slot->steps, program->steps, sizeof *slot->steps * (size_t)program->step_count);
    return RESULT_OK;
}

void diamond_programs_destroy(DiamondPrograms *programs) {
    for (int i = 0; i < DIAMOND_PROGRAMS; i++)
        glDeleteProgram(programs->compiled[i].program);
    *programs = (DiamondPrograms){0};
}
