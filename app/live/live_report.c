#include "app/live/live_report.h"

#include <math.h>

static const char *state_name(RenderAccuracyState state) {
    static const char *const NAMES[RENDER_ACCURACY_STATE_COUNT] = {"not yet",   "so far",    "measured", "on the GPU",
                                                                   "not whole", "too large", "failed"};
    return NAMES[state];
}

static void add_measured(Json *parent, const RenderAccuracyError *error) {
    Json *object = json_add_object(parent, "measured");
    json_add_text(object, "state", state_name(error->state));
    if (error->state != RENDER_ACCURACY_MEASURED && error->state != RENDER_ACCURACY_SO_FAR)
        return;
    json_add_number(object, "max_px", error->max_px);
    json_add_number(object, "share", error->share);
    if (error->state == RENDER_ACCURACY_SO_FAR)
        return;
    json_add_number(object, "p999_px", error->p999_px);
    json_add_number(object, "above_tau_share", error->above_tau_share);
    json_add_integer(object, "cracks", error->cracks);
    json_add_number(object, "tau_px", error->tau_px);
    json_add_number(object, "promised_px", error->promises ? error->promised_px : (double)NAN);
    json_add_number(object, "age_s", error->age_s);
}

static void add_curve(Json *parent, const RenderAccuracy *shown) {
    json_add_bool(parent, "slope_known", shown->slope_known);
    Json *curve = json_add_array(parent, "curve");
    for (int i = 0; i < shown->point_count; i++) {
        const RenderAccuracyPoint *point = &shown->points[i];
        Json *object = json_append_object(curve);
        json_add_number(object, "tau_px", (double)point->tau_px);
        json_add_number(object, "frame_ms", (double)point->frame_ms);
        json_add_bool(object, "flown", point->flown);
        if (point->flown)
            continue;
        json_add_number(object, "least_ms", (double)point->least_ms);
        json_add_number(object, "most_ms", (double)point->most_ms);
    }
}

static void add_stack(Json *parent, const RenderAccuracyFrame *mean) {
    Json *object = json_add_object(parent, "stack");
    json_add_number(object, "select_ms", (double)mean->select_ms);
    json_add_number(object, "refine_ms", (double)mean->refine_ms);
    json_add_number(object, "upload_ms", (double)mean->upload_ms);
    json_add_number(object, "draw_ms", (double)mean->draw_ms);
}

void live_report_add(Json *parent, const RenderAccuracy *shown) {
    if (!shown->show)
        return;
    Json *object = json_add_object(parent, "accuracy");
    json_add_number(object, "tau_px", shown->tau_px);
    json_add_number(object, "frame_ms", shown->frame_ms);
    json_add_number(object, "p50", shown->p50_ms);
    json_add_number(object, "p99", shown->p99_ms);
    add_measured(object, &shown->error);
    add_curve(object, shown);
    add_stack(object, &shown->mean);
}
