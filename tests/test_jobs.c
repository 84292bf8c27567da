// The worker pool: every item once, on any number of workers, whatever the grain.
#include "base/log.h"
#include "terrain/jobs.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define ITEMS_MAX 10000

static const int WORKERS[] = {1, 2, 3, 8, 16};

typedef struct Tally {
    _Atomic int visits[ITEMS_MAX];
    _Atomic int busy[64]; // by worker
    _Atomic int clashes;  // a worker that ran two pieces at a time, or an index out of range
    _Atomic int bad_pieces;
    int64_t count, grain;
    int worker_count;
} Tally;

static void tally_task(void *user, int64_t begin, int64_t end, int worker) {
    Tally *t = user;
    if (worker < 0 || worker >= t->worker_count || atomic_fetch_add(&t->busy[worker], 1))
        t->clashes++;
    if (begin < 0 || end <= begin || end > t->count)
        t->bad_pieces++;
    else
        for (int64_t i = begin; i < end; i++)
            t->visits[i]++;
    if (worker >= 0 && worker < t->worker_count)
        atomic_fetch_sub(&t->busy[worker], 1);
}

static int wrong_visits(const Tally *t) {
    int wrong = 0;
    for (int64_t i = 0; i < ITEMS_MAX; i++)
        wrong += t->visits[i] != (i < t->count);
    return wrong;
}

static void check_run(Jobs *jobs, Tally *t, int64_t count, int64_t grain) {
    memset(t, 0, sizeof *t);
    t->count = count;
    t->grain = grain;
    t->worker_count = jobs_worker_count(jobs);
    jobs_run(jobs, count, grain, tally_task, t);
    int wrong = wrong_visits(t);
    if (wrong || t->clashes || t->bad_pieces)
        fail_msg("%d workers, %lld items, grain %lld: %d items not visited once, %d clashes, %d bad pieces",
                 t->worker_count, (long long)count, (long long)grain, wrong, t->clashes, t->bad_pieces);
}

static void test_every_item_is_visited_once(void **state) {
    (void)state;
    static const int64_t COUNTS[] = {0, 1, 2, 7, 64, 1000, ITEMS_MAX}, GRAINS[] = {1, 3, 64, ITEMS_MAX, 5 * ITEMS_MAX};
    Tally *tally = malloc(sizeof *tally);
    for (size_t w = 0; w < COUNT_OF(WORKERS); w++) {
        Jobs *jobs;
        assert_int_equal(jobs_create(WORKERS[w], &jobs), RESULT_OK);
        assert_int_equal(jobs_worker_count(jobs), WORKERS[w]);
        for (size_t c = 0; c < COUNT_OF(COUNTS); c++)
            for (size_t g = 0; g < COUNT_OF(GRAINS); g++)
                check_run(jobs, tally, COUNTS[c], GRAINS[g]);
        jobs_destroy(&jobs);
        assert_null(jobs);
    }
    free(tally);
}

static void test_many_short_runs_in_a_row_lose_nothing(void **state) {
    (void)state;
    Tally *tally = malloc(sizeof *tally);
    Jobs *jobs;
    assert_int_equal(jobs_create(4, &jobs), RESULT_OK);
    for (int i = 0; i < 3000; i++)
        check_run(jobs, tally, 1 + i % 9, 1);
    jobs_destroy(&jobs);
    free(tally);
}

static void test_a_pool_that_never_worked_ends(void **state) {
    (void)state;
    for (int i = 0; i < 100; i++) {
        Jobs *jobs;
        assert_int_equal(jobs_create(3, &jobs), RESULT_OK);
        jobs_destroy(&jobs);
    }
    Jobs *none = NULL;
    jobs_destroy(&none);
}

static void sum_task(void *user, int64_t begin, int64_t end, int worker) {
    (void)worker;
    double *values = user;
    for (int64_t i = begin; i < end; i++)
        values[i] = values[i] / 3.0 + (double)i;
}

static void test_writes_of_workers_are_seen_afterwards(void **state) {
    (void)state;
    double *values = calloc(ITEMS_MAX, sizeof *values), sums[COUNT_OF(WORKERS)] = {0};
    for (size_t w = 0; w < COUNT_OF(WORKERS); w++) {
        Jobs *jobs;
        assert_int_equal(jobs_create(WORKERS[w], &jobs), RESULT_OK);
        memset(values, 0, ITEMS_MAX * sizeof *values);
        for (int pass = 0; pass < 20; pass++)
            jobs_run(jobs, ITEMS_MAX, 17, sum_task, values);
        for (int i = 0; i < ITEMS_MAX; i++)
            sums[w] += values[i];
        jobs_destroy(&jobs);
        print_message("%2d workers: %.17g\n", WORKERS[w], sums[w]);
        assert_memory_equal(&sums[w], &sums[0], sizeof sums[0]);
    }
    free(values);
}

static void count_message(void *user, LogLevel level, const char *message) {
    (void)level;
    (void)message;
    ++*(int *)user;
}

static void test_impossible_numbers_of_workers_are_refused(void **state) {
    (void)state;
    static const int BAD[] = {-1, 65, 1000000};
    int messages = 0;
    log_set_sink(count_message, &messages);
    for (size_t i = 0; i < COUNT_OF(BAD); i++) {
        Jobs *jobs = NULL;
        assert_int_equal(jobs_create(BAD[i], &jobs), RESULT_RANGE);
        assert_null(jobs);
    }
    log_set_sink(NULL, NULL);
    assert_int_equal(messages, COUNT_OF(BAD));
}

static void test_zero_means_one_per_processor(void **state) {
    (void)state;
    Jobs *jobs;
    assert_int_equal(jobs_create(0, &jobs), RESULT_OK);
    print_message("%d workers\n", jobs_worker_count(jobs));
    assert_true(jobs_worker_count(jobs) >= 1);
    jobs_destroy(&jobs);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_item_is_visited_once),
        cmocka_unit_test(test_many_short_runs_in_a_row_lose_nothing),
        cmocka_unit_test(test_a_pool_that_never_worked_ends),
        cmocka_unit_test(test_writes_of_workers_are_seen_afterwards),
        cmocka_unit_test(test_impossible_numbers_of_workers_are_refused),
        cmocka_unit_test(test_zero_means_one_per_processor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
