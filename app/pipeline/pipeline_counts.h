// app/pipeline/pipeline_counts.h: what the frames of a pipeline were and what they cost.
// Pixels, milliseconds.
// Values; one thread at a time.
#pragma once
#include "app/pipeline/frame_times.h"
#include "app/pipeline/pipeline_methods.h"
#include "render/render.h"
#include "terrain/lod/lod.h"

// What one method gave for the last frame drawn.
typedef struct PipelineCut {
    LodMethod method;
    LodStats lod;
    double reached_px;
    bool promises; // reached_px, at every sample
} PipelineCut;

// One drawn frame, of a split picture its left half, for who sets its tolerance by what it cost, or shows it.
typedef struct PipelineFrame {
    int64_t number; // counts up from 1
    int64_t end_ns; // as base/clock.h counts
    LodMethod method;
    bool split;
    double frame_ms; // from the end of the frame before to its end; 0: there was none
    double cost_ms;  // that, but for what passed while no order was there or the screen let it wait: its longest stage
                     // at least, which is what a frame takes where stages overlap
    double select_ms, refine_ms, upload_ms, draw_ms;
    double tau_px, reached_px; // asked for and kept
    double px_per_rad;
    int64_t triangles;       // of both halves
    int64_t triangles_drawn; // after view culling
    int width, height;       // of the whole picture
    bool another;            // method, size, colours or lines than that of the one before, or the first
    bool moved;              // that, or another view, lens, or more or less written over it
    bool disturbed; // nothing is to be learned from its time: `another`, or something was made or written meanwhile
} PipelineFrame;

#define PIPELINE_FRAMES_KEPT 64

typedef struct PipelineStats {
    int64_t frames;  // drawn
    PipelineCut cut; // of the last frame drawn, as all below
    bool split;      // with `right` on the right half
    PipelineCut right;
    RenderStats render;
    double frame_ms, frame_p99_ms; // from the end of the frame before to its end: the last, and of the last seconds
    double longest_frame_ms;       // of all
    int64_t triangles_sum;         // over all frames
    int64_t frames_split;
    int64_t frames_by_method[LOD_METHOD_COUNT]; // that it had the whole picture or a half of
    MethodChanges changes;
    double longest_gpu_create_ms; // the renderer's share of a resident method's creation, in the drawing thread
    Result picture_failure;       // of the first picture that could not be written; the flight goes on
    int64_t asked;                // pictures with FrameOrder.asked that are written, or cannot be
    Result asked_failure;         // of the last of them
    PipelineFrame latest[PIPELINE_FRAMES_KEPT]; // frame i, from 0, is at i % PIPELINE_FRAMES_KEPT
} PipelineStats;

typedef struct PipelineTimes {
    FrameTimesSummary frame, refine, upload, draw;            // of all frames
    FrameTimesSummary right_refine, right_upload, right_draw; // of the split ones
} PipelineTimes;

// What the stages did since the frame before was over, told by the pipeline.
typedef struct PipelineWork {
    int64_t refine_ns, draw_ns; // of this frame: the whole stages, without waiting for one another
    int64_t waited_ns;          // for an order, or for the screen
    int width, height;          // of the picture
    bool wrote;                 // a picture, to a file
} PipelineWork;

typedef struct PipelineCounts {
    PipelineStats stats;
    int64_t last_end_ns;
    RenderPacket last; // drawn, as what follows: its look; its cuts are gone
    int width, height;
    LodMethod methods[METHODS_HALVES];
    FrameTimes frame, refine, upload, draw, right_refine, right_upload, right_draw;
} PipelineCounts;

// A frame that is drawn, made by these methods.
void pipeline_counts_add(PipelineCounts *counts, const RenderPacket *packet, const LodMethod methods[METHODS_HALVES],
                         const RenderStats *render, const PipelineWork *work, int64_t now_ns);
// As pipeline_frames.
int pipeline_counts_frames(const PipelineCounts *counts, int64_t after, PipelineFrame *out, int max);
// One line in the log, which begins with `where`.
void pipeline_cut_log(const char *where, const PipelineCut *cut);
PipelineTimes pipeline_counts_times(const PipelineCounts *counts);
