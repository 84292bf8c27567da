#include "app/flight_report.h"

#include "app/json.h"
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
    json_add_text(json, "method", lod_method_name(settings->method));
    json_add_number(json, "tau_px", settings->tau_px);
    json_add_number(json, "fov_deg", degrees(settings->fov_rad));
    json_add_text(json, "view", camera_view_name(settings->view));
    json_add_text(json, "colouring", flight_colouring_name(settings->colouring));
    json_add_bool(json, "wireframe", settings->wireframe);
    json_add_bool(json, "hud", settings->show_flight);
    json_add_bool(json, "numbers", settings->show_numbers);
    json_add_bool(json, "help", settings->show_help);
    json_add_number(json, "time_rate", flight_clock_rate(&settings->clock));
    json_add_bool(json, "paused", settings->clock.paused);
}

static void add_times(Json *json, const char *name, FrameTimesSummary times) {
    Json *object = json_add_object(json, name);
    json_add_number(object, "mean", times.mean);
    json_add_number(object, "p50", times.p50);
    json_add_number(object, "p95", times.p95);
    json_add_number(object, "p99", times.p99);
    json_add_number(object, "max", times.max);
}

static void add_frames(Json *json, const PipelineStats *stats, const PipelineTimes *times) {
    double frames = stats->frames > 0 ? (double)stats->frames : NAN;
    json_add_integer(json, "frames", stats->frames);
    json_add_integer(json, "triangles", stats->lod.triangles);
    json_add_number(json, "triangles_mean", (double)stats->triangles_sum / frames);
    json_add_integer(json, "patches", stats->lod.patches);
    json_add_integer(json, "patches_reused", stats->lod.patches_reused);
    json_add_integer(json, "triangles_drawn", stats->render.triangles_drawn);
    json_add_number(json, "reached_px", stats->reached_px);
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
    add_aircraft(json, report->session);
    add_settings(json, &report->session->settings);
    Result result = json_print(json);
    json_destroy(&json);
    return result;
}

void flight_report_log(const FlightReport *report) {
    const PipelineStats *stats = &report->stats;
    FrameTimesSummary frame = report->times.frame;
    log_info("%lld frames; %.1f ms a frame (p99 %.1f, longest %.1f); last cut: %lld triangles in %lld patches, "
             "error at most %.2f px",
             (long long)stats->frames, frame.mean, frame.p99, frame.max, (long long)stats->lod.triangles,
             (long long)stats->lod.patches, stats->reached_px);
}
