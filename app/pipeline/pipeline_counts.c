#include "app/pipeline/pipeline_counts.h"

#include "base/log.h"

#define RECENT_FRAMES 240 // for the percentile on the screen
#define RECENT_EVERY 16
#define MS_PER_NS 1e-6

static PipelineCut cut_of(const LodCut *cut, LodMethod method) {
    return (PipelineCut){method, cut->stats, cut->reached_px, cut->promises};
}

static double refine_ms(const LodCut *cut) {
    return (double)(cut->stats.select_ns + cut->stats.refine_ns) * MS_PER_NS;
}

static void add_frame_time(PipelineCounts *counts, int64_t now_ns) {
    PipelineStats *stats = &counts->stats;
    if (counts->last_end_ns != 0) {
        stats->frame_ms = (double)(now_ns - counts->last_end_ns) * MS_PER_NS;
        frame_times_add(&counts->frame, stats->frame_ms);
        stats->longest_frame_ms = counts->frame.max_ms;
    }
    counts->last_end_ns = now_ns;
    if (stats->frames % RECENT_EVERY == 1)
        stats->frame_p99_ms = frame_times_summary(&counts->frame, RECENT_FRAMES).p99;
}

static LodCut told_cut(const LodCut *cut, const RenderResident *resident, bool partial) {
    LodCut told = *cut;
    render_tell_cut(resident, partial, &told);
    return told;
}

static void add_creation(PipelineStats *stats, const RenderResident *resident) {
    if (resident->create_ms > stats->longest_gpu_create_ms)
        stats->longest_gpu_create_ms = resident->create_ms;
}

static void add_right(PipelineCounts *counts, const LodCut *right, LodMethod method, const RenderCutStats *render) {
    const LodCut cut = told_cut(right, &render->resident, render->partial);
    counts->stats.right = cut_of(&cut, method);
    counts->stats.frames_split++;
    counts->stats.frames_by_method[method]++;
    add_creation(&counts->stats, &render->resident);
    frame_times_add(&counts->right_refine, refine_ms(&cut));
    frame_times_add(&counts->right_upload, render->upload_ms);
    frame_times_add(&counts->right_draw, render->draw_ms);
}

static void keep_frame(PipelineCounts *counts, const LodCut *cut, const RenderStats *render, int64_t now_ns) {
    const PipelineStats *stats = &counts->stats;
    counts->frames[stats->frames % PIPELINE_FRAMES_KEPT] =
        (PipelineFrame){.number = stats->frames,
                        .end_ns = now_ns,
                        .method = stats->cut.method,
                        .tau_px = cut->view.tau_px,
                        .px_per_rad = cut->view.px_per_rad,
                        .split = stats->split,
                        .select_ms = (float)((double)cut->stats.select_ns * MS_PER_NS),
                        .refine_ms = (float)((double)cut->stats.refine_ns * MS_PER_NS),
                        .upload_ms = (float)render->upload_ms,
                        .draw_ms = (float)render->draw_ms,
                        .frame_ms = stats->frames > 1 ? (float)stats->frame_ms : 0.0f,
                        .triangles_drawn = render->triangles_drawn};
}

int pipeline_counts_frames(const PipelineCounts *counts, int64_t after, PipelineFrame *out, int max) {
    int64_t last = counts->stats.frames, count = last - after;
    int64_t most = max < PIPELINE_FRAMES_KEPT ? max : PIPELINE_FRAMES_KEPT;
    count = count > most ? most : count;
    for (int64_t i = 0; i < count; i++)
        out[i] = counts->frames[(last - count + 1 + i) % PIPELINE_FRAMES_KEPT];
    return count > 0 ? (int)count : 0;
}

void pipeline_counts_add(PipelineCounts *counts, const RenderPacket *packet, const LodMethod methods[METHODS_HALVES],
                         const RenderStats *render, int64_t now_ns) {
    PipelineStats *stats = &counts->stats;
    const LodCut cut = told_cut(&packet->cut, &render->resident, render->partial);
    stats->frames++;
    add_frame_time(counts, now_ns);
    stats->cut = cut_of(&cut, methods[0]);
    stats->render = *render;
    stats->triangles_sum += cut.stats.triangles;
    stats->split = packet->split;
    add_creation(stats, &render->resident);
    frame_times_add(&counts->refine, refine_ms(&cut));
    frame_times_add(&counts->upload, render->upload_ms);
    frame_times_add(&counts->draw, render->draw_ms);
    keep_frame(counts, &cut, render, now_ns);
    if (packet->split)
        add_right(counts, &packet->right, methods[1], &render->right);
    if (!packet->split || methods[0] != methods[1])
        stats->frames_by_method[methods[0]]++;
}

void pipeline_cut_log(const char *where, const PipelineCut *cut) {
    log_info("%s: %s, %lld triangles in %lld patches, %s %.2f px", where, lod_method_name(cut->method),
             (long long)cut->lod.triangles, (long long)cut->lod.patches,
             cut->promises ? "error at most" : "no bound on the error, asked for", cut->reached_px);
}

static FrameTimesSummary all_of(const FrameTimes *times) {
    return frame_times_summary(times, FRAME_TIMES_KEPT);
}

PipelineTimes pipeline_counts_times(const PipelineCounts *counts) {
    return (PipelineTimes){.frame = all_of(&counts->frame),
                           .refine = all_of(&counts->refine),
                           .upload = all_of(&counts->upload),
                           .draw = all_of(&counts->draw),
                           .right_refine = all_of(&counts->right_refine),
                           .right_upload = all_of(&counts->right_upload),
                           .right_draw = all_of(&counts->right_draw)};
}
