// render/context/context.h: a GL 4.5 core context, in a window (GLFW) or without one (EGL).
// Pixels.
// A Context is created on the main thread and may then be made current on one other thread.
#pragma once
#include "base/base.h"

typedef struct Context Context;

typedef struct ContextOptions {
    int width, height;
    const char *title;
    bool fullscreen, vsync;
    bool debug;    // KHR_debug messages to the log
    bool optional; // the caller can do without a window: none is a warning, not an error
} ContextOptions;

// DEVICE: no display, or no GL 4.5; the message says what was found and what is needed.
MUST_USE Result context_create_window(const ContextOptions *options, Context **out);
// Tries EGL_EXT_platform_device, then surfaceless Mesa; draws to a framebuffer of its own.
MUST_USE Result context_create_offscreen(const ContextOptions *options, Context **out);
void context_destroy(Context **context);

MUST_USE Result context_make_current(Context *context);
void context_release_current(Context *context);
void context_swap(Context *context);
// The framebuffer to draw to: 0 for a window.
unsigned context_framebuffer(const Context *context);
bool context_is_software(const Context *context);
const char *context_renderer_name(const Context *context); // GL_RENDERER and GL_VERSION

// Windows only; main thread. Events by scancode position, US names; see input/keyboard.
// `modifiers`: bit 0 Shift, bit 1 Control.
typedef void ContextKey(void *user, int key, int scancode, bool pressed, bool repeated, unsigned modifiers);
void context_on_key(Context *context, ContextKey *on_key, void *user);
// The mouse moved, or its left button: in pixels of the framebuffer, from the top left corner.
typedef void ContextPointer(void *user, double x, double y, bool down);
void context_on_pointer(Context *context, ContextPointer *on_pointer, void *user);
typedef void ContextResize(void *user, int width, int height);
void context_on_resize(Context *context, ContextResize *on_resize, void *user);
void context_poll_events(Context *context);
bool context_should_close(const Context *context);
