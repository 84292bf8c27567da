// app/accuracy/accuracy.h: what accuracy costs in time: methods at tolerances over elevation models along flights, each
// cut measured at every sample, each frame timed in interleaved rounds.
// Milliseconds, pixels at the image centre (or its corners, with --bound corner), bytes.
// An Accuracy owns all below it; accuracy_run fills it, reports only read it. Main thread.
#pragma once
#include "app/bench/bench_preprocess.h"
#include "app/scene_load.h"
#include "app/track/track.h"
#include "base/base.h"
#include "config/options.h"
#include "render/context/context.h"
#include "render/render.h"
#include "terrain/lod/lod.h"
#include "terrain/measure/measure.h"

#define ACCURACY_DEMS_MAX 8
#define ACCURACY_VARIANTS_MAX 24
#define ACCURACY_TAUS_MAX 12
#define ACCURACY_KINDS_MAX 6
#define ACCURACY_FLIGHTS_MAX 8
#define ACCURACY_BURST 3 // frames that follow one another at 60 Hz, before the flight goes on elsewhere
#define ACCURACY_FRAME_HZ 60.0
// Frames of the stretch in the middle of each flight that popping is looked for in besides.
#define ACCURACY_STRETCH 60
#define ACCURACY_STRETCH_QUICK 20

// How vertex errors are defined: what the hierarchy is built with.
typedef struct AccuracyKind {
    char name[24]; // "total", "midpoint", "total:8": as --error takes it
    TerrainOptions terrain;
} AccuracyKind;

// One line of a plot: a method over tolerances.
typedef struct AccuracyVariant {
    char name[48]; // "geomipmap:centre"; of another kind than the first: "hybrid, midpoint"
    LodMethod method;
    LodBound bound;
    int kind; // index
} AccuracyVariant;

// What is to be run.
typedef struct AccuracyPlan {
    const Options *options;
    bool quick;
    const char *dems[ACCURACY_DEMS_MAX]; // names as given; NULL: the default scene
    int dem_count;
    AccuracyKind kinds[ACCURACY_KINDS_MAX]; // the first one is --error, which all methods are run with
    int kind_count;
    AccuracyVariant variants[ACCURACY_VARIANTS_MAX];
    int variant_count;
    double tau_px[ACCURACY_TAUS_MAX]; // ascending
    int tau_count;
    const char *flights[ACCURACY_FLIGHTS_MAX]; // names of built-in ones, or files; in `flight_text`
    Track read[ACCURACY_FLIGHTS_MAX];          // of files, but for recordings, which are flown over each DEM
    char flight_text[1024];
    int flight_count;
    int frames;  // of each flight, a multiple of ACCURACY_BURST
    int stretch; // frames of the one in each flight, 2 at least
    int rounds;
    int width, height;
    double fov_rad;
    // For tests: spoils a cut before it is measured. NULL: nothing is.
    void (*tamper)(void *user, const Terrain *terrain, LodCut *cut);
    void *tamper_user;
} AccuracyPlan;

typedef struct AccuracyPose {
    int flight, number; // within it
    bool jump;          // the first of a burst: neither its time nor its popping counts
    double t_s;         // of the flight
    Viewpoint at;
} AccuracyPose;

typedef struct AccuracyTimes {
    double select_ms, refine_ms, upload_ms, draw_ms;
    double frame_ms; // from the begin of the refinement to the end of the drawing: the stages one after another
} AccuracyTimes;

typedef struct AccuracyFrame {
    // The same whenever the same is run.
    Measure measure;
    double popping_px; // NaN at a jump
    double reached_px;
    bool promises; // reached_px, at every sample
    int64_t triangles, patches, vertices, index_bytes, upload_bytes, vram_bytes;
    double rebuilt_share; // of the triangles
    uint64_t cut_outline; // accuracy_cut_outline
    uint64_t cut_hash;    // accuracy_cut_hash of what was measured
    // Measured on this machine, this time.
    AccuracyTimes median, least, most; // of the rounds, each figure by itself
    int64_t memory_bytes;              // that the refinement made the process hold, as the system tells
} AccuracyFrame;

typedef struct AccuracyPercentiles {
    double p50, p95, p99, max;
} AccuracyPercentiles;

// Of all frames of a run; times without jumps.
// Spread of a median over the rounds.
typedef struct AccuracySpread {
    double least, most;
} AccuracySpread;

typedef struct AccuracySummary {
    double max_px, p999_px, p99_px; // greatest
    double rms_px, above_tau_share; // over all samples and frames
    double popping_px;              // greatest, of `popping_pairs` pairs of frames a 60th of a second apart
    int popping_pairs;
    int64_t t_junctions, holes, overlaps;
    double reached_px; // greatest
    bool promised;     // in every frame
    bool held;         // in every frame: nothing above reached_px, no crack
    bool same_cuts;    // what was measured is what was timed, in every round
    int worst_frame;   // the greatest measured error for what was tolerated; the first with a crack
    int worst_error;   // the same but for cracks
    double triangles_mean, rebuilt_share, upload_bytes_mean;
    int64_t vram_bytes, memory_bytes;        // greatest
    AccuracyPercentiles frame_ms, update_ms; // of all frames in all rounds; update: select and refine
    AccuracyTimes mean;                      // of the medians
    AccuracySpread frame_p50, update_p50;    // of single rounds
} AccuracySummary;

typedef struct AccuracyRun {
    int dem, variant;
    double tau_px;
    double stretch_px;     // greatest popping in the stretches
    int stretch_pairs;     // of frames in them
    AccuracyFrame *frames; // [pose_count of the DEM]
    double *frame_ms;      // of all frames in all rounds but of jumps, ascending
    int frame_ms_count;
    AccuracySummary summary;
} AccuracyRun;

// One elevation model: the worlds of all kinds of errors, its flights and their poses.
typedef struct AccuracyDem {
    char name[256]; // of the scene or the file, without folder
    char datum[16];
    int width, height;
    double spacing_m[2];
    uint64_t hash; // of its heights as loaded
    World worlds[ACCURACY_KINDS_MAX];
    double build_ms[ACCURACY_KINDS_MAX][3]; // of the hierarchy: median, least, most of the rounds
    double begin_ms[ACCURACY_VARIANTS_MAX]; // all that a method has ready before its first frame, median of its passes
    Track tracks[ACCURACY_FLIGHTS_MAX];
    AccuracyPose *poses;
    int pose_count;
    int off_count, under_count; // poses that are not over it; whose eye is under its ground
} AccuracyDem;

// A picture, rows from the top.
typedef struct AccuracyHeat {
    int width, height;
    uint8_t *rgb; // [height][width][3]
} AccuracyHeat;

// The worst frame of all that promise: what a heat map and a picture show.
typedef struct AccuracyWorst {
    int run, frame;       // -1: no run
    AccuracyHeat heat;    // where in the DEM the error is
    AccuracyHeat picture; // the frame itself; rgb NULL: nothing was drawn
    bool repeated;        // a refinement from scratch gave the same error again
} AccuracyWorst;

// A refinement from scratch by a number of workers, over a few views of the first DEM.
#define ACCURACY_SPEEDS_MAX 32
typedef struct AccuracySpeed {
    LodMethod method;
    int threads;
    double ms, least_ms, most_ms; // median of the rounds; the whole of the views
    // Over one worker: median of the ratios within a round, and their spread.
    double speedup, least_speedup, most_speedup;
} AccuracySpeed;

typedef struct AccuracyScaling {
    AccuracySpeed speeds[ACCURACY_SPEEDS_MAX];
    int speed_count;
    int views;
    double tau_px;
    PreprocessBench preprocess;
} AccuracyScaling;

typedef struct Accuracy {
    AccuracyPlan plan;
    AccuracyDem dems[ACCURACY_DEMS_MAX];
    AccuracyRun *runs; // [dem][variant][tau]
    int run_count;
    int signal; // that came while it ran; 0: none
    // Where not all were finished, plan.dem_count and run_count are those of the finished ones.
    int dems_planned, dems_finished;
    AccuracyWorst worst;
    AccuracyScaling scaling;
    char renderer[160]; // "": nothing was drawn
    bool software;
    char system[128]; // its name, release and machine
    double memory_gb;
    char *given; // the options that were given, as on a command line
    int threads;
    double wall_s, load; // the load average of the minute before
    int64_t unix_s;      // when it began
} Accuracy;

// From the options: DEMs, --methods, --tau, --errors, --track, --frames, --rounds, --quick. USAGE names what is wrong
// and what there is.
MUST_USE Result accuracy_plan(const Options *options, AccuracyPlan *out);
// Also after a failure.
void accuracy_plan_clear(AccuracyPlan *plan);
// Runs the plan. What loading, refining, measuring or drawing fails with; logged. Without a GL context nothing is
// drawn, and frames are refinement alone. Where signals are held (app/signals.h), one ends it within a frame, but for
// loading, the worst frame, and the part about workers and preprocessing, which are finished first. That is no failure,
// with no DEM finished neither.
MUST_USE Result accuracy_run(const AccuracyPlan *plan, Accuracy *out);
void accuracy_clear(Accuracy *accuracy);
bool accuracy_is_interrupted(const Accuracy *accuracy); // whether not all DEMs were finished

// Pixels a radian that the tolerances are of.
double accuracy_px_per_rad(const AccuracyPlan *plan);
// The first method with nested errors, which the kinds of --error are shown with: its variant of one kind; -1: none.
int accuracy_variant_of_kind(const AccuracyPlan *plan, int kind);
bool accuracy_is_nested(LodMethod method); // whether it takes the nested errors of the terrain
AccuracyRun *accuracy_run_at(const Accuracy *accuracy, int dem, int variant, int tau);
int accuracy_jump_free(const Accuracy *accuracy, int dem); // frames whose times count
// Whether what was promised was kept and the surfaces were whole: of one run, of all.
bool accuracy_run_holds(const AccuracyRun *run);
bool accuracy_holds(const Accuracy *accuracy);
// The command line that measures a frame again, for a shell: "overfly mesh ...". The caller frees it; NULL without
// memory.
char *accuracy_command(const Accuracy *accuracy, const AccuracyRun *run, int frame);

// What a method costs at a measured error that its line reaches: between the two tolerances around it, on straight
// lines of logarithms; NaN beyond the line's ends.
typedef struct AccuracyCost {
    double frame_ms, frame_least_ms, frame_most_ms, update_ms, triangles;
} AccuracyCost;
AccuracyCost accuracy_cost_at(const Accuracy *accuracy, int dem, int variant, double measured_px);
