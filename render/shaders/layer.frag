#version 450 core
// A picture kept from an earlier frame, as it is, pixel for pixel.
// Output: premultiplied. Binding: texture unit 0, the picture.
layout(binding = 0) uniform sampler2D u_layer;

layout(location = 0) uniform ivec2 u_corner_px; // its lower left pixel

layout(location = 0) out vec4 colour;

void main() {
    colour = texelFetch(u_layer, ivec2(gl_FragCoord.xy) - u_corner_px, 0);
}
