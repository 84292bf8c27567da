#include "app/accuracy/accuracy_internal.h"
#include "base/log.h"

#include <math.h>
#include <stdlib.h>

// A broken promise before any that was kept; else how near it came.
static bool is_worse(const Accuracy *accuracy, const AccuracyRun *run) {
    const AccuracyWorst *worst = &accuracy->worst;
    if (accuracy_run_holds(run) && !run->summary.promised)
        return false;
    if (worst->run < 0)
        return true;
    const AccuracyRun *other = &accuracy->runs[worst->run];
    if (accuracy_run_holds(run) != accuracy_run_holds(other))
        return !accuracy_run_holds(run);
    return accuracy_badness(&run->frames[run->summary.worst_frame]) > accuracy_badness(&other->frames[worst->frame]);
}

static Result draw(const Accuracy *accuracy, const AccuracyPass *pass, Context *context, int pose, uint8_t *rgb) {
    Renderer *renderer = NULL;
    RenderStats stats;
    RenderPacket packet = accuracy_packet(pass, pose);
    Result result = context_make_current(context);
    if (result == RESULT_OK)
        result = accuracy_renderer(&accuracy->plan, pass->world, &renderer);
    if (result == RESULT_OK)
        result = render_frame(renderer, &packet, &stats);
    if (result == RESULT_OK)
        result = render_read_pixels(renderer, rgb);
    render_destroy(&renderer);
    context_release_current(context);
    return result;
}

static Result make_room(const AccuracyPlan *plan, const AccuracyDem *dem, bool picture, AccuracyWorst *worst) {
    free(worst->error_px);
    free(worst->picture);
    worst->picture = NULL;
    worst->error_px = malloc(sizeof *worst->error_px * (size_t)dem->width * (size_t)dem->height);
    if (picture)
        worst->picture = malloc((size_t)plan->width * (size_t)plan->height * 3);
    if (worst->error_px && (worst->picture || !picture))
        return RESULT_OK;
    log_error("bench: no memory to show the worst frame");
    return RESULT_MEMORY;
}

static Result measure_again(Accuracy *accuracy, AccuracyPass *pass) {
    AccuracyWorst *worst = &accuracy->worst;
    const AccuracyFrame *frame = &accuracy->runs[worst->run].frames[worst->frame];
    const MeasureMaps maps = {.error_px = worst->error_px};
    Measure measure;
    LodCut cut = pass->cut;
    if (accuracy->plan.tamper)
        accuracy->plan.tamper(accuracy->plan.tamper_user, pass->world->terrain, &cut);
    Result result = measure_cut_maps(pass->world->terrain, &cut, pass->world->jobs, &maps, &measure);
    worst->repeated = result == RESULT_OK && measure.max_px == frame->measure.max_px;
    return result;
}

static Result show(Accuracy *accuracy, int dem, Context *context) {
    AccuracyWorst *worst = &accuracy->worst;
    const AccuracyRun *run = &accuracy->runs[worst->run];
    AccuracyPass pass = {.lod = NULL};
    Result result = make_room(&accuracy->plan, &accuracy->dems[dem], context != NULL, worst);
    if (result == RESULT_OK)
        result = accuracy_pass_begin(&accuracy->plan, &accuracy->dems[dem], run, 1, &pass);
    if (result == RESULT_OK)
        result = accuracy_pass_refine(&pass, worst->frame);
    if (result == RESULT_OK)
        result = measure_again(accuracy, &pass);
    if (result == RESULT_OK && context)
        result = draw(accuracy, &pass, context, worst->frame, worst->picture);
    accuracy_pass_end(&pass);
    return result;
}

Result accuracy_keep_worst(Accuracy *accuracy, int dem, Context *context) {
    int count = accuracy->plan.variant_count * accuracy->plan.tau_count;
    bool found = false;
    for (int i = dem * count; i < (dem + 1) * count; i++) {
        if (!is_worse(accuracy, &accuracy->runs[i]))
            continue;
        accuracy->worst.run = i;
        accuracy->worst.frame = accuracy->runs[i].summary.worst_frame;
        found = true;
    }
    return found ? show(accuracy, dem, context) : RESULT_OK;
}
