#include "app/flight/flight_report.h"

#include "app/compute.h"
#include "app/json.h"
#include "app/live/live_report.h"
#include "base/log.h"
#include "terrain/geodesy.h"

static double degrees(double radians) {
    return radians / GEODESY_RAD_PER_DEG;
}

static const char *contact_name(FlightContact contact) {
    return contact == FLIGHT_CRASHED ? "crashed" : contact == FLIGHT_ROLLING ? "rolling" : "airborne";
}

static void add_aircraft(Json *json, const FlightSession *session) {
    FlightInstruments now = flight_instruments(&session->flight);
    json_add_text(json, "aircraft", session->aircraft.id);
    json_add_integer(json, "steps", session->flight.state.step);
    json_add_number(json, "lat_deg", degrees(now.lat_rad));
    json_add_number(json, "lon_deg", degrees(now.lon_rad));
    json_add_number(json, "alt_m", session_altitude_m(session, &now));
    json_add_text(json, "datum", "EGM96");
    json_add_number(json, "above_ground_m", now.over_ground ? now.above_ground_m : NAN);
    json_add_number(json, "heading_deg", degrees(now.heading_rad));
    json_add_number(json, "pitch_deg", degrees(now.pitch_rad));
    json_add_number(json, "bank_deg", degrees(now.bank_rad));
    json_add_number(json, "speed_m_s", now.speed_m_s);
    json_add_number(json, "vertical_speed_m_s", now.vertical_speed_m_s);
    json_add_number(json, "throttle", session->flight.state.throttle);
    json_add_text(json, "contact", contact_name(session->flight.state.contact));
    json_add_integer(json, "crashes", session->crashes);
    json_add_bool(json, "demo", session->demo_flies);
}

static void add_settings(Json *json, const FlightSettings *settings) {
    json_add_number(json, "tau_px", settings->tau_px);
    json_add_bool(json, "compare_wanted", settings->compare);
    json_add_number(json, "fov_deg", degrees(settings->fov_rad));
    json_add_text(json, "view", camera_view_name(settings->view));
    json_add_text(json, "colouring", flight_colouring_name(settings->colouring));
    json_add_bool(json, "wireframe", settings->wireframe);
    json_add_bool(json, "hud", settings->show_flight);
    json_add_bool(json, "numbers", settings->show_numbers);
    json_add_bool(json, "help", settings->show_help);
    json_add_bool(json, "accuracy_panel", settings->show_accuracy);
    json_add_number(json, "time_rate", flight_clock_rate(&settings->clock));
    json_add_bool(json, "paused", settings->clock.paused);
}

static void add_governor(Json *json, const FlightSession *session) {
    if (!(session->settings.target_ms > 0.0))
        return;
    const Governor *governor = &session->governor;
    json_add_number(json, "target_ms", session->settings.target_ms);
    Json *object = json_add_object(json, "governed");
    json_add_bool(object, "settled", governor->settled);
    json_add_bool(object, "reachable", governor->reach == GOVERNOR_IN_REACH);
    json_add_text(object, "reach", governor_reach_name(governor->reach));
    json_add_integer(object, "changes", governor->changes);
    json_add_integer(object, "changes_settled", governor->changes_settled);
}

static void add_times(Json *json, const char *name, FrameTimesSummary times) {
    Json *object = json_add_object(json, name);
    json_add_number(object, "mean", times.mean);
    json_add_number(object, "p50", times.p50);
    json_add_number(object, "p95", times.p95);
    json_add_number(object, "p99", times.p99);
    json_add_number(object, "max", times.max);
}

static void add_cut(Json *json, const PipelineCut *cut, int64_t triangles_drawn) {
    json_add_text(json, "method", lod_method_name(cut->method));
    json_add_integer(json, "triangles", cut->lod.triangles);
    json_add_integer(json, "patches", cut->lod.patches);
    json_add_integer(json, "patches_reused", cut->lod.patches_reused);
    json_add_integer(json, "partitions", cut->lod.partitions);
    json_add_number(json, "balance", cut->lod.balance);
    json_add_integer(json, "triangles_drawn", triangles_drawn);
    json_add_number(json, "reached_px", cut->reached_px);
    json_add_bool(json, "promises", cut->promises);
}

// Of the right half, in the last frame drawn; its times are of all frames that had one.
static void add_right(Json *json, const PipelineStats *stats, const PipelineTimes *times) {
    json_add_bool(json, "compare", stats->split);
    json_add_integer(json, "frames_compared", stats->frames_split);
    if (!stats->split)
        return;
    Json *right = json_add_object(json, "right");
    add_cut(right, &stats->right, stats->render.right.triangles_drawn);
    compute_add_json(right, &stats->render.right.resident);
    add_times(right, "refine_ms", times->right_refine);
    add_times(right, "upload_ms", times->right_upload);
    add_times(right, "draw_ms", times->right_draw);
}

static void add_changes(Json *json, const PipelineStats *stats) {
    json_add_integer(json, "method_changes", stats->changes.changes);
    json_add_integer(json, "method_refusals", stats->changes.refusals);
    json_add_number(json, "longest_create_ms", stats->changes.longest_create_ms);
    json_add_number(json, "longest_gpu_create_ms", stats->longest_gpu_create_ms);
    json_add_integer(json, "gpu_refusals", stats->changes.fallbacks);
    json_add_number(json, "longest_first_refine_ms", stats->changes.longest_first_refine_ms);
    json_add_number(json, "longest_frame_ms", stats->longest_frame_ms);
    Json *frames = json_add_object(json, "frames_by_method");
    for (int i = 0; i < LOD_METHOD_COUNT; i++)
        if (stats->frames_by_method[i] > 0)
            json_add_integer(frames, lod_method_name((LodMethod)i), stats->frames_by_method[i]);
}

static void add_frames(Json *json, const PipelineStats *stats, const PipelineTimes *times) {
    double frames = stats->frames > 0 ? (double)stats->frames : NAN;
    json_add_integer(json, "frames", stats->frames);
    add_cut(json, &stats->cut, stats->render.triangles_drawn);
    compute_add_json(json, &stats->render.resident);
    json_add_number(json, "triangles_mean", (double)stats->triangles_sum / frames);
    json_add_integer(json, "vram_bytes", stats->render.vram_bytes);
    add_times(json, "frame_ms", times->frame);
    add_times(json, "refine_ms", times->refine);
    add_times(json, "upload_ms", times->upload);
    add_times(json, "draw_ms", times->draw);
}

Result flight_report_json(const FlightReport *report) {
    Json *json = json_create();
    json_add_text(json, "scene", report->session->world->scene.name);
    json_add_text(json, "dem", terrain_dem(report->session->world->terrain)->file);
    json_add_bool(json, "window", report->window);
    json_add_text(json, "renderer", context_renderer_name(report->context));
    json_add_bool(json, "software", context_is_software(report->context));
    add_frames(json, &report->stats, &report->times);
    add_changes(json, &report->stats);
    add_right(json, &report->stats, &report->times);
    add_aircraft(json, report->session);
    add_settings(json, &report->session->settings);
    add_governor(json, report->session);
    live_report_add(json, report->accuracy);
    Result result = json_print(json);
    json_destroy(&json);
    return result;
}

static void log_governor(const FlightSession *session) {
    const Governor *governor = &session->governor;
    if (!(session->settings.target_ms > 0.0))
        return;
    if (governor->reach == GOVERNOR_IN_REACH)
        log_info("target %.1f ms: affords %.2f px%s", session->settings.target_ms, governor->tau_px,
                 governor->settled ? ", settled" : "");
    else if (governor->reach == GOVERNOR_NOT_MET)
        log_info("target %.1f ms: not met, though %.2f px was settled on; frames take longer than when it was",
                 session->settings.target_ms, governor->tau_px);
    else
        log_info("target %.1f ms: out of reach, %s", session->settings.target_ms,
                 governor->reach == GOVERNOR_TOO_SLOW ? "too slow at any tolerance" : "faster at any tolerance");
}

void flight_report_log(const FlightReport *report) {
    const PipelineStats *stats = &report->stats;
    FrameTimesSummary frame = report->times.frame;
    log_info("%lld frame%s; %.1f ms a frame (p99 %.1f, longest %.1f)", (long long)stats->frames,
             stats->frames == 1 ? "" : "s", frame.mean, frame.p99, frame.max);
    log_governor(report->session);
    pipeline_cut_log(stats->split ? "left" : "last cut", &stats->cut);
    if (stats->split)
        pipeline_cut_log("right", &stats->right);
}
