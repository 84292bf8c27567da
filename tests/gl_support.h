// tests/gl_support.h: a GL context without a window for tests, and pages made by hand.
// Pixels; ECEF metres.
// Header only: everything belongs to the test.
#pragma once
#include "base/log.h"
#include "render/context/context.h"
#include "render/gl.h"

#include <stdio.h>

#define GL_SKIP_STATUS 77 // what ctest takes as skipped

// The context is current afterwards. False where there is none: the test is to skip, and the log has said why.
static inline bool gl_support_begin(int width, int height, Context **context) {
    const ContextOptions options = {.width = width, .height = height, .title = "test", .debug = true};
    if (context_create_offscreen(&options, context) == RESULT_OK && context_make_current(*context) == RESULT_OK) {
        printf("on %s\n", context_renderer_name(*context));
        return true;
    }
    printf("skipped: no OpenGL 4.5 without a window\n");
    return false;
}

// How many programs the present context has.
static inline int gl_support_programs(void) {
    int count = 0;
    for (GLuint name = 1; name < 4096; name++)
        count += glIsProgram(name) != 0;
    return count;
}
