#include "app/accuracy/accuracy_internal.h"
#include "app/flight/camera.h"
#include "app/flight/flight_session.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/statistics.h"
#include "terrain/errors/error_field.h"
#include "terrain/terrain_parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROUNDS_MAX 64            // of building a hierarchy
#define RECORDING_INTERVAL_S 0.1 // between the points that a recording is flown again with

static void describe(const AccuracyPlan *plan, int index, AccuracyDem *dem) {
    const World *world = &dem->worlds[0];
    const Dem *heights = terrain_dem(world->terrain);
    const char *given = plan->dems[index], *file = given ? given : heights->file, *slash = strrchr(file, '/');
    snprintf(dem->name, sizeof dem->name, "%s", slash ? slash + 1 : file);
    snprintf(dem->datum, sizeof dem->datum, "%s", heights->datum == DEM_DATUM_EGM96 ? "EGM96" : "ellipsoid");
    dem->width = heights->width;
    dem->height = heights->height;
    dem->hash = dem_hash(heights);
    if (dem_spacing_m(heights, dem->spacing_m) != RESULT_OK)
        dem->spacing_m[0] = dem->spacing_m[1] = 0.0;
}

static Result build_errors(const AccuracyDem *dem, const AccuracyKind *kind, const World *world, double *ms) {
    ErrorFieldInput input = {.height_m = terrain_dem(world->terrain)->height_m,
                             .grid = terrain_grid(world->terrain),
                             .forest = &world->terrain->forest,
                             .kind = kind->terrain.error,
                             .stride = kind->terrain.error_stride,
                             .void_bits = terrain_dem(world->terrain)->void_bits};
    ErrorField field;
    int64_t begin = clock_now_ns();
    Result result = error_field_create(&input, dem->worlds[0].jobs, &field);
    *ms = (double)(clock_now_ns() - begin) * 1e-6;
    if (result == RESULT_OK)
        error_field_destroy(&field);
    return result;
}

// The kinds in turn, round by round.
static Result time_building(const AccuracyPlan *plan, AccuracyDem *dem) {
    double ms[ACCURACY_KINDS_MAX][ROUNDS_MAX];
    int rounds = plan->rounds < ROUNDS_MAX ? plan->rounds : ROUNDS_MAX;
    Result result = RESULT_OK;
    for (int round = 0; round < rounds; round++)
        for (int kind = 0; kind < plan->kind_count && result == RESULT_OK; kind++)
            result = build_errors(dem, &plan->kinds[kind], &dem->worlds[kind], &ms[kind][round]);
    for (int kind = 0; kind < plan->kind_count && result == RESULT_OK; kind++) {
        statistics_sort(ms[kind], rounds);
        dem->build_ms[kind][0] = statistics_percentile(ms[kind], rounds, 0.5);
        dem->build_ms[kind][1] = ms[kind][0];
        dem->build_ms[kind][2] = ms[kind][rounds - 1];
    }
    return result;
}

static Result fly_recording(const AccuracyDem *dem, const char *path, Track *out) {
    const World *world = &dem->worlds[0];
    PlaybackOptions options = {.how = track_reading_default(), .ground = session_ground(world), .dem_hash = dem->hash};
    options.how.geoid = world->geoid;
    return playback_load_track(path, &options, RECORDING_INTERVAL_S, out);
}

static Result make_flight(const AccuracyPlan *plan, int flight, const AccuracyDem *dem, Track *out) {
    TrackKind kind;
    if (track_kind_find(plan->flights[flight], &kind))
        return track_builtin(&dem->worlds[0], kind, out);
    return plan->read[flight].count > 0 ? track_copy(&plan->read[flight], out)
                                        : fly_recording(dem, plan->flights[flight], out);
}

static Result plan_flights(const AccuracyPlan *plan, AccuracyDem *dem) {
    Result result = RESULT_OK;
    for (int i = 0; i < plan->flight_count && result == RESULT_OK; i++)
        result = make_flight(plan, i, dem, &dem->tracks[i]);
    return result;
}

// Flights of one name are told apart by a number.
static void number_names(const AccuracyPlan *plan, AccuracyDem *dem) {
    for (int i = 1; i < plan->flight_count; i++) {
        int same = 0;
        for (int k = 0; k < i; k++)
            same += strcmp(dem->tracks[k].name, dem->tracks[i].name) == 0;
        size_t used = strlen(dem->tracks[i].name);
        used = used < TRACK_NAME_BYTES - 4 ? used : TRACK_NAME_BYTES - 4;
        if (same)
            snprintf(dem->tracks[i].name + used, TRACK_NAME_BYTES - used, "-%d", i + 1);
    }
}

// Flights of another place measure little: that is said, and refused where no eye is over the model at all.
static Result judge_places(AccuracyDem *dem) {
    const World *world = &dem->worlds[0];
    for (int i = 0; i < dem->pose_count; i++) {
        const Viewpoint *at = &dem->poses[i].at;
        double ground_m, h_m = world_ellipsoid_m(world, at->lat_deg, at->lon_deg, at->alt_m);
        bool over = terrain_ground_m(world->terrain, at->lat_deg, at->lon_deg, &ground_m);
        dem->off_count += !over;
        dem->under_count += over && h_m < ground_m;
    }
    if (dem->off_count == dem->pose_count) {
        log_error("bench: no flight comes over %s; expected one of its own: --track valley,ridge,pass,dive,turn",
                  dem->name);
        return RESULT_RANGE;
    }
    if (dem->off_count || dem->under_count)
        log_warn("bench: of %d eyes %d are not over %s, and %d are under its ground", dem->pose_count, dem->off_count,
                 dem->name, dem->under_count);
    return RESULT_OK;
}

// Bursts spread over the flight, each of frames that follow one another.
static Result choose_poses(const AccuracyPlan *plan, AccuracyDem *dem) {
    int bursts = plan->frames / ACCURACY_BURST;
    dem->pose_count = plan->flight_count * plan->frames;
    dem->poses = calloc((size_t)dem->pose_count, sizeof *dem->poses);
    if (!dem->poses) {
        log_error("bench: no memory for %d frames", dem->pose_count);
        return RESULT_MEMORY;
    }
    for (int i = 0; i < dem->pose_count; i++) {
        int flight = i / plan->frames, number = i % plan->frames, burst = number / ACCURACY_BURST;
        const Track *track = &dem->tracks[flight];
        double t = track_duration_s(track) * (burst + 0.5) / bursts + number % ACCURACY_BURST / ACCURACY_FRAME_HZ;
        dem->poses[i] = (AccuracyPose){flight, number, number % ACCURACY_BURST == 0, t, track_at(track, t)};
    }
    return RESULT_OK;
}

Result accuracy_load(const AccuracyPlan *plan, int index, AccuracyDem *out) {
    Result result = RESULT_OK;
    *out = (AccuracyDem){.poses = NULL};
    for (int kind = 0; kind < plan->kind_count && result == RESULT_OK; kind++)
        result = world_load_named(plan->options, plan->dems[index], &plan->kinds[kind].terrain, &out->worlds[kind]);
    if (result == RESULT_OK)
        describe(plan, index, out);
    if (result == RESULT_OK)
        result = time_building(plan, out);
    if (result == RESULT_OK)
        result = plan_flights(plan, out);
    if (result == RESULT_OK)
        number_names(plan, out);
    if (result == RESULT_OK)
        result = choose_poses(plan, out);
    return result == RESULT_OK ? judge_places(out) : result;
}

void accuracy_unload(AccuracyDem *dem) {
    for (int kind = 0; kind < ACCURACY_KINDS_MAX; kind++) {
        world_unload(&dem->worlds[kind]);
        dem->worlds[kind] = (World){.jobs = NULL};
    }
}

double accuracy_px_per_rad(const AccuracyPlan *plan) {
    return camera_px_per_rad(plan->fov_rad, plan->width, plan->height, scene_bound_corner(plan->options));
}

LodView accuracy_view_at(const AccuracyPlan *plan, const AccuracyDem *dem, const Viewpoint *at, double tau_px) {
    return (LodView){.eye_ecef = world_viewpoint_ecef(&dem->worlds[0], at),
                     .forward_ecef = viewpoint_forward(at),
                     .px_per_rad =
                         camera_px_per_rad(plan->fov_rad, plan->width, plan->height, scene_bound_corner(plan->options)),
                     .tau_px = tau_px};
}

LodView accuracy_view(const AccuracyPlan *plan, const AccuracyDem *dem, int pose, double tau_px) {
    return accuracy_view_at(plan, dem, &dem->poses[pose].at, tau_px);
}
