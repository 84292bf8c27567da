// app/flight/demo.h: demonstration flights: a list of places that an autopilot flies to, one after another.
// As app/flight/autopilot.h; in the file degrees, metres above the geoid, units as everywhere.
// A Demo is a value.
#pragma once
#include "app/flight/autopilot.h"
#include "app/viewpoint.h"
#include "terrain/geo.h"

#define DEMO_WAYPOINTS_MAX 256

typedef struct Demo {
    Waypoint waypoints[DEMO_WAYPOINTS_MAX];
    int count;          // >= 1
    double clearance_m; // above the ground ahead, at least
    int next;           // the waypoint flown to; count: the demo is over
    Autopilot autopilot;
} Demo;

// A text file of lines
//   clearance LENGTH                 default 120m
//   to LAT,LON,ALT SPEED             any number
// and comments after '#'. NOT_FOUND, IO, FORMAT (file, line, what was expected); logged.
MUST_USE Result demo_read(const char *path, const Geoid *geoid, Demo *out);

// A round about what the viewpoint looks at, for terrains without a demo of their own.
void demo_make_round(const Viewpoint *view, const Geoid *geoid, double distance_m, Demo *out);

// The controls for the step of `dt_s` to come; goes on to the next waypoint when one is reached.
Controls demo_fly(Demo *demo, const Flight *flight, double dt_s);
bool demo_is_over(const Demo *demo);
// About how long the whole demo takes from a place.
double demo_duration_s(const Demo *demo, double lat_rad, double lon_rad);
