// app/flight/flight_loop.h: the main thread's part of a flight: events, time, simulation, orders for the pipeline.
// Seconds, pixels.
// Borrows everything. Main thread.
#pragma once
#include "app/flight/flight_session.h"
#include "app/live/monitor.h"
#include "app/pipeline/pipeline.h"
#include "render/context/context.h"

#define FLIGHT_PICTURE_BEGIN "overfly-" // of the names of pictures in a folder, before their number

typedef struct FlightLoop {
    FlightSession *session;
    Pipeline *pipeline;
    Monitor *monitor;
    Context *context;
    bool window;                 // else there are no events, and frames follow one another without waiting
    bool lockstep;               // stages one after another
    double fps;                  // frames a second at most, in a window
    int64_t frames;              // leave after so many; 0: when told to, or when the demo is over
    const char *screenshot;      // path of the last frame's picture, or NULL
    const char *pictures;        // folder, or NULL
    int64_t every;               // each so manieth frame is one of them, instead; 0: not so
    bool film;                   // each frame is one of the pipeline's video
    int picture_count;           // at most; fewer where there are fewer frames
    int64_t picture_frames;      // that the pictures are spread over; set by flight_loop_run
    int pictures_begun;          // in the folder, by which they are numbered from 1; 0 at first
    char asked[PATHS_BYTES_MAX]; // the picture that a key asked for and that is not written yet; "": none
    int64_t asked_heard;         // of PipelineStats.asked
    int width, height;
} FlightLoop;

// Flies until told to leave: frames, Esc, the window's closing, SIGINT, SIGTERM, or without a window the demo's end.
// The first error of a frame comes back.
MUST_USE Result flight_loop_run(FlightLoop *loop);
