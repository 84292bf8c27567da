// app/accuracy/accuracy_internal.h: what the passes over a plan share.
// As app/accuracy/accuracy.h.
// A Pass owns its Lod and arena, and borrows the rest.
#pragma once
#include "app/accuracy/accuracy.h"
#include "base/arena.h"

// Whether no signal came. Takes it.
bool accuracy_goes_on(Accuracy *accuracy);

// Loads the DEM with every kind of errors, times building them, plans its flights.
MUST_USE Result accuracy_load(const AccuracyPlan *plan, int dem, AccuracyDem *out);
void accuracy_unload(AccuracyDem *dem);
LodView accuracy_view_at(const AccuracyPlan *plan, const AccuracyDem *dem, const Viewpoint *at, double tau_px);
LodView accuracy_view(const AccuracyPlan *plan, const AccuracyDem *dem, int pose, double tau_px);

// One flight of one run: a Lod that begins without anything, so that every pass gives the same cuts.
typedef struct AccuracyPass {
    const AccuracyPlan *plan;
    const AccuracyDem *dem;
    const World *world;
    double tau_px;
    Lod *lod;
    Arena *frame;
    LodCut cut;
    int64_t bytes_before;
    int64_t prepare_ns; // what it made before its first frame: in lod_create, and in the first lod_update
} AccuracyPass;
// `serial`: another one for each pass that one renderer draws.
MUST_USE Result accuracy_pass_begin(const AccuracyPlan *plan, const AccuracyDem *dem, const AccuracyRun *run,
                                    uint32_t serial, AccuracyPass *out);
MUST_USE Result accuracy_pass_refine(AccuracyPass *pass, int pose);
MUST_USE Result accuracy_pass_refine_at(AccuracyPass *pass, const Viewpoint *at);
void accuracy_pass_end(AccuracyPass *pass);
// Of all triangles, and where their vertices are.
uint64_t accuracy_cut_hash(const LodCut *cut);
// Of the items' places, levels and numbers of triangles: so little that it may be taken between timed frames.
uint64_t accuracy_cut_outline(const LodCut *cut);

// All rounds of one DEM's runs, interleaved.
MUST_USE Result accuracy_time(Accuracy *accuracy, int dem, Context *context);
// Logs how long all of it takes about, told what a round of the DEM took. What measuring fails with.
MUST_USE Result accuracy_estimate(Accuracy *accuracy, int dem, double round_s);
// Popping between so many successive frames in the middle of a flight, added to the run's. What measuring fails with.
MUST_USE Result accuracy_stretch(Accuracy *accuracy, AccuracyPass *pass, int flight, int frames, AccuracyRun *run);
// Every cut of one DEM's runs at every sample, and the stretches.
MUST_USE Result accuracy_measure(Accuracy *accuracy, int dem);
// Fill the summaries: times, [run of the DEM][round][pose]; then errors, after measuring. MEMORY.
MUST_USE Result accuracy_summarize_times(Accuracy *accuracy, int dem, const AccuracyTimes *times);
void accuracy_summarize_errors(Accuracy *accuracy, int dem);
// How much of what a frame tolerates is used up: above 1 it is broken; infinite where the surface is not whole.
double accuracy_badness(const AccuracyFrame *frame);
// Where one of the DEM's runs has the worst frame so far, keeps it: measured again from scratch, and drawn.
MUST_USE Result accuracy_keep_worst(Accuracy *accuracy, int dem, Context *context);

// A map of a frame's errors, [height][width] of the DEM, at most 720 pixels a side; what `out` held is freed. The eye
// is ringed in white, the worst sample in red; what is above the bound is magenta, what is not covered black. MEMORY.
MUST_USE Result accuracy_make_heat(const Terrain *terrain, const float *error_px, const AccuracyFrame *frame,
                                   const Viewpoint *eye, AccuracyHeat *out);

// How refinement from scratch gains by workers. What lod_create fails with; MEMORY.
MUST_USE Result accuracy_scale(const AccuracyPlan *plan, const AccuracyDem *dem, AccuracyScaling *out);

// The picture of a frame.
RenderPacket accuracy_packet(const AccuracyPass *pass, int pose);
MUST_USE Result accuracy_renderer(const AccuracyPlan *plan, const World *world, Renderer **out);
