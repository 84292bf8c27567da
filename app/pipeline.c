#define _POSIX_C_SOURCE 200809L
#include "app/pipeline.h"

#include "app/picture.h"
#include "app/signals.h"
#include "base/arena.h"
#include "base/clock.h"
#include "base/log.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#define PACKETS 3
#define ARENA_BLOCK ((size_t)1 << 20)
#define RECENT_FRAMES 240 // for the percentile on the screen

typedef enum PacketState { PACKET_FREE, PACKET_REFINING, PACKET_READY, PACKET_DRAWING } PacketState;

// A frame on its way. Only the stage that holds it, by its state, touches the rest.
typedef struct Packet {
    PacketState state;
    uint64_t number; // order of submission
    Arena *arena;
    FrameOrder order;
    RenderPacket render;
} Packet;

struct Pipeline {
    PipelineOptions options;
    Lod *lod; // refining thread
    LodMethod method;
    Renderer *renderer; // drawing thread
    int64_t last_end_ns;
    uint32_t lods; // created so far

    pthread_mutex_t lock;
    pthread_cond_t changed;
    pthread_t refiner, drawer;
    bool refiner_runs, drawer_runs;

    // Under the lock.
    Packet packets[PACKETS];
    FrameOrder waiting;
    bool has_waiting, leaving, drawer_ready;
    uint64_t submitted, drawn; // numbers
    uint64_t released;         // LodCut.frame that is drawn
    Result failure;
    PipelineStats stats;
    FrameTimes frame_times, refine_times, upload_times, draw_times;
};

static Result change_method(Pipeline *p, LodMethod method) {
    LodOptions options = p->options.lod;
    options.method = method;
    options.serial = ++p->lods;
    Lod *lod = NULL;
    Result result = lod_create(&options, p->options.terrain, &lod);
    if (result != RESULT_OK)
        return result;
    lod_destroy(&p->lod);
    p->lod = lod;
    p->method = method;
    return RESULT_OK;
}

static void fill_packet(Packet *packet) {
    const FrameOrder *order = &packet->order;
    LodCut cut = packet->render.cut;
    packet->render = order->look;
    packet->render.cut = cut;
    packet->render.hud.message = order->message[0] ? order->message : NULL;
}

// The cut for the packet's order. A reached budget is a valid cut, and the panel says so.
static Result refine(Pipeline *p, Packet *packet) {
    arena_reset(packet->arena);
    Result result = lod_update(p->lod, &packet->order.view, p->options.jobs, packet->arena, &packet->render.cut);
    if (result != RESULT_OK && result != RESULT_BUDGET)
        return result;
    fill_packet(packet);
    return RESULT_OK;
}

static Result create_renderer(Pipeline *p) {
    return render_create(&p->options.render, p->options.terrain, &p->renderer);
}

static void resize(Pipeline *p, const FrameOrder *order) {
    if (order->width == p->options.render.width && order->height == p->options.render.height)
        return;
    p->options.render.width = order->width;
    p->options.render.height = order->height;
    render_resize(p->renderer, order->width, order->height);
}

static Result draw(Pipeline *p, Packet *packet, RenderStats *stats, Result *picture_failure) {
    const FrameOrder *order = &packet->order;
    resize(p, order);
    Result result = render_frame(p->renderer, &packet->render, stats);
    if (result == RESULT_OK && order->picture[0])
        *picture_failure = picture_write(p->renderer, order->width, order->height, order->picture);
    context_swap(p->options.context);
    return result;
}

// Under the lock.
static void count_frame(Pipeline *p, const Packet *packet, const RenderStats *render) {
    const LodCut *cut = &packet->render.cut;
    int64_t now_ns = clock_now_ns();
    if (p->last_end_ns != 0) {
        p->stats.frame_ms = (double)(now_ns - p->last_end_ns) * 1e-6;
        frame_times_add(&p->frame_times, p->stats.frame_ms);
    }
    p->last_end_ns = now_ns;
    frame_times_add(&p->refine_times, (double)(cut->stats.select_ns + cut->stats.refine_ns) * 1e-6);
    frame_times_add(&p->upload_times, render->upload_ms);
    frame_times_add(&p->draw_times, render->draw_ms);
    p->stats.frames++;
    p->stats.method = packet->order.method;
    p->stats.lod = cut->stats;
    p->stats.reached_px = cut->reached_px;
    p->stats.render = *render;
    p->stats.triangles_sum += cut->stats.triangles;
    if (p->stats.frames % 16 == 1)
        p->stats.frame_p99_ms = frame_times_summary(&p->frame_times, RECENT_FRAMES).p99;
    p->released = cut->frame;
    p->drawn = packet->number;
}

static Packet *find_packet(Pipeline *p, PacketState state) {
    Packet *oldest = NULL;
    for (int i = 0; i < PACKETS; i++)
        if (p->packets[i].state == state && (!oldest || p->packets[i].number < oldest->number))
            oldest = &p->packets[i];
    return oldest;
}

static void set_state(Pipeline *p, Packet *packet, PacketState state) {
    packet->state = state;
    pthread_cond_broadcast(&p->changed);
}

static void fail(Pipeline *p, Result result) {
    if (p->failure == RESULT_OK)
        p->failure = result;
    pthread_cond_broadcast(&p->changed);
}

// Under the lock: nothing refined awaits drawing, so cuts of the present Lod are no longer read.
static bool is_idle(const Pipeline *p) {
    for (int i = 0; i < PACKETS; i++)
        if (p->packets[i].state != PACKET_FREE)
            return false;
    return true;
}

// Under the lock. Not more than one refined frame waits: more would only show older views.
static bool can_refine(Pipeline *p) {
    if (!p->has_waiting || p->failure != RESULT_OK)
        return false;
    if (p->waiting.method != p->method)
        return is_idle(p);
    return find_packet(p, PACKET_FREE) && !find_packet(p, PACKET_READY);
}

// Under the lock, which is open while the work is done.
static Result refine_next(Pipeline *p) {
    Packet *packet = find_packet(p, PACKET_FREE);
    packet->order = p->waiting;
    packet->number = p->submitted;
    p->has_waiting = false;
    uint64_t released = p->released;
    set_state(p, packet, PACKET_REFINING);
    pthread_mutex_unlock(&p->lock);
    Result result = RESULT_OK;
    bool changed = packet->order.method != p->method;
    if (changed)
        result = change_method(p, packet->order.method);
    else
        lod_release(p->lod, released);
    if (result == RESULT_OK)
        result = refine(p, packet);
    pthread_mutex_lock(&p->lock);
    if (changed)
        p->released = 0; // the new Lod counts its frames anew
    set_state(p, packet, result == RESULT_OK ? PACKET_READY : PACKET_FREE);
    return result;
}

// Under the lock, which is open while the work is done.
static Result draw_next(Pipeline *p, Packet *packet) {
    set_state(p, packet, PACKET_DRAWING);
    pthread_mutex_unlock(&p->lock);
    RenderStats stats = {0};
    Result picture_failure = RESULT_OK;
    Result result = draw(p, packet, &stats, &picture_failure);
    pthread_mutex_lock(&p->lock);
    if (p->stats.picture_failure == RESULT_OK)
        p->stats.picture_failure = picture_failure;
    count_frame(p, packet, &stats);
    set_state(p, packet, PACKET_FREE);
    return result;
}

static void *run_refiner(void *user) {
    Pipeline *p = user;
    pthread_mutex_lock(&p->lock);
    while (!p->leaving) {
        Result result = can_refine(p) ? refine_next(p) : RESULT_OK;
        if (result != RESULT_OK)
            fail(p, result);
        else if (!p->leaving && !can_refine(p))
            pthread_cond_wait(&p->changed, &p->lock);
    }
    pthread_mutex_unlock(&p->lock);
    return NULL;
}

static Result begin_drawing(Pipeline *p) {
    Result result = context_make_current(p->options.context);
    return result == RESULT_OK ? create_renderer(p) : result;
}

static void end_drawing(Pipeline *p) {
    render_destroy(&p->renderer);
    context_release_current(p->options.context);
}

static void *run_drawer(void *user) {
    Pipeline *p = user;
    Result result = begin_drawing(p);
    pthread_mutex_lock(&p->lock);
    p->drawer_ready = true;
    if (result != RESULT_OK)
        fail(p, result);
    pthread_cond_broadcast(&p->changed);
    while (!p->leaving && p->failure == RESULT_OK) {
        Packet *packet = find_packet(p, PACKET_READY);
        result = packet ? draw_next(p, packet) : RESULT_OK;
        if (result != RESULT_OK)
            fail(p, result);
        else if (!packet && !p->leaving)
            pthread_cond_wait(&p->changed, &p->lock);
    }
    pthread_mutex_unlock(&p->lock);
    end_drawing(p);
    return NULL;
}

static Result start_thread(pthread_t *thread, bool *runs, void *(*run)(void *), Pipeline *p) {
    sigset_t before;
    signals_hold_all(&before);
    *runs = pthread_create(thread, NULL, run, p) == 0;
    signals_restore(&before);
    if (!*runs)
        log_error("a thread cannot be started; is the limit of processes reached (ulimit -u)?");
    return *runs ? RESULT_OK : RESULT_MEMORY;
}

static Result start_threads(Pipeline *p) {
    Result result = start_thread(&p->drawer, &p->drawer_runs, run_drawer, p);
    if (result != RESULT_OK)
        return result;
    pthread_mutex_lock(&p->lock);
    while (!p->drawer_ready)
        pthread_cond_wait(&p->changed, &p->lock);
    result = p->failure;
    pthread_mutex_unlock(&p->lock);
    return result == RESULT_OK ? start_thread(&p->refiner, &p->refiner_runs, run_refiner, p) : result;
}

static Result create_packets(Pipeline *p) {
    for (int i = 0; i < PACKETS; i++) {
        Result result = arena_create(ARENA_BLOCK, &p->packets[i].arena);
        if (result != RESULT_OK)
            return result;
    }
    return RESULT_OK;
}

Result pipeline_create(const PipelineOptions *options, Pipeline **out) {
    Pipeline *p = calloc(1, sizeof *p);
    if (!p) {
        log_error("no memory for the frames in flight");
        return RESULT_MEMORY;
    }
    p->options = *options;
    pthread_mutex_init(&p->lock, NULL);
    pthread_cond_init(&p->changed, NULL);
    Result result = create_packets(p);
    if (result == RESULT_OK)
        result = change_method(p, options->lod.method);
    if (result == RESULT_OK)
        result = options->threaded ? start_threads(p) : begin_drawing(p);
    if (result == RESULT_OK)
        *out = p;
    else
        pipeline_destroy(&p);
    return result;
}

static void stop_threads(Pipeline *p) {
    pthread_mutex_lock(&p->lock);
    p->leaving = true;
    pthread_cond_broadcast(&p->changed);
    pthread_mutex_unlock(&p->lock);
    if (p->refiner_runs)
        pthread_join(p->refiner, NULL);
    if (p->drawer_runs)
        pthread_join(p->drawer, NULL);
}

void pipeline_destroy(Pipeline **pipeline) {
    Pipeline *p = *pipeline;
    if (!p)
        return;
    stop_threads(p);
    if (!p->options.threaded)
        end_drawing(p);
    lod_destroy(&p->lod);
    for (int i = 0; i < PACKETS; i++)
        if (p->packets[i].arena)
            arena_destroy(&p->packets[i].arena);
    pthread_cond_destroy(&p->changed);
    pthread_mutex_destroy(&p->lock);
    free(p);
    *pipeline = NULL;
}

static Result submit_to_threads(Pipeline *p, const FrameOrder *order, bool wait) {
    bool must_wait = wait || (p->has_waiting && p->waiting.picture[0]);
    while (must_wait && p->has_waiting && p->failure == RESULT_OK)
        pthread_cond_wait(&p->changed, &p->lock);
    if (p->failure != RESULT_OK)
        return p->failure;
    p->waiting = *order;
    p->has_waiting = true;
    p->submitted++;
    pthread_cond_broadcast(&p->changed);
    return RESULT_OK;
}

// The stages one after another on this thread.
static Result submit_lockstep(Pipeline *p, const FrameOrder *order) {
    p->waiting = *order;
    p->submitted++;
    Result result = refine_next(p);
    if (result == RESULT_OK)
        result = draw_next(p, find_packet(p, PACKET_READY));
    return result;
}

Result pipeline_submit(Pipeline *p, const FrameOrder *order, bool wait) {
    pthread_mutex_lock(&p->lock);
    Result result = p->options.threaded ? submit_to_threads(p, order, wait) : submit_lockstep(p, order);
    pthread_mutex_unlock(&p->lock);
    return result;
}

Result pipeline_drain(Pipeline *p) {
    pthread_mutex_lock(&p->lock);
    while (p->failure == RESULT_OK && (p->has_waiting || !is_idle(p)))
        pthread_cond_wait(&p->changed, &p->lock);
    Result result = p->failure;
    pthread_mutex_unlock(&p->lock);
    return result;
}

PipelineStats pipeline_stats(Pipeline *p) {
    pthread_mutex_lock(&p->lock);
    PipelineStats stats = p->stats;
    pthread_mutex_unlock(&p->lock);
    return stats;
}

PipelineTimes pipeline_times(Pipeline *p) {
    pthread_mutex_lock(&p->lock);
    PipelineTimes times = {
        frame_times_summary(&p->frame_times, FRAME_TIMES_KEPT), frame_times_summary(&p->refine_times, FRAME_TIMES_KEPT),
        frame_times_summary(&p->upload_times, FRAME_TIMES_KEPT), frame_times_summary(&p->draw_times, FRAME_TIMES_KEPT)};
    pthread_mutex_unlock(&p->lock);
    return times;
}
