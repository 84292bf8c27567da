#include "render/hud/canvas_gl.h"

#include "base/log.h"
#include "render/gl.h"
#include "render/shader.h"

#include <stddef.h>
#include <stdlib.h>

_Static_assert(sizeof(CanvasShape) == 52, "attributes below follow CanvasShape");
_Static_assert(CANVAS_GLYPH == 3, "shaders/canvas_interface.glsl has the same values");

struct CanvasGl {
    GLuint program, vertex_array, shapes, atlas, sampler;
    uint64_t atlas_revision; // that was uploaded
    int capacity;            // shapes
    GLuint kept_program, kept_framebuffer, kept_picture;
    int kept_x, kept_y, kept_width, kept_height; // GL's pixels, from the lower left corner; no width: nothing is kept
    int kept_edge;                               // rows at either end that are not opaque
};

// What canvas_gl_draw changes, as it was before.
typedef struct SavedState {
    GLint framebuffer, program, vertex_array, texture, sampler, viewport[4], polygon_mode[2], unpack_alignment,
        unpack_row_length;
    GLint unpack_buffer, blend_source[2], blend_target[2], blend_equation[2];
    GLboolean blend, depth_test, stencil_test, cull, scissor, srgb, colour_mask[4];
} SavedState;

static void describe_attribute(GLuint vertex_array, GLuint index, GLint count, GLenum type, size_t offset) {
    glEnableVertexArrayAttrib(vertex_array, index);
    glVertexArrayAttribFormat(vertex_array, index, count, type, type == GL_UNSIGNED_BYTE, (GLuint)offset);
    glVertexArrayAttribBinding(vertex_array, index, 0);
}

static void create_vertex_array(CanvasGl *gl) {
    glCreateBuffers(1, &gl->shapes);
    glCreateVertexArrays(1, &gl->vertex_array);
    glVertexArrayVertexBuffer(gl->vertex_array, 0, gl->shapes, 0, sizeof(CanvasShape));
    glVertexArrayBindingDivisor(gl->vertex_array, 0, 1);
    describe_attribute(gl->vertex_array, 0, 4, GL_FLOAT, offsetof(CanvasShape, a));
    describe_attribute(gl->vertex_array, 1, 4, GL_FLOAT, offsetof(CanvasShape, b));
    describe_attribute(gl->vertex_array, 2, 4, GL_FLOAT, offsetof(CanvasShape, kind));
    describe_attribute(gl->vertex_array, 3, 4, GL_UNSIGNED_BYTE, offsetof(CanvasShape, rgba));
}

static void create_atlas(CanvasGl *gl) {
    glCreateTextures(GL_TEXTURE_2D, 1, &gl->atlas);
    glTextureStorage2D(gl->atlas, 1, GL_R8, TEXT_ATLAS_PX, TEXT_ATLAS_PX);
    glCreateSamplers(1, &gl->sampler);
    glSamplerParameteri(gl->sampler, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glSamplerParameteri(gl->sampler, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glSamplerParameteri(gl->sampler, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glSamplerParameteri(gl->sampler, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

Result canvas_gl_create(CanvasGl **out) {
    CanvasGl *gl = calloc(1, sizeof *gl);
    if (!gl) {
        log_error("no memory for the canvas' GL objects");
        return RESULT_MEMORY;
    }
    const ShaderSpec spec = {.stages = {"canvas.vert", "canvas.frag"}};
    Result result = shader_create_program(&spec, &gl->program);
    if (result != RESULT_OK)
        goto fail;
    const ShaderSpec kept = {.stages = {"fullscreen.vert", "layer.frag"}};
    result = shader_create_program(&kept, &gl->kept_program);
    if (result != RESULT_OK)
        goto fail;
    create_vertex_array(gl);
    create_atlas(gl);
    *out = gl;
    return RESULT_OK;
fail:
    canvas_gl_destroy(&gl);
    return result;
}

void canvas_gl_destroy(CanvasGl **gl) {
    if (!*gl)
        return;
    glDeleteSamplers(1, &(*gl)->sampler);
    glDeleteTextures(1, &(*gl)->atlas);
    glDeleteVertexArrays(1, &(*gl)->vertex_array);
    glDeleteBuffers(1, &(*gl)->shapes);
    glDeleteProgram((*gl)->program);
    glDeleteProgram((*gl)->kept_program);
    glDeleteFramebuffers(1, &(*gl)->kept_framebuffer);
    glDeleteTextures(1, &(*gl)->kept_picture);
    free(*gl);
    *gl = NULL;
}

static void save_switches(SavedState *saved) {
    saved->blend = glIsEnabled(GL_BLEND);
    saved->depth_test = glIsEnabled(GL_DEPTH_TEST);
    saved->stencil_test = glIsEnabled(GL_STENCIL_TEST);
    saved->cull = glIsEnabled(GL_CULL_FACE);
    saved->scissor = glIsEnabled(GL_SCISSOR_TEST);
    saved->srgb = glIsEnabled(GL_FRAMEBUFFER_SRGB);
    glGetBooleanv(GL_COLOR_WRITEMASK, saved->colour_mask);
}

static void save_state(SavedState *saved) {
    save_switches(saved);
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &saved->framebuffer);
    glGetIntegerv(GL_CURRENT_PROGRAM, &saved->program);
    glGetIntegerv(GL_VERTEX_ARRAY_BINDING, &saved->vertex_array);
    glGetIntegeri_v(GL_TEXTURE_BINDING_2D, 0, &saved->texture);
    glGetIntegeri_v(GL_SAMPLER_BINDING, 0, &saved->sampler);
    glGetIntegerv(GL_VIEWPORT, saved->viewport);
    glGetIntegerv(GL_POLYGON_MODE, saved->polygon_mode);
    glGetIntegerv(GL_BLEND_SRC_RGB, &saved->blend_source[0]);
    glGetIntegerv(GL_BLEND_SRC_ALPHA, &saved->blend_source[1]);
    glGetIntegerv(GL_BLEND_DST_RGB, &saved->blend_target[0]);
    glGetIntegerv(GL_BLEND_DST_ALPHA, &saved->blend_target[1]);
    glGetIntegerv(GL_BLEND_EQUATION_RGB, &saved->blend_equation[0]);
    glGetIntegerv(GL_BLEND_EQUATION_ALPHA, &saved->blend_equation[1]);
}

static void set_switch(GLenum name, GLboolean on) {
    if (on)
        glEnable(name);
    else
        glDisable(name);
}

static void restore_state(const SavedState *saved) {
    set_switch(GL_BLEND, saved->blend);
    set_switch(GL_DEPTH_TEST, saved->depth_test);
    set_switch(GL_STENCIL_TEST, saved->stencil_test);
    set_switch(GL_CULL_FACE, saved->cull);
    set_switch(GL_SCISSOR_TEST, saved->scissor);
    set_switch(GL_FRAMEBUFFER_SRGB, saved->srgb);
    glColorMask(saved->colour_mask[0], saved->colour_mask[1], saved->colour_mask[2], saved->colour_mask[3]);
    glBlendFuncSeparate((GLenum)saved->blend_source[0], (GLenum)saved->blend_target[0], (GLenum)saved->blend_source[1],
                        (GLenum)saved->blend_target[1]);
    glBlendEquationSeparate((GLenum)saved->blend_equation[0], (GLenum)saved->blend_equation[1]);
    glPolygonMode(GL_FRONT_AND_BACK, (GLenum)saved->polygon_mode[0]);
    glViewport(saved->viewport[0], saved->viewport[1], saved->viewport[2], saved->viewport[3]);
    glBindTextureUnit(0, (GLuint)saved->texture);
    glBindSampler(0, (GLuint)saved->sampler);
    glBindVertexArray((GLuint)saved->vertex_array);
    glUseProgram((GLuint)saved->program);
}

static void set_state(const CanvasGl *gl) {
    glEnable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_STENCIL_TEST);
    glDisable(GL_CULL_FACE);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_FRAMEBUFFER_SRGB);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glUseProgram(gl->program);
    glBindVertexArray(gl->vertex_array);
    glBindTextureUnit(0, gl->atlas);
    glBindSampler(0, gl->sampler);
}

static void upload_atlas(CanvasGl *gl, const Text *text) {
    if (gl->atlas_revision == text_atlas_revision(text))
        return;
    GLint alignment, row_length, buffer;
    glGetIntegerv(GL_UNPACK_ALIGNMENT, &alignment);
    glGetIntegerv(GL_UNPACK_ROW_LENGTH, &row_length);
    glGetIntegerv(GL_PIXEL_UNPACK_BUFFER_BINDING, &buffer);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    glTextureSubImage2D(gl->atlas, 0, 0, 0, TEXT_ATLAS_PX, TEXT_ATLAS_PX, GL_RED, GL_UNSIGNED_BYTE, text_atlas(text));
    glPixelStorei(GL_UNPACK_ALIGNMENT, alignment);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, row_length);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, (GLuint)buffer);
    gl->atlas_revision = text_atlas_revision(text);
}

// Halos and boxes first, then what lies on them: one buffer, one call. The buffer's old contents are given up, so that
// the driver need not wait for the frame before.
static int upload_shapes(CanvasGl *gl, const Canvas *canvas) {
    const CanvasShape *under, *over;
    int under_count = canvas_under(canvas, &under), over_count = canvas_over(canvas, &over);
    int count = under_count + over_count;
    if (count > gl->capacity)
        gl->capacity = count * 3 / 2;
    const GLsizeiptr size = sizeof(CanvasShape);
    glNamedBufferData(gl->shapes, gl->capacity * size, NULL, GL_STREAM_DRAW);
    glNamedBufferSubData(gl->shapes, 0, under_count * size, under);
    glNamedBufferSubData(gl->shapes, under_count * size, over_count * size, over);
    return count;
}

static void draw_shapes(int count, int width, int height) {
    glUniform2f(0, (float)width, (float)height);
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count);
}

void canvas_gl_draw(CanvasGl *gl, const Canvas *canvas, const Text *text, int width, int height) {
    SavedState saved;
    upload_atlas(gl, text);
    int count = upload_shapes(gl, canvas);
    save_state(&saved);
    set_state(gl);
    // The target's alpha stays as it is: a picture is opaque.
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    glViewport(0, 0, width, height);
    draw_shapes(count, width, height);
    restore_state(&saved);
}

// ---- a part that is kept ----

static void fit_kept(CanvasGl *gl, int width, int height) {
    if (width == gl->kept_width && height == gl->kept_height)
        return;
    glDeleteFramebuffers(1, &gl->kept_framebuffer);
    glDeleteTextures(1, &gl->kept_picture);
    glCreateTextures(GL_TEXTURE_2D, 1, &gl->kept_picture);
    glTextureStorage2D(gl->kept_picture, 1, GL_RGBA8, width, height);
    glTextureParameteri(gl->kept_picture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glCreateFramebuffers(1, &gl->kept_framebuffer);
    glNamedFramebufferTexture(gl->kept_framebuffer, GL_COLOR_ATTACHMENT0, gl->kept_picture, 0);
    gl->kept_width = width;
    gl->kept_height = height;
}

void canvas_gl_keep(CanvasGl *gl, const Canvas *canvas, const Text *text, const CanvasKept *kept, int width,
                    int height) {
    const CanvasRect part = kept->part;
    const float nothing[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    SavedState saved;
    upload_atlas(gl, text);
    int count = upload_shapes(gl, canvas);
    fit_kept(gl, (int)(part.x1 - part.x0), (int)(part.y1 - part.y0));
    gl->kept_x = (int)part.x0;
    gl->kept_y = height - (int)part.y1;
    gl->kept_edge = kept->edge_px < gl->kept_height / 2 ? kept->edge_px : gl->kept_height / 2;
    save_state(&saved);
    set_state(gl);
    // The colours come out premultiplied, over nothing.
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, gl->kept_framebuffer);
    glClearBufferfv(GL_COLOR, 0, nothing);
    glViewport(-gl->kept_x, -gl->kept_y, width, height);
    draw_shapes(count, width, height);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, (GLuint)saved.framebuffer);
    restore_state(&saved);
}

// With what is there showing through.
static void blend_kept(const CanvasGl *gl, int y, int height) {
    glViewport(gl->kept_x, gl->kept_y + y, gl->kept_width, height);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

static void copy_kept(const CanvasGl *gl, int y0, int y1, GLint framebuffer) {
    int x = gl->kept_x, y = gl->kept_y;
    glBlitNamedFramebuffer(gl->kept_framebuffer, (GLuint)framebuffer, 0, y0, gl->kept_width, y1, x, y + y0,
                           x + gl->kept_width, y + y1, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

// Software copies thirty times as fast as it blends.
void canvas_gl_draw_kept(CanvasGl *gl) {
    SavedState saved;
    int edge = gl->kept_edge, end = gl->kept_height - edge;
    if (gl->kept_width == 0)
        return;
    save_state(&saved);
    set_state(gl);
    glBlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    glUseProgram(gl->kept_program);
    glBindTextureUnit(0, gl->kept_picture);
    glBindSampler(0, 0);
    glUniform2i(0, gl->kept_x, gl->kept_y);
    blend_kept(gl, 0, edge);
    blend_kept(gl, end, edge);
    copy_kept(gl, edge, end, saved.framebuffer);
    restore_state(&saved);
}
