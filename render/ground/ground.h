// render/ground/ground.h: the ground's textures and uniforms, made from the terrain once, and its shadows, made when
// the sun's azimuth has moved. Metres above the geoid; texture coordinates from DEM samples. A Ground owns its textures
// and borrows the Terrain; thread of the context.
#pragma once
#include "base/base.h"
#include "base/vec.h"
#include "terrain/terrain.h"

#define GROUND_BLOCK_BINDING 1
#define GROUND_NOISE_M 32768.0 // the noise repeats after that

// Texture units, as shaders/ground.glsl has them.
enum { GROUND_UNIT_SURFACE, GROUND_UNIT_HEIGHT, GROUND_UNIT_SHADE, GROUND_UNIT_NOISE, GROUND_UNIT_HOLES, GROUND_UNITS };

// std140; the twin of shaders/ground.glsl.
typedef struct GroundBlock {
    float texel[4];  // coordinates = sample * xy + zw
    float height[4]; // m above the geoid = texture * x + y; z: metres a cell; w: unused
    float noise[4];  // xy: repeats of the noise per sample; zw: cells along x and y
    float globe[4];  // what surrounds the data: x: its height, m; y: 1 where it is sea
} GroundBlock;
_Static_assert(sizeof(GroundBlock) == 4 * 16, "as shaders/ground.glsl has it");

typedef struct Ground Ground;

MUST_USE Result ground_create(const Terrain *terrain, bool software, Ground **out);
void ground_destroy(Ground **ground);

// Makes the shadows anew when the sun's azimuth, seen from the middle of the data, is 1 degree off those at hand.
// Takes about 10 ns a sample; on failure, logged, the old shadows stay.
void ground_follow_sun(Ground *ground, Vec3d sun_ecef);
// Binds textures and the uniform block.
void ground_bind(const Ground *ground);

// Whether there may be water among samples col .. col + cols, row .. row + rows, or right beside them.
bool ground_is_wet(const Ground *ground, int col, int row, int cols, int rows);
bool ground_has_holes(const Ground *ground);
Vec3d ground_middle_ecef(const Ground *ground); // on the ellipsoid
bool ground_in_sea(const Ground *ground);       // most of the rim is
double ground_globe_m(const Ground *ground);
// Repeats of the noise per column and per row.
void ground_noise_repeats(const Ground *ground, double out[2]);
