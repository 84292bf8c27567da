#include "app/reproduce/reproduce_circuit.h"
#include "app/reproduce/reproduce_race.h"
#include "base/clock.h"
#include "render/render.h"

#include <math.h>

#define SUN_HEADING_DEG 300.0
#define SUN_HEIGHT_DEG 35.0

static RenderPacket make_packet(const Racer *racer, const RaceStage *stage, const Viewpoint *at) {
    Viewpoint towards_sun = *at;
    towards_sun.heading_deg = SUN_HEADING_DEG;
    towards_sun.pitch_deg = SUN_HEIGHT_DEG;
    RenderCamera camera = {racer->cut.view.eye_ecef, viewpoint_camera(at), stage->fov_y_rad};
    return (RenderPacket){.cut = racer->cut, .camera = camera, .sun_ecef = viewpoint_forward(&towards_sun)};
}

static Result draw_view(Racer *racer, Renderer *renderer, const RaceStage *stage, const Viewpoint *at, bool counted) {
    LodView view = circuit_view(at, stage->height / (2.0 * tan(0.5 * stage->fov_y_rad)), stage->tau_px);
    double ms;
    Result result = racer_refine(racer, &view, &ms);
    if (result != RESULT_OK)
        return result;
    RenderPacket packet = make_packet(racer, stage, at);
    RenderStats stats;
    int64_t begin = clock_now_ns();
    result = render_frame(renderer, &packet, &stats);
    ms += (double)(clock_now_ns() - begin) * 1e-6;
    if (result == RESULT_OK && counted) {
        racer->drawn_ms += ms;
        racer->drawn_triangles += (double)stats.triangles_drawn;
        racer->drawn++;
    }
    return result;
}

static Result draw_views(Race *race, Renderer *renderer, const RaceStage *stage, const Viewpoint *views, int count) {
    Result result = RESULT_OK;
    for (int view = 0; view < count; view++)
        for (int i = 0; i < race->count && result == RESULT_OK; i++)
            result = draw_view(&race->racers[i], renderer, stage, &views[view], view > 0);
    return result;
}

Result race_draw(Race *race, const RaceStage *stage, const Viewpoint *views, int count) {
    RenderOptions options = render_default_options();
    options.width = stage->width;
    options.height = stage->height;
    options.vram_bytes_max = stage->vram_bytes_max;
    options.measure_times = true; // a frame is over when it is drawn, not when it is ordered
    options.samples = 1;
    Renderer *renderer = NULL;
    Result result = context_make_current(stage->context);
    if (result != RESULT_OK)
        return result;
    result = render_create(&options, race->terrain, &renderer);
    if (result == RESULT_OK)
        result = draw_views(race, renderer, stage, views, count);
    if (renderer)
        render_destroy(&renderer);
    context_release_current(stage->context);
    return result;
}
