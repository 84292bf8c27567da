#define _POSIX_C_SOURCE 200809L
#include "terrain/jobs.h"

#include "base/log.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <unistd.h>

#define WORKERS_MAX 64

typedef struct Worker {
    Jobs *jobs;
    int index;
    pthread_t thread;
} Worker;

struct Jobs {
    pthread_mutex_t lock;
    pthread_cond_t work_ready, work_done;
    int worker_count, started;
    uint64_t round; // counts jobs_run calls, so that a worker joins each one once
    int busy;
    bool quit;
    JobsTask *task;
    void *user;
    int64_t count, grain;
    atomic_int_least64_t next;
    Worker workers[WORKERS_MAX];
};

static void run_pieces(Jobs *jobs, int worker) {
    for (;;) {
        int64_t begin = atomic_fetch_add_explicit(&jobs->next, jobs->grain, memory_order_relaxed);
        if (begin >= jobs->count)
            return;
        int64_t end = begin + jobs->grain < jobs->count ? begin + jobs->grain : jobs->count;
        jobs->task(jobs->user, begin, end, worker);
    }
}

static void *worker_main(void *argument) {
    Worker *self = argument;
    Jobs *jobs = self->jobs;
    uint64_t round = 0;
    pthread_mutex_lock(&jobs->lock);
    for (;;) {
        while (jobs->round == round && !jobs->quit)
            pthread_cond_wait(&jobs->work_ready, &jobs->lock);
        if (jobs->quit)
            break;
        round = jobs->round;
        pthread_mutex_unlock(&jobs->lock);
        run_pieces(jobs, self->index);
        pthread_mutex_lock(&jobs->lock);
        if (--jobs->busy == 0)
            pthread_cond_signal(&jobs->work_done);
    }
    pthread_mutex_unlock(&jobs->lock);
    return NULL;
}

static int processor_count(void) {
    long online = sysconf(_SC_NPROCESSORS_ONLN);
    return online < 1 ? 1 : online > WORKERS_MAX ? WORKERS_MAX : (int)online;
}

Result jobs_create(int workers, Jobs **out) {
    if (workers < 0 || workers > WORKERS_MAX) {
        log_error("workers: %d is not within 0..%d", workers, WORKERS_MAX);
        return RESULT_RANGE;
    }
    Jobs *jobs = calloc(1, sizeof *jobs);
    if (!jobs)
        return RESULT_MEMORY;
    jobs->worker_count = workers ? workers : processor_count();
    pthread_mutex_init(&jobs->lock, NULL);
    pthread_cond_init(&jobs->work_ready, NULL);
    pthread_cond_init(&jobs->work_done, NULL);
    for (int i = 1; i < jobs->worker_count; i++) {
        jobs->workers[i] = (Worker){.jobs = jobs, .index = i};
        if (pthread_create(&jobs->workers[i].thread, NULL, worker_main, &jobs->workers[i])) {
            log_error("the system gave %d of %d worker threads; ask for fewer with --threads", i, jobs->worker_count);
            jobs_destroy(&jobs);
            return RESULT_DEVICE;
        }
        jobs->started = i;
    }
    *out = jobs;
    return RESULT_OK;
}

void jobs_destroy(Jobs **jobs) {
    if (!*jobs)
        return;
    pthread_mutex_lock(&(*jobs)->lock);
    (*jobs)->quit = true;
    pthread_cond_broadcast(&(*jobs)->work_ready);
    pthread_mutex_unlock(&(*jobs)->lock);
    for (int i = 1; i <= (*jobs)->started; i++)
        pthread_join((*jobs)->workers[i].thread, NULL);
    pthread_cond_destroy(&(*jobs)->work_done);
    pthread_cond_destroy(&(*jobs)->work_ready);
    pthread_mutex_destroy(&(*jobs)->lock);
    free(*jobs);
    *jobs = NULL;
}

int jobs_worker_count(const Jobs *jobs) {
    return jobs->worker_count;
}

static void begin_range(Jobs *jobs, int64_t count, int64_t grain, JobsTask *task, void *user) {
    jobs->task = task;
    jobs->user = user;
    jobs->count = count;
    jobs->grain = grain > 0 ? grain : 1;
    atomic_store_explicit(&jobs->next, 0, memory_order_relaxed);
}

void jobs_run(Jobs *jobs, int64_t count, int64_t grain, JobsTask *task, void *user) {
    if (count <= 0)
        return;
    if (jobs->started == 0 || count <= grain) { // nobody to share with; the pieces are the same
        begin_range(jobs, count, grain, task, user);
        run_pieces(jobs, 0);
        return;
    }
    pthread_mutex_lock(&jobs->lock);
    begin_range(jobs, count, grain, task, user);
    jobs->busy = jobs->started;
    jobs->round++;
    pthread_cond_broadcast(&jobs->work_ready);
    pthread_mutex_unlock(&jobs->lock);
    run_pieces(jobs, 0);
    pthread_mutex_lock(&jobs->lock);
    while (jobs->busy > 0)
        pthread_cond_wait(&jobs->work_done, &jobs->lock);
    pthread_mutex_unlock(&jobs->lock);
}
