#include "app/pilot/terrain_watch.h"

#include "terrain/geodesy.h"

#include <math.h>

#define LOOK_STEPS 30 // between two looks: 0.25 s
#define LOOKS 60      // along a way
#define CLEARANCE_LEAST 30.0
#define CLEARANCE_MOST 120.0
#define CLEARANCE_SHARE 0.7 // of the height above ground at the begin
#define SETTLED_M 5.0       // lower than what is wished for, so that a warning does not flicker
#define KEEPS_S 120.0
#define NEAR_M 15.0   // what a way has to leave near by, and farther off
#define FAR_SHARE 0.5 // of the clearance
#define FAR_S 10.0
#define REACT_S 1.5     // until a turn or a climb has begun
#define CLIMB_SHARE 0.8 // of what is computed
#define WIDER 1.15      // turns than computed
#define TURN_EACH 0.35  // rad between the headings that are tried
#define TURNS 9         // to each side: all around

TerrainWatch terrain_watch_begin(const Flight *flight) {
    FlightInstruments now = flight_instruments(flight);
    double share_m = now.over_ground ? CLEARANCE_SHARE * now.above_ground_m : CLEARANCE_MOST;
    return (TerrainWatch){.clearance_m = fmin(fmax(share_m, CLEARANCE_LEAST), CLEARANCE_MOST), .height_m = -INFINITY};
}

// A way that could be flown: a turn to a heading, and on.
typedef struct Way {
    double track_rad, turn_rad; // at its begin, and by how much it turns
    double radius_m;
    double turn_way_m; // that the turn takes, with its begin
} Way;

// What a way comes to.
typedef struct Outlook {
    double needed_m; // the height that clears all of it
    double spare_m;  // the least height above what it has to leave, climbing as well as it goes; INFINITY: no ground
} Outlook;

typedef struct Look {
    const Flight *flight;
    const TerrainWatch *watch;
    FlightInstruments at;
    AutopilotReach reach;
    double speed; // over ground
} Look;

static Way way_to(const Look *look, double heading_rad, double bank_rad) {
    Way way = {.track_rad = look->at.track_rad,
               .turn_rad = remainder(heading_rad - look->at.track_rad, 2.0 * GEODESY_PI)};
    way.radius_m = WIDER * look->speed * look->speed / (AUTOPILOT_GRAVITY * tan(bank_rad));
    way.turn_way_m = look->speed * REACT_S + way.radius_m * fabs(way.turn_rad);
    return way;
}

// Of the track, so far along the way.
static double track_at(const Look *look, const Way *way, double way_m) {
    double turned = fmax(way_m - look->speed * REACT_S, 0.0) / way->radius_m;
    return way->track_rad + copysign(fmin(turned, fabs(way->turn_rad)), way->turn_rad);
}

// What is gained along the way: by the engine, and by speed that is given up for height.
static double gain_m(const Look *look, const Way *way, double way_m) {
    const AutopilotReach *reach = &look->reach;
    double climbing_m = fmax(way_m - look->speed * REACT_S, 0.0), turning_m = fmin(climbing_m, way->turn_way_m);
    double steady_m = reach->turning * turning_m + reach->steady * (climbing_m - turning_m);
    double zoom_m = reach->zoom_m * (1.0 - exp(-climbing_m / (look->speed * AUTOPILOT_ZOOM_S)));
    double sum_m = fmin(steady_m + zoom_m, AUTOPILOT_PATH_MOST * climbing_m);
    return sum_m > 0.0 ? CLIMB_SHARE * sum_m : sum_m;
}

static double to_leave_m(const Look *look, double way_m) {
    double far_m = fmax(FAR_SHARE * look->watch->clearance_m, NEAR_M);
    return NEAR_M + (far_m - NEAR_M) * fmin(way_m / (look->speed * FAR_S), 1.0);
}

static Outlook look_along(const Look *look, const Way *way) {
    Outlook out = {-INFINITY, INFINITY};
    const FlightGround *ground = &look->flight->ground;
    double part_m = look->speed * TERRAIN_WATCH_S / LOOKS, lat = look->at.lat_rad, lon = look->at.lon_rad, ground_m;
    for (int i = 0; i <= LOOKS && ground->height; i++) {
        double way_m = i * part_m, track = track_at(look, way, way_m + 0.5 * part_m);
        if (ground->height(ground->user, lat, lon, &ground_m)) {
            out.needed_m = fmax(out.needed_m, ground_m + look->watch->clearance_m);
            out.spare_m =
                fmin(out.spare_m, look->at.h_m + gain_m(look, way, way_m) - ground_m - to_leave_m(look, way_m));
        }
        lat += part_m * cos(track) / GEODESY_A_M;
        lon += part_m * sin(track) / (GEODESY_A_M * fmax(cos(lat), 0.05));
    }
    return out;
}

// The heading nearest to the one wished for whose way can be climbed over, on the side that it already turns to; else
// the one that comes least near to the ground.
static void turn_away(TerrainWatch *watch, const Look *look, double heading_rad, double best_m) {
    double side = watch->turn_rad < 0.0 ? -1.0 : 1.0, chosen = 0.0;
    for (int i = 2; i < 2 * (TURNS + 1) && best_m < 0.0; i++) {
        double turn = (i % 2 == 0 ? side : -side) * TURN_EACH * (i / 2);
        Way way = way_to(look, heading_rad + turn, watch->bank_rad);
        Outlook outlook = look_along(look, &way);
        if (outlook.spare_m <= best_m)
            continue;
        best_m = outlook.spare_m;
        chosen = turn;
    }
    watch->turn_rad = chosen;
}

static void look_ahead(TerrainWatch *watch, const Flight *flight, const AutopilotWish *wish) {
    Look look = {flight, watch, flight_instruments(flight), autopilot_reach(flight), 0.0};
    look.speed = fmax(look.at.speed_m_s, 10.0);
    watch->bank_rad = look.reach.bank_rad;
    Way straight = way_to(&look, wish->heading_rad, watch->bank_rad);
    Outlook outlook = look_along(&look, &straight);
    watch->ahead = outlook.needed_m > wish->height_m - (watch->ahead ? SETTLED_M : 0.0);
    bool turns = watch->ahead && outlook.spare_m < 0.0;
    watch->keeps_s = turns ? KEEPS_S : watch->keeps_s - LOOK_STEPS * FLIGHT_STEP_S;
    watch->height_m = watch->keeps_s > 0.0 ? fmax(watch->height_m, outlook.needed_m) : outlook.needed_m;
    if (turns)
        turn_away(watch, &look, wish->heading_rad, outlook.spare_m);
    else
        watch->turn_rad = 0.0;
}

void terrain_watch_change(TerrainWatch *watch, const Flight *flight, AutopilotWish *wish) {
    if (--watch->steps < 0) {
        watch->steps = LOOK_STEPS - 1;
        look_ahead(watch, flight, wish);
    }
    wish->height_m = fmax(wish->height_m, watch->height_m);
    if (watch->turn_rad == 0.0)
        return;
    wish->heading_rad += watch->turn_rad;
    wish->bank_max_rad = watch->bank_rad;
}
