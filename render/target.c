#include "render/target.h"

#include "base/log.h"
#include "render/gl.h"

static GLuint create_storage(GLenum format, int width, int height, int samples) {
    GLuint storage = 0;
    glCreateRenderbuffers(1, &storage);
    if (samples > 1)
        glNamedRenderbufferStorageMultisample(storage, samples, format, width, height);
    else
        glNamedRenderbufferStorage(storage, format, width, height);
    return storage;
}

Result target_create(int width, int height, int samples, Target *out) {
    Target target = {.width = width, .height = height, .samples = samples};
    target.colour = create_storage(GL_RGBA8, width, height, samples);
    target.depth = create_storage(GL_DEPTH_COMPONENT32F, width, height, samples);
    glCreateFramebuffers(1, &target.framebuffer);
    glNamedFramebufferRenderbuffer(target.framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target.colour);
    glNamedFramebufferRenderbuffer(target.framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, target.depth);
    if (glCheckNamedFramebufferStatus(target.framebuffer, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        log_error("no framebuffer of %d x %d pixels with %d samples: the driver refuses it; ask for fewer", width,
                  height, samples);
        target_destroy(&target);
        return RESULT_DEVICE;
    }
    *out = target;
    return RESULT_OK;
}

void target_destroy(Target *target) {
    glDeleteFramebuffers(1, &target->framebuffer);
    glDeleteRenderbuffers(1, &target->colour);
    glDeleteRenderbuffers(1, &target->depth);
    *target = (Target){0};
}

void target_blit_colour(const Target *target, unsigned framebuffer) {
    // Mesa asks a window for its size anew only when the viewport is set while the window is bound.
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, target->width, target->height);
    glBlitNamedFramebuffer(target->framebuffer, framebuffer, 0, 0, target->width, target->height, 0, 0, target->width,
                           target->height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}
