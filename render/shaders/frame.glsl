// Uniforms of one frame, binding 0; the twin of render/frame.h.
// Round space is ECEF with z stretched so that the ellipsoid is a sphere.
layout(std140, binding = 0) uniform FrameBlock {
    mat4 clip_from_eye; // from metres relative to the eye, ECEF axes; depth 1 near .. 0 at infinity
    vec4 eye_rest_m;    // xyz: the eye minus its lattice point
    vec4 ray_right;     // a pixel looks along ahead + clip.x right + clip.y up, ECEF axes; w: pixels per radian
    vec4 ray_up;
    vec4 ray_ahead;
    vec4 sun;           // towards the sun, ECEF; w: exposure
    vec4 eye_up;        // up at the eye, round space; w: its height, km
    vec4 sun_side;      // horizontal, towards the sun, round space; w: cosine of its zenith angle
    vec4 air;           // density of air and haze at the eye; z: cosine of the horizon's zenith angle; w: height of
                        // the globe around the data, km
    vec4 light_sun[2];  // irradiance at sea level and at 4 km
    vec4 light_sky[2];
    vec4 wave_east;     // repeats of the waves = dot(xyz, metres from the eye) + w
    vec4 wave_north;
    ivec4 mode;         // colouring; 1: flat colours, for tests: no dithering, and tints without light and air
} frame;

const vec3 ROUND = vec3(1.0, 1.0, 1.0033640898); // the ellipsoid's axes, a / b

const int COLOUR_LAND = 0, COLOUR_LEVEL = 1, COLOUR_CACHE = 2, COLOUR_PARTITION = 3;
