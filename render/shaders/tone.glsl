// From radiance to what a screen shows.
// Units: radiance relative to the sun's irradiance in; 0 .. 1 with the sRGB curve out.
#include "frame.glsl"

// Screens show less range than eyes see; without help from the sky's light, slopes in the shade would be black.
const float SHADOW_FILL = 2.2;

// Half a step of the screen's 255, differently for each pixel: gradients without bands.
float dither(vec2 pixel) {
    return (fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))) - 0.5) / 255.0;
}

// A film's shoulder and foot: the form of K. Narkowicz's fit to the Academy's curve, with a foot that keeps shadows
// open.
vec3 film(vec3 x) {
    return clamp((x * (2.51 * x + 0.15)) / (x * (2.43 * x + 0.70) + 0.14), 0.0, 1.0);
}

vec4 display(vec3 radiance) {
    const vec3 WHITE = vec3(1.0, 1.0, 1.04); // a camera's balance for sunlight
    vec3 exposed = film(radiance * WHITE * frame.sun.w);
    // The foot that keeps shadows open also pales colours; this gives them back.
    exposed = max(mix(vec3(dot(exposed, vec3(0.2126, 0.7152, 0.0722))), exposed, 1.18), 0.0);
    vec3 shown = pow(exposed, vec3(1.0 / 2.2));
    return vec4(shown + (frame.mode.y == 0 ? dither(gl_FragCoord.xy) : 0.0), 1.0);
}
