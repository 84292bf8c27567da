#include "app/pipeline/pipeline_counts.h"

#include "base/log.h"

#include <math.h>

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

static bool has_moved(const RenderPacket *last, const RenderPacket *packet) {
    const RenderCamera *a = &last->camera, *b = &packet->camera;
    bool same = last->cut.view.px_per_rad == packet->cut.view.px_per_rad && a->fov_y_rad == b->fov_y_rad &&
                vec3d_length(vec3d_sub(a->eye_ecef, b->eye_ecef)) == 0.0;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            same = same && a->camera_from_ecef.m[row][column] == b->camera_from_ecef.m[row][column];
    return !same;
}

// What lies over the picture costs time as well. Not the messages, which come and go by themselves.
static bool has_other_display(const RenderHud *last, const RenderHud *hud) {
    return last->show_flight != hud->show_flight || last->show_numbers != hud->show_numbers ||
           last->show_help != hud->show_help || last->show_names != hud->show_names ||
           last->accuracy.show != hud->accuracy.show;
}

static bool is_another(const PipelineCounts *counts, const RenderPacket *packet,
                       const LodMethod methods[METHODS_HALVES], const PipelineWork *work) {
    const RenderPacket *last = &counts->last;
    return counts->last_end_ns == 0 || last->split != packet->split || counts->width != work->width ||
           counts->height != work->height || counts->methods[0] != methods[0] || counts->methods[1] != methods[1] ||
           last->colouring != packet->colouring || last->wireframe != packet->wireframe ||
           last->magenta_background != packet->magenta_background;
}

static bool is_creation(const PipelineCounts *counts, const RenderStats *render) {
    return render->resident.create_ms != counts->stats.render.resident.create_ms ||
           render->right.resident.create_ms != counts->stats.render.right.resident.create_ms;
}

// On a GPU the drawing thread has only given its orders when its stage ends: the timer knows how long they take.
static double longest_stage_ms(const RenderStats *render, const PipelineWork *work) {
    double drawn_ms = render->upload_ms + render->draw_ms + render->right.upload_ms + render->right.draw_ms;
    return fmax((double)work->refine_ns * MS_PER_NS, fmax((double)work->draw_ns * MS_PER_NS, drawn_ms));
}

// Before the counts are those of this frame.
static PipelineFrame frame_of(const PipelineCounts *counts, const RenderPacket *packet,
                              const LodMethod methods[METHODS_HALVES], const RenderStats *render,
                              const PipelineWork *work, int64_t now_ns) {
    double frame_ms = counts->last_end_ns ? (double)(now_ns - counts->last_end_ns) * MS_PER_NS : 0.0;
    const LodCut cut = told_cut(&packet->cut, &render->resident, render->partial);
    const LodCut right = told_cut(&packet->right, &render->right.resident, render->right.partial);
    bool another = is_another(counts, packet, methods, work);
    return (PipelineFrame){
        .number = counts->stats.frames + 1,
        .end_ns = now_ns,
        .method = methods[0],
        .split = packet->split,
        .px_per_rad = cut.view.px_per_rad,
        .select_ms = (double)cut.stats.select_ns * MS_PER_NS,
        .refine_ms = (double)cut.stats.refine_ns * MS_PER_NS,
        .upload_ms = render->upload_ms,
        .draw_ms = render->draw_ms,
        .triangles_drawn = render->triangles_drawn,
        .frame_ms = frame_ms,
        .cost_ms = fmax(frame_ms - (double)work->waited_ns * MS_PER_NS, longest_stage_ms(render, work)),
        .tau_px = cut.view.tau_px,
        .reached_px = cut.reached_px,
        .triangles = cut.stats.triangles + (packet->split ? right.stats.triangles : 0),
        .width = work->width,
        .height = work->height,
        .another = another,
        .moved = another || has_moved(&counts->last, packet) || has_other_display(&counts->last.hud, &packet->hud),
        .disturbed = another || work->wrote || is_creation(counts, render)};
}

static void keep_frame(PipelineCounts *counts, const RenderPacket *packet, const LodMethod methods[METHODS_HALVES],
                       const RenderStats *render, const PipelineWork *work, int64_t now_ns) {
    PipelineFrame *frame = &counts->stats.latest[counts->stats.frames % PIPELINE_FRAMES_KEPT];
    *frame = frame_of(counts, packet, methods, render, work, now_ns);
    counts->last = *packet;
    counts->width = work->width;
    counts->height = work->height;
    for (int half = 0; half < METHODS_HALVES; half++)
        counts->methods[half] = methods[half];
}

int pipeline_counts_frames(const PipelineCounts *counts, int64_t after, PipelineFrame *out, int max) {
    int64_t last = counts->stats.frames, count = last - after;
    int64_t most = max < PIPELINE_FRAMES_KEPT ? max : PIPELINE_FRAMES_KEPT;
    count = count > most ? most : count;
    for (int64_t i = 0; i < count; i++)
        out[i] = counts->stats.latest[(last - count + i) % PIPELINE_FRAMES_KEPT];
    return count > 0 ? (int)count : 0;
}

void pipeline_counts_add(PipelineCounts *counts, const RenderPacket *packet, const LodMethod methods[METHODS_HALVES],
                         const RenderStats *render, const PipelineWork *work, int64_t now_ns) {
    PipelineStats *stats = &counts->stats;
    keep_frame(counts, packet, methods, render, work, now_ns);
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
