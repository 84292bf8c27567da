#include "render/gl.h"

#include <string.h>

bool gl_is_software(void) {
    static const char *const NAMES[] = {"llvmpipe", "softpipe", "swrast", "SWR", "Software Rasterizer"};
    const char *renderer = (const char *)glGetString(GL_RENDERER);
    for (size_t i = 0; renderer && i < COUNT_OF(NAMES); i++)
        if (strstr(renderer, NAMES[i]))
            return true;
    return false;
}

GLenum gl_take_error(void) {
    GLenum first = GL_NO_ERROR;
    // Bounded: a lost context may report one forever.
    for (int i = 0; i < 16; i++) {
        GLenum error = glGetError();
        if (error == GL_NO_ERROR)
            break;
        first = first == GL_NO_ERROR ? error : first;
    }
    return first;
}
