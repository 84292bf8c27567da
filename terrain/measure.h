// terrain/measure.h: how far a cut is from the terrain, and whether it is whole. Shares no code with the
// refinement: it reads triangles and samples only.
// Pixels at the image centre, ECEF metres.
// Outputs are values. Any thread.
#pragma once
#include "base/base.h"
#include "terrain/jobs.h"
#include "terrain/lod.h"
#include "terrain/terrain.h"

typedef struct Measure {
    // Per sample: lambda |P - Q| / |P - e| with P the sample's exact ECEF position and Q the point of the drawn triangle at
    // the same column and row.
    double max_px, p999_px, p99_px, rms_px;
    double above_tau_share;     // share of samples above cut->view.tau_px
    int64_t samples;
    int worst_col, worst_row;   // where max_px is
    int64_t t_junctions;        // vertices inside another triangle's edge
    int64_t holes;              // interior edges with one triangle, and uncovered samples
    int64_t overlaps;           // edges with more than two triangles, or the same direction twice; cells covered twice
} Measure;

MUST_USE Result measure_cut(const Terrain *terrain, const LodCut *cut, Jobs *jobs, Measure *out);
