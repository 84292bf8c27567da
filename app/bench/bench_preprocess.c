#include "app/bench/bench_preprocess.h"

#include "app/bench/bench.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/statistics.h"

#include <stdio.h>
#include <stdlib.h>

void preprocess_kind_name(const PreprocessRun *run, char out[PREPROCESS_NAME_BYTES]) {
    if (run->stride)
        snprintf(out, PREPROCESS_NAME_BYTES, "total:%d", run->stride);
    else
        snprintf(out, PREPROCESS_NAME_BYTES, "%s", run->kind == TERRAIN_ERROR_TOTAL ? "total" : "midpoint");
}

const char *preprocess_scheme_name(const PreprocessRun *run) {
    return run->scheme == ERROR_SCHEME_RECURSIVE ? "recursive" : "parallel";
}

double preprocess_median(const PreprocessBench *bench, const PreprocessRun *run) {
    return statistics_percentile(run->ns_per_vertex, bench->rounds, 0.5);
}

int preprocess_next_threads(int threads, int all) {
    int next = threads < 4 ? threads + 1 : 2 * threads;
    return threads < all && next > all ? all : next;
}

// ---- what is tried ----

static Result add_run(PreprocessBench *bench, const PreprocessRun *form) {
    PreprocessRun *runs = realloc(bench->runs, sizeof *runs * (size_t)(bench->run_count + 1));
    if (!runs)
        return RESULT_MEMORY;
    bench->runs = runs;
    PreprocessRun *run = &runs[bench->run_count++];
    *run = *form;
    run->equal = true;
    run->ns_per_vertex = calloc((size_t)bench->rounds, sizeof *run->ns_per_vertex);
    return run->ns_per_vertex ? RESULT_OK : RESULT_MEMORY;
}

static Result plan_side(PreprocessBench *bench, int side, int stride) {
    const struct {
        TerrainErrorKind kind;
        int stride;
    } kinds[] = {{TERRAIN_ERROR_MIDPOINT, 0}, {TERRAIN_ERROR_TOTAL, stride}, {TERRAIN_ERROR_TOTAL, 0}};
    Result result = RESULT_OK;
    for (size_t i = 0; i < COUNT_OF(kinds) && result == RESULT_OK; i++) {
        PreprocessRun run = {.kind = kinds[i].kind, .stride = kinds[i].stride, .side = side, .threads = 1};
        run.scheme = ERROR_SCHEME_RECURSIVE;
        result = add_run(bench, &run);
        run.scheme = ERROR_SCHEME_PARALLEL;
        for (; run.threads <= bench->threads && result == RESULT_OK;
             run.threads = preprocess_next_threads(run.threads, bench->threads))
            result = add_run(bench, &run);
    }
    return result;
}

// ---- timing ----

typedef struct Ground {
    float *height_m;
    Grid *grid;
    Forest forest;
} Ground;

static void ground_end(Ground *ground) {
    forest_destroy(&ground->forest);
    grid_destroy(&ground->grid);
    free(ground->height_m);
}

static Result ground_begin(int side, Ground *out) {
    const DemGeoref georef = {.crs = DEM_CRS_GEOGRAPHIC, .x0 = 19.0, .y0 = 50.0, .dx = 1.0 / 1200, .dy = -1.0 / 1200};
    *out = (Ground){.height_m = malloc(sizeof *out->height_m * (size_t)side * (size_t)side)};
    Result result = out->height_m ? grid_create(&georef, side, side, &out->grid) : RESULT_MEMORY;
    if (result == RESULT_OK)
        result = forest_create(side, side, &out->forest);
    if (result == RESULT_OK)
        bench_fill_rough(out->height_m, side);
    return result;
}

static Result time_run(PreprocessRun *run, int round, const Ground *ground, Jobs *jobs) {
    const ErrorFieldInput input = {.height_m = ground->height_m,
                                   .grid = ground->grid,
                                   .forest = &ground->forest,
                                   .kind = run->kind,
                                   .stride = run->stride,
                                   .scheme = run->scheme};
    ErrorField field;
    int64_t begin = clock_now_ns();
    Result result = error_field_create(&input, jobs, &field);
    if (result != RESULT_OK)
        return result;
    run->ns_per_vertex[round] = (double)(clock_now_ns() - begin) / ((double)run->side * run->side);
    uint64_t hash = error_field_hash(&field);
    run->equal = run->equal && (round == 0 || hash == run->hash);
    run->hash = hash;
    error_field_destroy(&field);
    return RESULT_OK;
}

// One round of a side's runs with so many threads.
static Result time_threads(PreprocessBench *bench, int side, int threads, int round, const Ground *ground) {
    Jobs *jobs = NULL;
    Result result = jobs_create(threads, &jobs);
    for (int i = 0; i < bench->run_count && result == RESULT_OK; i++)
        if (bench->runs[i].side == side && bench->runs[i].threads == threads)
            result = time_run(&bench->runs[i], round, ground, jobs);
    if (jobs)
        jobs_destroy(&jobs);
    return result;
}

static Result time_side(PreprocessBench *bench, int side, const Ground *ground) {
    Progress progress = progress_begin("preprocess");
    Result result = RESULT_OK;
    for (int round = 0; round < bench->rounds && result == RESULT_OK; round++) {
        for (int threads = 1; threads <= bench->threads && result == RESULT_OK;
             threads = preprocess_next_threads(threads, bench->threads))
            result = time_threads(bench, side, threads, round, ground);
        progress_update(&progress, (double)(round + 1) / bench->rounds);
    }
    progress_end(&progress);
    return result;
}

static Result measure_side(PreprocessBench *bench, int side, int stride) {
    Ground ground;
    Result result = plan_side(bench, side, stride);
    if (result != RESULT_OK)
        return result;
    result = ground_begin(side, &ground);
    if (result == RESULT_OK)
        result = time_side(bench, side, &ground);
    ground_end(&ground);
    if (result == RESULT_MEMORY)
        log_error("bench preprocess: not enough memory for %d x %d samples", side, side);
    return result;
}

static Result count_threads(int threads, int *out) {
    Jobs *jobs = NULL;
    Result result = jobs_create(threads, &jobs);
    if (result == RESULT_OK)
        *out = jobs_worker_count(jobs);
    if (jobs)
        jobs_destroy(&jobs);
    return result;
}

Result preprocess_measure(const int *sides, int side_count, int rounds, int threads, int stride, PreprocessBench *out) {
    *out = (PreprocessBench){.rounds = rounds, .side_count = side_count};
    Result result = count_threads(threads, &out->threads);
    for (int i = 0; i < side_count && result == RESULT_OK; i++) {
        out->sides[i] = sides[i];
        result = measure_side(out, sides[i], stride);
    }
    for (int i = 0; i < out->run_count && result == RESULT_OK; i++)
        statistics_sort(out->runs[i].ns_per_vertex, rounds);
    return result;
}

void preprocess_clear(PreprocessBench *bench) {
    for (int i = 0; i < bench->run_count; i++)
        free(bench->runs[i].ns_per_vertex);
    free(bench->runs);
    *bench = (PreprocessBench){.runs = NULL};
}
