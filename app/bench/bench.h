// app/bench/bench.h: what the benchmarks share: the machine they ran on, times and their spread, a synthetic terrain.
// Nanoseconds and milliseconds as named; metres.
// Values; the caller owns what it allocates.
#pragma once
#include "app/bench/bench_preprocess.h"
#include "app/json.h"
#include "base/base.h"
#include "config/options.h"

// `overfly bench [SCENE|DEM]...`: app/accuracy. RANGE: a promise was broken; the report says which.
MUST_USE Result bench_accuracy(const Options *options);
// `overfly bench preprocess`, `overfly bench refine`, `overfly bench partitions`, `overfly bench governor`,
// `overfly bench panel`.
MUST_USE Result bench_preprocess(const Options *options);
MUST_USE Result bench_refine(const Options *options);
MUST_USE Result bench_partitions(const Options *options);
MUST_USE Result bench_governor(const Options *options);
MUST_USE Result bench_panel(const Options *options);

// The machine this runs on.
typedef struct BenchMachine {
    char processor[128]; // "unknown" where the system does not tell
    int processors;
    const char *compiler; // static
    bool optimized;
} BenchMachine;
BenchMachine bench_machine(void);

// Up to `max` sides of 3, 5, 9 ... 16385 samples (2^n + 1), separated by commas. USAGE; logged.
MUST_USE Result bench_read_sides(const char *text, int max, int *sides, int *count);

// The one tolerance of a benchmark: --tau, else 1 pixel. USAGE: a list, or no number; logged.
MUST_USE Result bench_tau(const Options *options, double *tau_px);

// "machine": processor, processors, compiler, build.
void bench_add_machine(Json *parent);

// An array of the runs.
void bench_add_preprocess(Json *parent, const char *name, const PreprocessBench *bench);

// Bytes of the program's memory that hold no file, now; 0 where the system does not tell.
int64_t bench_resident_bytes(void);

// {p50, p99, max} of `count` values, which are sorted.
void bench_add_percentiles(Json *parent, const char *name, double *values, int count);

// Rough ground: midpoint noise of octaves down to single samples, each 0.55 of the one before, 0 .. about 1800 m.
// [side][side]
void bench_fill_rough(float *height_m, int side);
