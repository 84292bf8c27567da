// terrain/measure/measure.h: how far a cut is from the terrain, and whether it is whole. Shares no code with the
// refinement: it reads triangles and samples only.
// Pixels at the image centre, ECEF metres.
// Outputs are values. Any thread.
#pragma once
#include "base/base.h"
#include "terrain/jobs.h"
#include "terrain/lod/lod.h"
#include "terrain/terrain.h"

typedef struct Measure {
    // Per sample: lambda |P - Q| / |P - e| with P the sample's exact ECEF position and Q the point of the drawn
    // triangle at the same column and row; on an edge the larger of the two triangles'. Infinite where that is not a
    // number.
    double max_px, p999_px, p99_px, rms_px; // percentiles by nearest rank
    double above_tau_share;                 // share of samples above cut->view.tau_px
    int64_t samples;                        // that a triangle covers
    int worst_col, worst_row;               // where max_px is; the first in row-major order
    int64_t t_junctions;                    // vertices inside another triangle's edge
    // Interior edges with one triangle; vertices drawn at two positions; samples and cells that no triangle covers.
    int64_t holes;
    // Edges with more than two triangles, or the same direction twice; cells covered twice; triangles that are
    // degenerate, clockwise or outside the DEM.
    int64_t overlaps;
} Measure;

// What holds for each sample, [height][width] of the DEM, of the caller; NULL: not wanted. NaN: no triangle covers it.
typedef struct MeasureMaps {
    float *error_px; // as in Measure, rounded up
    float *rise_m;   // the drawn surface above the sample, along its vertical; where triangles disagree the highest one
} MeasureMaps;

// The same for any number of workers. Takes 9 bytes a sample while it runs. MEMORY; RANGE: more than 2^30 vertices.
MUST_USE Result measure_cut(const Terrain *terrain, const LodCut *cut, Jobs *jobs, Measure *out);
// The same, with maps; with rise_m another 4 bytes a sample.
MUST_USE Result measure_cut_maps(const Terrain *terrain, const LodCut *cut, Jobs *jobs, const MeasureMaps *maps,
                                 Measure *out);
// The same with heights above the ellipsoid in `dem`, without a Terrain.
MUST_USE Result measure_cut_of(const Dem *dem, const Grid *grid, const LodCut *cut, Jobs *jobs, Measure *out);

// How far the drawn surface moved from one cut to another, seen from a view: popping, where the views are those of
// neighbouring frames. Heights at the same columns and rows are compared: lambda |rise - rise before| / |P - e|.
typedef struct MeasurePopping {
    double max_px;            // over all samples that both cuts cover
    int worst_col, worst_row; // where; the first in row-major order
} MeasurePopping;
// `before_m`, `after_m`: rise_m of two cuts of the terrain. The same for any number of workers. MEMORY.
MUST_USE Result measure_popping(const Terrain *terrain, const LodView *view, const float *before_m,
                                const float *after_m, Jobs *jobs, MeasurePopping *out);

// Popping over many cuts that follow one another. Only what changed is looked at: an item counts as unchanged when its
// triangles are where an item's of the cut before were, whatever their method says. It gives what whole maps give.
typedef struct MeasureStretch MeasureStretch;
// Takes 13 bytes a sample, and a copy of a cut. Borrows the terrain. MEMORY.
MUST_USE Result measure_stretch_create(const Terrain *terrain, MeasureStretch **out);
void measure_stretch_destroy(MeasureStretch **stretch);
// From the cut added before to this one, seen from this one's view; nothing moved to the first. The same for any number
// of workers. MEMORY.
MUST_USE Result measure_stretch_add(MeasureStretch *stretch, const LodCut *cut, Jobs *jobs, MeasurePopping *out);
// Of the cut added last, as MeasureMaps.rise_m; until the next one.
const float *measure_stretch_rise_m(const MeasureStretch *stretch);

// What is known before all is measured.
typedef struct MeasureSoFar {
    double share;  // 0..1, of the terrain's cells
    double max_px; // over the samples of these; as Measure.max_px, rounded up
} MeasureSoFar;

// For who measures beside other work: `go_on` is asked before each item of the cut and each row of a pass over the
// samples, by all workers. It may wait; false ends the measuring. One sort of the items' border edges is in one piece.
typedef struct MeasurePace {
    bool (*go_on)(void *user, const MeasureSoFar *so_far);
    void *user;
} MeasurePace;
// As measure_cut_of, the items in their order. BUDGET: `go_on` ended it, and nothing is measured.
MUST_USE Result measure_cut_paced(const Dem *dem, const Grid *grid, const LodCut *cut, Jobs *jobs,
                                  const MeasurePace *pace, Measure *out);
