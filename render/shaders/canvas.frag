#version 450 core
// Coverage of a shape of a canvas from the signed distance to its outline, in pixels, negative inside.
// Binding: texture unit 0, the atlas of distance fields (render/text.h), one channel.
layout(location = 0) flat in vec4 shape_a;
layout(location = 1) flat in vec4 shape_b;
layout(location = 2) flat in vec4 shape_style; // kind, grow, soft, spread
layout(location = 3) flat in vec4 shape_colour;
layout(location = 4) in vec2 position_px;
layout(location = 5) in vec2 atlas_uv;

layout(binding = 0) uniform sampler2D u_atlas;

layout(location = 0) out vec4 colour; // not premultiplied

#include "canvas_kinds.glsl"

// To a box around the origin.
float box_distance(vec2 at, vec2 half_size) {
    vec2 beyond = abs(at) - half_size;
    return length(max(beyond, 0.0)) + min(max(beyond.x, beyond.y), 0.0);
}

float line_distance(vec2 at) {
    vec2 along = shape_a.zw - shape_a.xy;
    float span = length(along);
    along = span > 0.0 ? along / span : vec2(1.0, 0.0);
    vec2 from_middle = at - (shape_a.xy + shape_a.zw) * 0.5;
    vec2 turned = vec2(dot(from_middle, along), dot(from_middle, vec2(-along.y, along.x)));
    return box_distance(turned, vec2(span * 0.5, shape_b.x));
}

// Rounded; an outline when its half width is not negative.
float rounded_box_distance(vec2 at) {
    vec2 half_size = (shape_a.zw - shape_a.xy) * 0.5;
    float corner = min(shape_b.x, min(half_size.x, half_size.y));
    float inside = box_distance(at - (shape_a.xy + shape_a.zw) * 0.5, half_size - corner) - corner;
    return shape_b.y < 0.0 ? inside : abs(inside) - shape_b.y;
}

float segment_distance(vec2 at, vec2 from, vec2 to) {
    vec2 along = to - from;
    float share = clamp(dot(at - from, along) / max(dot(along, along), 1e-12), 0.0, 1.0);
    return distance(at, from + along * share);
}

float cross_z(vec2 a, vec2 b) {
    return a.x * b.y - a.y * b.x;
}

float triangle_distance(vec2 at) {
    vec2 p = shape_a.xy, q = shape_a.zw, r = shape_b.xy;
    float nearest = min(segment_distance(at, p, q), min(segment_distance(at, q, r), segment_distance(at, r, p)));
    vec3 sides = vec3(cross_z(q - p, at - p), cross_z(r - q, at - q), cross_z(p - r, at - r));
    bool inside = all(greaterThan(sides, vec3(0.0))) || all(lessThan(sides, vec3(0.0)));
    return inside ? -nearest : nearest;
}

float ring_distance(vec2 at) {
    return abs(distance(at, shape_a.xy) - shape_a.z) - shape_a.w;
}

// The field's bytes mean (byte - 128) / 128 of the spread, positive inside.
float glyph_distance() {
    return (128.0 - 255.0 * texture(u_atlas, atlas_uv).r) / 128.0 * shape_style.w;
}

float shape_distance(int kind) {
    if (kind == CANVAS_GLYPH)
        return glyph_distance();
    if (kind == CANVAS_LINE)
        return line_distance(position_px);
    if (kind == CANVAS_BOX)
        return rounded_box_distance(position_px);
    return kind == CANVAS_TRIANGLE ? triangle_distance(position_px) : ring_distance(position_px);
}

void main() {
    float coverage = clamp(0.5 - (shape_distance(int(shape_style.x)) - shape_style.y) / shape_style.z, 0.0, 1.0);
    // Edges wider than a pixel fade in smoothly; crisp ones stay linear, which is what coverage is.
    if (shape_style.z > 1.5)
        coverage = coverage * coverage * (3.0 - 2.0 * coverage);
    colour = vec4(shape_colour.rgb, shape_colour.a * coverage);
}
