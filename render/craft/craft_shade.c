#include "render/craft/craft_shade.h"

#include "base/log.h"
#include "render/gl.h"
#include "render/shader.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SIDE_HARDWARE 2048 // texels
#define SIDE_SOFTWARE 1024
#define SIDE_LEAST 128

struct CraftShade {
    int side, level; // level: of the texture that was drawn to last
    GLuint program, texture, depth, framebuffer, block_buffer;
};

static int count_levels(int side) {
    int count = 1;
    for (; side > 1; side /= 2)
        count++;
    return count;
}

// Beside the map there is nothing.
static void create_map(CraftShade *shade) {
    const float nothing[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    glCreateTextures(GL_TEXTURE_2D, 1, &shade->texture);
    glTextureStorage2D(shade->texture, count_levels(shade->side), GL_RG16, shade->side, shade->side);
    glTextureParameteri(shade->texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameteri(shade->texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(shade->texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
    glTextureParameteri(shade->texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    glTextureParameterfv(shade->texture, GL_TEXTURE_BORDER_COLOR, nothing);
    glCreateRenderbuffers(1, &shade->depth);
    glNamedRenderbufferStorage(shade->depth, GL_DEPTH_COMPONENT32F, shade->side, shade->side);
}

static Result create_framebuffer(CraftShade *shade) {
    glCreateFramebuffers(1, &shade->framebuffer);
    glNamedFramebufferTexture(shade->framebuffer, GL_COLOR_ATTACHMENT0, shade->texture, 0);
    glNamedFramebufferRenderbuffer(shade->framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, shade->depth);
    if (glCheckNamedFramebufferStatus(shade->framebuffer, GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE)
        return RESULT_OK;
    log_error("no framebuffer of %d x %d texels for the aircraft's shadow on the ground: the driver refuses it; update "
              "the driver",
              shade->side, shade->side);
    return RESULT_DEVICE;
}

Result craft_shade_create(CraftShade **out) {
    const ShaderSpec spec = {.stages = {"craft_shadow.vert", "craft_shade.frag"}};
    CraftShade *shade = calloc(1, sizeof *shade);
    if (!shade) {
        log_error("out of memory for the aircraft's shadow on the ground");
        return RESULT_MEMORY;
    }
    shade->side = gl_is_software() ? SIDE_SOFTWARE : SIDE_HARDWARE;
    create_map(shade);
    glCreateBuffers(1, &shade->block_buffer);
    glNamedBufferStorage(shade->block_buffer, sizeof(CraftShadeBlock), NULL, GL_DYNAMIC_STORAGE_BIT);
    Result result = create_framebuffer(shade);
    if (result == RESULT_OK)
        result = shader_create_program(&spec, &shade->program);
    if (result != RESULT_OK) {
        craft_shade_destroy(&shade);
        return result;
    }
    *out = shade;
    return RESULT_OK;
}

void craft_shade_destroy(CraftShade **shade) {
    CraftShade *self = *shade;
    if (!self)
        return;
    glDeleteProgram(self->program);
    glDeleteTextures(1, &self->texture);
    glDeleteRenderbuffers(1, &self->depth);
    glDeleteFramebuffers(1, &self->framebuffer);
    glDeleteBuffers(1, &self->block_buffer);
    free(self);
    *shade = NULL;
}

static int level_for(const CraftShade *shade, double across_m, double texel_m) {
    int level = 0;
    for (int side = shade->side; side > SIDE_LEAST && 2.0 * across_m <= texel_m * side; side /= 2)
        level++;
    return level;
}

void craft_shade_begin(CraftShade *shade, double across_m, double texel_m) {
    const float nothing[4] = {0.0f, 0.0f, 0.0f, 0.0f}, farthest = 0.0f;
    shade->level = level_for(shade, across_m, texel_m);
    int side = shade->side >> shade->level;
    glTextureParameteri(shade->texture, GL_TEXTURE_BASE_LEVEL, shade->level);
    glNamedFramebufferTexture(shade->framebuffer, GL_COLOR_ATTACHMENT0, shade->texture, shade->level);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, shade->framebuffer);
    glViewport(0, 0, side, side);
    glDisable(GL_SCISSOR_TEST);
    glClearNamedFramebufferfv(shade->framebuffer, GL_COLOR, 0, nothing);
    glClearNamedFramebufferfv(shade->framebuffer, GL_DEPTH, 0, &farthest);
    glUseProgram(shade->program);
}

void craft_shade_end(CraftShade *shade, const float map_rows[3][4]) {
    CraftShadeBlock block;
    memcpy(block.map_rows, map_rows, sizeof block.map_rows);
    glNamedBufferSubData(shade->block_buffer, 0, sizeof block, &block);
    glGenerateTextureMipmap(shade->texture);
    glBindTextureUnit(CRAFT_SHADE_UNIT, shade->texture);
    glBindBufferBase(GL_UNIFORM_BUFFER, CRAFT_SHADE_BLOCK_BINDING, shade->block_buffer);
}
