// render/accuracy.h: what the panel of accuracy against time tells, in numbers.
// Milliseconds, pixels at the image's centre, seconds.
// A value of fixed size; it is copied with the packet.
#pragma once
#include "base/base.h"

#define RENDER_ACCURACY_POINTS 72
#define RENDER_ACCURACY_FRAMES 120

// What a frame takes at a tolerance.
typedef struct RenderAccuracyPoint {
    float tau_px, frame_ms;
    float least_ms, most_ms; // not flown: what frame_ms may as well be
    float freshness;         // 1: of now .. 0: too old to show
    bool flown;              // frames were drawn with it; else estimated from a sample of the refinement
} RenderAccuracyPoint;

typedef struct RenderAccuracyFrame {
    float select_ms, refine_ms, upload_ms, draw_ms;
} RenderAccuracyFrame;

typedef enum RenderAccuracyState {
    RENDER_ACCURACY_NOTHING,  // not measured yet
    RENDER_ACCURACY_SO_FAR,   // max_px is of `share` of the terrain, from the eye on; the rest is being measured
    RENDER_ACCURACY_MEASURED, // the numbers hold
    RENDER_ACCURACY_RESIDENT, // only the GPU has the triangles
    RENDER_ACCURACY_PARTIAL,  // the cut was not drawn whole
    RENDER_ACCURACY_LARGE,    // too many triangles to keep
    RENDER_ACCURACY_FAILED,   // the log says why
    RENDER_ACCURACY_STATE_COUNT
} RenderAccuracyState;

// The error of one drawn cut, at every sample.
typedef struct RenderAccuracyError {
    RenderAccuracyState state;
    double share; // 0..1, of the terrain's cells
    double max_px, p999_px, above_tau_share;
    int64_t cracks; // T-junctions, holes and overlaps
    double tau_px, promised_px;
    bool promises; // promised_px, at every sample
    double age_s;  // since the frame was drawn
} RenderAccuracyError;

typedef struct RenderAccuracy {
    bool show;
    uint64_t revision; // the same: nothing below has changed; 0: it may have
    RenderAccuracyError error;
    bool slope_known; // points that are not flown follow from frames; else from what nobody can doubt alone
    int point_count;
    RenderAccuracyPoint points[RENDER_ACCURACY_POINTS]; // ascending by tau_px
    double tau_px, frame_ms;                            // of the last frames; NaN: none
    double p50_ms, p99_ms;                              // whole frames of the last `seconds`
    double seconds;
    double target_ms; // that somebody keeps; 0: nobody
    double axis_ms;   // the end of the scale of times, > 0
    int frame_count;
    RenderAccuracyFrame frames[RENDER_ACCURACY_FRAMES]; // the latest, oldest first
    RenderAccuracyFrame mean;                           // of the last seconds
} RenderAccuracy;
