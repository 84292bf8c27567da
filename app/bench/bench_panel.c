// `overfly bench panel`: what the panel of accuracy costs a frame. The same short stretch of flight is flown without
// and with it, through the threads of a real flight, without a window: a round is four blocks of a few frames in the
// order ABBA, there and back and there and back, and the next one begins with the other. Each kind flies each view once
// in either direction, and within seconds of the other, which takes out what a machine drifts meanwhile. The panel
// stays open: without it, it rests.
#define _POSIX_C_SOURCE 200809L
#include "app/bench/bench.h"
#include "app/flight/flight_pipeline.h"
#include "app/flight/flight_session.h"
#include "app/live/monitor.h"
#include "app/picture_options.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/statistics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define DEFAULT_FRAMES 3 // of a block: rounds of longer ones differ as much, and are fewer
#define DEFAULT_ROUNDS 240
#define ROUNDS_LEAST 5
#define OPENING_MOST 120  // in place, to the first error
#define OPENING_BLOCKS 40 // and not more than so many blocks
#define BLOCKS 2          // of each kind in a round
#define FRAME_S (1.0 / 60.0)
#define COST_LIMIT 0.03

enum { WITHOUT, WITH, KINDS };

static const int ORDER[KINDS * BLOCKS] = {WITHOUT, WITH, WITH, WITHOUT};

typedef struct Bench {
    const Options *options;
    Context *context;
    World world;
    FlightSession *session;
    Pipeline *pipeline;
    Monitor *monitor;
    int frames, rounds, width, height;
    FrameOrder *orders;        // of a stretch
    double *drawn_ms;          // of all frames, by number
    int64_t heard, room;       // frames, of `drawn_ms`
    int64_t first;             // number of the first frame of the first round
    double *frame_ms[KINDS];   // one block after another
    double *cost, *work;       // of the rounds: logarithm of with over without, of frame time and of all threads' time
    double spent_ms, flown_ms; // by the monitor's thread; in blocks with the panel
    int painted, paintings;    // frames with the panel; how often it was painted in them
} Bench;

static Result allocate(Bench *bench) {
    size_t rounds = (size_t)bench->rounds, stretch = (size_t)bench->frames;
    size_t counted = BLOCKS * stretch * rounds;
    bench->room = (int64_t)(KINDS * BLOCKS * stretch * rounds) + OPENING_MOST + 1;
    bench->session = calloc(1, sizeof *bench->session);
    bench->orders = calloc(stretch, sizeof *bench->orders);
    bench->drawn_ms = calloc((size_t)bench->room, sizeof *bench->drawn_ms);
    bench->cost = calloc(rounds, sizeof *bench->cost);
    bench->work = calloc(rounds, sizeof *bench->work);
    for (int i = 0; i < KINDS; i++)
        bench->frame_ms[i] = calloc(counted, sizeof *bench->frame_ms[i]);
    if (bench->session && bench->orders && bench->drawn_ms && bench->cost && bench->work && bench->frame_ms[WITHOUT] &&
        bench->frame_ms[WITH])
        return RESULT_OK;
    log_error("bench: no memory for %d rounds of %d frames; ask for fewer (--rounds, --frames)", bench->rounds,
              bench->frames);
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

// The times of the frames drawn since.
static void hear(Bench *bench) {
    PipelineFrame frames[PIPELINE_FRAMES_KEPT];
    int found = pipeline_frames(bench->pipeline, bench->heard, frames, PIPELINE_FRAMES_KEPT);
    for (int i = 0; i < found; i++) {
        bench->heard = frames[i].number;
        if (frames[i].number < bench->room)
            bench->drawn_ms[frames[i].number] = frames[i].frame_ms;
    }
}

static void order_frame(const Bench *bench, FrameOrder *order) {
    PipelineStats stats = pipeline_stats(bench->pipeline);
    session_order(bench->session, bench->width, bench->height, stats.frame_ms, stats.frame_p99_ms, order);
}

// Its time comes with a later one.
static Result fly_frame(Bench *bench, int kind, const FrameOrder *wanted) {
    FrameOrder order = *wanted;
    if (kind == WITH)
        monitor_follow(bench->monitor, true, &order);
    Result result = pipeline_submit(bench->pipeline, &order, true);
    hear(bench);
    return result;
}

// In place: a panel that opened hurries to its first error.
static Result open_panel(Bench *bench) {
    Result result = RESULT_OK;
    int most = OPENING_BLOCKS * bench->frames < OPENING_MOST ? OPENING_BLOCKS * bench->frames : OPENING_MOST;
    order_frame(bench, &bench->orders[0]);
    for (int i = 0; i < most && result == RESULT_OK; i++) {
        result = fly_frame(bench, WITH, &bench->orders[0]);
        if (monitor_shown(bench->monitor)->error.state == RENDER_ACCURACY_MEASURED)
            break;
    }
    if (result == RESULT_OK)
        result = pipeline_drain(bench->pipeline);
    bench->first = pipeline_stats(bench->pipeline).frames + 1;
    return result;
}

// What all threads have used of the processors.
static double process_ms(void) {
    struct timespec used;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return (double)used.tv_sec * 1e3 + (double)used.tv_nsec * 1e-6;
}

// Over the stretch, or back, until all of it is drawn: orders run ahead of drawing, and none of the next block shall.
// Adds to `work_ms` what the processors worked.
static Result fly_block(Bench *bench, int kind, bool back, double *work_ms) {
    monitor_rest(bench->monitor, kind == WITHOUT);
    double processor_ms = process_ms();
    int64_t begin_ns = clock_now_ns();
    Result result = RESULT_OK;
    for (int i = 0; i < bench->frames && result == RESULT_OK; i++) {
        uint64_t revision = monitor_shown(bench->monitor)->revision;
        result = fly_frame(bench, kind, &bench->orders[back ? bench->frames - 1 - i : i]);
        bench->painted += kind == WITH;
        bench->paintings += monitor_shown(bench->monitor)->revision != revision;
    }
    if (result == RESULT_OK)
        result = pipeline_drain(bench->pipeline);
    *work_ms += process_ms() - processor_ms;
    bench->flown_ms += kind == WITH ? (double)(clock_now_ns() - begin_ns) * 1e-6 : 0.0;
    return result;
}

static int kind_of(int round, int block) {
    return (ORDER[block] + round) % KINDS;
}

static Result fly_round(Bench *bench, int round) {
    double work_ms[KINDS] = {0.0, 0.0};
    Result result = RESULT_OK;
    for (int i = 0; i < bench->frames; i++) {
        session_advance(bench->session, FRAME_S);
        order_frame(bench, &bench->orders[i]);
    }
    for (int i = 0; i < KINDS * BLOCKS && result == RESULT_OK; i++)
        result = fly_block(bench, kind_of(round, i), i % 2 == 1, &work_ms[kind_of(round, i)]);
    bench->work[round] = log(work_ms[WITH] / work_ms[WITHOUT]);
    return result;
}

static Result fly_rounds(Bench *bench) {
    Progress progress = progress_begin("panel");
    Result result = open_panel(bench);
    double spent_ms = monitor_spent_ms(bench->monitor);
    for (int round = 0; round < bench->rounds && result == RESULT_OK; round++) {
        result = fly_round(bench, round);
        progress_update(&progress, (double)(round + 1) / bench->rounds);
    }
    hear(bench);
    bench->spent_ms = monitor_spent_ms(bench->monitor) - spent_ms;
    progress_end(&progress);
    return result;
}

// ---- what came of it ----

// The frames of a block.
static const double *times_of(const Bench *bench, int round, int block) {
    int64_t blocks = (int64_t)round * KINDS * BLOCKS + block;
    return bench->drawn_ms + bench->first + blocks * bench->frames;
}

// Sums of blocks: the frames that paint the panel have their due share in them.
static void compare_rounds(Bench *bench) {
    int counted[KINDS] = {0, 0};
    for (int round = 0; round < bench->rounds; round++) {
        double sum_ms[KINDS] = {0.0, 0.0};
        for (int block = 0; block < KINDS * BLOCKS; block++) {
            const double *times = times_of(bench, round, block);
            int kind = kind_of(round, block);
            for (int i = 0; i < bench->frames; i++) {
                sum_ms[kind] += times[i];
                bench->frame_ms[kind][counted[kind]++] = times[i];
            }
        }
        bench->cost[round] = log(sum_ms[WITH] / sum_ms[WITHOUT]);
    }
}

typedef struct Spread {
    double median, low, high, min, max; // `low` and `high`: of the median, with 95 % certainty
} Spread;

// Of the shares that logarithms stand for; sorts them.
static Spread spread_of(double *logs, int count) {
    Spread spread;
    statistics_sort(logs, count);
    statistics_median_bounds(logs, count, &spread.low, &spread.high);
    spread.low = expm1(spread.low);
    spread.high = expm1(spread.high);
    spread.median = expm1(statistics_percentile(logs, count, 0.5));
    spread.min = expm1(logs[0]);
    spread.max = expm1(logs[count - 1]);
    return spread;
}

static void add_spread(Json *parent, const char *name, const Spread *spread) {
    Json *object = json_add_object(parent, name);
    json_add_number(object, "median", spread->median);
    json_add_numbers(object, "median_95", (double[]){spread->low, spread->high}, 2);
    json_add_number(object, "min", spread->min);
    json_add_number(object, "max", spread->max);
}

// Of the frames that show it.
static double painted_share(const Bench *bench) {
    return (double)bench->paintings / bench->painted;
}

static double thread_share(const Bench *bench) {
    return bench->spent_ms / bench->flown_ms;
}

// Of the limit, and of what the median is with 95 % certainty.
static const char *verdict_of(const Spread *cost) {
    return cost->high <= COST_LIMIT ? "met" : cost->low > COST_LIMIT ? "missed" : "undecided";
}

static Result print_json(const Bench *bench, const Spread *cost, const Spread *work) {
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
    add_spread(json, "cost_share", cost);
    add_spread(json, "processor_share", work);
    json_add_number(json, "limit_share", COST_LIMIT);
    json_add_text(json, "limit", verdict_of(cost));
    json_add_number(json, "thread_share", thread_share(bench));
    json_add_number(json, "painted_share", painted_share(bench));
    Result result = json_print(json);
    json_destroy(&json);
    return result;
}

static void print_spread(const char *what, const Spread *spread, int count) {
    printf("%-14s median %+.2f %%, with 95 %% certainty %+.2f to %+.2f; %+.2f to %+.2f in %d rounds\n", what,
           100.0 * spread->median, 100.0 * spread->low, 100.0 * spread->high, 100.0 * spread->min, 100.0 * spread->max,
           count);
}

static void print_verdict(const Spread *cost) {
    const char *verdict = verdict_of(cost);
    printf("the limit      %g %% of frame time: %s%s\n", 100.0 * COST_LIMIT, verdict,
           strcmp(verdict, "undecided") == 0 ? "; fly more rounds (--rounds), with nothing else running" : "");
}

static void print_text(const Bench *bench, const Spread *cost, const Spread *work) {
    int count = BLOCKS * bench->frames * bench->rounds;
    for (int kind = 0; kind < KINDS; kind++) {
        statistics_sort(bench->frame_ms[kind], count);
        printf("%-14s p50 %.2f ms, p99 %.2f ms a frame\n", kind == WITH ? "with" : "without",
               statistics_percentile(bench->frame_ms[kind], count, 0.5),
               statistics_percentile(bench->frame_ms[kind], count, 0.99));
    }
    print_spread("frame time", cost, bench->rounds);
    print_spread("all processors", work, bench->rounds);
    print_verdict(cost);
    printf("its thread     %.2f %% of one processor\n", 100.0 * thread_share(bench));
    printf("painted        in %.1f %% of the frames that show it\n", 100.0 * painted_share(bench));
}

static void finish(Bench *bench) {
    monitor_destroy(&bench->monitor);
    pipeline_destroy(&bench->pipeline);
    free(bench->session);
    free(bench->orders);
    free(bench->drawn_ms);
    free(bench->cost);
    free(bench->work);
    for (int i = 0; i < KINDS; i++)
        free(bench->frame_ms[i]);
    world_unload(&bench->world);
    context_destroy(&bench->context);
}

static Result tell(Bench *bench) {
    compare_rounds(bench);
    const Spread cost = spread_of(bench->cost, bench->rounds), work = spread_of(bench->work, bench->rounds);
    if (options_flag(bench->options, OPTION_JSON))
        return print_json(bench, &cost, &work);
    print_text(bench, &cost, &work);
    return RESULT_OK;
}

Result bench_panel(const Options *options) {
    int frames = (int)options_integer(options, OPTION_FRAMES), rounds = (int)options_integer(options, OPTION_ROUNDS);
    bool given = options_is_given(options, OPTION_ROUNDS);
    Bench bench = {.options = options,
                   .frames = frames ? frames : DEFAULT_FRAMES,
                   .rounds = !given                  ? DEFAULT_ROUNDS
                             : rounds > ROUNDS_LEAST ? rounds
                                                     : ROUNDS_LEAST};
    Result result = prepare(&bench);
    if (result == RESULT_OK)
        result = fly_rounds(&bench);
    if (result == RESULT_OK)
        result = tell(&bench);
    finish(&bench);
    return result;
}
