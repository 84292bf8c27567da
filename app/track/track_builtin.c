#include "app/track/track.h"

#include "app/track/track_ways.h"
#include "base/log.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define SPEED_M_S 100.0
#define CLEARANCE_SHARE 0.012 // of the shorter side of the terrain: so far above the ground, within the limits below
#define CLEARANCE_MIN_M 5.0
#define CLEARANCE_MAX_M 200.0
#define CLIMB_WINDOW 6 // points to each side whose ground is kept clear of, and over which heights are smoothed
#define LOOK_DOWN_DEG 6.0
#define PASS_REACH 0.16 // of the shorter side, to each side of the saddle
#define PASS_FAN 9      // directions tried
#define PASS_FAN_RAD 1.0
#define SUMMITS_NEAR 10  // the summits of a pass are within a tenth of the ridge
#define SADDLE_DEPTH 0.1 // below both, of the ridge's range of heights
#define DIVE_HEIGHT 0.5  // of the way on the ground
#define DIVE_LEVEL 0.75  // of the way: from here on level
#define TURN_S 12.0
#define TURN_STEPS 48
#define TURN_LOOK_DEG (-8.0)

typedef struct Plan {
    const World *world;
    const Terrain *terrain;
    double across_m, down_m; // of a cell
    double side_m;           // the shorter one of the terrain
    double clearance_m;
} Plan;

static Plan plan_of(const World *world) {
    const Dem *dem = terrain_dem(world->terrain);
    Plan plan = {.world = world, .terrain = world->terrain};
    track_cell_m(plan.terrain, &plan.across_m, &plan.down_m);
    plan.side_m = fmin((dem->width - 1) * plan.across_m, (dem->height - 1) * plan.down_m);
    plan.clearance_m = fmin(fmax(CLEARANCE_SHARE * plan.side_m, CLEARANCE_MIN_M), CLEARANCE_MAX_M);
    return plan;
}

static Result begin(Track *track, TrackKind kind, int count) {
    *track = (Track){.points = calloc((size_t)count, sizeof *track->points), .count = count, .start_unix_s = NAN};
    snprintf(track->name, sizeof track->name, "%s", track_kind_name(kind));
    if (track->points)
        return RESULT_OK;
    log_error("no memory for a flight of %d points", count);
    return RESULT_MEMORY;
}

static Viewpoint place(const Plan *plan, double col, double row, double h_m) {
    Viewpoint at = {0};
    grid_geodetic(terrain_grid(plan->terrain), col, row, &at.lat_deg, &at.lon_deg);
    at.alt_m = h_m - world_ellipsoid_m(plan->world, at.lat_deg, at.lon_deg, 0.0);
    return at;
}

static int clamped(int i, int count) {
    return i < 0 ? 0 : i >= count ? count - 1 : i;
}

// The mean over a window of the greatest over a window: never below what is in the middle.
static void clear_ground(const Plan *plan, const TrackWay *way, double h_m[TRACK_WAY_MAX]) {
    double greatest[TRACK_WAY_MAX];
    for (int i = 0; i < way->count; i++) {
        greatest[i] = -INFINITY;
        for (int k = -CLIMB_WINDOW; k <= CLIMB_WINDOW; k++) {
            int j = clamped(i + k, way->count);
            greatest[i] = fmax(greatest[i], track_ground_m(plan->terrain, way->col[j], way->row[j]));
        }
    }
    for (int i = 0; i < way->count; i++) {
        h_m[i] = plan->clearance_m;
        for (int k = -CLIMB_WINDOW; k <= CLIMB_WINDOW; k++)
            h_m[i] += greatest[clamped(i + k, way->count)] / (2 * CLIMB_WINDOW + 1);
    }
}

// Along the way, `down_deg` below it, at a constant speed on the ground.
static void fly_way(const Plan *plan, const TrackWay *way, const double *h_m, double down_deg, Track *track) {
    double metres = track_way_m(plan->terrain, way);
    for (int i = 0; i < way->count; i++)
        track->points[i] = (TrackPoint){.t_s = metres / SPEED_M_S * i / (way->count - 1),
                                        .at = place(plan, way->col[i], way->row[i], h_m[i])};
    for (int i = 0; i < way->count; i++) {
        int from = i + 1 < way->count ? i : i - 1;
        Viewpoint *at = &track->points[i].at;
        track_look(&track->points[from].at, &track->points[from + 1].at, &at->heading_deg, &at->pitch_deg);
        at->pitch_deg = fmax(at->pitch_deg - down_deg, -85.0);
    }
}

static Result fly_across(const Plan *plan, TrackKeep keep, Track *track) {
    TrackWay way;
    double h_m[TRACK_WAY_MAX];
    Result result = track_way_across(plan->terrain, keep, &way);
    if (result != RESULT_OK)
        return result;
    clear_ground(plan, &way, h_m);
    result = begin(track, keep == TRACK_KEEP_LOW ? TRACK_VALLEY : TRACK_RIDGE, way.count);
    if (result == RESULT_OK)
        fly_way(plan, &way, h_m, LOOK_DOWN_DEG, track);
    return result;
}

// ---- the pass ----

static double highest_within(const double *ground_m, int count, int from, int to) {
    double most = -INFINITY;
    for (int i = clamped(from, count); i <= clamped(to, count); i++)
        most = fmax(most, ground_m[i]);
    return most;
}

// How far the ridge rises again on both sides of a point near by.
static double depth_at(const double *ground_m, int count, int i) {
    int near = count / SUMMITS_NEAR;
    return fmin(highest_within(ground_m, count, i - near, i), highest_within(ground_m, count, i, i + near)) -
           ground_m[i];
}

// The highest point of the ridge that lies deep enough between summits; where none does, the deepest.
static int find_saddle(const Plan *plan, const TrackWay *ridge) {
    double ground[TRACK_WAY_MAX], least = INFINITY, most = -INFINITY;
    for (int i = 0; i < ridge->count; i++) {
        ground[i] = track_ground_m(plan->terrain, ridge->col[i], ridge->row[i]);
        least = fmin(least, ground[i]);
        most = fmax(most, ground[i]);
    }
    int deepest = ridge->count / 2, highest = -1;
    for (int i = 0; i < ridge->count; i++) {
        double depth = depth_at(ground, ridge->count, i);
        if (depth > depth_at(ground, ridge->count, deepest))
            deepest = i;
        if (depth >= SADDLE_DEPTH * (most - least) && (highest < 0 || ground[i] > ground[highest]))
            highest = i;
    }
    return highest < 0 ? deepest : highest;
}

static bool is_inside(const Plan *plan, double col, double row) {
    const Dem *dem = terrain_dem(plan->terrain);
    return col >= 0.0 && row >= 0.0 && col <= dem->width - 1 && row <= dem->height - 1;
}

// The lowest ground of a fan about a direction from the saddle; where the fan leaves the DEM, its clamped middle.
static void descend(const Plan *plan, double col, double row, double angle_rad, double *out_col, double *out_row) {
    const Dem *dem = terrain_dem(plan->terrain);
    double reach = PASS_REACH * plan->side_m, best = INFINITY;
    *out_col = fmin(fmax(col + reach * cos(angle_rad) / plan->across_m, 0.0), dem->width - 1.0);
    *out_row = fmin(fmax(row + reach * sin(angle_rad) / plan->down_m, 0.0), dem->height - 1.0);
    for (int i = 0; i < PASS_FAN; i++) {
        double angle = angle_rad + PASS_FAN_RAD * (2.0 * i / (PASS_FAN - 1) - 1.0);
        double x = col + reach * cos(angle) / plan->across_m, y = row + reach * sin(angle) / plan->down_m;
        double ground = track_ground_m(plan->terrain, x, y);
        if (!is_inside(plan, x, y) || ground >= best)
            continue;
        best = ground;
        *out_col = x;
        *out_row = y;
    }
}

static Result fly_pass(const Plan *plan, Track *track) {
    TrackWay ridge, over = {.count = 3}, way;
    double h_m[TRACK_WAY_MAX];
    Result result = track_way_across(plan->terrain, TRACK_KEEP_HIGH, &ridge);
    if (result != RESULT_OK)
        return result;
    int saddle = find_saddle(plan, &ridge), step = ridge.count / 32;
    int before = clamped(saddle - step, ridge.count), after = clamped(saddle + step, ridge.count);
    double along = atan2((ridge.row[after] - ridge.row[before]) * plan->down_m,
                         (ridge.col[after] - ridge.col[before]) * plan->across_m);
    over.col[1] = ridge.col[saddle];
    over.row[1] = ridge.row[saddle];
    descend(plan, over.col[1], over.row[1], along - GEODESY_PI / 2.0, &over.col[0], &over.row[0]);
    descend(plan, over.col[1], over.row[1], along + GEODESY_PI / 2.0, &over.col[2], &over.row[2]);
    track_way_through(plan->terrain, &over, &way);
    clear_ground(plan, &way, h_m);
    result = begin(track, TRACK_PASS, way.count);
    if (result == RESULT_OK)
        fly_way(plan, &way, h_m, LOOK_DOWN_DEG, track);
    return result;
}

// ---- on the highest relief ----

// Down along a cosine, never lower than clear of the ground.
static Result fly_dive(const Plan *plan, Track *track) {
    Viewpoint eye;
    Result result = viewpoint_of_relief(plan->terrain, plan->world->geoid, &eye);
    if (result != RESULT_OK)
        return result;
    TrackWay line = {.count = 2}, way;
    double clear_m[TRACK_WAY_MAX], heading = eye.heading_deg * GEODESY_RAD_PER_DEG;
    double reach = 2.0 * PASS_REACH * plan->side_m;
    if (!grid_from_geodetic(terrain_grid(plan->terrain), eye.lat_deg, eye.lon_deg, &line.col[0], &line.row[0]))
        return RESULT_RANGE;
    line.col[1] = line.col[0] + reach * sin(heading) / plan->across_m;
    line.row[1] = line.row[0] - reach * cos(heading) / plan->down_m;
    track_way_through(plan->terrain, &line, &way);
    clear_ground(plan, &way, clear_m);
    double top = clear_m[0] + DIVE_HEIGHT * reach, bottom = clear_m[way.count - 1];
    for (int i = 0; i < way.count; i++) {
        double share = fmin(i / (DIVE_LEVEL * (way.count - 1)), 1.0);
        double h_m = bottom + (top - bottom) * 0.5 * (1.0 + cos(GEODESY_PI * share));
        clear_m[i] = fmax(clear_m[i], h_m);
    }
    result = begin(track, TRACK_DIVE, way.count);
    if (result == RESULT_OK)
        fly_way(plan, &way, clear_m, 0.0, track);
    return result;
}

// Above the summit of the ridge.
static Result turn(const Plan *plan, Track *track) {
    TrackWay ridge;
    Result result = track_way_across(plan->terrain, TRACK_KEEP_HIGH, &ridge);
    if (result == RESULT_OK)
        result = begin(track, TRACK_TURN, TURN_STEPS + 1);
    if (result != RESULT_OK)
        return result;
    double ground = -INFINITY;
    Viewpoint eye = {0};
    for (int i = 0; i < ridge.count; i++) {
        double here = track_ground_m(plan->terrain, ridge.col[i], ridge.row[i]);
        if (here <= ground)
            continue;
        ground = here;
        eye = place(plan, ridge.col[i], ridge.row[i], ground + plan->clearance_m);
    }
    for (int i = 0; i <= TURN_STEPS; i++) {
        track->points[i] = (TrackPoint){.t_s = TURN_S * i / TURN_STEPS, .at = eye};
        track->points[i].at.heading_deg = fmod(360.0 * i / TURN_STEPS, 360.0);
        track->points[i].at.pitch_deg = TURN_LOOK_DEG;
    }
    return RESULT_OK;
}

Result track_builtin(const World *world, TrackKind kind, Track *out) {
    Plan plan = plan_of(world);
    Track track = {0};
    Result result = kind == TRACK_PASS    ? fly_pass(&plan, &track)
                    : kind == TRACK_DIVE  ? fly_dive(&plan, &track)
                    : kind == TRACK_TURN  ? turn(&plan, &track)
                    : kind == TRACK_RIDGE ? fly_across(&plan, TRACK_KEEP_HIGH, &track)
                                          : fly_across(&plan, TRACK_KEEP_LOW, &track);
    if (result == RESULT_OK)
        *out = track;
    return result;
}
