#include "render/context/context_backend.h"

#include "base/log.h"
#include "render/gl.h"

#include <epoxy/egl.h>
#include <stdio.h>
#include <stdlib.h>

#define DEVICES_MAX 16

typedef struct EglContext {
    Context base;
    EGLDisplay display;
    EGLContext context;
    GLuint framebuffer, colour, depth;
    char trouble[256]; // what the attempts so far ran into
} EglContext;

static const char *egl_error_name(EGLint error) {
    switch (error) {
    case EGL_NOT_INITIALIZED:
        return "EGL_NOT_INITIALIZED";
    case EGL_BAD_MATCH:
        return "EGL_BAD_MATCH (this version of OpenGL is not there)";
    case EGL_BAD_ATTRIBUTE:
        return "EGL_BAD_ATTRIBUTE";
    case EGL_BAD_CONFIG:
        return "EGL_BAD_CONFIG";
    case EGL_BAD_ALLOC:
        return "EGL_BAD_ALLOC (out of memory)";
    case EGL_BAD_DISPLAY:
        return "EGL_BAD_DISPLAY";
    case EGL_SUCCESS:
        return "no error given";
    default:
        return "another EGL error";
    }
}

static void note_trouble(EglContext *self, const char *what) {
    snprintf(self->trouble, sizeof self->trouble, "%s: %s", what, egl_error_name(eglGetError()));
}

static void close_display(EglContext *self) {
    if (self->display == EGL_NO_DISPLAY)
        return;
    eglMakeCurrent(self->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (self->context != EGL_NO_CONTEXT)
        eglDestroyContext(self->display, self->context);
    eglTerminate(self->display);
    eglReleaseThread();
    self->context = EGL_NO_CONTEXT;
    self->display = EGL_NO_DISPLAY;
}

static void destroy_offscreen(Context *context) {
    EglContext *self = (EglContext *)context;
    close_display(self);
    free(self);
}

static Result make_offscreen_current(Context *context) {
    EglContext *self = (EglContext *)context;
    if (!eglBindAPI(EGL_OPENGL_API) || !eglMakeCurrent(self->display, EGL_NO_SURFACE, EGL_NO_SURFACE, self->context)) {
        log_error("the OpenGL context cannot be used on this thread: %s", egl_error_name(eglGetError()));
        return RESULT_DEVICE;
    }
    glBindFramebuffer(GL_FRAMEBUFFER, self->framebuffer);
    return RESULT_OK;
}

static void release_offscreen(Context *context) {
    EglContext *self = (EglContext *)context;
    eglMakeCurrent(self->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

static void finish_offscreen(Context *context) {
    (void)context;
    glFlush();
}

static const ContextBackend BACKEND = {
    .destroy = destroy_offscreen,
    .make_current = make_offscreen_current,
    .release_current = release_offscreen,
    .swap = finish_offscreen,
};

static EGLContext create_context(EGLDisplay display, EGLint major, EGLint minor, bool debug) {
    const EGLint config_attributes[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 major,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 minor,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_CONTEXT_OPENGL_DEBUG,
                                 debug,
                                 EGL_NONE};
    EGLConfig config = NULL;
    EGLint count = 0;
    if (!eglChooseConfig(display, config_attributes, &config, 1, &count) || count < 1)
        return EGL_NO_CONTEXT;
    return eglCreateContext(display, config, EGL_NO_CONTEXT, attributes);
}

// Another, older context only to say what there is.
static void describe_older(EglContext *self) {
    EGLContext older = create_context(self->display, 3, 1, false);
    if (older == EGL_NO_CONTEXT)
        return;
    if (eglMakeCurrent(self->display, EGL_NO_SURFACE, EGL_NO_SURFACE, older))
        snprintf(self->trouble, sizeof self->trouble, "found %s, OpenGL %s, %s clip control",
                 (const char *)glGetString(GL_RENDERER), (const char *)glGetString(GL_VERSION),
                 epoxy_has_gl_extension("GL_ARB_clip_control") ? "with" : "without");
    eglMakeCurrent(self->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(self->display, older);
}

// Takes `display`; on failure it is closed again and `trouble` says why.
static bool try_display(EglContext *self, EGLDisplay display, bool debug) {
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, NULL, NULL)) {
        note_trouble(self, "EGL display");
        return false;
    }
    self->display = display;
    if (!epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context") || !eglBindAPI(EGL_OPENGL_API)) {
        snprintf(self->trouble, sizeof self->trouble, "EGL without OpenGL or without surfaceless contexts");
        goto fail;
    }
    self->context = create_context(display, 4, 5, debug);
    if (self->context == EGL_NO_CONTEXT) {
        note_trouble(self, "OpenGL 4.5 core context");
        describe_older(self);
        goto fail;
    }
    if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, self->context)) {
        note_trouble(self, "surfaceless OpenGL context");
        goto fail;
    }
    return true;
fail:
    close_display(self);
    return false;
}

static bool try_devices(EglContext *self, bool debug) {
    EGLDeviceEXT devices[DEVICES_MAX];
    EGLint count = 0;
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device") ||
        !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") ||
        !eglQueryDevicesEXT(DEVICES_MAX, devices, &count))
        return false;
    for (EGLint i = 0; i < count; i++)
        if (try_display(self, eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL), debug))
            return true;
    return false;
}

static bool try_surfaceless(EglContext *self, bool debug) {
    return epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless") &&
           try_display(self, eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL), debug);
}

static Result create_framebuffer(EglContext *self, int width, int height) {
    glCreateRenderbuffers(1, &self->colour);
    glCreateRenderbuffers(1, &self->depth);
    glNamedRenderbufferStorage(self->colour, GL_RGBA8, width, height);
    glNamedRenderbufferStorage(self->depth, GL_DEPTH_COMPONENT32F, width, height);
    glCreateFramebuffers(1, &self->framebuffer);
    glNamedFramebufferRenderbuffer(self->framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, self->colour);
    glNamedFramebufferRenderbuffer(self->framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, self->depth);
    if (glCheckNamedFramebufferStatus(self->framebuffer, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        log_error("no framebuffer of %d x %d pixels: the driver refuses it; ask for fewer", width, height);
        return RESULT_DEVICE;
    }
    self->base.framebuffer = self->framebuffer;
    return RESULT_OK;
}

Result context_create_offscreen(const ContextOptions *options, Context **out) {
    EglContext *self = calloc(1, sizeof *self);
    if (!self) {
        log_error("out of memory for an OpenGL context");
        return RESULT_MEMORY;
    }
    self->base.backend = &BACKEND;
    self->display = EGL_NO_DISPLAY;
    self->context = EGL_NO_CONTEXT;
    snprintf(self->trouble, sizeof self->trouble, "EGL offers neither devices nor surfaceless displays");
    Result result = RESULT_DEVICE;
    if (!try_devices(self, options->debug) && !try_surfaceless(self, options->debug)) {
        log_error("no OpenGL 4.5 core without a window: %s; a newer driver, or Mesa's software renderer "
                  "(package libgl1-mesa-dri), has it",
                  self->trouble);
        goto fail;
    }
    if ((result = context_inspect(&self->base, options->debug)) != RESULT_OK)
        goto fail;
    if ((result = create_framebuffer(self, options->width, options->height)) != RESULT_OK)
        goto fail;
    release_offscreen(&self->base);
    *out = &self->base;
    return RESULT_OK;
fail:
    destroy_offscreen(&self->base);
    return result;
}
