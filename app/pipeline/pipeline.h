// app/pipeline/pipeline.h: the stages of a frame: refine it on the workers while the one before is drawn by the render
// thread. Pixels, milliseconds, ECEF metres. A Pipeline owns its threads, Lods, Renderer and packets; it borrows
// terrain, jobs and context. One thread submits.
#pragma once
#include "app/pipeline/pipeline_counts.h"
#include "app/pipeline/video.h"
#include "base/base.h"
#include "base/paths.h"
#include "render/context/context.h"
#include "render/render.h"
#include "terrain/lod/lod.h"

#define PIPELINE_MESSAGE_BYTES 192

// What a frame shall show. Copied on submission.
typedef struct FrameOrder {
    LodMethod method;
    bool compare; // with `right` on the right half of the picture
    LodMethod right;
    LodView view;
    int width, height;                    // pixels of the framebuffer
    RenderPacket look;                    // all but cuts, `split`, and the HUD's message and methods
    char message[PIPELINE_MESSAGE_BYTES]; // for the HUD; "": none
    char picture[PATHS_BYTES_MAX];        // write the finished frame as PNG; "": no
    bool asked;                           // a person wants to know what became of it: PipelineStats.asked
    bool film;                            // add it to PipelineOptions.video
} FrameOrder;

typedef struct PipelineOptions {
    bool threaded; // false: pipeline_submit refines and draws before it returns
    LodOptions lod;
    bool compare; // the first orders will want `right` on the right half
    LodMethod right;
    bool bound_brute; // as MethodsOptions has it
    RenderOptions render;
    const Terrain *terrain;
    Jobs *jobs;
    Context *context; // current nowhere; the drawing thread makes it current
    Video *video;     // borrowed, or NULL
} PipelineOptions;

typedef struct Pipeline Pipeline;
// Errors of the renderer's creation come from here: DEVICE, MEMORY, IO; and of lod_create for the first methods.
MUST_USE Result pipeline_create(const PipelineOptions *options, Pipeline **out);
// Ends the threads and frees all; what was submitted and not begun is dropped.
void pipeline_destroy(Pipeline **pipeline);

// Hands over an order. A method that no Lod has yet is created, where threaded, while the flight goes on with the one
// before, or without the right half; it takes over after its first refinement. One that cannot be created or refined is
// refused: the one before stays, and PipelineStats.changes tells it. It is not tried again until another was wanted.
// Where the renderer has no room for a resident method, its frames are refined again, by the method before or by the
// processor's twin, and drawn then.
//  While the stage before is still busy: `wait` true waits; false replaces an order that was not
// begun, as only the newest view matters to a person. Pictures and frames of a film are never dropped. The error of any
// earlier frame comes back here.
MUST_USE Result pipeline_submit(Pipeline *pipeline, const FrameOrder *order, bool wait);
// Waits until everything submitted is drawn; the error of any frame.
MUST_USE Result pipeline_drain(Pipeline *pipeline);

// The cut of a frame that was drawn, of the whole picture or its left half.
typedef struct PipelineHeld {
    LodCut cut; // as the renderer tells of it (render_tell_cut)
    LodMethod method;
    bool partial;     // it was not drawn whole
    int64_t drawn_ns; // when its frame was finished, as base/clock.h counts
} PipelineHeld;
// Waits for the next frame that is drawn, until `until_ns` at most, and holds its cut: all that it points to stays as
// it is until pipeline_let_go, which has to come before another hold and before pipeline_destroy. Meanwhile no memory
// of cuts since is used again: let go soon. False: no frame came. One thread at a time, any but the one that submits.
bool pipeline_hold(Pipeline *pipeline, int64_t until_ns, PipelineHeld *out);
void pipeline_let_go(Pipeline *pipeline);

// The frames drawn since number `after` (PipelineFrame.number; 0: from the first), oldest first; the latest `max` of
// them, and no more than are kept. Returns how many.
int pipeline_frames(Pipeline *pipeline, int64_t after, PipelineFrame *out, int max);
PipelineStats pipeline_stats(Pipeline *pipeline);
PipelineTimes pipeline_times(Pipeline *pipeline);
