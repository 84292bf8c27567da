// render/hud/canvas.h: a list of antialiased lines, boxes, triangles, rings and text, drawn later in one call
// (render/hud/canvas_gl.h). Knows no GL.
// Pixels from the top left corner of the picture, y downwards; pixel centres lie at halves.
// A Canvas owns its shapes; it borrows texts during a call only. One thread at a time.
#pragma once
#include "base/base.h"
#include "render/hud/text.h"

typedef struct CanvasPoint {
    float x, y;
} CanvasPoint;

typedef struct CanvasRect {
    float x0, y0, x1, y1; // x0 <= x1, y0 <= y1
} CanvasRect;

typedef struct CanvasColour {
    float r, g, b, a; // 0..1, not premultiplied, as it appears on the screen (sRGB)
} CanvasColour;

typedef enum CanvasAlign { CANVAS_LEFT, CANVAS_CENTRE, CANVAS_RIGHT } CanvasAlign;

typedef enum CanvasKind { CANVAS_LINE, CANVAS_BOX, CANVAS_TRIANGLE, CANVAS_GLYPH } CanvasKind;

// One instance of canvas.vert, field by field in the same order there. By kind, `a` and `b` are
// LINE      two ends; half width
// BOX       two corners; corner radius, half width of the outline or less than 0: filled
// TRIANGLE  two corners; the third one, counter-clockwise as the picture is seen
// GLYPH     two corners; the same in the atlas
typedef struct CanvasShape {
    float a[4], b[4];
    float kind;   // CanvasKind
    float grow;   // pixels that the shape is widened by
    float soft;   // width of its edge, pixels: 1 for a crisp one
    float spread; // GLYPH: what the field's 0.5..1 means, pixels
    uint8_t rgba[4];
} CanvasShape;

typedef struct Canvas Canvas;

MUST_USE Result canvas_create(Canvas **out);
void canvas_destroy(Canvas **canvas);

// Empties the canvas and keeps its memory: after warm-up no drawing function allocates. `unit_px` is the size of a
// thin line, from which the width of halos follows, > 0.
void canvas_begin(Canvas *canvas, float unit_px);

// Whether shapes get halos from here on, as they do after canvas_begin. A dense plate below makes up for them.
void canvas_set_halos(Canvas *canvas, bool on);

// Whether shapes from here on lie below all others but boxes drawn before, and get no halo; not so after canvas_begin.
void canvas_set_lower(Canvas *canvas, bool lower);

// All shapes get a dark halo that keeps them readable over snow as over forest; halos and filled boxes lie below all
// other shapes. Shapes that are fully transparent, or not finite, are left out; a shape that finds no memory is left
// out as well.
void canvas_line(Canvas *canvas, CanvasPoint a, CanvasPoint b, float width_px, CanvasColour colour); // flat ends
void canvas_box(Canvas *canvas, CanvasRect box, float corner_px, CanvasColour colour);               // filled, no halo
void canvas_frame(Canvas *canvas, CanvasRect box, float corner_px, float width_px, CanvasColour colour);
void canvas_triangle(Canvas *canvas, CanvasPoint a, CanvasPoint b, CanvasPoint c, CanvasColour colour);
void canvas_ring(Canvas *canvas, CanvasPoint centre, float radius_px, float width_px, CanvasColour colour);

typedef struct CanvasFont {
    Text *text;
    float size_px;
    CanvasAlign align;
    CanvasColour colour;
} CanvasFont;
// `at`: on the baseline, at the left end, centre or right end of the line as the font says.
void canvas_text(Canvas *canvas, const CanvasFont *font, CanvasPoint at, const char *utf8);

// In drawing order: what lies below, then the rest. They live until the next drawing function or canvas_begin.
int canvas_under(const Canvas *canvas, const CanvasShape **shapes);
int canvas_over(const Canvas *canvas, const CanvasShape **shapes);
