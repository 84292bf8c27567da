#version 450 core
// A quad around each shape of a canvas (render/hud/canvas.h: CanvasShape). Four vertices an instance, a triangle strip.
// Lengths in pixels from the top left corner, y downwards. Everything linear in the position is computed here.
layout(location = 0) in vec4 in_a;
layout(location = 1) in vec4 in_b;
layout(location = 2) in vec4 in_style; // kind, grow, soft, spread
layout(location = 3) in vec4 in_colour;

layout(location = 0) uniform vec2 u_size_px; // of the picture

#include "canvas_interface.glsl"
CANVAS_INTERFACE(out)

// The quad: its middle, half its size without the edge, and its axis to the right.
struct Quad {
    vec2 middle, half_size, axis;
};

Quad line_quad() {
    vec2 along = in_a.zw - in_a.xy;
    float span = length(along);
    vec2 axis = span > 0.0 ? along / span : vec2(1.0, 0.0);
    return Quad((in_a.xy + in_a.zw) * 0.5, vec2(span * 0.5, in_b.x), axis);
}

Quad box_quad(vec2 low, vec2 high) {
    return Quad((low + high) * 0.5, (high - low) * 0.5, vec2(1.0, 0.0));
}

Quad shape_quad(int kind) {
    if (kind == CANVAS_LINE)
        return line_quad();
    if (kind == CANVAS_TRIANGLE)
        return box_quad(min(min(in_a.xy, in_a.zw), in_b.xy), max(max(in_a.xy, in_a.zw), in_b.xy));
    return box_quad(in_a.xy, in_a.zw);
}

// How far to the right of the way from `from` to `to`, as the picture is seen: outside, for a triangle that
// is counter-clockwise.
float side_distance(vec2 at, vec2 from, vec2 to) {
    vec2 along = normalize(to - from);
    return dot(at - from, vec2(-along.y, along.x));
}

vec3 triangle_sides(vec2 at) {
    return vec3(side_distance(at, in_a.xy, in_a.zw), side_distance(at, in_a.zw, in_b.xy),
                side_distance(at, in_b.xy, in_a.xy));
}

void main() {
    int kind = int(in_style.x);
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    Quad quad = shape_quad(kind);
    float outline = kind == CANVAS_BOX ? max(in_b.y, 0.0) : 0.0;
    // The field of a glyph reaches far enough by itself.
    float reach = kind == CANVAS_GLYPH ? 0.0 : in_style.y + in_style.z * 0.5 + 0.5 + outline;
    vec2 offset = (quad.half_size + reach) * (corner * 2.0 - 1.0);
    vec2 position_px = quad.middle + offset.x * quad.axis + offset.y * vec2(-quad.axis.y, quad.axis.x);
    box = vec4(quad.half_size, kind == CANVAS_BOX ? in_b.xy : vec2(0.0, -1.0));
    local = kind == CANVAS_TRIANGLE ? triangle_sides(position_px) : vec3(offset, 0.0);
    atlas_uv = mix(in_b.xy, in_b.zw, corner);
    style = in_style;
    shape_colour = in_colour;
    vec2 clip = position_px / u_size_px * 2.0 - 1.0;
    gl_Position = vec4(clip.x, -clip.y, 0.5, 1.0);
}
