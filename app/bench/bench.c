#define _POSIX_C_SOURCE 200809L
#include "app/bench/bench.h"

#include "base/log.h"
#include "base/statistics.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define ROUGH_OCTAVES 11
#define ROUGH_AMPLITUDE_M 800.0f
#define ROUGH_PERSISTENCE 0.55f

// "model name : AMD ..." of /proc/cpuinfo.
static void read_processor(char *out, size_t size) {
    snprintf(out, size, "unknown");
    FILE *file = fopen("/proc/cpuinfo", "r");
    char line[256];
    while (file && fgets(line, sizeof line, file)) {
        char *value = strchr(line, ':');
        if (strncmp(line, "model name", 10) != 0 || !value)
            continue;
        value[strcspn(value, "\n")] = '\0';
        snprintf(out, size, "%s", value + 2);
        break;
    }
    if (file)
        fclose(file);
}

BenchMachine bench_machine(void) {
    BenchMachine machine = {.processors = (int)sysconf(_SC_NPROCESSORS_ONLN), .compiler = __VERSION__};
    read_processor(machine.processor, sizeof machine.processor);
#ifdef __OPTIMIZE__
    machine.optimized = true;
#endif
    return machine;
}

void bench_add_machine(Json *parent) {
    BenchMachine machine = bench_machine();
    Json *object = json_add_object(parent, "machine");
    json_add_text(object, "processor", machine.processor);
    json_add_integer(object, "processors", machine.processors);
    json_add_text(object, "compiler", machine.compiler);
    json_add_bool(object, "optimized", machine.optimized);
}

static bool is_side(long side) {
    return side >= 3 && side <= 16385 && ((side - 1) & (side - 2)) == 0;
}

Result bench_read_sides(const char *text, int max, int *sides, int *count) {
    *count = 0;
    for (const char *next = text; *next;) {
        char *end;
        long side = strtol(next, &end, 10);
        if (end == next || !is_side(side) || (*end && *end != ',') || *count == max) {
            log_error("--sides: expected up to %d of 3, 5, 9 ... 16385 (2^n + 1), separated by commas; found '%s'", max,
                      text);
            return RESULT_USAGE;
        }
        sides[(*count)++] = (int)side;
        next = *end ? end + 1 : end;
    }
    return RESULT_OK;
}

Result bench_tau(const Options *options, double *tau_px) {
    const char *text = options_text(options, OPTION_BENCH_TAU);
    char *end;
    *tau_px = text ? strtod(text, &end) : 1.0;
    if (!text || (end != text && *end == '\0' && *tau_px >= 0.01 && *tau_px <= 1000.0))
        return RESULT_OK;
    log_error("--tau: expected one number from 0.01 to 1000; found '%s'", text);
    return RESULT_USAGE;
}

int64_t bench_resident_bytes(void) {
    FILE *file = fopen("/proc/self/status", "r");
    char line[128];
    long long kib = 0;
    while (file && fgets(line, sizeof line, file))
        if (sscanf(line, "RssAnon: %lld kB", &kib) == 1)
            break;
    if (file)
        fclose(file);
    return (int64_t)kib * 1024;
}

void bench_add_percentiles(Json *parent, const char *name, double *values, int count) {
    statistics_sort(values, count);
    Json *object = json_add_object(parent, name);
    json_add_number(object, "p50", statistics_percentile(values, count, 0.50));
    json_add_number(object, "p99", statistics_percentile(values, count, 0.99));
    json_add_number(object, "max", statistics_percentile(values, count, 1.0));
}

// 0 .. 1, the same for the same lattice point.
static float lattice_noise(int x, int y, int octave) {
    uint32_t h = (uint32_t)x * 374761393u + (uint32_t)y * 668265263u + (uint32_t)octave * 974711u;
    h = (h ^ (h >> 13)) * 1274126177u;
    return (float)((h ^ (h >> 16)) & 0xFFFFu) / 65536.0f;
}

static float smooth_noise(int col, int row, int octave) {
    int cell = 1 << octave, x = col >> octave, y = row >> octave;
    float u = (float)(col & (cell - 1)) / (float)cell, v = (float)(row & (cell - 1)) / (float)cell;
    float north = lattice_noise(x, y, octave) * (1.0f - u) + lattice_noise(x + 1, y, octave) * u;
    float south = lattice_noise(x, y + 1, octave) * (1.0f - u) + lattice_noise(x + 1, y + 1, octave) * u;
    return north * (1.0f - v) + south * v;
}

void bench_fill_rough(float *height_m, int side) {
    for (int row = 0; row < side; row++) {
        for (int col = 0; col < side; col++) {
            float sum = 0.0f, amplitude = ROUGH_AMPLITUDE_M;
            for (int octave = ROUGH_OCTAVES - 1; octave >= 0; octave--, amplitude *= ROUGH_PERSISTENCE)
                sum += amplitude * smooth_noise(col, row, octave);
            height_m[(size_t)row * (size_t)side + (size_t)col] = sum;
        }
    }
}
