#include "render/craft/craft_shadow.h"

#include "base/log.h"
#include "render/gl.h"
#include "render/shader.h"

#include <stdlib.h>

#define SIDE_HARDWARE 2048 // texels
#define SIDE_SOFTWARE 1024

struct CraftShadow {
    int side;
    GLuint program, texture, framebuffer;
};

// Compared while it is sampled: 1 where the point is not behind what the map holds. Outside the map is sun.
static GLuint create_texture(int side) {
    const float outside[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    GLuint texture = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, 1, GL_DEPTH_COMPONENT32F, side, side);
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    glTextureParameterfv(texture, GL_TEXTURE_BORDER_COLOR, outside);
    glTextureParameteri(texture, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTextureParameteri(texture, GL_TEXTURE_COMPARE_FUNC, GL_GEQUAL);
    return texture;
}

static Result create_framebuffer(CraftShadow *shadow) {
    shadow->side = gl_is_software() ? SIDE_SOFTWARE : SIDE_HARDWARE;
    shadow->texture = create_texture(shadow->side);
    glCreateFramebuffers(1, &shadow->framebuffer);
    glNamedFramebufferTexture(shadow->framebuffer, GL_DEPTH_ATTACHMENT, shadow->texture, 0);
    glNamedFramebufferDrawBuffer(shadow->framebuffer, GL_NONE);
    glNamedFramebufferReadBuffer(shadow->framebuffer, GL_NONE);
    if (glCheckNamedFramebufferStatus(shadow->framebuffer, GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE)
        return RESULT_OK;
    log_error("no framebuffer of %d x %d depths for the aircraft's shadow: the driver refuses it; update the driver",
              shadow->side, shadow->side);
    return RESULT_DEVICE;
}

Result craft_shadow_create(CraftShadow **out) {
    const ShaderSpec spec = {.stages = {"craft_shadow.vert", "craft_shadow.frag"}};
    CraftShadow *shadow = calloc(1, sizeof *shadow);
    if (!shadow) {
        log_error("out of memory for the aircraft's shadow");
        return RESULT_MEMORY;
    }
    Result result = create_framebuffer(shadow);
    if (result == RESULT_OK)
        result = shader_create_program(&spec, &shadow->program);
    if (result != RESULT_OK) {
        craft_shadow_destroy(&shadow);
        return result;
    }
    *out = shadow;
    return RESULT_OK;
}

void craft_shadow_destroy(CraftShadow **shadow) {
    CraftShadow *self = *shadow;
    if (!self)
        return;
    glDeleteProgram(self->program);
    glDeleteTextures(1, &self->texture);
    glDeleteFramebuffers(1, &self->framebuffer);
    free(self);
    *shadow = NULL;
}

static void put_row(float row[4], Vec3d axis, Vec3d centre, double radius_m) {
    double scale = 0.5 / radius_m;
    row[0] = (float)(axis.x * scale);
    row[1] = (float)(axis.y * scale);
    row[2] = (float)(axis.z * scale);
    row[3] = (float)(0.5 - vec3d_dot(axis, centre) * scale);
}

void craft_shadow_axes(Vec3d sun_ecef, Vec3d *right, Vec3d *top) {
    Vec3d aside = fabs(sun_ecef.z) < 0.9 ? vec3d(0.0, 0.0, 1.0) : vec3d(1.0, 0.0, 0.0);
    *right = vec3d_normalize(vec3d_cross(aside, sun_ecef));
    *top = vec3d_cross(sun_ecef, *right);
}

void craft_shadow_project(Vec3d sun_ecef, Vec3d centre_from_eye_m, double radius_m, float rows[3][4]) {
    Vec3d right, top;
    craft_shadow_axes(sun_ecef, &right, &top);
    put_row(rows[0], right, centre_from_eye_m, radius_m);
    put_row(rows[1], top, centre_from_eye_m, radius_m);
    put_row(rows[2], sun_ecef, centre_from_eye_m, radius_m);
}

void craft_shadow_begin(CraftShadow *shadow) {
    const float farthest = 0.0f;
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, shadow->framebuffer);
    glViewport(0, 0, shadow->side, shadow->side);
    glDisable(GL_SCISSOR_TEST);
    glClearNamedFramebufferfv(shadow->framebuffer, GL_DEPTH, 0, &farthest);
    glUseProgram(shadow->program);
}

void craft_shadow_end(CraftShadow *shadow) {
    glBindTextureUnit(CRAFT_SHADOW_UNIT, shadow->texture);
}
