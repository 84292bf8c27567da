#define _POSIX_C_SOURCE 200809L
#include "app/pipeline/pipeline.h"

#include "app/pipeline/picture.h"
#include "app/pipeline/pipeline_packet.h"
#include "app/signals.h"
#include "base/arena.h"
#include "base/clock.h"
#include "base/log.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define PACKETS 4 // one of them for pipeline_hold
#define ARENA_BLOCK ((size_t)1 << 20)

struct Pipeline {
    PipelineOptions options;
    Methods *methods;   // refining thread
    Renderer *renderer; // drawing thread

    pthread_mutex_t lock;
    pthread_cond_t changed;
    pthread_t refiner, drawer;
    bool refiner_runs, drawer_runs;

    // Under the lock.
    Packet packets[PACKETS];
    FrameOrder waiting;
    bool has_waiting, leaving, drawer_ready;
    uint64_t submitted; // number of the last order
    Result failure;
    PipelineCounts counts;
    int64_t waited_ns; // for an order or the screen, since the last frame was drawn

    // Under the lock: a cut that somebody wants to hold, or holds.
    bool hold_wanted;
    Packet *held;
    PipelineHeld held_cut;
    pthread_cond_t hold_changed;
};

static Result begin_methods(Pipeline *p) {
    const PipelineOptions *options = &p->options;
    const MethodsOptions methods = {.threaded = options->threaded,
                                    .lod = options->lod,
                                    .bound_brute = options->bound_brute,
                                    .terrain = options->terrain};
    Result result = methods_create(&methods, &p->methods);
    if (result == RESULT_OK)
        result = methods_begin(p->methods, 0, options->lod.method);
    return result == RESULT_OK && options->compare ? methods_begin(p->methods, 1, options->right) : result;
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

// What became of a packet.
typedef struct Drawn {
    RenderStats stats;
    bool refused;
    Result picture_failure;
    int64_t draw_ns, swap_ns; // a screen may let the swap wait
} Drawn;

// A frame that is refused is not shown.
static Result draw(Pipeline *p, Packet *packet, Drawn *drawn) {
    const FrameOrder *order = &packet->order;
    int64_t begin_ns = clock_now_ns();
    resize(p, order);
    Result result = render_frame(p->renderer, &packet->render, &drawn->stats);
    drawn->draw_ns = clock_now_ns() - begin_ns;
    drawn->refused = result == RESULT_OK && packet_is_refused(packet, &drawn->stats);
    if (drawn->refused)
        return RESULT_OK;
    if (result == RESULT_OK && order->picture[0])
        drawn->picture_failure = picture_write(p->renderer, order->width, order->height, order->picture);
    if (result == RESULT_OK && order->film && p->options.video)
        result = picture_film(p->renderer, order->width, order->height, p->options.video);
    begin_ns = clock_now_ns();
    context_swap(p->options.context);
    drawn->swap_ns = clock_now_ns() - begin_ns;
    return result;
}

// Under the lock: whether the packet is held from now on.
static bool hold(Pipeline *p, Packet *packet, const RenderStats *render, int64_t now_ns) {
    if (!p->hold_wanted || !packet->runs[0])
        return false;
    packet_hold(packet);
    p->held = packet;
    p->held_cut = (PipelineHeld){packet->render.cut, packet->runs[0]->method, render->partial, now_ns};
    render_tell_cut(&render->resident, render->partial, &p->held_cut.cut);
    p->hold_wanted = false;
    pthread_cond_broadcast(&p->hold_changed);
    return true;
}

// Under the lock: a frame is drawn, and its packet held or not.
static PacketState count_frame(Pipeline *p, Packet *packet, const Drawn *drawn) {
    LodMethod methods[METHODS_HALVES];
    const FrameOrder *order = &packet->order;
    const PipelineWork work = {.refine_ns = packet->refine_ns,
                               .draw_ns = drawn->draw_ns,
                               .waited_ns = p->waited_ns + drawn->swap_ns,
                               .width = order->width,
                               .height = order->height,
                               .wrote = order->picture[0] != '\0' || order->film};
    int64_t now_ns = clock_now_ns();
    PacketState state = hold(p, packet, &drawn->stats, now_ns) ? PACKET_HELD : PACKET_FREE;
    packet_mark_drawn(packet, methods);
    pipeline_counts_add(&p->counts, &packet->render, methods, &drawn->stats, &work, now_ns);
    p->waited_ns = 0;
    return state;
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

// Under the lock: nothing refined awaits drawing.
static bool is_idle(const Pipeline *p) {
    for (int i = 0; i < PACKETS; i++)
        if (p->packets[i].state != PACKET_FREE && p->packets[i].state != PACKET_HELD)
            return false;
    return true;
}

// Under the lock. Not more than one refined frame waits: more would only show older views.
static bool can_refine(Pipeline *p) {
    if (p->failure != RESULT_OK)
        return false;
    bool next = p->has_waiting && find_packet(p, PACKET_FREE) && !find_packet(p, PACKET_READY);
    return next || find_packet(p, PACKET_REFUSED);
}

// Under the lock: what can_refine has seen.
static Packet *take_to_refine(Pipeline *p) {
    Packet *packet = find_packet(p, PACKET_REFUSED);
    if (packet)
        return packet;
    packet = find_packet(p, PACKET_FREE);
    packet->order = p->waiting;
    packet->number = p->submitted;
    p->has_waiting = false;
    return packet;
}

// Under the lock: the oldest frame, unless one before it is to be refined again.
static Packet *find_to_draw(Pipeline *p) {
    Packet *ready = find_packet(p, PACKET_READY);
    const Packet *others[] = {find_packet(p, PACKET_REFUSED), find_packet(p, PACKET_REFINING)};
    for (size_t i = 0; ready && i < COUNT_OF(others); i++)
        if (others[i] && others[i]->number < ready->number)
            return NULL;
    return ready;
}

// Under the lock, which is open while the work is done.
static Result refine_next(Pipeline *p) {
    Packet *packet = take_to_refine(p);
    set_state(p, packet, PACKET_REFINING);
    pthread_mutex_unlock(&p->lock);
    int64_t begin_ns = clock_now_ns();
    Result result = methods_settle(p->methods);
    methods_sweep(p->methods);
    if (result == RESULT_OK)
        result = packet_refine(packet, p->methods, p->options.jobs);
    packet->refine_ns = clock_now_ns() - begin_ns;
    pthread_mutex_lock(&p->lock);
    p->counts.stats.changes = methods_changes(p->methods);
    set_state(p, packet, result == RESULT_OK ? PACKET_READY : PACKET_FREE);
    return result;
}

// Under the lock, which is open while the work is done.
static Result draw_next(Pipeline *p, Packet *packet) {
    set_state(p, packet, PACKET_DRAWING);
    pthread_mutex_unlock(&p->lock);
    Drawn drawn = {.picture_failure = RESULT_OK};
    Result result = draw(p, packet, &drawn);
    pthread_mutex_lock(&p->lock);
    if (p->counts.stats.picture_failure == RESULT_OK)
        p->counts.stats.picture_failure = drawn.picture_failure;
    if (result == RESULT_OK && !drawn.refused && packet->order.asked) {
        p->counts.stats.asked_failure = drawn.picture_failure;
        p->counts.stats.asked++;
    }
    PacketState state = drawn.refused ? PACKET_REFUSED : PACKET_FREE;
    if (result == RESULT_OK && !drawn.refused)
        state = count_frame(p, packet, &drawn);
    if (state != PACKET_HELD)
        packet_leave(packet);
    set_state(p, packet, state);
    return result;
}

// Under the lock.
static void wait_to_refine(Pipeline *p) {
    bool no_order = !p->has_waiting;
    int64_t begin_ns = clock_now_ns();
    pthread_cond_wait(&p->changed, &p->lock);
    if (no_order)
        p->waited_ns += clock_now_ns() - begin_ns;
}

static void *run_refiner(void *user) {
    Pipeline *p = user;
    pthread_mutex_lock(&p->lock);
    while (!p->leaving) {
        Result result = can_refine(p) ? refine_next(p) : RESULT_OK;
        if (result != RESULT_OK)
            fail(p, result);
        else if (!p->leaving && !can_refine(p))
            wait_to_refine(p);
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
        Packet *packet = find_to_draw(p);
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

static void begin_waiting(Pipeline *p) {
    pthread_condattr_t monotonic;
    pthread_condattr_init(&monotonic);
    pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    pthread_mutex_init(&p->lock, NULL);
    pthread_cond_init(&p->changed, NULL);
    pthread_cond_init(&p->hold_changed, &monotonic);
    pthread_condattr_destroy(&monotonic);
}

Result pipeline_create(const PipelineOptions *options, Pipeline **out) {
    Pipeline *p = calloc(1, sizeof *p);
    if (!p) {
        log_error("no memory for the frames in flight");
        return RESULT_MEMORY;
    }
    p->options = *options;
    p->options.render.lockstep = !options->threaded;
    begin_waiting(p);
    Result result = create_packets(p);
    if (result == RESULT_OK)
        result = begin_methods(p);
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
    methods_destroy(&p->methods);
    for (int i = 0; i < PACKETS; i++)
        if (p->packets[i].arena)
            arena_destroy(&p->packets[i].arena);
    pthread_cond_destroy(&p->hold_changed);
    pthread_cond_destroy(&p->changed);
    pthread_mutex_destroy(&p->lock);
    free(p);
    *pipeline = NULL;
}

static Result submit_to_threads(Pipeline *p, const FrameOrder *order, bool wait) {
    bool must_wait = wait || (p->has_waiting && (p->waiting.picture[0] || p->waiting.film));
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
    if (p->failure != RESULT_OK)
        return p->failure;
    p->waiting = *order;
    p->submitted++;
    Result result;
    do {
        result = refine_next(p);
        if (result == RESULT_OK)
            result = draw_next(p, find_packet(p, PACKET_READY));
    } while (result == RESULT_OK && find_packet(p, PACKET_REFUSED));
    if (result != RESULT_OK)
        fail(p, result);
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

bool pipeline_hold(Pipeline *p, int64_t until_ns, PipelineHeld *out) {
    const struct timespec until = {until_ns / 1000000000, until_ns % 1000000000};
    pthread_mutex_lock(&p->lock);
    p->hold_wanted = true;
    while (!p->held && pthread_cond_timedwait(&p->hold_changed, &p->lock, &until) == 0) {
    }
    p->hold_wanted = false;
    bool holds = p->held != NULL;
    if (holds)
        *out = p->held_cut;
    pthread_mutex_unlock(&p->lock);
    return holds;
}

void pipeline_let_go(Pipeline *p) {
    pthread_mutex_lock(&p->lock);
    Packet *packet = p->held;
    p->held = NULL;
    packet_let_go(packet);
    set_state(p, packet, PACKET_FREE);
    pthread_mutex_unlock(&p->lock);
}

int pipeline_frames(Pipeline *p, int64_t after, PipelineFrame *out, int max) {
    pthread_mutex_lock(&p->lock);
    int count = pipeline_counts_frames(&p->counts, after, out, max);
    pthread_mutex_unlock(&p->lock);
    return count;
}

PipelineStats pipeline_stats(Pipeline *p) {
    pthread_mutex_lock(&p->lock);
    PipelineStats stats = p->counts.stats;
    pthread_mutex_unlock(&p->lock);
    return stats;
}

PipelineTimes pipeline_times(Pipeline *p) {
    pthread_mutex_lock(&p->lock);
    PipelineTimes times = pipeline_counts_times(&p->counts);
    pthread_mutex_unlock(&p->lock);
    return times;
}
