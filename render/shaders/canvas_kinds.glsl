// CanvasKind of render/canvas.h.
const int CANVAS_LINE = 0;
const int CANVAS_BOX = 1;
const int CANVAS_TRIANGLE = 2;
const int CANVAS_RING = 3;
const int CANVAS_GLYPH = 4;
