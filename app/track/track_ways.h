// app/track/track_ways.h: ways over a terrain that keep low, or high.
// Columns and rows of the DEM, fractional; metres above the ellipsoid.
// A TrackWay is a value; the Terrain is borrowed. Deterministic.
#pragma once
#include "base/base.h"
#include "terrain/terrain.h"

#define TRACK_WAY_MAX 512 // points

typedef struct TrackWay {
    double col[TRACK_WAY_MAX], row[TRACK_WAY_MAX];
    int count; // >= 2
} TrackWay;

typedef enum TrackKeep { TRACK_KEEP_LOW, TRACK_KEEP_HIGH } TrackKeep;

// The cheapest way across the longer side of the DEM, where a metre costs the more the higher (or lower) the ground is;
// smoothed, its points evenly spread. RANGE: no sample has data; MEMORY.
MUST_USE Result track_way_across(const Terrain *terrain, TrackKeep keep, TrackWay *out);
// Through these points, smoothed, evenly spread.
void track_way_through(const Terrain *terrain, const TrackWay *points, TrackWay *out);

// The ground; outside the DEM that of its rim.
double track_ground_m(const Terrain *terrain, double col, double row);
// A cell's sides on the ground, at the DEM's middle row.
void track_cell_m(const Terrain *terrain, double *across_m, double *down_m);
// The way's length on the ground.
double track_way_m(const Terrain *terrain, const TrackWay *way);
