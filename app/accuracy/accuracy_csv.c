#include "app/accuracy/accuracy_report.h"
#include "app/csv.h"

#include <inttypes.h>
#include <math.h>

// Then a comma.
static void put_text(const char *text, FILE *to) {
    csv_put_text(text, to);
    fputc(',', to);
}

// All digits; nothing for what is no number; then a comma.
static void put_number(double value, FILE *to) {
    if (isfinite(value))
        fprintf(to, "%.17g", value);
    else if (isinf(value))
        fputs("inf", to);
    fputc(',', to);
}

static void put_integer(int64_t value, FILE *to) {
    fprintf(to, "%" PRId64 ",", value);
}

static void put_run(const Accuracy *accuracy, const AccuracyRun *run, FILE *to) {
    const AccuracyVariant *variant = &accuracy->plan.variants[run->variant];
    put_text(accuracy->dems[run->dem].name, to);
    put_text(variant->name, to);
    put_text(lod_method_name(variant->method), to);
    put_text(accuracy->plan.kinds[variant->kind].name, to);
    put_number(run->tau_px, to);
}

#define RUN_COLUMNS "dem,variant,method,error,tau_px,"

static void put_pose(const Accuracy *accuracy, const AccuracyRun *run, int pose, FILE *to) {
    const AccuracyDem *dem = &accuracy->dems[run->dem];
    const AccuracyPose *p = &dem->poses[pose];
    put_text(dem->tracks[p->flight].name, to);
    put_integer(p->number, to);
    put_integer(p->jump, to);
    put_number(p->t_s, to);
    put_number(p->at.lat_deg, to);
    put_number(p->at.lon_deg, to);
    put_number(p->at.alt_m, to);
    put_number(p->at.heading_deg, to);
    put_number(p->at.pitch_deg, to);
}

static void put_errors(const AccuracyFrame *frame, FILE *to) {
    const Measure *m = &frame->measure;
    put_number(frame->reached_px, to);
    put_integer(frame->promises, to);
    put_number(m->max_px, to);
    put_number(m->p999_px, to);
    put_number(m->p99_px, to);
    put_number(m->rms_px, to);
    put_number(m->above_tau_share, to);
    put_integer(m->samples, to);
    put_integer(m->worst_col, to);
    put_integer(m->worst_row, to);
    put_number(frame->popping_px, to);
    put_integer(m->t_junctions, to);
    put_integer(m->holes, to);
    put_integer(m->overlaps, to);
    put_integer(frame->triangles, to);
    put_integer(frame->patches, to);
    put_number(frame->rebuilt_share, to);
    put_integer(frame->index_bytes, to);
    put_integer(frame->upload_bytes, to);
    put_integer(frame->vram_bytes, to);
    fprintf(to, "%016" PRIx64 ",", frame->cut_hash);
}

static void put_times(const AccuracyTimes *times, FILE *to) {
    put_number(times->select_ms, to);
    put_number(times->refine_ms, to);
    put_number(times->upload_ms, to);
    put_number(times->draw_ms, to);
    put_number(times->frame_ms, to);
}

void accuracy_write_frames(const Accuracy *accuracy, FILE *to) {
    fputs(RUN_COLUMNS "flight,frame,jump,t_s,lat_deg,lon_deg,alt_m,heading_deg,pitch_deg,reached_px,promises,max_px,"
                      "p999_px,p99_px,rms_px,above_tau_share,samples,worst_col,worst_row,popping_px,t_junctions,holes,"
                      "overlaps,triangles,patches,retriangulated_share,index_bytes,upload_bytes,vram_bytes,cut_hash,"
                      "select_ms,refine_ms,upload_ms,draw_ms,frame_ms,select_ms_min,refine_ms_min,upload_ms_min,"
                      "draw_ms_min,frame_ms_min,select_ms_max,refine_ms_max,upload_ms_max,draw_ms_max,frame_ms_max,"
                      "memory_bytes\r\n",
          to);
    for (int i = 0; i < accuracy->run_count; i++) {
        const AccuracyRun *run = &accuracy->runs[i];
        for (int pose = 0; pose < accuracy->dems[run->dem].pose_count; pose++) {
            const AccuracyFrame *frame = &run->frames[pose];
            put_run(accuracy, run, to);
            put_pose(accuracy, run, pose, to);
            put_errors(frame, to);
            put_times(&frame->median, to);
            put_times(&frame->least, to);
            put_times(&frame->most, to);
            fprintf(to, "%" PRId64 "\r\n", frame->memory_bytes);
        }
    }
}

static void put_summary_errors(const AccuracyRun *run, FILE *to) {
    const AccuracySummary *s = &run->summary;
    put_number(s->reached_px, to);
    put_integer(s->promised, to);
    put_integer(s->held, to);
    put_number(s->max_px, to);
    put_number(s->p999_px, to);
    put_number(s->p99_px, to);
    put_number(s->rms_px, to);
    put_number(s->above_tau_share, to);
    put_number(s->popping_px, to);
    put_integer(s->popping_pairs, to);
    put_integer(s->t_junctions, to);
    put_integer(s->holes, to);
    put_integer(s->overlaps, to);
    put_number(s->triangles_mean, to);
    put_number(s->rebuilt_share, to);
    put_number(s->upload_bytes_mean, to);
    put_integer(s->vram_bytes, to);
}

static void put_percentiles(const AccuracyPercentiles *p, const AccuracySpread *rounds, FILE *to) {
    put_number(p->p50, to);
    put_number(p->p95, to);
    put_number(p->p99, to);
    put_number(p->max, to);
    put_number(rounds->least, to);
    put_number(rounds->most, to);
}

void accuracy_write_summary(const Accuracy *accuracy, FILE *to) {
    fputs(RUN_COLUMNS
          "reached_px,promised,promise_held,max_px,p999_px,p99_px,rms_px,above_tau_share,popping_px,popping_pairs,"
          "t_junctions,holes,overlaps,triangles_mean,retriangulated_share,upload_bytes_mean,vram_bytes,"
          "frame_ms_p50,frame_ms_p95,frame_ms_p99,frame_ms_max,frame_ms_p50_least_round,frame_ms_p50_most_round,"
          "update_ms_p50,update_ms_p95,update_ms_p99,update_ms_max,update_ms_p50_least_round,"
          "update_ms_p50_most_round,select_ms_mean,refine_ms_mean,upload_ms_mean,draw_ms_mean,"
          "memory_bytes\r\n",
          to);
    for (int i = 0; i < accuracy->run_count; i++) {
        const AccuracyRun *run = &accuracy->runs[i];
        const AccuracySummary *s = &run->summary;
        put_run(accuracy, run, to);
        put_summary_errors(run, to);
        put_percentiles(&s->frame_ms, &s->frame_p50, to);
        put_percentiles(&s->update_ms, &s->update_p50, to);
        put_number(s->mean.select_ms, to);
        put_number(s->mean.refine_ms, to);
        put_number(s->mean.upload_ms, to);
        put_number(s->mean.draw_ms, to);
        fprintf(to, "%" PRId64 "\r\n", s->memory_bytes);
    }
}
