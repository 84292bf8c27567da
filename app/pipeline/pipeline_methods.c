#define _POSIX_C_SOURCE 200809L
#include "app/pipeline/pipeline_methods.h"

#include "app/signals.h"
#include "base/clock.h"
#include "base/log.h"

#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

#define MS_PER_NS 1e-6

// What the creating thread is asked for and what it gave.
typedef enum MakingState { MAKING_NOTHING, MAKING_ASKED, MAKING_BEGUN, MAKING_DONE } MakingState;
typedef struct Making {
    MakingState state;
    LodOptions lod;
    MethodRun *made; // NULL: `result` says why
    Result result;
} Making;

typedef struct Half {
    MethodRun *current, *candidate;
    MethodRun *former; // kept until the first cut of a resident one is drawn
    bool refused;      // `refused_method`, and nothing else was wanted since
    LodMethod refused_method;
    Making making; // under the lock
} Half;

struct Methods {
    MethodsOptions options;
    Half halves[METHODS_HALVES];
    MethodRun *retired;
    uint32_t serials;
    MethodChanges changes;

    pthread_mutex_t lock;
    pthread_cond_t changed;
    pthread_t maker;
    bool maker_runs, leaving;
};

static void destroy_run(MethodRun **run) {
    if (!*run)
        return;
    lod_destroy(&(*run)->lod);
    free(*run);
    *run = NULL;
}

static LodOptions next_lod(Methods *methods, LodMethod method) {
    LodOptions lod = methods->options.lod;
    lod.method = method;
    lod.serial = ++methods->serials;
    lod.resident = lod.resident && method == LOD_DIAMOND;
    return lod;
}

// Any thread.
static Result create_run(const LodOptions *lod, const Terrain *terrain, MethodRun **out) {
    MethodRun *run = calloc(1, sizeof *run);
    if (!run) {
        log_error("no memory for another level-of-detail method");
        return RESULT_MEMORY;
    }
    run->method = lod->method;
    run->resident = lod->resident;
    int64_t begin_ns = clock_now_ns();
    Result result = lod_create(lod, terrain, &run->lod);
    run->create_ms = (double)(clock_now_ns() - begin_ns) * MS_PER_NS;
    if (result == RESULT_OK)
        *out = run;
    else
        free(run);
    return result;
}

// --- the creating thread

// Under the lock.
static Making *find_asked(Methods *methods) {
    for (int i = 0; i < METHODS_HALVES; i++)
        if (methods->halves[i].making.state == MAKING_ASKED)
            return &methods->halves[i].making;
    return NULL;
}

// Under the lock, which is open while the work is done.
static void make(Methods *methods, Making *making) {
    making->state = MAKING_BEGUN;
    const LodOptions lod = making->lod;
    MethodRun *made = NULL;
    pthread_mutex_unlock(&methods->lock);
    Result result = create_run(&lod, methods->options.terrain, &made);
    pthread_mutex_lock(&methods->lock);
    making->made = made;
    making->result = result;
    making->state = MAKING_DONE;
}

static void *run_maker(void *user) {
    Methods *methods = user;
    pthread_mutex_lock(&methods->lock);
    while (!methods->leaving) {
        Making *asked = find_asked(methods);
        if (asked)
            make(methods, asked);
        else
            pthread_cond_wait(&methods->changed, &methods->lock);
    }
    pthread_mutex_unlock(&methods->lock);
    return NULL;
}

static Result start_maker(Methods *methods) {
    sigset_t before;
    signals_hold_all(&before);
    methods->maker_runs = pthread_create(&methods->maker, NULL, run_maker, methods) == 0;
    signals_restore(&before);
    if (!methods->maker_runs)
        log_error("a thread cannot be started; is the limit of processes reached (ulimit -u)?");
    return methods->maker_runs ? RESULT_OK : RESULT_MEMORY;
}

static void stop_maker(Methods *methods) {
    pthread_mutex_lock(&methods->lock);
    methods->leaving = true;
    pthread_cond_broadcast(&methods->changed);
    pthread_mutex_unlock(&methods->lock);
    if (methods->maker_runs)
        pthread_join(methods->maker, NULL);
}

// Under the lock.
static void forget_made(Making *making) {
    if (making->state != MAKING_DONE)
        return;
    destroy_run(&making->made);
    making->state = MAKING_NOTHING;
}

// --- lifetime

Result methods_create(const MethodsOptions *options, Methods **out) {
    Methods *methods = calloc(1, sizeof *methods);
    if (!methods) {
        log_error("no memory for the level-of-detail methods");
        return RESULT_MEMORY;
    }
    methods->options = *options;
    pthread_mutex_init(&methods->lock, NULL);
    pthread_cond_init(&methods->changed, NULL);
    Result result = options->threaded ? start_maker(methods) : RESULT_OK;
    if (result == RESULT_OK)
        *out = methods;
    else
        methods_destroy(&methods);
    return result;
}

static void destroy_retired(Methods *methods) {
    while (methods->retired) {
        MethodRun *run = methods->retired;
        methods->retired = run->next;
        destroy_run(&run);
    }
}

void methods_destroy(Methods **methods) {
    Methods *self = *methods;
    if (!self)
        return;
    stop_maker(self);
    for (int i = 0; i < METHODS_HALVES; i++) {
        forget_made(&self->halves[i].making);
        destroy_run(&self->halves[i].candidate);
        destroy_run(&self->halves[i].former);
        destroy_run(&self->halves[i].current);
    }
    destroy_retired(self);
    pthread_cond_destroy(&self->changed);
    pthread_mutex_destroy(&self->lock);
    free(self);
    *methods = NULL;
}

// --- changes

static Result create_now(Methods *methods, LodMethod method, MethodRun **out) {
    const LodOptions lod = next_lod(methods, method);
    return create_run(&lod, methods->options.terrain, out);
}

// Two triangles a cell, as no cell is left out. `why`: the words that the screen shows.
static Result check_size(const Methods *methods, LodMethod method, char why[METHODS_WHY_BYTES]) {
    const Dem *dem = terrain_dem(methods->options.terrain);
    int64_t triangles = 2 * (int64_t)(dem->width - 1) * (dem->height - 1), most = methods->options.lod.max_triangles;
    why[0] = '\0';
    if (method != LOD_BRUTE || !methods->options.bound_brute || triangles <= most)
        return RESULT_OK;
    snprintf(why, METHODS_WHY_BYTES, "%" PRId64 " triangles, more than --max-triangles %" PRId64, triangles, most);
    log_error("%s: the terrain has %s: raise that, or take another method", lod_method_name(method), why);
    return RESULT_RANGE;
}

Result methods_begin(Methods *methods, int half, LodMethod method) {
    char why[METHODS_WHY_BYTES];
    Result result = check_size(methods, method, why);
    return result == RESULT_OK ? create_now(methods, method, &methods->halves[half].current) : result;
}

MethodRun *methods_current(const Methods *methods, int half) {
    return methods->halves[half].current;
}

MethodChanges methods_changes(const Methods *methods) {
    return methods->changes;
}

static void retire(Methods *methods, MethodRun *run) {
    if (!run)
        return;
    run->next = methods->retired;
    methods->retired = run;
}

void methods_sweep(Methods *methods) {
    for (MethodRun **link = &methods->retired; *link;) {
        MethodRun *run = *link;
        if (atomic_load(&run->users) > 0) {
            link = &run->next;
            continue;
        }
        *link = run->next;
        destroy_run(&run);
    }
}

static Result fall_back(Methods *methods, int index) {
    Half *half = &methods->halves[index];
    LodMethod method = half->current->method;
    if (methods->options.lod.resident)
        log_warn("%s: the GPU cannot hold it; the processor computes it instead, as with --compute cpu",
                 lod_method_name(method));
    methods->options.lod.resident = false;
    methods->changes.fallbacks++;
    retire(methods, half->current);
    half->current = half->former;
    half->former = NULL;
    return half->current || index > 0 ? RESULT_OK : create_now(methods, method, &half->current);
}

Result methods_settle(Methods *methods) {
    Result result = RESULT_OK;
    for (int i = 0; i < METHODS_HALVES && result == RESULT_OK; i++) {
        Half *half = &methods->halves[i];
        if (half->current && atomic_load(&half->current->undrawable)) {
            result = fall_back(methods, i);
        } else if (half->former && atomic_load(&half->current->drawn) > 0) {
            retire(methods, half->former);
            half->former = NULL;
        }
    }
    return result;
}

static void refuse(Methods *methods, Half *half, LodMethod method, Result why) {
    half->refused = true;
    half->refused_method = method;
    methods->changes.refusals++;
    methods->changes.refused = method;
    methods->changes.refusal = why;
}

// Takes what was made of the method, or asks for it.
static Result take_or_ask(Methods *methods, Half *half, LodMethod wanted, MethodRun **out) {
    Result result = RESULT_OK;
    Making *making = &half->making;
    pthread_mutex_lock(&methods->lock);
    if (making->state == MAKING_DONE && making->lod.method == wanted) {
        *out = making->made;
        making->made = NULL;
        result = making->result;
        making->state = MAKING_NOTHING;
    } else {
        forget_made(making);
        if (making->state == MAKING_NOTHING)
            *making = (Making){.state = MAKING_ASKED, .lod = next_lod(methods, wanted)};
        pthread_cond_broadcast(&methods->changed);
    }
    pthread_mutex_unlock(&methods->lock);
    return result;
}

static void forget_unwanted(Methods *methods, Half *half) {
    pthread_mutex_lock(&methods->lock);
    forget_made(&half->making);
    if (half->making.state == MAKING_ASKED)
        half->making.state = MAKING_NOTHING;
    pthread_mutex_unlock(&methods->lock);
}

MethodRun *methods_find_candidate(Methods *methods, int index, LodMethod wanted) {
    Half *half = &methods->halves[index];
    half->refused = half->refused && half->refused_method == wanted;
    if (half->refused)
        return NULL;
    if (half->current && half->current->method == wanted) {
        forget_unwanted(methods, half);
        return NULL;
    }
    Result result = check_size(methods, wanted, methods->changes.why);
    if (result == RESULT_OK)
        result = methods->options.threaded ? take_or_ask(methods, half, wanted, &half->candidate)
                                           : create_now(methods, wanted, &half->candidate);
    if (result != RESULT_OK)
        refuse(methods, half, wanted, result);
    return half->candidate;
}

static void longest(double *kept_ms, double ms) {
    *kept_ms = ms > *kept_ms ? ms : *kept_ms;
}

void methods_judge(Methods *methods, int index, Result result, double refine_ms) {
    Half *half = &methods->halves[index];
    if (result != RESULT_OK) {
        refuse(methods, half, half->candidate->method, result);
        destroy_run(&half->candidate);
        return;
    }
    retire(methods, half->former);
    half->former = half->candidate->resident ? half->current : NULL;
    if (!half->former)
        retire(methods, half->current);
    half->current = half->candidate;
    half->candidate = NULL;
    methods->changes.changes++;
    longest(&methods->changes.longest_create_ms, half->current->create_ms);
    longest(&methods->changes.longest_first_refine_ms, refine_ms);
    log_debug("%s: %s, created in %.1f ms, first refined in %.1f ms", index ? "right half" : "left half",
              lod_method_name(half->current->method), half->current->create_ms, refine_ms);
}

void methods_leave(Methods *methods, int index) {
    Half *half = &methods->halves[index];
    forget_unwanted(methods, half);
    retire(methods, half->former);
    retire(methods, half->current);
    half->former = half->current = NULL;
    half->refused = false;
}
