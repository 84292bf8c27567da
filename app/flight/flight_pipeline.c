#include "app/flight/flight_pipeline.h"

#include "app/compute.h"
#include "app/picture_options.h"

Result flight_pipeline_create(const Options *options, const World *world, const FlightSession *session,
                              Context *context, Video *video, Pipeline **out) {
    PipelineOptions pipeline = {.threaded = !options_flag(options, OPTION_LOCKSTEP),
                                .lod = scene_lod_options(options),
                                .compare = session->settings.compare,
                                .right = session->settings.right,
                                .bound_brute = true,
                                .render = picture_render_options(options, world),
                                .terrain = world->terrain,
                                .jobs = world->jobs,
                                .context = context,
                                .video = video};
    Result result = compute_choose(options, context, pipeline.terrain, &pipeline.lod.resident);
    return result == RESULT_OK ? pipeline_create(&pipeline, out) : result;
}
