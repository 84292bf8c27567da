// app/flight/flight_map.h: where a flight was and where it goes, on the ground below, for the map.
// ECEF metres, seconds.
// A value, too big for some stacks; one thread. What flight_map_tell gives points to the route in it.
#pragma once
#include "app/demo/demo.h"
#include "app/replay/playback.h"
#include "render/render.h"

#define FLIGHT_MAP_ROUTE 4096
#define FLIGHT_MAP_TRAIL (RENDER_TRAIL_PLACES - 2) // the newest place is where the aircraft is now
#define FLIGHT_MAP_TRAIL_STEP_S 1.0

typedef struct FlightMap {
    RenderMapPlace route[FLIGHT_MAP_ROUTE];
    int route_count;
    int stops[DEMO_WAYPOINTS_MAX]; // of a demo: the waypoints' numbers in the route
    double looked_s, look_step_s;  // of a recorded flight: up to where the route is known; between its places
    bool look_apart;               // no line leads to its next place
    RenderMapPlace trail[FLIGHT_MAP_TRAIL];
    int trail_begin, trail_count;
    double noted_s; // when the newest was
} FlightMap;

// The way of a demo from where `flight` is. A new route takes the place of the old one, and must not while a packet
// points to that; what is added later stands behind what packets point to.
void flight_map_take_demo(FlightMap *map, const Flight *flight, const Demo *demo);
// The way of a recorded flight, unknown yet.
void flight_map_take_replay(FlightMap *map, const Playback *playback);
// Some seconds more of it, until all of it is known: a recording has to be flown for that.
void flight_map_look_ahead(FlightMap *map, const FlightGround *ground, Playback *playback);

// Where the aircraft is at `t_s`, a second or more after the last note or before; the last ten minutes are kept. After
// a jump in time the trail begins anew, after a jump in place it has a gap.
void flight_map_note(FlightMap *map, const Flight *flight, double t_s);

// What the map shows for a camera that looks straight down; `next`: the demo's waypoint that is flown to, -1: none.
// `routed`: whether the route is shown.
void flight_map_tell(const FlightMap *map, const Flight *flight, const RenderCamera *camera, bool routed, int next,
                     RenderMap *out);
