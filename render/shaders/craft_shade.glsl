// The shadow that an aircraft throws on the ground; the twin of render/craft/craft_shade.h.
// Units: metres from the eye, ECEF axes; of the map, which is 1 across, and as deep.
layout(std140, binding = 4) uniform CraftShadeBlock {
    vec4 map_rows[3]; // from metres from the eye to the map and depth in it, 1 nearest to the sun; 0.5 the aircraft
} craft_shade;

layout(binding = 15) uniform sampler2D craft_map; // share that the aircraft covers, depth times share

const float SUN_TANGENT = 0.0046532;  // of the sun's angular radius
const float GONE = 0.5, FADES = 0.3;  // radius of the sun's disc on the map: as wide as the aircraft; fading begins
const float TOUCHES = 0.004;          // depth of what sinks into the ground, wheels say: it still throws a shadow

// Middles of six circles around one, that fill a circle of radius 1; each is 1/3 wide.
const int AROUND = 6;
const vec2 MIDDLES[AROUND] = vec2[](vec2(0.6667, 0.0), vec2(0.3333, 0.5774), vec2(-0.3333, 0.5774),
                                    vec2(-0.6667, 0.0), vec2(-0.3333, -0.5774), vec2(0.3333, -0.5774));
const float CELL = 0.488;  // texels so wide, blended between four, spread as far as the seventh part of a disc

// Share of the sun's disc that is seen past the aircraft.
float craft_passes(vec3 at_m) {
    vec4 from_eye = vec4(at_m, 1.0);
    vec3 at = vec3(dot(craft_shade.map_rows[0], from_eye), dot(craft_shade.map_rows[1], from_eye),
                   dot(craft_shade.map_rows[2], from_eye));
    vec2 right = dFdx(at.xy), up = dFdy(at.xy); // a pixel
    float disc = max(0.5 - at.z, 0.0) * SUN_TANGENT;
    vec2 aside = abs(at.xy - 0.5);
    if (disc >= GONE || max(aside.x, aside.y) > 0.5 + disc)
        return 1.0;
    float pixel = min(length(right), length(up));
    float level = log2(max(length(vec2(CELL * disc, 0.5 * pixel)) * float(textureSize(craft_map, 0).x), 1.0));
    vec2 covered = textureLod(craft_map, at.xy, level).rg;
    for (int i = 0; i < AROUND; i++) {
        vec2 middle = MIDDLES[i];
        covered += textureLod(craft_map, at.xy + disc * middle + 0.5 * (middle.x * right + middle.y * up), level).rg;
    }
    float nearer = covered.g / max(covered.r, 1e-4) - at.z; // to the sun than the ground is
    float share = covered.r / float(AROUND + 1) * clamp(1.0 + nearer / TOUCHES, 0.0, 1.0);
    return 1.0 - share * (1.0 - smoothstep(FADES, GONE, disc));
}
