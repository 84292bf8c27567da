// render/hud/canvas_gl.h: draw a Canvas with GL.
// Pixels from the top left corner.
// A CanvasGl owns its GL objects and belongs to the thread that has the context current.
#pragma once
#include "render/hud/canvas.h"

typedef struct CanvasGl CanvasGl;

// Needs a current GL 4.5 context. NOT_FOUND, FORMAT, DEVICE: the shaders, as shader_create_program says; MEMORY.
MUST_USE Result canvas_gl_create(CanvasGl **out);
void canvas_gl_destroy(CanvasGl **gl);

// One draw call over the framebuffer bound for drawing. Changes no GL state beyond its own objects: see hud_draw.
void canvas_gl_draw(CanvasGl *gl, const Canvas *canvas, const Text *text, int width, int height);

typedef struct CanvasKept {
    CanvasRect part; // whole pixels, not empty
    int edge_px;     // rows at its top and at its bottom that are blended; what is between has to be opaque
} CanvasKept;
// For what changes seldom and is much to draw: keeps a part of a picture of that size as the canvas has it, and draws
// it over the framebuffer bound for drawing, of one sample a pixel, in later frames as well. State as above.
void canvas_gl_keep(CanvasGl *gl, const Canvas *canvas, const Text *text, const CanvasKept *kept, int width,
                    int height);
void canvas_gl_draw_kept(CanvasGl *gl);
