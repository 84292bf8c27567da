// app/live/curve.h: frame time against tolerance, from the frames of a flight and from samples of the refinement.
// Milliseconds, pixels at the image centre, nanoseconds as base/clock.h counts.
// A value; one thread at a time.
#pragma once
#include "app/pipeline/pipeline_counts.h"
#include "base/base.h"
#include "render/accuracy.h"

#define CURVE_BINS 56       // thirds of octaves, from 0.01 px on
#define CURVE_SAMPLES 13    // half octaves
#define CURVE_LEAST_PX 0.25 // of the first sample
#define CURVE_FRESH_S 5.0   // so long a point is of now
#define CURVE_FORGOTTEN_S 90.0

// Frames drawn with tolerances within a third of an octave; moments of the triangles drawn and of the time for upload
// and drawing, over the latest frames.
typedef struct CurveBin {
    double weight; // of frames; 0: none
    double log_tau, triangles, refine_ms, draw_ms;
    double triangles2, draw2, both; // means of squares and of the product
    int64_t seen_ns;
} CurveBin;

// The refinement of a view from scratch.
typedef struct CurveSample {
    double tau_px;    // 0: none
    double triangles; // in view
    double refine_ms; // of one processor's time
    int64_t made_ns;
} CurveSample;

typedef struct Curve {
    CurveBin bins[CURVE_BINS];
    CurveSample samples[CURVE_SAMPLES]; // by tolerance, ascending
    PipelineFrame last;
} Curve;

// The tolerance of a sample.
double curve_sample_tau(int index);
// Forgets all that another method made, or another lens, size or colouring, or halves instead of a whole picture.
void curve_add_frame(Curve *curve, const PipelineFrame *frame);
// The time that one more triangle takes to draw, and between what bounds it lies: never less than nothing, never more
// than all the time shared out among the triangles, and in between as the frames of the flight tell.
typedef struct CurveSlope {
    double ms, least_ms, most_ms; // a triangle
    bool known;                   // frames of numbers of triangles far enough apart tell it
} CurveSlope;
CurveSlope curve_slope(const Curve *curve, int64_t now_ns);
// Fills `out`, ascending, and returns how many: what was flown, and from the samples what else there is to have.
int curve_points(const Curve *curve, int64_t now_ns, RenderAccuracyPoint out[RENDER_ACCURACY_POINTS]);
