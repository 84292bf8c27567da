// app/bench/bench_preprocess.h: what building the nested error fields takes, each way they can be computed, over
// synthetic rough ground.
// Nanoseconds a vertex; sides in samples.
// A PreprocessBench owns its runs and their times.
#pragma once
#include "base/base.h"
#include "terrain/errors/error_field.h"

#define PREPROCESS_SIDES_MAX 8
#define PREPROCESS_NAME_BYTES 24

typedef struct PreprocessRun {
    TerrainErrorKind kind;
    int stride; // of a total error that is bounded above it; 0: exact
    ErrorScheme scheme;
    int side, threads;
    double *ns_per_vertex; // [rounds], ascending once measured
    uint64_t hash;         // of the field
    bool equal;            // it was the same in all rounds
} PreprocessRun;

typedef struct PreprocessBench {
    int rounds, threads; // threads: of the most that are tried
    int sides[PREPROCESS_SIDES_MAX], side_count;
    PreprocessRun *runs; // by side
    int run_count;
} PreprocessBench;

// Both kinds of errors and the one that is bounded above `stride`, the recursive scheme with one thread and the
// parallel one with 1, 2, 3, 4, 8,
// ... `threads` (0: one per processor). The rounds are interleaved: each computes every kind once, so that a busy
// machine harms all alike. MEMORY; logged.
MUST_USE Result preprocess_measure(const int *sides, int side_count, int rounds, int threads, int stride,
                                   PreprocessBench *out);
void preprocess_clear(PreprocessBench *bench);

// As --error takes it: "total:4".
void preprocess_kind_name(const PreprocessRun *run, char out[PREPROCESS_NAME_BYTES]);
const char *preprocess_scheme_name(const PreprocessRun *run);
// The median of its rounds.
double preprocess_median(const PreprocessBench *bench, const PreprocessRun *run);

// The next number of threads to try after `threads`: 1, 2, 3, 4, then doubled, at last `all`; above `all`: none.
int preprocess_next_threads(int threads, int all);
