#version 450 core
// Coverage of a shape of a canvas from the signed distance to its outline, in pixels, negative inside.
// Binding: texture unit 0, the atlas of distance fields (render/hud/text.h), one channel.
layout(binding = 0) uniform sampler2D u_atlas;

layout(location = 0) out vec4 colour; // not premultiplied

#include "canvas_interface.glsl"
CANVAS_INTERFACE(in)

// A box around the origin with rounded corners; an outline when its half width is not negative. A line is a box, and
// a ring is the outline of one that is all corner.
float box_distance(vec2 at, vec2 half_size, float corner, float half_width) {
    float rounding = min(corner, min(half_size.x, half_size.y));
    vec2 beyond = abs(at) - half_size + rounding;
    float outside = length(max(beyond, 0.0)) + min(max(beyond.x, beyond.y), 0.0) - rounding;
    return half_width < 0.0 ? outside : abs(outside) - half_width;
}

// The field's bytes mean (byte - 128) / 128 of the spread, positive inside.
float glyph_distance(float spread) {
    return (128.0 - 255.0 * texture(u_atlas, atlas_uv).r) / 128.0 * spread;
}

float shape_distance(int kind) {
    if (kind == CANVAS_GLYPH)
        return glyph_distance(style.w);
    if (kind == CANVAS_TRIANGLE)
        return max(local.x, max(local.y, local.z));
    return box_distance(local.xy, box.xy, box.z, box.w);
}

void main() {
    float coverage = clamp(0.5 - (shape_distance(int(style.x)) - style.y) / style.z, 0.0, 1.0);
    // Edges wider than a pixel fade in smoothly; crisp ones stay linear, which is what coverage is.
    if (style.z > 1.5)
        coverage = coverage * coverage * (3.0 - 2.0 * coverage);
    colour = vec4(shape_colour.rgb, shape_colour.a * coverage);
}
