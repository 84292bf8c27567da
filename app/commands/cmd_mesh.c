#include "app/commands/command.h"
#include "app/json.h"
#include "app/outputs.h"
#include "app/scene_load.h"
#include "base/clock.h"
#include "base/log.h"
#include "terrain/diamond/diamond_select.h"
#include "terrain/geodesy.h"
#include "terrain/measure/measure.h"
#include "terrain/mesh/mesh.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#define FRAME_BLOCK_BYTES (1 << 20)

// Everything one run of the subcommand makes. The cut lies in `frame`, its pages in `lod`.
typedef struct MeshRun {
    const Options *options;
    const char *path; // NULL: report only
    MeshFormat format;
    LodOptions lod_options;
    DiamondSelect *select; // --select; NULL: none
    World world;
    Viewpoint viewpoint;
    Lod *lod;
    Arena *frame;
    LodCut cut;
    double refine_ms;
    Measure measure;
    Mesh mesh;
} MeshRun;

static Result check_output(MeshRun *run) {
    run->path = options_text(run->options, OPTION_OUTPUT);
    Result result = run->path ? mesh_format_of(run->path, &run->format) : RESULT_OK;
    return result == RESULT_OK && run->path ? outputs_check(run->options, "--output", run->path) : result;
}

static double tan_up(const Options *options) {
    return tan(0.5 * options_number(options, OPTION_FOV) * GEODESY_RAD_PER_DEG);
}

static double tan_right(const Options *options) {
    const double *size = options_numbers(options, OPTION_SIZE);
    return tan_up(options) * size[0] / size[1];
}

// Before anything slow is done: a selection is compiled, and makes the method diamond where none is asked for.
static Result choose_method(MeshRun *run) {
    const Options *options = run->options;
    run->lod_options = scene_lod_options(options);
    if (!options_is_set(options, OPTION_SELECT))
        return RESULT_OK;
    OptionSource source = options_source(options, OPTION_METHOD);
    bool asked_for = source == SOURCE_ENVIRONMENT || source == SOURCE_COMMAND_LINE;
    if (asked_for && run->lod_options.method != LOD_DIAMOND) {
        log_error("--select: %s refines by the tolerance alone; only diamond takes a selection: --method diamond",
                  lod_method_name(run->lod_options.method));
        return RESULT_USAGE;
    }
    DiamondLens lens = {tan_right(options), tan_up(options)};
    Result result = diamond_select_create(options_text(options, OPTION_SELECT), &lens, &run->select);
    run->lod_options.method = LOD_DIAMOND;
    run->lod_options.select = run->select;
    return result;
}

// Even without any error bound there are more triangles than allowed.
static bool is_smallest(const MeshRun *run) {
    return run->cut.reached_px > run->cut.view.tau_px &&
           run->cut.stats.triangles > options_integer(run->options, OPTION_MAX_TRIANGLES);
}

static void warn_of_budget(const MeshRun *run) {
    if (is_smallest(run))
        log_warn("--max-triangles %" PRId64 " is below the smallest mesh of this terrain, %" PRId64
                 " triangles; that one is taken",
                 options_integer(run->options, OPTION_MAX_TRIANGLES), run->cut.stats.triangles);
    else
        log_warn("the triangle budget was reached: %.3g px %s instead of %.3g; raise --max-triangles or --tau",
                 run->cut.reached_px, run->cut.promises ? "hold" : "are asked for", run->cut.view.tau_px);
}

// A reached budget leaves a valid cut; its error is in the report.
static Result refine(MeshRun *run) {
    Result result = lod_create(&run->lod_options, run->world.terrain, &run->lod);
    if (result != RESULT_OK)
        return result;
    result = arena_create(FRAME_BLOCK_BYTES, &run->frame);
    if (result != RESULT_OK)
        return result;
    LodView view = world_lod_view(&run->world, run->options, &run->viewpoint);
    int64_t begin_ns = clock_now_ns();
    result = lod_update(run->lod, &view, run->world.jobs, run->frame, &run->cut);
    run->refine_ms = (double)(clock_now_ns() - begin_ns) * 1e-6;
    if (result == RESULT_BUDGET)
        warn_of_budget(run);
    return result == RESULT_BUDGET ? RESULT_OK : result;
}

// The half space ahead, and the four sides of the frustum.
static Result cull(MeshRun *run) {
    Mat3d camera = viewpoint_camera(&run->viewpoint);
    Vec3d right = {camera.m[0][0], camera.m[0][1], camera.m[0][2]};
    Vec3d up = {camera.m[1][0], camera.m[1][1], camera.m[1][2]};
    Vec3d ahead = {-camera.m[2][0], -camera.m[2][1], -camera.m[2][2]};
    Vec3d across = vec3d_scale(ahead, tan_right(run->options)), along = vec3d_scale(ahead, tan_up(run->options));
    Vec3d eye = run->cut.view.eye_ecef;
    const MeshPlane planes[] = {{eye, ahead},
                                {eye, vec3d_add(across, right)},
                                {eye, vec3d_sub(across, right)},
                                {eye, vec3d_add(along, up)},
                                {eye, vec3d_sub(along, up)}};
    return mesh_cull(&run->mesh, planes, COUNT_OF(planes));
}

static Result make_mesh(MeshRun *run) {
    Result result = mesh_from_cut(run->world.terrain, &run->cut, &run->mesh);
    if (result == RESULT_OK && options_flag(run->options, OPTION_CULL))
        result = cull(run);
    if (result == RESULT_OK && run->path)
        result = mesh_write(&run->mesh, run->format, run->path);
    return result;
}

static void add_measured(Json *json, const Measure *m) {
    json_add_number(json, "max_px", m->max_px);
    json_add_number(json, "p999_px", m->p999_px);
    json_add_number(json, "p99_px", m->p99_px);
    json_add_number(json, "rms_px", m->rms_px);
    json_add_number(json, "above_tau_share", m->above_tau_share);
    json_add_integer(json, "t_junctions", m->t_junctions);
    json_add_integer(json, "holes", m->holes);
    json_add_integer(json, "overlaps", m->overlaps);
    json_add_integer(json, "samples", m->samples);
    json_add_numbers(json, "worst_col_row", (double[2]){m->worst_col, m->worst_row}, 2);
}

static void add_split(Json *json, const MeshRun *run) {
    if (run->select)
        json_add_text(json, "select", diamond_select_text(run->select));
    if (run->lod_options.method != LOD_DIAMOND)
        return;
    Json *split = json_add_object(json, "split");
    json_add_integer(split, "chosen", run->cut.stats.chosen);
    json_add_integer(split, "closed", run->cut.stats.closed);
    json_add_number(split, "select_ms", (double)run->cut.stats.select_ns * 1e-6); // evaluation and closure
    json_add_number(split, "triangles_ms", (double)run->cut.stats.refine_ns * 1e-6);
}

static Result print_json(const MeshRun *run) {
    Json *json = json_create();
    json_add_text(json, "file", run->path);
    json_add_text(json, "dem", terrain_dem(run->world.terrain)->file);
    json_add_text(json, "method", lod_method_name(run->lod_options.method));
    json_add_text(json, "error", options_text(run->options, OPTION_ERROR));
    json_add_number(json, "tau_px", run->cut.view.tau_px);
    json_add_number(json, "px_per_rad", run->cut.view.px_per_rad);
    json_add_numbers(json, "eye", (double[3]){run->viewpoint.lat_deg, run->viewpoint.lon_deg, run->viewpoint.alt_m}, 3);
    json_add_bool(json, "culled", options_flag(run->options, OPTION_CULL));
    json_add_integer(json, "triangles", run->mesh.triangle_count);
    json_add_integer(json, "vertices", run->mesh.vertex_count);
    json_add_integer(json, "patches", run->cut.stats.patches);
    json_add_number(json, "refine_ms", run->refine_ms);
    add_split(json, run);
    add_measured(json_add_object(json, "measured"), &run->measure);
    json_add_number(json, "reached_px", run->cut.reached_px);
    json_add_bool(json, "promised", run->cut.promises);
    Result result = json_print(json);
    json_destroy(&json);
    return result;
}

static void print_method(const MeshRun *run) {
    const LodCut *cut = &run->cut;
    printf("method      %s, ", lod_method_name(run->lod_options.method));
    if (run->select)
        printf("%s where '%s'\n", cut->promises ? "refined too" : "refined", diamond_select_text(run->select));
    else if (is_smallest(run))
        printf("tau %g px, not reached: the smallest mesh\n", cut->view.tau_px);
    else
        printf(cut->promises ? "tau %g px, %g px hold\n" : "tau %g px, %g px asked for, none promised\n",
               cut->view.tau_px, cut->reached_px);
    if (run->lod_options.method == LOD_DIAMOND)
        printf("split       %" PRId64 " diamonds chosen, %" PRId64 " with those they need\n", cut->stats.chosen,
               cut->stats.closed);
}

static void print_text(const MeshRun *run) {
    const Measure *m = &run->measure;
    if (run->path)
        printf("file        %s\n", run->path);
    print_method(run);
    printf("mesh        %" PRId64 " triangles, %" PRId64 " vertices%s\n", run->mesh.triangle_count,
           run->mesh.vertex_count, options_flag(run->options, OPTION_CULL) ? " in view" : "");
    printf("patches     %" PRId64 ", refined in %.1f ms\n", run->cut.stats.patches, run->refine_ms);
    printf("measured    max %.4f px, p99.9 %.4f, p99 %.4f, rms %.4f at %" PRId64 " samples; %.4f %% above tau\n",
           m->max_px, m->p999_px, m->p99_px, m->rms_px, m->samples, 100.0 * m->above_tau_share);
    printf("wholeness   %" PRId64 " T-junctions, %" PRId64 " holes, %" PRId64 " overlaps\n", m->t_junctions, m->holes,
           m->overlaps);
}

static Result report(const MeshRun *run) {
    if (options_flag(run->options, OPTION_JSON))
        return print_json(run);
    print_text(run);
    return RESULT_OK;
}

static void run_end(MeshRun *run) {
    mesh_clear(&run->mesh);
    lod_destroy(&run->lod);
    arena_destroy(&run->frame);
    world_unload(&run->world);
    diamond_select_destroy(&run->select);
}

Result cmd_mesh(const Options *options) {
    MeshRun run = {.options = options};
    Result result = check_output(&run);
    if (result == RESULT_OK)
        result = choose_method(&run);
    if (result == RESULT_OK)
        result = world_load(options, &run.world);
    if (result == RESULT_OK)
        result = world_viewpoint(&run.world, options, &run.viewpoint);
    if (result == RESULT_OK)
        world_warn_underground(&run.world, &run.viewpoint);
    if (result == RESULT_OK)
        result = refine(&run);
    if (result == RESULT_OK)
        result = measure_cut(run.world.terrain, &run.cut, run.world.jobs, &run.measure);
    if (result == RESULT_OK)
        result = make_mesh(&run);
    if (result == RESULT_OK)
        result = report(&run);
    run_end(&run);
    return result;
}
