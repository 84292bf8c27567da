#include "app/commands/command.h"
#include "app/compute.h"
#include "app/flight/flight_settings.h"
#include "app/json.h"
#include "app/outputs.h"
#include "app/picture_options.h"
#include "app/pipeline/picture.h"
#include "app/pipeline/pipeline.h"
#include "app/scene_load.h"
#include "base/log.h"
#include "terrain/geodesy.h"

#include <stdio.h>

#define SAMPLES 4 // a pixel: one picture may take its time

typedef struct Snapshot {
    const Options *options;
    const char *output;
    Context *context;
    World world;
    Viewpoint view;
    Pipeline *pipeline;
} Snapshot;

static Result check_output(Snapshot *snapshot) {
    snapshot->output = options_text(snapshot->options, OPTION_OUTPUT);
    if (!snapshot->output) {
        log_error("snapshot: expected where to write the picture: -o FILE.png");
        return RESULT_USAGE;
    }
    Result result = picture_check_name(snapshot->output, "--output");
    return result == RESULT_OK ? outputs_check(snapshot->options, "--output", snapshot->output) : result;
}

static LodMethod compared_method(const Options *options) {
    return options_is_set(options, OPTION_COMPARE) ? (LodMethod)options_choice(options, OPTION_COMPARE) : LOD_HYBRID;
}

static FrameOrder make_order(const Snapshot *snapshot) {
    const Options *options = snapshot->options;
    const double *size = options_numbers(options, OPTION_SIZE);
    FrameOrder order = {.method = (LodMethod)options_choice(options, OPTION_METHOD),
                        .compare = options_is_set(options, OPTION_COMPARE),
                        .right = compared_method(options),
                        .view = world_lod_view(&snapshot->world, options, &snapshot->view),
                        .width = (int)size[0],
                        .height = (int)size[1]};
    order.look = (RenderPacket){.sun_ecef = world_sun(&snapshot->world, options, &snapshot->view),
                                .colouring = (RenderColouring)options_choice(options, OPTION_COLOUR),
                                .wireframe = options_flag(options, OPTION_WIREFRAME),
                                .hud = {.show_names = order.compare},
                                .magenta_background = options_flag(options, OPTION_MAGENTA)};
    order.look.camera = (RenderCamera){.eye_ecef = order.view.eye_ecef,
                                       .camera_from_ecef = viewpoint_camera(&snapshot->view),
                                       .fov_y_rad = options_number(options, OPTION_FOV) * GEODESY_RAD_PER_DEG};
    snprintf(order.picture, sizeof order.picture, "%s", snapshot->output);
    return order;
}

static Result start_pipeline(Snapshot *snapshot) {
    PipelineOptions pipeline = {.lod = scene_lod_options(snapshot->options),
                                .compare = options_is_set(snapshot->options, OPTION_COMPARE),
                                .right = compared_method(snapshot->options),
                                .render = picture_render_options(snapshot->options, &snapshot->world),
                                .terrain = snapshot->world.terrain,
                                .jobs = snapshot->world.jobs,
                                .context = snapshot->context};
    pipeline.render.measure_times = true;
    if (pipeline.render.samples == 0)
        pipeline.render.samples = SAMPLES;
    Result result = compute_choose(snapshot->options, snapshot->context, pipeline.terrain, &pipeline.lod.resident);
    return result == RESULT_OK ? pipeline_create(&pipeline, &snapshot->pipeline) : result;
}

// `ms`: refining, uploading, drawing.
static void add_cut(Json *json, const PipelineCut *cut, int64_t triangles_drawn, const double ms[3]) {
    json_add_text(json, "method", lod_method_name(cut->method));
    json_add_number(json, "reached_px", cut->reached_px);
    json_add_bool(json, "promises", cut->promises);
    json_add_integer(json, "triangles", cut->lod.triangles);
    json_add_integer(json, "patches", cut->lod.patches);
    json_add_integer(json, "partitions", cut->lod.partitions);
    json_add_number(json, "balance", cut->lod.balance);
    json_add_integer(json, "triangles_drawn", triangles_drawn);
    json_add_number(json, "refine_ms", ms[0]);
    json_add_number(json, "upload_ms", ms[1]);
    json_add_number(json, "draw_ms", ms[2]);
}

static Result print_json(const Snapshot *snapshot) {
    PipelineStats stats = pipeline_stats(snapshot->pipeline);
    PipelineTimes times = pipeline_times(snapshot->pipeline);
    const Viewpoint *view = &snapshot->view;
    Json *json = json_create();
    json_add_text(json, "file", snapshot->output);
    json_add_text(json, "dem", terrain_dem(snapshot->world.terrain)->file);
    json_add_numbers(json, "eye", (double[3]){view->lat_deg, view->lon_deg, view->alt_m}, 3);
    json_add_numbers(json, "look", (double[2]){view->heading_deg, view->pitch_deg}, 2);
    json_add_number(json, "tau_px", options_number(snapshot->options, OPTION_TAU));
    const double left_ms[] = {times.refine.max, times.upload.max, times.draw.max};
    add_cut(json, &stats.cut, stats.render.triangles_drawn, left_ms);
    compute_add_json(json, &stats.render.resident);
    if (stats.split) {
        const double right_ms[] = {times.right_refine.max, times.right_upload.max, times.right_draw.max};
        Json *right = json_add_object(json, "right");
        add_cut(right, &stats.right, stats.render.right.triangles_drawn, right_ms);
        compute_add_json(right, &stats.render.right.resident);
    }
    json_add_text(json, "renderer", context_renderer_name(snapshot->context));
    json_add_bool(json, "software", context_is_software(snapshot->context));
    Result result = json_print(json);
    json_destroy(&json);
    return result;
}

// Without --json: a line, or one more for each of two methods.
static void log_methods(const Snapshot *snapshot) {
    PipelineStats stats = pipeline_stats(snapshot->pipeline);
    if (!stats.split) {
        pipeline_cut_log(snapshot->output, &stats.cut);
        return;
    }
    log_info("%s: two methods side by side", snapshot->output);
    pipeline_cut_log("left", &stats.cut);
    pipeline_cut_log("right", &stats.right);
}

static Result prepare(Snapshot *snapshot) {
    ContextOptions context = picture_context_options(snapshot->options);
    Result result = check_output(snapshot);
    if (result == RESULT_OK)
        result = world_check_inputs(snapshot->options);
    if (result == RESULT_OK)
        result = context_create_offscreen(&context, &snapshot->context);
    if (result == RESULT_OK)
        result = world_load(snapshot->options, &snapshot->world);
    if (result == RESULT_OK)
        result = world_viewpoint(&snapshot->world, snapshot->options, &snapshot->view);
    return result == RESULT_OK ? start_pipeline(snapshot) : result;
}

static Result take(Snapshot *snapshot) {
    world_warn_underground(&snapshot->world, &snapshot->view);
    FrameOrder order = make_order(snapshot);
    Result result = pipeline_submit(snapshot->pipeline, &order, true);
    return result == RESULT_OK ? pipeline_stats(snapshot->pipeline).picture_failure : result;
}

Result cmd_snapshot(const Options *options) {
    Snapshot snapshot = {.options = options};
    Result result = prepare(&snapshot);
    if (result == RESULT_OK)
        result = take(&snapshot);
    if (result == RESULT_OK && options_flag(options, OPTION_JSON))
        result = print_json(&snapshot);
    else if (result == RESULT_OK)
        log_methods(&snapshot);
    pipeline_destroy(&snapshot.pipeline);
    world_unload(&snapshot.world);
    context_destroy(&snapshot.context);
    return result;
}
