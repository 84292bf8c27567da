#include "app/accuracy/accuracy_hitches.h"
#include "app/accuracy/accuracy_report.h"
#include "app/bench/bench.h"
#include "app/version.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

static void add_hash(Json *parent, const char *name, uint64_t hash) {
    char text[24];
    snprintf(text, sizeof text, "%016" PRIx64, hash);
    json_add_text(parent, name, text);
}

static void add_percentiles(Json *parent, const char *name, const AccuracyPercentiles *p) {
    Json *object = json_add_object(parent, name);
    json_add_number(object, "p50", p->p50);
    json_add_number(object, "p95", p->p95);
    json_add_number(object, "p99", p->p99);
    json_add_number(object, "max", p->max);
}

static void add_measured(Json *run, const AccuracySummary *s) {
    Json *measured = json_add_object(run, "measured");
    json_add_number(measured, "max_px", s->max_px);
    json_add_number(measured, "p999_px", s->p999_px);
    json_add_number(measured, "p99_px", s->p99_px);
    json_add_number(measured, "rms_px", s->rms_px);
    json_add_number(measured, "above_tau_share", s->above_tau_share);
    json_add_number(measured, "popping_px", s->popping_px);
    json_add_integer(measured, "popping_pairs", s->popping_pairs);
    json_add_integer(measured, "t_junctions", s->t_junctions);
    json_add_integer(measured, "holes", s->holes);
    json_add_integer(measured, "overlaps", s->overlaps);
}

static void add_times(Json *json, const AccuracySummary *s) {
    add_percentiles(json, "frame_ms", &s->frame_ms);
    add_percentiles(json, "refine_ms", &s->update_ms); // select and refine: all of the refinement
    json_add_numbers(json, "frame_ms_p50_of_rounds", (double[2]){s->frame_p50.least, s->frame_p50.most}, 2);
    json_add_numbers(json, "refine_ms_p50_of_rounds", (double[2]){s->update_p50.least, s->update_p50.most}, 2);
    Json *mean = json_add_object(json, "stages_ms_mean");
    json_add_number(mean, "select", s->mean.select_ms);
    json_add_number(mean, "refine", s->mean.refine_ms);
    json_add_number(mean, "upload", s->mean.upload_ms);
    json_add_number(mean, "draw", s->mean.draw_ms);
}

static void add_worst_frame(Json *json, const Accuracy *accuracy, const AccuracyRun *run) {
    const AccuracyDem *dem = &accuracy->dems[run->dem];
    const AccuracyPose *pose = &dem->poses[run->summary.worst_frame];
    char *command = accuracy_command(accuracy, run, run->summary.worst_frame);
    Json *worst = json_add_object(json, "worst_frame");
    json_add_text(worst, "flight", dem->tracks[pose->flight].name);
    json_add_integer(worst, "frame", pose->number);
    json_add_number(worst, "max_px", run->frames[run->summary.worst_frame].measure.max_px);
    json_add_text(worst, "command", command);
    free(command);
}

static void add_run(Json *runs, const Accuracy *accuracy, const AccuracyRun *run) {
    const AccuracySummary *s = &run->summary;
    const AccuracyVariant *variant = &accuracy->plan.variants[run->variant];
    char fault[ACCURACY_TEXT_BYTES];
    Json *json = json_append_object(runs);
    json_add_text(json, "dem", accuracy->dems[run->dem].name);
    json_add_text(json, "method", lod_method_name(variant->method));
    json_add_text(json, "variant", variant->name);
    json_add_text(json, "error", accuracy->plan.kinds[variant->kind].name);
    json_add_number(json, "tau_px", run->tau_px);
    json_add_number(json, "reached_px", s->reached_px);
    add_measured(json, s);
    json_add_bool(json, "promised", s->promised);
    json_add_bool(json, "promise_held", s->held);
    accuracy_fault(accuracy, run, fault);
    json_add_text(json, "fault", *fault ? fault : NULL);
    json_add_number(json, "triangles_mean", s->triangles_mean);
    json_add_number(json, "retriangulated_share", s->rebuilt_share);
    add_times(json, s);
    json_add_number(json, "upload_bytes_mean", s->upload_bytes_mean);
    json_add_integer(json, "vram_bytes", s->vram_bytes);
    json_add_integer(json, "memory_bytes", s->memory_bytes);
    json_add_bool(json, "measured_what_was_timed", s->same_cuts);
    add_worst_frame(json, accuracy, run);
}

static void add_flights(Json *json, const Accuracy *accuracy, const AccuracyDem *dem) {
    Json *flights = json_add_array(json, "flights");
    for (int i = 0; i < accuracy->plan.flight_count; i++) {
        Json *flight = json_append_object(flights);
        json_add_text(flight, "name", dem->tracks[i].name);
        add_hash(flight, "hash", track_hash(&dem->tracks[i]));
        json_add_number(flight, "duration_s", track_duration_s(&dem->tracks[i]));
    }
}

static void add_hitches(Json *json, const Accuracy *accuracy, int dem) {
    AccuracyHitch hitches[ACCURACY_HITCHES_MAX];
    int found, count = accuracy_hitches(accuracy, dem, hitches, &found);
    json_add_integer(json, "hitch_count", found);
    Json *rows = json_add_array(json, "hitches");
    for (int i = 0; i < count; i++) {
        const AccuracyHitch *hitch = &hitches[i];
        const AccuracyPose *pose = &accuracy->dems[dem].poses[hitch->pose];
        Json *row = json_append_object(rows);
        json_add_text(row, "variant", accuracy->plan.variants[hitch->run->variant].name);
        json_add_number(row, "tau_px", hitch->run->tau_px);
        json_add_text(row, "flight", accuracy->dems[dem].tracks[pose->flight].name);
        json_add_integer(row, "frame", pose->number);
        json_add_number(row, "times_p50", hitch->times);
        json_add_text(row, "cause", hitch->cause);
    }
}

static void add_dem(Json *dems, const Accuracy *accuracy, int index) {
    const AccuracyDem *dem = &accuracy->dems[index];
    Json *json = json_append_object(dems);
    json_add_text(json, "name", dem->name);
    json_add_integer(json, "width", dem->width);
    json_add_integer(json, "height", dem->height);
    json_add_numbers(json, "spacing_m", dem->spacing_m, 2);
    json_add_text(json, "datum", dem->datum);
    add_hash(json, "hash", dem->hash);
    json_add_integer(json, "eyes_off_it", dem->off_count);
    json_add_integer(json, "eyes_under_ground", dem->under_count);
    json_add_integer(json, "frames", dem->pose_count);
    add_flights(json, accuracy, dem);
    add_hitches(json, accuracy, index);
    Json *kinds = json_add_array(json, "preprocessing");
    for (int i = 0; i < accuracy->plan.kind_count; i++) {
        Json *kind = json_append_object(kinds);
        json_add_text(kind, "error", accuracy->plan.kinds[i].name);
        json_add_number(kind, "ms", dem->build_ms[i][0]);
        json_add_numbers(kind, "ms_of_rounds", &dem->build_ms[i][1], 2);
    }
}

static void add_setting(Json *json, const Accuracy *accuracy) {
    const AccuracyPlan *plan = &accuracy->plan;
    json_add_text(json, "version", version_text());
    json_add_integer(json, "unix_s", accuracy->unix_s);
    json_add_bool(json, "quick", plan->quick);
    json_add_text(json, "renderer", *accuracy->renderer ? accuracy->renderer : NULL);
    json_add_bool(json, "software", accuracy->software);
    json_add_integer(json, "threads", accuracy->threads);
    json_add_number(json, "load_average", accuracy->load);
    json_add_number(json, "wall_s", accuracy->wall_s);
    json_add_numbers(json, "size_px", (double[2]){plan->width, plan->height}, 2);
    json_add_number(json, "fov_deg", options_number(plan->options, OPTION_FOV));
    json_add_number(json, "px_per_rad", accuracy_px_per_rad(plan));
    json_add_text(json, "bound", options_text(plan->options, OPTION_BOUND));
    json_add_integer(json, "max_triangles", options_integer(plan->options, OPTION_MAX_TRIANGLES));
    json_add_text(json, "options_given", accuracy->given);
    json_add_text(json, "system", accuracy->system);
    json_add_number(json, "memory_gb", accuracy->memory_gb);
    json_add_integer(json, "rounds", plan->rounds);
    json_add_integer(json, "frames_a_burst", ACCURACY_BURST);
    json_add_integer(json, "frames_a_stretch", plan->stretch);
}

static void add_equal_errors(Json *json, const Accuracy *accuracy) {
    Json *rows = json_add_array(json, "at_equal_measured_error");
    for (int dem = 0; dem < accuracy->plan.dem_count; dem++)
        for (int tau = 0; tau < accuracy->plan.tau_count; tau++)
            for (int variant = 0; variant < accuracy->plan.variant_count; variant++) {
                AccuracyCost cost = accuracy_cost_at(accuracy, dem, variant, accuracy->plan.tau_px[tau]);
                if (!isfinite(cost.frame_ms))
                    continue;
                Json *row = json_append_object(rows);
                json_add_text(row, "dem", accuracy->dems[dem].name);
                json_add_text(row, "variant", accuracy->plan.variants[variant].name);
                json_add_number(row, "measured_max_px", accuracy->plan.tau_px[tau]);
                json_add_number(row, "frame_ms", cost.frame_ms);
                json_add_numbers(row, "frame_ms_of_rounds", (double[2]){cost.frame_least_ms, cost.frame_most_ms}, 2);
                json_add_number(row, "refine_ms", cost.update_ms);
                json_add_number(row, "triangles", cost.triangles);
            }
}

static void add_scaling(Json *json, const AccuracyScaling *scaling) {
    Json *rows = json_add_array(json, "workers");
    for (int i = 0; i < scaling->speed_count; i++) {
        const AccuracySpeed *speed = &scaling->speeds[i];
        Json *row = json_append_object(rows);
        json_add_text(row, "method", lod_method_name(speed->method));
        json_add_integer(row, "threads", speed->threads);
        json_add_number(row, "refine_ms", speed->ms);
        json_add_numbers(row, "refine_ms_of_rounds", (double[2]){speed->least_ms, speed->most_ms}, 2);
        json_add_number(row, "speedup", speed->speedup);
        json_add_numbers(row, "speedup_of_rounds", (double[2]){speed->least_speedup, speed->most_speedup}, 2);
    }
}

Json *accuracy_make_json(const Accuracy *accuracy) {
    char verdict[ACCURACY_TEXT_BYTES];
    Json *json = json_create();
    bench_add_machine(json);
    add_setting(json, accuracy);
    Json *dems = json_add_array(json, "dems");
    for (int dem = 0; dem < accuracy->plan.dem_count; dem++)
        add_dem(dems, accuracy, dem);
    Json *runs = json_add_array(json, "runs");
    for (int i = 0; i < accuracy->run_count; i++)
        add_run(runs, accuracy, &accuracy->runs[i]);
    add_equal_errors(json, accuracy);
    add_scaling(json, &accuracy->scaling);
    bench_add_preprocess(json, "preprocessing", &accuracy->scaling.preprocess);
    accuracy_verdict(accuracy, verdict);
    json_add_text(json, "verdict", verdict);
    json_add_bool(json, "promises_held", accuracy_holds(accuracy));
    json_add_bool(json, "interrupted", accuracy_is_interrupted(accuracy));
    json_add_integer(json, "dems_planned", accuracy->dems_planned);
    return json;
}
