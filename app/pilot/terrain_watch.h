// app/pilot/terrain_watch.h: what an autopilot that holds height and heading does about the ground ahead: it climbs
// over it in time, or turns away from what it cannot climb over. Radians, metres above the ellipsoid, metres a second.
// A value; deterministic.
#pragma once
#include "app/pilot/autopilot.h"

#define TERRAIN_WATCH_S 45.0 // of flight that is looked at

typedef struct TerrainWatch {
    double clearance_m; // above the ground ahead
    int steps;          // until it looks again
    bool ahead;         // what is wished for would come nearer to the ground than that
    double height_m;    // that is wanted instead; -INFINITY: none
    double turn_rad;    // off the heading wished for, right; 0: straight on
    double bank_rad;    // of the turn away
    double keeps_s;     // so long the height stays: who comes back from a turn away comes back higher
} TerrainWatch;

// Who flies low may stay so: the clearance is at most what there is now.
TerrainWatch terrain_watch_begin(const Flight *flight);
// Before each step: the wish as the ground ahead allows. Looks four times a second, at 60 heights where the way is
// clear and 1200 at most.
void terrain_watch_change(TerrainWatch *watch, const Flight *flight, AutopilotWish *wish);
