#include "app/flight/runway.h"

#include "app/aircraft/airframe.h"
#include "app/aircraft/isa.h"
#include "app/aircraft/propulsion.h"
#include "app/aircraft/trim.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <stdlib.h>

#define NODES 40 // whose heights are looked at first, to each side
#define NODE_M (RUNWAY_SEARCH_M / NODES)
#define SIDE (2 * NODES + 1)
#define HEADINGS 16
#define ROUGH_ACROSS 0.5 // of the slope across, which is another so near as wheels are
#define SLOPE_LEAST 0.44 // = 0.5 / sqrt(1 + 0.5^2): of a slope whose half across is as much as what is along
#define KEPT 128         // of the first look, which are looked at closely

#define STEP_LEAST_M 40.0 // beside the best, where a better one is looked for
#define PARTS 12          // of the run
#define BESIDE_M 30.0     // where the slope across is looked at
#define CLIMB_M 4000.0    // of ground behind the run, at whose end there is some height already, that is climbed over
#define CLIMBS 16         // looks at it

#define CLIMB_FREE 0.03 // a climb that every engine can
#define FAR_COST 1e-6   // of slope, a metre of the way: a kilometre farther for a thousandth less
#define WATER_COST 0.05 // what is level everywhere is a lake or the sea, where it is no made plain
#define EDGE_COST 0.02  // of a climb that leaves the land
#define LEVEL_MOST 2e-4 // slope, of heights that were projected
#define LIFT_OFF 1.2    // times the stall speed
#define ROLLING 0.03    // friction
#define LEAST_GAIN 0.3  // m/s^2
#define LEAST_M 400.0   // of a run
#define RUNS 2.0        // lengths of the computed run

double runway_length_m(const Aircraft *a, double h_m) {
    Isa air = isa_at(h_m);
    double speed = LIFT_OFF * airframe_stall_speed(a, air.density, 0.0), mean = 0.7 * speed;
    if (a->engine == AIRCRAFT_GLIDER)
        return LEAST_M;
    double thrust_n = propulsion_at(a, &air, mean, propulsion_steady(a, &air, mean, 1.0), 1.0).thrust_n;
    double gain = thrust_n / a->mass - ROLLING * TRIM_GRAVITY_0;
    return fmax(RUNS * speed * speed / (2.0 * fmax(gain, LEAST_GAIN)), LEAST_M);
}

// ---- one run, closely -------------------------------------------------------------------------------------------

// The height so far along the run, and to its right; small ways.
static bool height_along(const FlightGround *ground, const Runway *run, double along_m, double right_m, double *h_m) {
    double c = cos(run->heading_rad), s = sin(run->heading_rad);
    double north_m = along_m * c - right_m * s, east_m = along_m * s + right_m * c;
    double lat = run->lat_rad + north_m / GEODESY_A_M;
    double lon = run->lon_rad + east_m / (GEODESY_A_M * fmax(cos(run->lat_rad), 0.05));
    return ground->height && ground->height(ground->user, lat, lon, h_m);
}

// False: there is no ground, or it is steeper than `most`.
static bool measure_slope(const FlightGround *ground, double length_m, double most, Runway *run, double *end_h_m) {
    double part_m = length_m / PARTS, before_m = 0.0, here_m, left_m, right_m;
    run->slope = 0.0;
    for (int i = 0; i <= PARTS; i++) {
        if (run->slope > most || !height_along(ground, run, i * part_m, 0.0, &here_m) ||
            !height_along(ground, run, i * part_m, -BESIDE_M, &left_m) ||
            !height_along(ground, run, i * part_m, BESIDE_M, &right_m))
            return false;
        double along = i > 0 ? fabs(here_m - before_m) / part_m : 0.0;
        double across = fmax(fabs(right_m - here_m), fabs(here_m - left_m)) / BESIDE_M;
        run->slope = fmax(run->slope, fmax(along, across));
        before_m = here_m;
    }
    run->level = run->slope <= LEVEL_MOST;
    *end_h_m = before_m;
    return true;
}

static void measure_climb(const FlightGround *ground, double length_m, double end_h_m, Runway *run) {
    double h_m;
    run->climb = 0.0;
    for (int i = 1; i <= CLIMBS; i++) {
        double way_m = CLIMB_M * i / CLIMBS;
        if (height_along(ground, run, length_m + way_m, 0.0, &h_m))
            run->climb = fmax(run->climb, (h_m - end_h_m) / way_m);
        else
            run->leaves = true;
    }
}

static double cost_of(const Runway *run, double far_m) {
    return run->slope + fmax(run->climb - CLIMB_FREE, 0.0) + (run->level ? WATER_COST : 0.0) +
           (run->leaves ? EDGE_COST : 0.0) + FAR_COST * far_m;
}

// ---- all of them, roughly ---------------------------------------------------------------------------------------

typedef struct Candidate {
    double north_m, east_m; // from the middle
    double heading_rad, cost;
} Candidate;

typedef struct Search {
    const FlightGround *ground;
    const RunwayWish *wish;
    float h_m[SIDE][SIDE]; // by nodes to the north and to the east; NAN: no ground
    Candidate kept[KEPT];  // the cheapest first
    int count;
} Search;

static Runway run_of(const RunwayWish *wish, const Candidate *at) {
    return (Runway){.lat_rad = wish->lat_rad + at->north_m / GEODESY_A_M,
                    .lon_rad = wish->lon_rad + at->east_m / (GEODESY_A_M * fmax(cos(wish->lat_rad), 0.05)),
                    .heading_rad = at->heading_rad};
}

static int headings_of(const RunwayWish *wish) {
    return wish->heading_given ? 1 : HEADINGS;
}

static double heading_of(const RunwayWish *wish, int i) {
    return fmod(wish->heading_rad + 2.0 * GEODESY_PI * i / HEADINGS, 2.0 * GEODESY_PI);
}

static double far_m(const Candidate *at) {
    return hypot(at->north_m, at->east_m);
}

static void look_around(Search *search) {
    for (int north = -NODES; north <= NODES; north++) {
        for (int east = -NODES; east <= NODES; east++) {
            double h_m;
            Runway place = run_of(search->wish, &(Candidate){.north_m = north * NODE_M, .east_m = east * NODE_M});
            bool there = height_along(search->ground, &place, 0.0, 0.0, &h_m);
            search->h_m[north + NODES][east + NODES] = there ? (float)h_m : NAN;
        }
    }
}

// Between four nodes; NAN beyond them.
static double rough_height(const Search *search, double north_m, double east_m) {
    double y = north_m / NODE_M + NODES, x = east_m / NODE_M + NODES;
    if (!(y >= 0.0 && x >= 0.0 && y <= SIDE - 1 && x <= SIDE - 1))
        return NAN;
    int j = (int)fmin(y, SIDE - 2), i = (int)fmin(x, SIDE - 2);
    double v = y - j, u = x - i;
    const float *h = &search->h_m[j][i], *above = &search->h_m[j + 1][i];
    return (1.0 - v) * ((1.0 - u) * h[0] + u * h[1]) + v * ((1.0 - u) * above[0] + u * above[1]);
}

// What is known of a run from the nodes' heights, so far.
typedef struct Rough {
    Runway run;
    double north_m, east_m, along_north, along_east; // where it begins, and its direction
    double before_m;                                 // the height at the last look, not behind the run
} Rough;

static double rough_height_along(const Search *search, const Rough *rough, double along_m, double right_m) {
    double north_m = rough->north_m + along_m * rough->along_north - right_m * rough->along_east;
    return rough_height(search, north_m, rough->east_m + along_m * rough->along_east + right_m * rough->along_north);
}

// False: there is no ground.
static bool look_at_part(const Search *search, Rough *rough, double way_m, double part_m) {
    double h_m = rough_height_along(search, rough, way_m, 0.0);
    double left_m = rough_height_along(search, rough, way_m, -0.5 * NODE_M);
    double across = ROUGH_ACROSS * fabs(rough_height_along(search, rough, way_m, 0.5 * NODE_M) - left_m) / NODE_M;
    double along = way_m > 0.0 ? fabs(h_m - rough->before_m) / part_m : 0.0;
    rough->run.slope = fmax(rough->run.slope, fmax(along, across));
    rough->before_m = h_m;
    return isfinite(h_m) && isfinite(across);
}

static void look_behind(const Search *search, Rough *rough, double way_m, double length_m) {
    double h_m = rough_height_along(search, rough, way_m, 0.0);
    if (isnan(h_m))
        rough->run.leaves = true;
    else
        rough->run.climb = fmax(rough->run.climb, (h_m - rough->before_m) / (way_m - length_m));
}

// Of slope and climb by the nodes' heights; looks no farther once it is `most`. Infinite where there is no ground.
static double rough_cost(const Search *search, const Candidate *at, double most) {
    double length_m = search->wish->length_m, far = far_m(at), cost = 0.0;
    int parts = (int)ceil(length_m / NODE_M), looks = parts + (int)(CLIMB_M / NODE_M);
    Rough rough = {.north_m = at->north_m,
                   .east_m = at->east_m,
                   .along_north = cos(at->heading_rad),
                   .along_east = sin(at->heading_rad)};
    for (int i = 0; i <= looks && cost < most; i++) {
        if (i > parts)
            look_behind(search, &rough, length_m * i / parts, length_m);
        else if (!look_at_part(search, &rough, length_m * i / parts, length_m / parts))
            return INFINITY;
        rough.run.level = i >= parts && rough.run.slope <= LEVEL_MOST;
        cost = cost_of(&rough.run, far);
    }
    return cost;
}

static void keep(Search *search, const Candidate *candidate) {
    int place = search->count < KEPT ? search->count++ : KEPT - 1;
    for (; place > 0 && search->kept[place - 1].cost > candidate->cost; place--)
        search->kept[place] = search->kept[place - 1];
    search->kept[place] = *candidate;
}

// Of any run from there; whatever its heading, so much of the ground's slope counts, along or across it.
static double least_cost(const Search *search, int north, int east) {
    if (abs(north) == NODES || abs(east) == NODES)
        return 0.0;
    const float *h = &search->h_m[north + NODES][east + NODES];
    double slope = hypot(h[1] - h[-1], h[SIDE] - h[-SIDE]) / (2.0 * NODE_M);
    return SLOPE_LEAST * slope + FAR_COST * NODE_M * hypot(north, east);
}

// One heading a node, so that what is kept lies in many places.
static void try_node(Search *search, int north, int east) {
    const RunwayWish *wish = search->wish;
    Candidate best = {.cost = INFINITY};
    double most = search->count < KEPT ? INFINITY : search->kept[KEPT - 1].cost;
    for (int i = 0; i < headings_of(wish) && least_cost(search, north, east) < most; i++) {
        Candidate candidate = {north * NODE_M, east * NODE_M, heading_of(wish, i), 0.0};
        candidate.cost = rough_cost(search, &candidate, fmin(best.cost, most));
        if (candidate.cost < best.cost)
            best = candidate;
    }
    if (best.cost < most)
        keep(search, &best);
}

// ---- the best of them, closely ----------------------------------------------------------------------------------

// The best so far, at a cost that is infinite at first, is given up for a better one.
static void try_closely(const Search *search, const Candidate *candidate, Candidate *best, Runway *out) {
    double end_h_m, length_m = search->wish->length_m;
    Runway run = run_of(search->wish, candidate);
    if (!measure_slope(search->ground, length_m, best->cost, &run, &end_h_m))
        return;
    measure_climb(search->ground, length_m, end_h_m, &run);
    double cost = cost_of(&run, far_m(candidate));
    if (cost >= best->cost)
        return;
    *best = *candidate;
    best->cost = cost;
    *out = run;
}

static void try_beside(const Search *search, double step_m, Candidate *best, Runway *out) {
    const Candidate middle = *best;
    for (int north = -1; north <= 1; north++)
        for (int east = -1; east <= 1; east++)
            for (int i = 0; i < headings_of(search->wish); i++) {
                Candidate candidate = middle;
                candidate.north_m += north * step_m;
                candidate.east_m += east * step_m;
                candidate.heading_rad = heading_of(search->wish, i);
                try_closely(search, &candidate, best, out);
            }
}

static bool choose(const Search *search, Runway *out) {
    Candidate best = {.cost = INFINITY};
    for (int i = 0; i < search->count; i++)
        try_closely(search, &search->kept[i], &best, out);
    if (best.cost == INFINITY)
        return false;
    for (double step_m = NODE_M; step_m > STEP_LEAST_M; step_m *= 0.5)
        try_beside(search, step_m, &best, out);
    return true;
}

Result runway_find(const FlightGround *ground, const RunwayWish *wish, Runway *out) {
    Search *search = calloc(1, sizeof *search);
    if (!search)
        return RESULT_MEMORY;
    search->ground = ground;
    search->wish = wish;
    look_around(search);
    for (int north = -NODES; north <= NODES; north++)
        for (int east = -NODES; east <= NODES; east++)
            try_node(search, north, east);
    bool found = choose(search, out);
    free(search);
    return found ? RESULT_OK : RESULT_RANGE;
}
