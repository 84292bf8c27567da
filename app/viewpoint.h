// app/viewpoint.h: a place and a direction to look from, given by people or found in the terrain.
// Degrees; altitude in metres above the geoid; heading clockwise from north, pitch up.
// Values.
#pragma once
#include "base/base.h"
#include "base/vec.h"
#include "terrain/geo.h"
#include "terrain/terrain.h"

typedef struct Viewpoint {
    double lat_deg, lon_deg, alt_m;
    double heading_deg, pitch_deg;
} Viewpoint;

// Unit vector of the direction, in ECEF.
Vec3d viewpoint_forward(const Viewpoint *viewpoint);
// Rows right, up, back of a camera that looks so, without bank; continuous through straight up and down.
Mat3d viewpoint_camera(const Viewpoint *viewpoint);

// A three-quarter view of the part with the highest relief: from over the lower side, above the ground all the way.
// The same terrain gives the same view. RANGE: no sample with data.
MUST_USE Result viewpoint_of_relief(const Terrain *terrain, const Geoid *geoid, Viewpoint *out);
