// `overfly bench panel`: what the panel of accuracy costs a frame. The same stretch of flight is flown without and with
// it, through the threads of a real flight, without a window: a round is two blocks of each in the order ABBA, which
// takes out what a machine drifts meanwhile, and the next one begins with the other.
#define _POSIX_C_SOURCE 200809L
#include "app/bench/bench.h"
#include "app/flight/flight_pipeline.h"
#include "app/flight/flight_session.h"
#include "app/live/monitor.h"
#include "app/picture_options.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/statistics.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define DEFAULT_FRAMES 60 // of a block
#define WARM_UP_FRAMES 12 // of each block, in place: the panel opens, or closes, in them
#define OPENING_MOST 60   // before them, in place, at most four blocks: a panel that opened hurries to its first error
#define BLOCKS 2          // of each kind in a round
#define ROUNDS_LEAST 5
#define FRAME_S (1.0 / 60.0)
#define COST_LIMIT 0.03

enum { WITHOUT, WITH, KINDS };

typedef struct Bench {
    const Options *options;
    Context *context;
    World world;
    FlightSession *session, *start; // now, and where the block begins
    Pipeline *pipeline;
    Monitor *monitor;
    int frames, rounds, width, height;
    double *frame_ms[KINDS];   // of all rounds, one after another
    double *ratios;            // of the rounds' medians
    double spent_ms, flown_ms; // by the monitor's thread; in blocks with the panel
    double *work;              // of the rounds: all threads' time with the panel over that without, less 1
} Bench;

static Result allocate(Bench *bench) {
    size_t count = (size_t)(BLOCKS * bench->frames) * (size_t)bench->rounds;
    bench->session = calloc(1, sizeof *bench->session);
    bench->start = calloc(1, sizeof *bench->start);
    bench->ratios = calloc((size_t)bench->rounds, sizeof *bench->ratios);
    bench->work = calloc((size_t)bench->rounds, sizeof *bench->work);
    for (int i = 0; i < KINDS; i++)
        bench->frame_ms[i] = calloc(count, sizeof *bench->frame_ms[i]);
    if (bench->session && bench->start && bench->ratios && bench->work && bench->frame_ms[WITHOUT] &&
        bench->frame_ms[WITH])
        return RESULT_OK;
    log_error("bench: no memory for %d rounds of %d frames", bench->rounds, bench->frames);
    return RESULT_MEMORY;
}

static Result start_pipeline(Bench *bench) {
    Result result =
        flight_pipeline_create(bench->options, &bench->world, bench->session, bench->context, NULL, &bench->pipeline);
    const MonitorOptions monitor = {scene_lod_options(bench->options), bench->world.terrain, bench->pipeline};
    return result == RESULT_OK ? monitor_create(&monitor, &bench->monitor) : result;
}

static Result prepare(Bench *bench) {
    const ContextOptions context = picture_context_options(bench->options);
    bench->width = context.width;
    bench->height = context.height;
    Result result = context_create_offscreen(&context, &bench->context);
    if (result == RESULT_OK)
        result = world_load(bench->options, &bench->world);
    if (result == RESULT_OK)
        result = allocate(bench);
    if (result == RESULT_OK)
        result = session_create(&bench->world, bench->options, bench->session);
    return result == RESULT_OK ? start_pipeline(bench) : result;
}

// One frame on; its time comes with a later one.
static Result fly_frame(Bench *bench, bool open, double passed_s) {
    FrameOrder order;
    PipelineStats stats = pipeline_stats(bench->pipeline);
    session_order(bench->session, bench->width, bench->height, stats.frame_ms, stats.frame_p99_ms, &order);
    monitor_follow(bench->monitor, open, &order);
    session_advance(bench->session, passed_s);
    return pipeline_submit(bench->pipeline, &order, true);
}

// The times of the frames drawn since number `*heard`.
static void hear(Bench *bench, int64_t *heard, double *frame_ms, int *count) {
    PipelineFrame frames[PIPELINE_FRAMES_KEPT];
    int found = pipeline_frames(bench->pipeline, *heard, frames, PIPELINE_FRAMES_KEPT);
    for (int i = 0; i < found && *count < bench->frames; i++)
        frame_ms[(*count)++] = (double)frames[i].frame_ms;
    *heard += found;
}

// What all threads have used of the processors.
static double process_ms(void) {
    struct timespec used;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return (double)used.tv_sec * 1e3 + (double)used.tv_nsec * 1e-6;
}

// In place: what comes after begins where it does without the panel.
static Result warm_up(Bench *bench, bool open) {
    Result result = RESULT_OK;
    int opening = !open ? 0 : 4 * bench->frames < OPENING_MOST ? 4 * bench->frames : OPENING_MOST;
    for (int i = 0; i < opening + WARM_UP_FRAMES && result == RESULT_OK; i++) {
        result = fly_frame(bench, open, 0.0);
        if (i < opening && monitor_shown(bench->monitor)->error.state == RENDER_ACCURACY_MEASURED)
            opening = i;
    }
    return result == RESULT_OK ? pipeline_drain(bench->pipeline) : result;
}

// From where the round begins. Adds to `block_ms` what the processors worked.
static Result fly_block(Bench *bench, bool open, double *frame_ms, double *block_ms) {
    *bench->session = *bench->start;
    Result result = warm_up(bench, open);
    int64_t heard = pipeline_stats(bench->pipeline).frames, begin_ns = clock_now_ns();
    double spent_ms = monitor_spent_ms(bench->monitor), processor_ms = process_ms();
    int count = 0;
    for (int i = 0; i < bench->frames && result == RESULT_OK; i++) {
        result = fly_frame(bench, open, FRAME_S);
        hear(bench, &heard, frame_ms, &count);
    }
    if (result == RESULT_OK)
        result = pipeline_drain(bench->pipeline);
    hear(bench, &heard, frame_ms, &count);
    *block_ms += process_ms() - processor_ms;
    if (open) {
        bench->spent_ms += monitor_spent_ms(bench->monitor) - spent_ms;
        bench->flown_ms += (double)(clock_now_ns() - begin_ns) * 1e-6;
    }
    return result;
}

static double *frames_of(const Bench *bench, int kind, int round) {
    return bench->frame_ms[kind] + (size_t)round * (size_t)(BLOCKS * bench->frames);
}

static double median_of(const Bench *bench, int kind, int round) {
    double *frame_ms = frames_of(bench, kind, round);
    statistics_sort(frame_ms, BLOCKS * bench->frames);
    return statistics_percentile(frame_ms, BLOCKS * bench->frames, 0.5);
}

static Result fly_round(Bench *bench, int round) {
    static const int ORDER[KINDS * BLOCKS] = {WITHOUT, WITH, WITH, WITHOUT};
    double work_ms[KINDS] = {0.0, 0.0};
    int flown[KINDS] = {0, 0};
    Result result = RESULT_OK;
    *bench->start = *bench->session;
    for (int i = 0; i < KINDS * BLOCKS && result == RESULT_OK; i++) {
        int kind = (ORDER[i] + round) % KINDS;
        double *frame_ms = frames_of(bench, kind, round) + (size_t)(flown[kind]++ * bench->frames);
        result = fly_block(bench, kind == WITH, frame_ms, &work_ms[kind]);
    }
    bench->work[round] = work_ms[WITH] / work_ms[WITHOUT] - 1.0;
    bench->ratios[round] = median_of(bench, WITH, round) / median_of(bench, WITHOUT, round) - 1.0;
    return result;
}

static Result fly_rounds(Bench *bench) {
    Progress progress = progress_begin("panel");
    Result result = RESULT_OK;
    for (int round = 0; round < bench->rounds && result == RESULT_OK; round++) {
        result = fly_round(bench, round);
        progress_update(&progress, (double)(round + 1) / bench->rounds);
    }
    progress_end(&progress);
    statistics_sort(bench->ratios, bench->rounds);
    statistics_sort(bench->work, bench->rounds);
    return result;
}

// ---- what came of it ----

static void add_spread(Json *parent, const char *name, const double *sorted, int count) {
    Json *object = json_add_object(parent, name);
    double low, high;
    statistics_median_bounds(sorted, count, &low, &high);
    json_add_number(object, "median", statistics_percentile(sorted, count, 0.5));
    json_add_numbers(object, "median_95", (double[]){low, high}, 2);
    json_add_number(object, "min", statistics_percentile(sorted, count, 0.0));
    json_add_number(object, "max", statistics_percentile(sorted, count, 1.0));
}

static Result print_json(const Bench *bench) {
    int count = BLOCKS * bench->frames * bench->rounds;
    Json *json = json_create();
    bench_add_machine(json);
    json_add_text(json, "dem", terrain_dem(bench->world.terrain)->file);
    json_add_text(json, "renderer", context_renderer_name(bench->context));
    json_add_numbers(json, "size", (double[]){bench->width, bench->height}, 2);
    json_add_integer(json, "rounds", bench->rounds);
    json_add_integer(json, "frames", bench->frames);
    bench_add_percentiles(json, "frame_ms_without", bench->frame_ms[WITHOUT], count);
    bench_add_percentiles(json, "frame_ms_with", bench->frame_ms[WITH], count);
    add_spread(json, "cost_share", bench->ratios, bench->rounds);
    add_spread(json, "processor_share", bench->work, bench->rounds);
    json_add_number(json, "limit_share", COST_LIMIT);
    json_add_number(json, "thread_share", bench->spent_ms / bench->flown_ms);
    Result result = json_print(json);
    json_destroy(&json);
    return result;
}

static void print_spread(const char *what, const double *sorted, int count) {
    double low, high;
    statistics_median_bounds(sorted, count, &low, &high);
    printf(
        "%-14s median %+.2f %%, with 95 %% certainty %+.2f to %+.2f; %+.2f to %+.2f in %d rounds; %g %% are allowed\n",
        what, 100.0 * statistics_percentile(sorted, count, 0.5), 100.0 * low, 100.0 * high,
        100.0 * statistics_percentile(sorted, count, 0.0), 100.0 * statistics_percentile(sorted, count, 1.0), count,
        100.0 * COST_LIMIT);
}

static void print_text(const Bench *bench) {
    int count = BLOCKS * bench->frames * bench->rounds;
    for (int kind = 0; kind < KINDS; kind++) {
        statistics_sort(bench->frame_ms[kind], count);
        printf("%-14s p50 %.2f ms, p99 %.2f ms a frame\n", kind == WITH ? "with" : "without",
               statistics_percentile(bench->frame_ms[kind], count, 0.5),
               statistics_percentile(bench->frame_ms[kind], count, 0.99));
    }
    print_spread("frame time", bench->ratios, bench->rounds);
    print_spread("all processors", bench->work, bench->rounds);
    printf("its thread     %.2f %% of one processor\n", 100.0 * bench->spent_ms / bench->flown_ms);
}

static void finish(Bench *bench) {
    monitor_destroy(&bench->monitor);
    pipeline_destroy(&bench->pipeline);
    free(bench->session);
    free(bench->start);
    free(bench->ratios);
    free(bench->work);
    for (int i = 0; i < KINDS; i++)
        free(bench->frame_ms[i]);
    world_unload(&bench->world);
    context_destroy(&bench->context);
}

Result bench_panel(const Options *options) {
    int frames = (int)options_integer(options, OPTION_FRAMES), rounds = (int)options_integer(options, OPTION_ROUNDS);
    Bench bench = {.options = options,
                   .frames = frames ? frames : DEFAULT_FRAMES,
                   .rounds = rounds > ROUNDS_LEAST ? rounds : ROUNDS_LEAST};
    Result result = prepare(&bench);
    if (result == RESULT_OK)
        result = fly_rounds(&bench);
    if (result == RESULT_OK && options_flag(options, OPTION_JSON))
        result = print_json(&bench);
    else if (result == RESULT_OK)
        print_text(&bench);
    finish(&bench);
    return result;
}
