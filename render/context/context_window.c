#include "render/context/context_backend.h"

#include "base/log.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <stdlib.h>

typedef struct WindowContext {
    Context base;
    GLFWwindow *window;
    bool vsync, swap_interval_set;
} WindowContext;

static const char *last_error(void) {
    const char *text = NULL;
    glfwGetError(&text);
    return text ? text : "no reason given";
}

static void destroy_window(Context *context) {
    WindowContext *self = (WindowContext *)context;
    if (self->window)
        glfwDestroyWindow(self->window);
    glfwTerminate();
    free(self);
}

static Result make_window_current(Context *context) {
    WindowContext *self = (WindowContext *)context;
    glfwMakeContextCurrent(self->window);
    if (glfwGetCurrentContext() != self->window) {
        log_error("the window's OpenGL context cannot be used on this thread: %s", last_error());
        return RESULT_DEVICE;
    }
    if (!self->swap_interval_set) // belongs to the context that is current, so not before
        glfwSwapInterval(self->vsync ? 1 : 0);
    self->swap_interval_set = true;
    return RESULT_OK;
}

static void release_window(Context *context) {
    (void)context;
    glfwMakeContextCurrent(NULL);
}

static void swap_window(Context *context) {
    glfwSwapBuffers(((WindowContext *)context)->window);
}

static void poll_window(Context *context) {
    (void)context;
    glfwPollEvents();
}

static bool window_should_close(const Context *context) {
    return glfwWindowShouldClose(((const WindowContext *)context)->window);
}

static const ContextBackend BACKEND = {
    .destroy = destroy_window,
    .make_current = make_window_current,
    .release_current = release_window,
    .swap = swap_window,
    .poll_events = poll_window,
    .should_close = window_should_close,
};

static void pass_key(GLFWwindow *window, int key, int scancode, int action, int mods) {
    Context *context = glfwGetWindowUserPointer(window);
    if (context->on_key)
        context->on_key(context->on_key_user, key, scancode, action != GLFW_RELEASE, action == GLFW_REPEAT,
                        (mods & GLFW_MOD_SHIFT ? 1u : 0u) | (mods & GLFW_MOD_CONTROL ? 2u : 0u));
}

// A window's places are not pixels on every screen.
static void pass_pointer(GLFWwindow *window, double x, double y) {
    Context *context = glfwGetWindowUserPointer(window);
    int width = 0, height = 0, columns = 0, rows = 0;
    glfwGetWindowSize(window, &width, &height);
    glfwGetFramebufferSize(window, &columns, &rows);
    if (context->on_pointer && width > 0 && height > 0)
        context->on_pointer(context->on_pointer_user, x * columns / width, y * rows / height,
                            glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS);
}

static void pass_button(GLFWwindow *window, int button, int action, int mods) {
    (void)button;
    (void)action;
    (void)mods;
    double x = 0.0, y = 0.0;
    glfwGetCursorPos(window, &x, &y);
    pass_pointer(window, x, y);
}

static void pass_size(GLFWwindow *window, int width, int height) {
    Context *context = glfwGetWindowUserPointer(window);
    if (context->on_resize && width > 0 && height > 0)
        context->on_resize(context->on_resize_user, width, height);
}

static void set_hints(const ContextOptions *options) {
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, options->debug);
    glfwWindowHint(GLFW_DEPTH_BITS, 0); // the renderer brings its own, in float
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
}

static void tell(const ContextOptions *options, const char *what, const char *remedy) {
    if (options->optional)
        log_warn("%s: %s; %s", what, last_error(), remedy);
    else
        log_error("%s: %s; %s", what, last_error(), remedy);
}

static Result open_window(WindowContext *self, const ContextOptions *options) {
    GLFWmonitor *monitor = options->fullscreen ? glfwGetPrimaryMonitor() : NULL;
    const GLFWvidmode *mode = monitor ? glfwGetVideoMode(monitor) : NULL;
    set_hints(options);
    self->window = glfwCreateWindow(mode ? mode->width : options->width, mode ? mode->height : options->height,
                                    options->title, monitor, NULL);
    if (!self->window) {
        tell(options, "no window with OpenGL 4.5 core",
             "a newer driver, or Mesa's software renderer (LIBGL_ALWAYS_SOFTWARE=1), has it");
        return RESULT_DEVICE;
    }
    glfwSetWindowUserPointer(self->window, self);
    glfwSetKeyCallback(self->window, pass_key);
    glfwSetCursorPosCallback(self->window, pass_pointer);
    glfwSetMouseButtonCallback(self->window, pass_button);
    glfwSetFramebufferSizeCallback(self->window, pass_size);
    return RESULT_OK;
}

Result context_create_window(const ContextOptions *options, Context **out) {
    WindowContext *self = calloc(1, sizeof *self);
    if (!self) {
        log_error("out of memory for a window");
        return RESULT_MEMORY;
    }
    self->base.backend = &BACKEND;
    self->vsync = options->vsync;
    Result result = RESULT_DEVICE;
    if (!glfwInit()) {
        tell(options, "no display to open a window on", "set DISPLAY, or fly without a window (--no-window)");
        goto fail;
    }
    if ((result = open_window(self, options)) != RESULT_OK)
        goto fail;
    if ((result = make_window_current(&self->base)) != RESULT_OK)
        goto fail;
    if ((result = context_inspect(&self->base, options->debug)) != RESULT_OK)
        goto fail;
    release_window(&self->base);
    *out = &self->base;
    return RESULT_OK;
fail:
    destroy_window(&self->base);
    return result;
}
