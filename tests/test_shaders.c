// Every shader compiles in every variant, its uniform blocks lie as their C twins do, and the small preprocessor does
// what its header says.
#define _POSIX_C_SOURCE 200809L
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "render/craft/craft_shade.h"
#include "render/frame.h"
#include "render/gl.h"
#include "render/ground/drape.h"
#include "render/ground/ground.h"
#include "render/shader.h"
#include "tests/gl_support.h"
#include "tests/heard.h"

typedef struct Variants {
    const char *stages[SHADER_STAGES_MAX];
    const char *switches[5]; // each on or off
    const char *always;
} Variants;

static const Variants VARIANTS[] = {
    {{"terrain.vert", "terrain.frag"}, {"HOLES", "DRAPE", "WATER", "SEA", "SHADED"}, ""},
    {{"terrain.vert", "wire.geom", "wire.frag"}, {NULL}, ""},
    {{"sky.vert", "sky.frag"}, {NULL}, ""},
    {{"sky.vert", "globe.frag"}, {"DRAPE", "SEA", "SHADED"}, ""},
    {{"craft.vert", "craft.frag"}, {NULL}, ""},
    {{"craft_shadow.vert", "craft_shadow.frag"}, {NULL}, ""},
    {{"craft_shadow.vert", "craft_shade.frag"}, {NULL}, ""},
    {{"fullscreen.vert", "atmosphere_transmittance.frag"}, {NULL}, ""},
    {{"fullscreen.vert", "atmosphere_multiple.frag"}, {NULL}, ""},
    {{"fullscreen.vert", "atmosphere_ground.frag"}, {NULL}, "GROUND_LIGHT_WIDTH=64 GROUND_LIGHT_HEIGHT=4"},
    {{"fullscreen.vert", "sky_view.frag"}, {NULL}, ""},
    {{"canvas.vert", "canvas.frag"}, {NULL}, ""},
    {{"fullscreen.vert", "layer.frag"}, {NULL}, ""},
    {{"diamond_terrain.vert", "terrain.frag"}, {"HOLES", "DRAPE", "WATER", "SEA", "SHADED"}, ""},
    {{"diamond_terrain.vert", "diamond_level.geom", "terrain.frag"}, {"HOLES", "DRAPE", "SEA", "SHADED"}, ""},
    {{"diamond_terrain.vert", "wire.geom", "wire.frag"}, {NULL}, ""},
    {{"diamond_errors.comp"}, {"BY_GROUP"}, ""},
    {{"diamond_evaluate.comp"}, {"FIELD_DATUM", "FIELD_DEGREES"}, ""},
    {{"diamond_close.comp"}, {"EDGES_OF_PLANE"}, ""},
    {{"diamond_indices.comp"}, {NULL}, ""},
};

// What predicates are compiled to, see render/diamond/diamond_program.h.
static const ShaderInsert PREDICATE = {"diamond_program.glsl", "bool selects(Vertex vertex) {\n    return true;\n}\n"};

static bool compile_variant(const Variants *variants, unsigned choice) {
    char defines[256];
    snprintf(defines, sizeof defines, "%s", variants->always);
    for (unsigned i = 0; i < COUNT_OF(variants->switches) && variants->switches[i]; i++) {
        size_t used = strlen(defines);
        if (choice >> i & 1)
            snprintf(defines + used, sizeof defines - used, " %s", variants->switches[i]);
    }
    ShaderSpec spec = {.defines = defines, .insert = &PREDICATE};
    memcpy(spec.stages, variants->stages, sizeof spec.stages);
    unsigned program = 0;
    bool compiles = shader_create_program(&spec, &program) == RESULT_OK;
    if (compiles)
        glDeleteProgram(program);
    else
        print_error("%s, %s with '%s' fails\n", variants->stages[0],
                    variants->stages[1] ? variants->stages[1] : "alone", defines);
    return compiles;
}

static void every_variant_compiles(void **state) {
    (void)state;
    int tried = 0, failed = 0;
    for (size_t i = 0; i < COUNT_OF(VARIANTS); i++) {
        unsigned switches = 0;
        while (switches < COUNT_OF(VARIANTS[i].switches) && VARIANTS[i].switches[switches])
            switches++;
        for (unsigned choice = 0; choice < 1u << switches; choice++, tried++)
            failed += !compile_variant(&VARIANTS[i], choice);
    }
    print_message("%d variants\n", tried);
    assert_int_equal(failed, 0);
}

static int offset_in_block(unsigned program, const char *member) {
    const GLenum property = GL_OFFSET;
    GLint offset = -1;
    GLuint index = glGetProgramResourceIndex(program, GL_UNIFORM, member);
    if (index != GL_INVALID_INDEX)
        glGetProgramResourceiv(program, GL_UNIFORM, index, 1, &property, 1, NULL, &offset);
    return offset;
}

#define MEMBER(block, Type, name)                                                                                      \
    { #block "." #name, offsetof(Type, name) }
#define ARRAY(block, Type, name)                                                                                       \
    { #block "." #name "[0]", offsetof(Type, name) }

static void uniform_blocks_lie_as_in_c(void **state) {
    (void)state;
    static const struct {
        const char *name;
        size_t offset;
    } MEMBERS[] = {
        MEMBER(FrameBlock, FrameBlock, clip_from_eye), MEMBER(FrameBlock, FrameBlock, eye_rest_m),
        MEMBER(FrameBlock, FrameBlock, ray_right),     MEMBER(FrameBlock, FrameBlock, ray_up),
        MEMBER(FrameBlock, FrameBlock, ray_ahead),     MEMBER(FrameBlock, FrameBlock, sun),
        MEMBER(FrameBlock, FrameBlock, eye_up),        MEMBER(FrameBlock, FrameBlock, sun_side),
        MEMBER(FrameBlock, FrameBlock, air),           ARRAY(FrameBlock, FrameBlock, light_sun),
        ARRAY(FrameBlock, FrameBlock, light_sky),      MEMBER(FrameBlock, FrameBlock, wave_east),
        MEMBER(FrameBlock, FrameBlock, wave_north),    MEMBER(FrameBlock, FrameBlock, mode),
        MEMBER(GroundBlock, GroundBlock, texel),       MEMBER(GroundBlock, GroundBlock, height),
        MEMBER(GroundBlock, GroundBlock, noise),       MEMBER(GroundBlock, GroundBlock, globe),
        MEMBER(DrapeBlock, DrapeBlock, globe),         MEMBER(DrapeBlock, DrapeBlock, map),
        MEMBER(DrapeBlock, DrapeBlock, image),         ARRAY(CraftShadeBlock, CraftShadeBlock, map_rows),
    };
    const ShaderSpec specs[] = {
        {.stages = {"terrain.vert", "terrain.frag"}, .defines = "DRAPE WATER HOLES SHADED"},
        {.stages = {"sky.vert", "globe.frag"}, .defines = "DRAPE"},
    };
    unsigned programs[COUNT_OF(specs)];
    for (size_t i = 0; i < COUNT_OF(specs); i++)
        assert_int_equal(shader_create_program(&specs[i], &programs[i]), RESULT_OK);
    for (size_t i = 0; i < COUNT_OF(MEMBERS); i++) {
        int offset = offset_in_block(programs[0], MEMBERS[i].name);
        offset = offset >= 0 ? offset : offset_in_block(programs[1], MEMBERS[i].name);
        if (offset >= 0 && (size_t)offset != MEMBERS[i].offset)
            fail_msg("%s: at %d in the shader, at %zu in C", MEMBERS[i].name, offset, MEMBERS[i].offset);
        print_message("%-28s %d\n", MEMBERS[i].name, offset);
    }
    for (size_t i = 0; i < COUNT_OF(specs); i++)
        glDeleteProgram(programs[i]);
}

// --- the preprocessor, on files of the test's own

static void write_file(const char *folder, const char *name, const char *text) {
    char path[256];
    snprintf(path, sizeof path, "%s/shaders/%s", folder, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static void remove_file(const char *folder, const char *name) {
    char path[256];
    snprintf(path, sizeof path, "%s/shaders/%s", folder, name);
    remove(path);
}

static void includes_are_taken_once_and_defines_follow_the_version(void **state) {
    (void)state;
    char folder[] = "/tmp/overfly-shaders-XXXXXX", sub[64];
    assert_non_null(mkdtemp(folder));
    snprintf(sub, sizeof sub, "%s/shaders", folder);
    assert_int_equal(mkdir(sub, 0700), 0);
    write_file(folder, "a.frag", "#version 450 core\n#include \"b.glsl\"\n#include \"c.glsl\"\nvoid main() {}\n");
    write_file(folder, "b.glsl", "#include \"c.glsl\"\nint b;\n");
    write_file(folder, "c.glsl", "int c;\n");
    assert_int_equal(setenv("OVERFLY_DATA_DIR", folder, 1), 0);
    char *text = NULL, *files = NULL;
    assert_int_equal(shader_expand("a.frag", "HOLES SIZE=12", &text, &files), RESULT_OK);
    assert_string_equal(text,
                        "#version 450 core\n#define HOLES 1\n#define SIZE 12\n#line 2 0\n"
                        "#line 1 1\n#line 1 2\nint c;\n#line 2 1\nint b;\n#line 3 0\n#line 4 0\nvoid main() {}\n");
    assert_string_equal(files, "a.frag\nb.glsl\nc.glsl\n");
    free(text);
    free(files);

    Heard heard;
    unsigned program = 0;
    write_file(folder, "bad.frag",
               "#version 450 core\n#include \"c.glsl\"\nout vec4 colour;\nvoid main() { colour = 3; }\n");
    const ShaderSpec bad = {.stages = {"bad.frag"}}, missing = {.stages = {"missing.frag"}};
    heard_begin(&heard);
    assert_int_equal(shader_create_program(&bad, &program), RESULT_DEVICE);
    heard_end();
    assert_non_null(strstr(heard.text, "bad.frag"));
    assert_non_null(strstr(heard.text, "0:4")); // the file and the line, in spite of the include
    heard_begin(&heard);
    assert_int_equal(shader_create_program(&missing, &program), RESULT_NOT_FOUND);
    heard_end();
    assert_non_null(strstr(heard.text, "missing.frag"));
    assert_int_equal(unsetenv("OVERFLY_DATA_DIR"), 0);
    const char *const names[] = {"a.frag", "b.glsl", "c.glsl", "bad.frag"};
    for (size_t i = 0; i < COUNT_OF(names); i++)
        remove_file(folder, names[i]);
    rmdir(sub);
    rmdir(folder);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_variant_compiles),
        cmocka_unit_test(uniform_blocks_lie_as_in_c),
        cmocka_unit_test(includes_are_taken_once_and_defines_follow_the_version),
    };
    Context *context = NULL;
    if (!gl_support_begin(16, 16, &context))
        return GL_SKIP_STATUS;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    context_destroy(&context);
    return failed;
}
