// `overfly bench preprocess`: what the nested error fields cost, each way they can be computed, on synthetic rough
// ground. The rounds are interleaved: each computes every kind once, so that a busy machine harms all alike.
#include "app/bench/bench.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/statistics.h"
#include "terrain/errors/error_field.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define SIDES_MAX 8
#define RUNS_MAX (SIDES_MAX * 8)

typedef struct Run {
    TerrainErrorKind kind;
    ErrorScheme scheme;
    int side, threads;
    double *ns_per_vertex; // [rounds]
    uint64_t hash;
    bool equal; // the hash was the same in all rounds
} Run;

typedef struct Bench {
    int rounds, threads;
    int sides[SIDES_MAX], side_count;
    Run runs[RUNS_MAX];
    int run_count;
} Bench;

static const char *kind_name(TerrainErrorKind kind) {
    return kind == TERRAIN_ERROR_TOTAL ? "total" : "midpoint";
}

static const char *scheme_name(ErrorScheme scheme) {
    return scheme == ERROR_SCHEME_RECURSIVE ? "recursive" : "parallel";
}

static Result add_run(Bench *bench, TerrainErrorKind kind, ErrorScheme scheme, int side, int threads) {
    Run *run = &bench->runs[bench->run_count];
    *run = (Run){.kind = kind, .scheme = scheme, .side = side, .threads = threads, .equal = true};
    run->ns_per_vertex = calloc((size_t)bench->rounds, sizeof *run->ns_per_vertex);
    if (!run->ns_per_vertex)
        return RESULT_MEMORY;
    bench->run_count++;
    return RESULT_OK;
}

static Result plan(Bench *bench) {
    Result result = RESULT_OK;
    for (int i = 0; i < bench->side_count && result == RESULT_OK; i++) {
        for (int kind = TERRAIN_ERROR_MIDPOINT; kind <= TERRAIN_ERROR_TOTAL && result == RESULT_OK; kind++) {
            result = add_run(bench, (TerrainErrorKind)kind, ERROR_SCHEME_RECURSIVE, bench->sides[i], 1);
            if (result == RESULT_OK)
                result = add_run(bench, (TerrainErrorKind)kind, ERROR_SCHEME_PARALLEL, bench->sides[i], 1);
            if (result == RESULT_OK && bench->threads > 1)
                result = add_run(bench, (TerrainErrorKind)kind, ERROR_SCHEME_PARALLEL, bench->sides[i], bench->threads);
        }
    }
    return result;
}

static Result time_run(Run *run, int round, const float *height_m, const Grid *grid, const Forest *forest, Jobs *jobs) {
    ErrorFieldInput input = {height_m, grid, forest, run->kind, run->scheme, NULL};
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

// All rounds of the runs of one side.
static Result time_side(Bench *bench, int side, const float *height_m, const Grid *grid, const Forest *forest) {
    Jobs *one = NULL, *all = NULL;
    Result result = jobs_create(1, &one);
    if (result == RESULT_OK)
        result = jobs_create(bench->threads, &all);
    Progress progress = progress_begin("preprocess");
    for (int round = 0; round < bench->rounds && result == RESULT_OK; round++) {
        for (int i = 0; i < bench->run_count && result == RESULT_OK; i++) {
            Run *run = &bench->runs[i];
            if (run->side == side)
                result = time_run(run, round, height_m, grid, forest, run->threads == 1 ? one : all);
        }
        progress_update(&progress, (double)(round + 1) / bench->rounds);
    }
    progress_end(&progress);
    jobs_destroy(&all);
    jobs_destroy(&one);
    return result;
}

static Result bench_side(Bench *bench, int side) {
    DemGeoref georef = {.crs = DEM_CRS_GEOGRAPHIC, .x0 = 19.0, .y0 = 50.0, .dx = 1.0 / 1200, .dy = -1.0 / 1200};
    float *height_m = malloc(sizeof *height_m * (size_t)side * (size_t)side);
    Grid *grid = NULL;
    Forest forest = {0};
    Result result = height_m ? grid_create(&georef, side, side, &grid) : RESULT_MEMORY;
    if (result == RESULT_OK)
        result = forest_create(side, side, &forest);
    if (result == RESULT_OK) {
        bench_fill_rough(height_m, side);
        result = time_side(bench, side, height_m, grid, &forest);
    }
    if (result == RESULT_MEMORY)
        log_error("bench preprocess: not enough memory for %d x %d samples", side, side);
    forest_destroy(&forest);
    grid_destroy(&grid);
    free(height_m);
    return result;
}

static void add_run_json(Json *array, Run *run, int rounds) {
    char hash[24];
    snprintf(hash, sizeof hash, "%016" PRIx64, run->hash);
    statistics_sort(run->ns_per_vertex, rounds);
    Json *row = json_append_object(array);
    json_add_text(row, "kind", kind_name(run->kind));
    json_add_text(row, "scheme", scheme_name(run->scheme));
    json_add_integer(row, "size", run->side);
    json_add_integer(row, "threads", run->threads);
    json_add_number(row, "ns_per_vertex", statistics_percentile(run->ns_per_vertex, rounds, 0.5));
    json_add_number(row, "ns_per_vertex_min", run->ns_per_vertex[0]);
    json_add_number(row, "ns_per_vertex_max", run->ns_per_vertex[rounds - 1]);
    json_add_text(row, "hash", hash);
    json_add_bool(row, "equal_in_all_rounds", run->equal);
}

static Result print_json(Bench *bench) {
    Json *json = json_create();
    bench_add_machine(json);
    json_add_integer(json, "rounds", bench->rounds);
    Json *runs = json_add_array(json, "runs");
    for (int i = 0; i < bench->run_count; i++)
        add_run_json(runs, &bench->runs[i], bench->rounds);
    Result result = json_print(json);
    json_destroy(&json);
    return result;
}

static void print_text(Bench *bench) {
    printf("%-9s %-10s %6s %8s  %-26s %s\n", "error", "scheme", "side", "threads", "ns a vertex (min .. max)", "hash");
    for (int i = 0; i < bench->run_count; i++) {
        Run *run = &bench->runs[i];
        statistics_sort(run->ns_per_vertex, bench->rounds);
        printf("%-9s %-10s %6d %8d  %7.2f (%.2f .. %.2f)  %016" PRIx64 "%s\n", kind_name(run->kind),
               scheme_name(run->scheme), run->side, run->threads,
               statistics_percentile(run->ns_per_vertex, bench->rounds, 0.5), run->ns_per_vertex[0],
               run->ns_per_vertex[bench->rounds - 1], run->hash, run->equal ? "" : "  DIFFERS BETWEEN ROUNDS");
    }
}

Result bench_preprocess(const Options *options) {
    Bench bench = {.rounds = (int)options_integer(options, OPTION_ROUNDS)};
    Jobs *jobs = NULL;
    Result result = jobs_create((int)options_integer(options, OPTION_THREADS), &jobs);
    if (result != RESULT_OK)
        return result;
    bench.threads = jobs_worker_count(jobs);
    jobs_destroy(&jobs);
    result = bench_read_sides(options_text(options, OPTION_SIDES), SIDES_MAX, bench.sides, &bench.side_count);
    if (result == RESULT_OK)
        result = plan(&bench);
    for (int i = 0; i < bench.side_count && result == RESULT_OK; i++)
        result = bench_side(&bench, bench.sides[i]);
    if (result == RESULT_OK && options_flag(options, OPTION_JSON))
        result = print_json(&bench);
    else if (result == RESULT_OK)
        print_text(&bench);
    for (int i = 0; i < bench.run_count; i++)
        free(bench.runs[i].ns_per_vertex);
    return result;
}
