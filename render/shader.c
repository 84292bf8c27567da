#include "render/shader.h"

#include "base/log.h"
#include "base/paths.h"
#include "render/gl.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FILES_MAX 32 // of one stage, includes counted
#define LINE_MAX_BYTES 512

// Text that grows; `failed` is kept until the end, so that appending needs no checks.
typedef struct Text {
    char *bytes;
    size_t length, capacity;
    bool failed;
} Text;

typedef struct Expansion {
    const char *defines;
    const ShaderInsert *insert; // or NULL
    Text text, files;
    char seen[FILES_MAX][LINE_MAX_BYTES];
    int seen_count;
} Expansion;

static void text_append(Text *text, const char *bytes, size_t length) {
    if (text->length + length + 1 > text->capacity) {
        size_t capacity = (text->length + length + 1) * 2;
        char *grown = realloc(text->bytes, capacity);
        if (!grown) {
            text->failed = true;
            return;
        }
        text->bytes = grown;
        text->capacity = capacity;
    }
    memcpy(text->bytes + text->length, bytes, length);
    text->length += length;
    text->bytes[text->length] = '\0';
}

PRINTF_LIKE(2, 3) static void text_print(Text *text, const char *format, ...) {
    char line[LINE_MAX_BYTES];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    text_append(text, line, length < (int)sizeof line ? (size_t)length : sizeof line - 1);
}

// "HOLES SAMPLES=4" becomes one #define a line.
static void append_defines(Expansion *expansion, int next_line, int file_index) {
    const char *rest = expansion->defines ? expansion->defines : "";
    while (*rest) {
        size_t length = strcspn(rest, " ");
        size_t name = strcspn(rest, "= ");
        const char *value = name < length ? rest + name + 1 : "1";
        int value_length = name < length ? (int)(length - name - 1) : 1;
        if (length)
            text_print(&expansion->text, "#define %.*s %.*s\n", (int)name, rest, value_length, value);
        rest += length;
        rest += strspn(rest, " ");
    }
    text_print(&expansion->text, "#line %d %d\n", next_line, file_index);
}

static bool was_seen(const Expansion *expansion, const char *file) {
    for (int i = 0; i < expansion->seen_count; i++)
        if (strcmp(expansion->seen[i], file) == 0)
            return true;
    return false;
}

static bool included_name(const char *line, char name[LINE_MAX_BYTES]) {
    return sscanf(line, " #include \"%255[^\"]\"", name) == 1;
}

static Result expand_file(Expansion *expansion, const char *file);

static Result expand_lines(Expansion *expansion, FILE *stream, int file_index) {
    char line[LINE_MAX_BYTES], name[LINE_MAX_BYTES];
    for (int number = 1; fgets(line, sizeof line, stream); number++) {
        if (included_name(line, name)) {
            Result result = expand_file(expansion, name);
            if (result != RESULT_OK)
                return result;
            text_print(&expansion->text, "#line %d %d\n", number + 1, file_index);
            continue;
        }
        text_append(&expansion->text, line, strlen(line));
        if (strncmp(line, "#version", 8) == 0)
            append_defines(expansion, number + 1, file_index);
    }
    return RESULT_OK;
}

static Result open_shader(const char *file, FILE **out) {
    char relative[LINE_MAX_BYTES], path[PATHS_BYTES_MAX];
    snprintf(relative, sizeof relative, "shaders/%s", file);
    Result result = paths_find_data(relative, path);
    if (result != RESULT_OK)
        return result;
    *out = fopen(path, "r");
    if (!*out)
        log_error("%s: %s; make it readable, or install overfly again", path, strerror(errno));
    return *out ? RESULT_OK : RESULT_IO;
}

static bool is_insert(const Expansion *expansion, const char *file) {
    return expansion->insert && strcmp(expansion->insert->name, file) == 0;
}

static Result expand_insert(Expansion *expansion, int index) {
    const char *text = expansion->insert->text;
    text_print(&expansion->text, "#line 1 %d\n", index);
    text_append(&expansion->text, text, strlen(text));
    return RESULT_OK;
}

static Result expand_file(Expansion *expansion, const char *file) {
    if (was_seen(expansion, file))
        return RESULT_OK;
    if (expansion->seen_count == FILES_MAX) {
        log_error("%s: a shader of more than %d files", file, FILES_MAX);
        return RESULT_FORMAT;
    }
    int index = expansion->seen_count++;
    snprintf(expansion->seen[index], sizeof expansion->seen[index], "%s", file);
    text_print(&expansion->files, "%s\n", file);
    if (is_insert(expansion, file))
        return expand_insert(expansion, index);
    FILE *stream = NULL;
    Result result = open_shader(file, &stream);
    if (result != RESULT_OK)
        return result;
    if (index > 0)
        text_print(&expansion->text, "#line 1 %d\n", index);
    result = expand_lines(expansion, stream, index);
    fclose(stream);
    return result;
}

static Result expand(const char *file, const char *defines, const ShaderInsert *insert, char **text, char **files) {
    Result result = RESULT_MEMORY;
    Expansion *expansion = calloc(1, sizeof *expansion);
    if (!expansion)
        goto fail;
    expansion->defines = defines;
    expansion->insert = insert;
    if ((result = expand_file(expansion, file)) != RESULT_OK)
        goto fail;
    if (expansion->text.failed || expansion->files.failed || !expansion->text.bytes) {
        log_error("%s: empty, or no memory for it", file);
        result = RESULT_MEMORY;
        goto fail;
    }
    *text = expansion->text.bytes;
    if (files)
        *files = expansion->files.bytes;
    else
        free(expansion->files.bytes);
    free(expansion);
    return RESULT_OK;
fail:
    if (expansion) {
        free(expansion->text.bytes);
        free(expansion->files.bytes);
    }
    free(expansion);
    return result;
}

Result shader_expand(const char *file, const char *defines, char **text, char **files) {
    return expand(file, defines, NULL, text, files);
}

static GLenum stage_of(const char *file) {
    const char *suffix = strrchr(file, '.');
    if (suffix && strcmp(suffix, ".vert") == 0)
        return GL_VERTEX_SHADER;
    if (suffix && strcmp(suffix, ".geom") == 0)
        return GL_GEOMETRY_SHADER;
    if (suffix && strcmp(suffix, ".comp") == 0)
        return GL_COMPUTE_SHADER;
    return GL_FRAGMENT_SHADER;
}

static void log_compile_error(GLuint shader, const char *file, const char *defines, const char *files) {
    char complaint[2048] = "";
    glGetShaderInfoLog(shader, sizeof complaint, NULL, complaint);
    log_error("shader %s (%s) does not compile:\n%s\nfiles, counted from 0:\n%s", file,
              defines ? defines : "no defines", complaint, files);
}

static Result compile_stage(const char *file, const ShaderSpec *spec, GLuint *out) {
    char *text = NULL, *files = NULL;
    Result result = expand(file, spec->defines, spec->insert, &text, &files);
    if (result != RESULT_OK)
        return result;
    GLuint shader = glCreateShader(stage_of(file));
    const GLchar *source = text;
    GLint compiled = GL_FALSE;
    glShaderSource(shader, 1, &source, NULL);
    glCompileShader(shader);
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (!compiled) {
        log_compile_error(shader, file, spec->defines, files);
        glDeleteShader(shader);
        result = RESULT_DEVICE;
    }
    free(text);
    free(files);
    *out = shader;
    return result;
}

static Result link_program(GLuint program, const ShaderSpec *spec) {
    if (spec->feedback_count)
        glTransformFeedbackVaryings(program, spec->feedback_count, spec->feedback, GL_INTERLEAVED_ATTRIBS);
    GLint linked = GL_FALSE;
    glLinkProgram(program);
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    if (linked)
        return RESULT_OK;
    char complaint[2048] = "";
    glGetProgramInfoLog(program, sizeof complaint, NULL, complaint);
    log_error("shader program %s does not link:\n%s", spec->stages[0], complaint);
    return RESULT_DEVICE;
}

Result shader_create_program(const ShaderSpec *spec, unsigned *out) {
    Result result = RESULT_OK;
    GLuint program = glCreateProgram();
    for (int i = 0; i < SHADER_STAGES_MAX && spec->stages[i]; i++) {
        GLuint shader = 0;
        if ((result = compile_stage(spec->stages[i], spec, &shader)) != RESULT_OK)
            goto fail;
        glAttachShader(program, shader);
        glDeleteShader(shader); // lives on until the program goes
    }
    if ((result = link_program(program, spec)) != RESULT_OK)
        goto fail;
    *out = program;
    return RESULT_OK;
fail:
    glDeleteProgram(program);
    return result;
}
