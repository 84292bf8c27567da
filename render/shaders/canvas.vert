#version 450 core
// A quad around each shape of a canvas (render/canvas.h: CanvasShape). Four vertices an instance, a triangle strip.
// Lengths in pixels from the top left corner, y downwards; what reaches the fragment stage is in pixels as well.
layout(location = 0) in vec4 in_a;
layout(location = 1) in vec4 in_b;
layout(location = 2) in vec4 in_style; // kind, grow, soft, spread
layout(location = 3) in vec4 in_colour;

layout(location = 0) uniform vec2 u_size_px; // of the picture

layout(location = 0) flat out vec4 shape_a;
layout(location = 1) flat out vec4 shape_b;
layout(location = 2) flat out vec4 shape_style;
layout(location = 3) flat out vec4 shape_colour;
layout(location = 4) out vec2 position_px;
layout(location = 5) out vec2 atlas_uv;

#include "canvas_kinds.glsl"

// Corner (0..1, 0..1) of a box that reaches `reach` further on all sides.
vec2 box_corner(vec2 low, vec2 high, vec2 corner, float reach) {
    return mix(low - reach, high + reach, corner);
}

vec2 line_corner(vec2 corner, float reach) {
    vec2 along = in_a.zw - in_a.xy;
    float span = length(along);
    along = span > 0.0 ? along / span : vec2(1.0, 0.0);
    vec2 across = vec2(-along.y, along.x);
    vec2 at = mix(in_a.xy - along * reach, in_a.zw + along * reach, corner.x);
    return at + across * (in_b.x + reach) * (corner.y * 2.0 - 1.0);
}

vec2 shape_corner(int kind, vec2 corner, float reach) {
    if (kind == CANVAS_LINE)
        return line_corner(corner, reach);
    if (kind == CANVAS_BOX)
        return box_corner(in_a.xy, in_a.zw, corner, reach + max(in_b.y, 0.0));
    if (kind == CANVAS_TRIANGLE)
        return box_corner(min(min(in_a.xy, in_a.zw), in_b.xy), max(max(in_a.xy, in_a.zw), in_b.xy), corner, reach);
    if (kind == CANVAS_RING)
        return box_corner(in_a.xy - in_a.z - in_a.w, in_a.xy + in_a.z + in_a.w, corner, reach);
    return mix(in_a.xy, in_a.zw, corner); // a glyph's field reaches far enough
}

void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    float reach = in_style.y + in_style.z * 0.5 + 0.5;
    position_px = shape_corner(int(in_style.x), corner, reach);
    atlas_uv = mix(in_b.xy, in_b.zw, corner);
    shape_a = in_a;
    shape_b = in_b;
    shape_style = in_style;
    shape_colour = in_colour;
    vec2 clip = position_px / u_size_px * 2.0 - 1.0;
    gl_Position = vec4(clip.x, -clip.y, 0.5, 1.0);
}
