// Colours that tell patches apart. In: level | state << 8 | partition << 16. Out: linear albedo.
#include "frame.glsl"

vec3 tint_cycle(uint n) { // neighbours in number are far apart in hue
    return 0.22 + 0.18 * cos(6.2832 * (float(n) * 0.381966 + vec3(0.0, 0.33, 0.67)));
}

vec3 tint_of(uint info) {
    if (frame.mode.x == COLOUR_CACHE) {
        uint state = info >> 8 & 0xffu;
        return state == 0u ? vec3(0.10, 0.22, 0.10) : state == 1u ? vec3(0.45, 0.32, 0.05) : vec3(0.45, 0.06, 0.05);
    }
    return tint_cycle(frame.mode.x == COLOUR_PARTITION ? info >> 16 : info & 0xffu);
}
