// `overfly bench preprocess`.
#include "app/bench/bench.h"
#include "app/bench/bench_preprocess.h"

#include <inttypes.h>
#include <stdio.h>

#define STRIDE 8 // of the bounded kind

void bench_add_preprocess(Json *parent, const char *name, const PreprocessBench *bench) {
    Json *runs = json_add_array(parent, name);
    for (int i = 0; i < bench->run_count; i++) {
        const PreprocessRun *run = &bench->runs[i];
        char kind[PREPROCESS_NAME_BYTES], hash[24];
        preprocess_kind_name(run, kind);
        snprintf(hash, sizeof hash, "%016" PRIx64, run->hash);
        Json *row = json_append_object(runs);
        json_add_text(row, "kind", run->kind == TERRAIN_ERROR_TOTAL ? "total" : "midpoint");
        json_add_text(row, "error", kind);
        json_add_integer(row, "stride", run->stride); // 0: exact everywhere
        json_add_text(row, "scheme", preprocess_scheme_name(run));
        json_add_integer(row, "size", run->side);
        json_add_integer(row, "threads", run->threads);
        json_add_number(row, "ns_per_vertex", preprocess_median(bench, run));
        json_add_number(row, "ns_per_vertex_min", run->ns_per_vertex[0]);
        json_add_number(row, "ns_per_vertex_max", run->ns_per_vertex[bench->rounds - 1]);
        json_add_text(row, "hash", hash);
        json_add_bool(row, "equal_in_all_rounds", run->equal);
    }
}

static Result print_json(const PreprocessBench *bench) {
    Json *json = json_create();
    bench_add_machine(json);
    json_add_integer(json, "rounds", bench->rounds);
    bench_add_preprocess(json, "runs", bench);
    Result result = json_print(json);
    json_destroy(&json);
    return result;
}

static void print_text(const PreprocessBench *bench) {
    printf("%-9s %-10s %6s %8s  %-26s %s\n", "error", "scheme", "side", "threads", "ns a vertex (min .. max)", "hash");
    for (int i = 0; i < bench->run_count; i++) {
        const PreprocessRun *run = &bench->runs[i];
        char kind[PREPROCESS_NAME_BYTES];
        preprocess_kind_name(run, kind);
        printf("%-9s %-10s %6d %8d  %7.2f (%.2f .. %.2f)  %016" PRIx64 "%s\n", kind, preprocess_scheme_name(run),
               run->side, run->threads, preprocess_median(bench, run), run->ns_per_vertex[0],
               run->ns_per_vertex[bench->rounds - 1], run->hash, run->equal ? "" : "  DIFFERS BETWEEN ROUNDS");
    }
}

Result bench_preprocess(const Options *options) {
    PreprocessBench bench = {.runs = NULL};
    int sides[PREPROCESS_SIDES_MAX], count;
    Result result = bench_read_sides(options_text(options, OPTION_SIDES), PREPROCESS_SIDES_MAX, sides, &count);
    if (result == RESULT_OK)
        result = preprocess_measure(sides, count, (int)options_integer(options, OPTION_ROUNDS),
                                    (int)options_integer(options, OPTION_THREADS), STRIDE, &bench);
    if (result == RESULT_OK && options_flag(options, OPTION_JSON))
        result = print_json(&bench);
    else if (result == RESULT_OK)
        print_text(&bench);
    preprocess_clear(&bench);
    return result;
}
