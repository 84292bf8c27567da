// Between the stages of the canvas, and CanvasKind of render/hud/canvas.h.
const int CANVAS_LINE = 0;
const int CANVAS_BOX = 1;
const int CANVAS_TRIANGLE = 2;
const int CANVAS_GLYPH = 3;

// style: kind, grow, soft, spread, as CanvasShape has them.
// box: half size, corner radius, half width of the outline or less than 0.
// local: from the middle along the shape's own axes; TRIANGLE: beyond each of its sides.
#define CANVAS_INTERFACE(direction)                     \
    layout(location = 0) flat direction vec4 style;        \
    layout(location = 1) flat direction vec4 box;          \
    layout(location = 2) flat direction vec4 shape_colour; \
    layout(location = 3) direction vec3 local;             \
    layout(location = 4) direction vec2 atlas_uv;
