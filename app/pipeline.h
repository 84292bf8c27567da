// app/pipeline.h: the stages of a frame: refine it on the workers while the one before is drawn by the render thread.
// Pixels, milliseconds, ECEF metres.
// A Pipeline owns its threads, Lod, Renderer and packets; it borrows terrain, jobs and context. One thread submits.
#pragma once
#include "app/frame_times.h"
#include "base/base.h"
#include "base/paths.h"
#include "render/context.h"
#include "render/render.h"
#include "terrain/lod/lod.h"

#define PIPELINE_MESSAGE_BYTES 160

// What a frame shall show. Copied on submission.
typedef struct FrameOrder {
    LodMethod method;
    LodView view;
    int width, height;                    // pixels of the framebuffer
    RenderPacket look;                    // all but `cut`, `hud.message` and the times
    char message[PIPELINE_MESSAGE_BYTES]; // for the HUD; "": none
    char picture[PATHS_BYTES_MAX];        // write the finished frame as PNG; "": no
} FrameOrder;

typedef struct PipelineOptions {
    bool threaded; // false: pipeline_submit refines and draws before it returns
    LodOptions lod;
    RenderOptions render;
    const Terrain *terrain;
    Jobs *jobs;
    Context *context; // current nowhere; the drawing thread makes it current
} PipelineOptions;

typedef struct PipelineStats {
    int64_t frames;   // drawn
    LodMethod method; // of the last frame drawn, as all below
    LodStats lod;
    double reached_px;
    RenderStats render;
    double frame_ms, frame_p99_ms; // the last, and of the last seconds
    int64_t triangles_sum;         // over all frames
    Result picture_failure;        // of the first picture that could not be written; the flight goes on
} PipelineStats;

typedef struct PipelineTimes {
    FrameTimesSummary frame, refine, upload, draw; // of all frames
} PipelineTimes;

typedef struct Pipeline Pipeline;
// Errors of the renderer's creation come from here: DEVICE, MEMORY, IO.
MUST_USE Result pipeline_create(const PipelineOptions *options, Pipeline **out);
// Ends the threads and frees all; what was submitted and not begun is dropped.
void pipeline_destroy(Pipeline **pipeline);

// Hands over an order. While the stage before is still busy: `wait` true waits; false replaces an order that was not
// begun, as only the newest view matters to a person. Pictures are never dropped. The error of any earlier frame comes
// back here.
MUST_USE Result pipeline_submit(Pipeline *pipeline, const FrameOrder *order, bool wait);
// Waits until everything submitted is drawn; the error of any frame.
MUST_USE Result pipeline_drain(Pipeline *pipeline);

PipelineStats pipeline_stats(Pipeline *pipeline);
PipelineTimes pipeline_times(Pipeline *pipeline);
