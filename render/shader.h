// render/shader.h: GL programs from files in the data directory, with #include and injected defines.
// No units.
// The caller owns the program and deletes it with glDeleteProgram; thread of the context.
#pragma once
#include "base/base.h"

#define SHADER_STAGES_MAX 3

// Text made by the program, for the place where a file says #include "name".
typedef struct ShaderInsert {
    const char *name, *text; // `text` ends with a newline
} ShaderInsert;

// One program: files of the shaders folder (base/paths.h), ending in .vert, .geom, .frag or .comp.
typedef struct ShaderSpec {
    const char *stages[SHADER_STAGES_MAX];
    const char *defines;         // "HOLES SAMPLES=4", or NULL
    const char *const *feedback; // varyings to capture, or NULL
    int feedback_count;
    const ShaderInsert *insert; // or NULL
} ShaderSpec;

// The text a stage is compiled from: `#include "file"` (relative to the folder of shaders, once per stage) is
// replaced by the file, and defines follow the #version line. The caller frees it. `files`, if not NULL, gets one
// name per line, numbered as in the #line directives. NOT_FOUND and FORMAT (nesting) name the file.
MUST_USE Result shader_expand(const char *file, const char *defines, char **text, char **files);

// Compiles and links; the driver's complaint goes to the log. NOT_FOUND, FORMAT, DEVICE, MEMORY.
MUST_USE Result shader_create_program(const ShaderSpec *spec, unsigned *program);
