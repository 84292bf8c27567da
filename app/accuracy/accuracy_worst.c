#include "app/accuracy/accuracy_internal.h"
#include "base/log.h"

#include <math.h>
#include <stdlib.h>

static int rank_of(const AccuracyRun *run) {
    return !accuracy_run_holds(run) ? 2 : run->summary.promised ? 1 : 0;
}

// A broken promise before any that was kept, and that before none; else how near it came.
static bool is_worse(const Accuracy *accuracy, const AccuracyRun *run) {
    const AccuracyWorst *worst = &accuracy->worst;
    if (worst->run < 0)
        return true;
    const AccuracyRun *other = &accuracy->runs[worst->run];
    if (rank_of(run) != rank_of(other))
        return rank_of(run) > rank_of(other);
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

static Result measure_again(Accuracy *accuracy, const AccuracyPass *pass, float *error_px) {
    AccuracyWorst *worst = &accuracy->worst;
    const AccuracyFrame *frame = &accuracy->runs[worst->run].frames[worst->frame];
    const MeasureMaps maps = {.error_px = error_px};
    Measure measure;
    LodCut cut = pass->cut;
    if (accuracy->plan.tamper)
        accuracy->plan.tamper(accuracy->plan.tamper_user, pass->world->terrain, &cut);
    Result result = measure_cut_maps(pass->world->terrain, &cut, pass->world->jobs, &maps, &measure);
    worst->repeated = result == RESULT_OK && measure.max_px == frame->measure.max_px;
    if (result != RESULT_OK)
        return result;
    return accuracy_make_heat(pass->world->terrain, error_px, frame, &pass->dem->poses[worst->frame].at, &worst->heat);
}

static Result make_map(Accuracy *accuracy, const AccuracyPass *pass) {
    float *error_px = malloc(sizeof *error_px * (size_t)pass->dem->width * (size_t)pass->dem->height);
    if (!error_px) {
        log_error("bench: no memory to map the worst frame");
        return RESULT_MEMORY;
    }
    Result result = measure_again(accuracy, pass, error_px);
    free(error_px);
    return result;
}

static Result make_picture(Accuracy *accuracy, const AccuracyPass *pass, Context *context) {
    const AccuracyPlan *plan = &accuracy->plan;
    AccuracyHeat *picture = &accuracy->worst.picture;
    free(picture->rgb);
    *picture = (AccuracyHeat){.width = plan->width, .height = plan->height};
    picture->rgb = malloc((size_t)plan->width * (size_t)plan->height * 3);
    if (picture->rgb)
        return draw(accuracy, pass, context, accuracy->worst.frame, picture->rgb);
    log_error("bench: no memory for a picture of %d x %d", plan->width, plan->height);
    return RESULT_MEMORY;
}

static Result show(Accuracy *accuracy, int dem, Context *context) {
    AccuracyPass pass = {.lod = NULL};
    Result result =
        accuracy_pass_begin(&accuracy->plan, &accuracy->dems[dem], &accuracy->runs[accuracy->worst.run], 1, &pass);
    if (result == RESULT_OK)
        result = accuracy_pass_refine(&pass, accuracy->worst.frame);
    if (result == RESULT_OK)
        result = make_map(accuracy, &pass);
    if (result == RESULT_OK && context)
        result = make_picture(accuracy, &pass, context);
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
