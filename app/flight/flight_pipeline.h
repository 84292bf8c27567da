// app/flight/flight_pipeline.h: the pipeline that draws a flight, as the options want it.
// No units.
// The caller destroys the pipeline; everything else is borrowed and outlives it.
#pragma once
#include "app/flight/flight_session.h"
#include "app/pipeline/pipeline.h"
#include "app/scene_load.h"
#include "config/options.h"
#include "render/context/context.h"

// `video`: gets the frames of a film, or NULL. Threaded, unless the stages are to run in lockstep. Errors of
// compute_choose and pipeline_create.
MUST_USE Result flight_pipeline_create(const Options *options, const World *world, const FlightSession *session,
                                       Context *context, Video *video, Pipeline **out);
