// Times of one DEM's runs. A round flies every run once, the methods of one tolerance after another; who begins changes
// from round to round, so that a busy machine harms all alike. Nothing is measured in these passes but time.
#include "app/accuracy/accuracy_internal.h"
#include "app/bench/bench.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/statistics.h"

#include <stddef.h>
#include <stdlib.h>

typedef struct Timing {
    Accuracy *accuracy;
    int dem;
    Context *context;                        // NULL: nothing is drawn
    Renderer *renderers[ACCURACY_KINDS_MAX]; // of each kind's terrain
    AccuracyTimes *times;                    // [run of the DEM][round][pose]
    double *prepare_ms;                      // [run of the DEM][round]
    uint32_t serial;
    Progress progress;
    int passes, passes_done;
} Timing;

static Result draw(const AccuracyPass *pass, Renderer *renderer, int pose, RenderStats *stats) {
    RenderPacket packet = accuracy_packet(pass, pose);
    return render_frame(renderer, &packet, stats);
}

// What is not a time is kept in the first round, and compared in the others.
static void keep_counts(const AccuracyPass *pass, const RenderStats *stats, int round, AccuracyRun *run, int pose) {
    AccuracyFrame *frame = &run->frames[pose];
    uint64_t outline = accuracy_cut_outline(&pass->cut);
    if (round > 0) {
        run->summary.same_cuts = run->summary.same_cuts && outline == frame->cut_outline;
        return;
    }
    const LodStats *lod = &pass->cut.stats;
    frame->cut_outline = outline;
    frame->triangles = lod->triangles;
    frame->patches = lod->patches;
    frame->vertices = lod->vertices;
    frame->index_bytes = lod->index_bytes;
    frame->rebuilt_share = lod->triangles ? (double)lod->triangles_rebuilt / (double)lod->triangles : 0.0;
    frame->upload_bytes = stats->upload_bytes;
    frame->vram_bytes = stats->vram_bytes;
    frame->memory_bytes = bench_resident_bytes() - pass->bytes_before;
}

static Result fly_frame(const Timing *timing, AccuracyPass *pass, AccuracyRun *run, int round, int pose,
                        AccuracyTimes *times) {
    Renderer *renderer = timing->renderers[timing->accuracy->plan.variants[run->variant].kind];
    RenderStats stats = {0};
    int64_t begin = clock_now_ns();
    Result result = accuracy_pass_refine(pass, pose);
    if (result == RESULT_OK && renderer)
        result = draw(pass, renderer, pose, &stats);
    times->frame_ms = (double)(clock_now_ns() - begin) * 1e-6;
    times->select_ms = (double)pass->cut.stats.select_ns * 1e-6;
    times->refine_ms = (double)pass->cut.stats.refine_ns * 1e-6;
    times->upload_ms = stats.upload_ms;
    times->draw_ms = stats.draw_ms;
    if (result == RESULT_OK)
        keep_counts(pass, &stats, round, run, pose);
    return result;
}

static Result fly(Timing *timing, int run_of_dem, int round) {
    Accuracy *accuracy = timing->accuracy;
    const AccuracyPlan *plan = &accuracy->plan;
    const AccuracyDem *dem = &accuracy->dems[timing->dem];
    AccuracyRun *run = &accuracy->runs[timing->dem * plan->variant_count * plan->tau_count + run_of_dem];
    AccuracyTimes *times =
        timing->times + ((size_t)run_of_dem * (size_t)plan->rounds + (size_t)round) * (size_t)dem->pose_count;
    AccuracyPass pass = {.lod = NULL};
    Renderer *renderer = timing->renderers[plan->variants[run->variant].kind];
    if (renderer)
        render_forget_patches(renderer);
    Result result = accuracy_pass_begin(plan, dem, run, ++timing->serial, &pass);
    for (int pose = 0; pose < dem->pose_count && result == RESULT_OK && accuracy_goes_on(accuracy); pose++)
        result = fly_frame(timing, &pass, run, round, pose, &times[pose]);
    timing->prepare_ms[run_of_dem * plan->rounds + round] = (double)pass.prepare_ns * 1e-6;
    accuracy_pass_end(&pass);
    progress_update(&timing->progress, (double)++timing->passes_done / timing->passes);
    return result;
}

static Result fly_round(Timing *timing, int round) {
    const AccuracyPlan *plan = &timing->accuracy->plan;
    Result result = RESULT_OK;
    for (int tau = 0; tau < plan->tau_count; tau++)
        for (int i = 0; i < plan->variant_count && result == RESULT_OK && accuracy_goes_on(timing->accuracy); i++) {
            int variant = (i + round) % plan->variant_count;
            result = fly(timing, variant * plan->tau_count + tau, round);
        }
    return result;
}

static Result create_renderers(Timing *timing) {
    const AccuracyPlan *plan = &timing->accuracy->plan;
    const AccuracyDem *dem = &timing->accuracy->dems[timing->dem];
    Result result = context_make_current(timing->context);
    for (int kind = 0; kind < plan->kind_count && result == RESULT_OK; kind++)
        result = accuracy_renderer(plan, &dem->worlds[kind], &timing->renderers[kind]);
    return result;
}

static void destroy_renderers(Timing *timing) {
    for (int kind = 0; kind < ACCURACY_KINDS_MAX; kind++)
        render_destroy(&timing->renderers[kind]);
    if (timing->context)
        context_release_current(timing->context);
}

static void summarize_beginnings(const Timing *timing) {
    const AccuracyPlan *plan = &timing->accuracy->plan;
    AccuracyDem *dem = &timing->accuracy->dems[timing->dem];
    int count = plan->tau_count * plan->rounds;
    for (int i = 0; i < plan->variant_count; i++) {
        double *ms = timing->prepare_ms + (ptrdiff_t)i * count;
        statistics_sort(ms, count);
        dem->begin_ms[i] = statistics_percentile(ms, count, 0.5);
        if (accuracy_is_nested(plan->variants[i].method))
            dem->begin_ms[i] += dem->build_ms[plan->variants[i].kind][0];
    }
}

Result accuracy_time(Accuracy *accuracy, int dem, Context *context) {
    const AccuracyPlan *plan = &accuracy->plan;
    Timing timing = {.accuracy = accuracy, .dem = dem, .context = context};
    int runs = plan->variant_count * plan->tau_count;
    size_t count = (size_t)runs * (size_t)plan->rounds * (size_t)accuracy->dems[dem].pose_count;
    timing.passes = runs * plan->rounds;
    timing.times = calloc(count, sizeof *timing.times);
    timing.prepare_ms = calloc((size_t)timing.passes, sizeof *timing.prepare_ms);
    Result result = timing.times && timing.prepare_ms ? RESULT_OK : RESULT_MEMORY;
    if (result == RESULT_MEMORY)
        log_error("bench: no memory for the times of %zu frames", count);
    if (result == RESULT_OK && context)
        result = create_renderers(&timing);
    timing.progress = progress_begin("timing");
    for (int round = 0; round < plan->rounds && result == RESULT_OK && accuracy_goes_on(accuracy); round++) {
        result = fly_round(&timing, round);
        if (result == RESULT_OK && round == 0 && dem == 0)
            result = accuracy_estimate(accuracy, dem, (double)(clock_now_ns() - timing.progress.begin_ns) * 1e-9);
    }
    progress_end(&timing.progress);
    destroy_renderers(&timing);
    if (result == RESULT_OK && accuracy_goes_on(accuracy))
        result = accuracy_summarize_times(accuracy, dem, timing.times);
    if (result == RESULT_OK && accuracy_goes_on(accuracy))
        summarize_beginnings(&timing);
    free(timing.times);
    free(timing.prepare_ms);
    return result;
}
