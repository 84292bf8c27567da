// render/ground/ground_shade.h: how high the ground stands towards the sun, seen from every cell. No GL.
// Tangents of elevation angles, as bytes: 255 sqrt(tangent / GROUND_SHADE_TAN_MAX).
// The caller owns the array.
#pragma once
#include "render/ground/ground_source.h"
#include "terrain/jobs.h"

#define GROUND_SHADE_TAN_MAX 2.0 // 63 degrees

// `out`: [height][width] of the source. `azimuth_rad`: of the sun at the middle of the grid, clockwise from north;
// lines towards it are straight in the grid. The Earth's curvature counts, the air's refraction does not. The same
// bytes for any number of workers. After V. Timonen, J. Westerholm, "Scalable Height Field Self-Shadowing", EG 2010.
MUST_USE Result ground_shade_build(const GroundSource *source, double azimuth_rad, Jobs *jobs, uint8_t *out);
