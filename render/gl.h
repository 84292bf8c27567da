// render/gl.h: OpenGL 4.5 core, through libepoxy. The only place that includes it.
// Lattice, clip and texture conventions are those of render/frame.h.
// GL calls belong to the thread that has the context current.
#pragma once
#include "base/base.h"
#include <epoxy/gl.h>

// Whether the current context draws on the processor, by the driver's name.
bool gl_is_software(void);
// Errors that are pending are dropped; the first of them, or GL_NO_ERROR.
GLenum gl_take_error(void);
