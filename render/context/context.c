#include "render/context/context_backend.h"

#include "base/log.h"
#include "render/gl.h"

#include <stdio.h>

#define GL_NEEDED 45 // as epoxy_gl_version() counts: major * 10 + minor

static void APIENTRY log_message(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length,
                                 const GLchar *message, const void *user) {
    (void)source, (void)id, (void)length, (void)user;
    if (type == GL_DEBUG_TYPE_ERROR || severity == GL_DEBUG_SEVERITY_HIGH)
        log_warn("OpenGL: %s", message);
    else if (severity != GL_DEBUG_SEVERITY_NOTIFICATION)
        log_debug("OpenGL: %s", message);
}

static void listen_to_driver(void) {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(log_message, NULL);
}

Result context_inspect(Context *context, bool debug) {
    const char *version = (const char *)glGetString(GL_VERSION);
    const char *renderer = (const char *)glGetString(GL_RENDERER);
    version = version ? version : "unknown version";
    renderer = renderer ? renderer : "unknown renderer";
    snprintf(context->renderer_name, sizeof context->renderer_name, "%s, OpenGL %s", renderer, version);
    context->software = gl_is_software();
    if (epoxy_gl_version() < GL_NEEDED) {
        log_error("OpenGL 4.5 core is needed, found %s; a newer driver, or Mesa's software renderer "
                  "(LIBGL_ALWAYS_SOFTWARE=1), has it",
                  context->renderer_name);
        return RESULT_DEVICE;
    }
    if (!epoxy_has_gl_extension("GL_ARB_clip_control")) {
        log_error("clip control (glClipControl) is needed for the depth of far terrain, and %s lacks it; a newer "
                  "driver, or Mesa's software renderer (LIBGL_ALWAYS_SOFTWARE=1), has it",
                  context->renderer_name);
        return RESULT_DEVICE;
    }
    if (debug)
        listen_to_driver();
    return RESULT_OK;
}

void context_destroy(Context **context) {
    if (*context)
        (*context)->backend->destroy(*context);
    *context = NULL;
}

Result context_make_current(Context *context) {
    return context->backend->make_current(context);
}

void context_release_current(Context *context) {
    context->backend->release_current(context);
}

void context_swap(Context *context) {
    context->backend->swap(context);
}

unsigned context_framebuffer(const Context *context) {
    return context->framebuffer;
}

bool context_is_software(const Context *context) {
    return context->software;
}

const char *context_renderer_name(const Context *context) {
    return context->renderer_name;
}

void context_on_key(Context *context, ContextKey *on_key, void *user) {
    context->on_key = on_key;
    context->on_key_user = user;
}

void context_on_pointer(Context *context, ContextPointer *on_pointer, void *user) {
    context->on_pointer = on_pointer;
    context->on_pointer_user = user;
}

void context_on_resize(Context *context, ContextResize *on_resize, void *user) {
    context->on_resize = on_resize;
    context->on_resize_user = user;
}

void context_poll_events(Context *context) {
    if (context->backend->poll_events)
        context->backend->poll_events(context);
}

bool context_should_close(const Context *context) {
    return context->backend->should_close && context->backend->should_close(context);
}
