#include "app/flight/flight_map.h"

#include "app/dynamics/flight_contact.h"
#include "terrain/geodesy.h"

#include <math.h>

#define LEG_PIECE_M 500.0 // of a demo's legs, so that they lie on the ground
#define LEG_PIECES_MAX ((FLIGHT_MAP_ROUTE - 1) / DEMO_WAYPOINTS_MAX)
#define LOOK_STEP_S 1.0  // between places of a recorded flight, at least
#define LOOK_FLOWN_S 4.0 // that are flown again a call
#define LOOK_PLACES 64   // that are looked up a call
#define STANDS_M 1.0     // that nothing moves
#define JUMP_S 10.0      // more is no flight, but somebody's jump
#define JUMP_M 200.0
#define JUMP_SPEEDS 3.0 // farther than so many times what the speed carries

// Below a place; on the ellipsoid where there is no ground.
static Vec3d on_ground(const FlightGround *ground, Vec3d ecef) {
    Geodetic place = geodesy_from_ecef(ecef);
    double above_m = 0.0;
    place.h_m = flight_ground_below(ground, ecef, &above_m) ? place.h_m - above_m : 0.0;
    return geodesy_to_ecef(place);
}

// Farther than it flies.
static bool is_jump(const FlightState *state, Vec3d from, Vec3d to, double passed_s) {
    return vec3d_distance(from, to) > JUMP_SPEEDS * vec3d_length(state->velocity_ecef) * passed_s + JUMP_M;
}

static void add_to_route(FlightMap *map, Vec3d ecef, bool apart, bool stop) {
    if (map->route_count < FLIGHT_MAP_ROUTE)
        map->route[map->route_count++] = (RenderMapPlace){ecef, apart, stop};
}

// ---- a demo ----

// Pieces of the straight line, each on the ground.
static void add_leg(FlightMap *map, const FlightGround *ground, Vec3d from, Vec3d to) {
    double wanted = ceil(vec3d_distance(from, to) / LEG_PIECE_M);
    int pieces = (int)fmin(fmax(wanted, 1.0), LEG_PIECES_MAX);
    for (int i = 1; i <= pieces; i++) {
        Vec3d at = vec3d_mad(from, vec3d_sub(to, from), (double)i / pieces);
        add_to_route(map, on_ground(ground, at), false, i == pieces);
    }
}

void flight_map_take_demo(FlightMap *map, const Flight *flight, const Demo *demo) {
    Vec3d from = flight->state.position_ecef;
    map->route_count = 0;
    add_to_route(map, on_ground(&flight->ground, from), true, false);
    for (int i = 0; i < demo->count; i++) {
        const Waypoint *to = &demo->waypoints[i];
        Vec3d there = geodesy_to_ecef((Geodetic){to->lat_rad, to->lon_rad, to->h_m});
        add_leg(map, &flight->ground, from, there);
        map->stops[i] = map->route_count - 1;
        from = there;
    }
}

// ---- a recorded flight ----

void flight_map_take_replay(FlightMap *map, const Playback *playback) {
    map->route_count = 0;
    map->looked_s = 0.0;
    map->look_step_s = fmax(LOOK_STEP_S, playback_duration_s(playback) / (FLIGHT_MAP_ROUTE - 2));
    map->look_apart = true;
}

static void look_at(FlightMap *map, const FlightGround *ground, const PlaybackMoment *moment) {
    if (moment->in_gap) {
        map->look_apart = true;
        return;
    }
    Vec3d there = on_ground(ground, moment->state.position_ecef);
    bool jumped =
        map->route_count > 0 && is_jump(&moment->state, map->route[map->route_count - 1].ecef, there, map->look_step_s);
    add_to_route(map, there, map->look_apart || jumped, false);
    map->look_apart = false;
}

void flight_map_look_ahead(FlightMap *map, const FlightGround *ground, Playback *playback) {
    bool flown = playback_header(playback) != NULL;
    int places = flown ? (int)ceil(LOOK_FLOWN_S / map->look_step_s) : LOOK_PLACES;
    for (int i = 0; i < places && map->looked_s < playback_duration_s(playback) + map->look_step_s; i++) {
        PlaybackMoment moment = playback_scout(playback, map->looked_s);
        look_at(map, ground, &moment);
        map->looked_s += map->look_step_s;
    }
}

// ---- the trail ----

static const RenderMapPlace *newest(const FlightMap *map) {
    return &map->trail[(map->trail_begin + map->trail_count - 1) % FLIGHT_MAP_TRAIL];
}

static void add_to_trail(FlightMap *map, Vec3d ecef, bool apart) {
    if (map->trail_count == FLIGHT_MAP_TRAIL)
        map->trail_begin = (map->trail_begin + 1) % FLIGHT_MAP_TRAIL;
    else
        map->trail_count++;
    map->trail[(map->trail_begin + map->trail_count - 1) % FLIGHT_MAP_TRAIL] = (RenderMapPlace){ecef, apart, false};
}

void flight_map_note(FlightMap *map, const Flight *flight, double t_s) {
    double passed_s = fabs(t_s - map->noted_s);
    if (map->trail_count > 0 && passed_s < FLIGHT_MAP_TRAIL_STEP_S)
        return;
    Vec3d there = on_ground(&flight->ground, flight->state.position_ecef);
    if (passed_s > JUMP_S)
        map->trail_count = 0;
    map->noted_s = t_s;
    if (map->trail_count == 0)
        add_to_trail(map, there, true);
    else if (vec3d_distance(newest(map)->ecef, there) > STANDS_M)
        add_to_trail(map, there, is_jump(&flight->state, newest(map)->ecef, there, passed_s));
}

static double ground_below_m(const FlightGround *ground, Vec3d eye_ecef) {
    double above_m = 0.0;
    return flight_ground_below(ground, eye_ecef, &above_m) ? above_m : geodesy_from_ecef(eye_ecef).h_m;
}

void flight_map_tell(const FlightMap *map, const Flight *flight, const RenderCamera *camera, bool routed, int next,
                     RenderMap *out) {
    out->show = true;
    out->ground_m = ground_below_m(&flight->ground, camera->eye_ecef);
    out->route = map->route;
    out->route_count = routed ? map->route_count : 0;
    out->next = next >= 0 && next < DEMO_WAYPOINTS_MAX ? map->stops[next] : -1;
    out->trail_count = 0;
    for (int i = 0; i < map->trail_count; i++)
        out->trail[out->trail_count++] = map->trail[(map->trail_begin + i) % FLIGHT_MAP_TRAIL];
    Vec3d there = on_ground(&flight->ground, flight->state.position_ecef);
    if (map->trail_count > 0)
        out->trail[out->trail_count++] =
            (RenderMapPlace){there, is_jump(&flight->state, newest(map)->ecef, there, FLIGHT_MAP_TRAIL_STEP_S), false};
}
