// app/reproduce/reproduce_race.h: several level-of-detail methods over the same views, frame by frame in turn, so that
// a busy machine harms all alike. Milliseconds of lod_update, of wall time; pixels at the image centre. A Race owns its
// Lods and times; it borrows terrain, jobs and context. One thread.
#pragma once
#include "app/viewpoint.h"
#include "base/arena.h"
#include "base/base.h"
#include "render/context/context.h"
#include "terrain/lod/lod.h"
#include "terrain/terrain.h"

#define RACE_RACERS_MAX 8

typedef struct Racer {
    LodOptions options;
    Jobs *jobs;
    Lod *lod;
    Arena *frame;
    LodCut cut; // of the latest step
    double *ms; // [frames]
    int frames;
    double triangles, vertices, cut_vertices, balance; // sums over frames
    double reached_px;                                 // greatest
    // Of race_measure: the greatest, the greatest, the mean of squares' sum.
    double max_px, p999_px, squares_px;
    int measures;
    double drawn_ms, drawn_triangles; // sums: refinement and drawing; what was in view
    int drawn;
} Racer;

typedef struct Race {
    const Terrain *terrain;
    Racer racers[RACE_RACERS_MAX];
    int count, frames_max, turn;
} Race;

// Up to `frames_max` counted steps.
void race_begin(const Terrain *terrain, int frames_max, Race *out);
// Entrants get the indices 0, 1, 2 ... What lod_create fails with; MEMORY.
MUST_USE Result race_enter(Race *race, const LodOptions *options, Jobs *jobs);
void race_end(Race *race);

// Each refines this view; who is first changes from step to step. Steps that do not count warm up. A reached budget is
// no failure.
MUST_USE Result race_step(Race *race, const LodView *view, bool counted);
// One refinement of one racer, timed.
MUST_USE Result racer_refine(Racer *racer, const LodView *view, double *ms);
// The latest step's cuts against all samples.
MUST_USE Result race_measure(Race *race, Jobs *jobs);

// Each refines and draws these views; the first does not count. DEVICE, MEMORY.
typedef struct RaceStage {
    Context *context;
    int width, height;
    double fov_y_rad, tau_px;
    size_t vram_bytes_max;
} RaceStage;
MUST_USE Result race_draw(Race *race, const RaceStage *stage, const Viewpoint *views, int count);

typedef struct RaceTimes {
    double p50_ms, p99_ms;
    double fps; // frames over the sum of their times, as a paper's average
} RaceTimes;
// NaN where nothing was counted, in all of these.
RaceTimes race_times(const Race *race, int racer);
double race_mean(const Race *race, int racer, double sum); // `sum` over its frames
double race_drawn_triangles(const Race *race, int racer);
double race_drawn_fps(const Race *race, int racer);
// The median over frames of the time of `slow` over that of `fast`.
double race_ratio(const Race *race, int slow, int fast);
