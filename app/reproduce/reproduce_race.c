#include "app/reproduce/reproduce_race.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/statistics.h"
#include "terrain/measure/measure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FRAME_BLOCK_BYTES (1 << 20)

void race_begin(const Terrain *terrain, int frames_max, Race *out) {
    *out = (Race){.terrain = terrain, .frames_max = frames_max};
}

Result race_enter(Race *race, const LodOptions *options, Jobs *jobs) {
    Racer *racer = &race->racers[race->count];
    *racer = (Racer){.options = *options, .jobs = jobs};
    racer->options.serial = (uint32_t)++race->count; // one renderer may draw them all
    racer->ms = calloc((size_t)race->frames_max, sizeof *racer->ms);
    Result result = racer->ms ? arena_create(FRAME_BLOCK_BYTES, &racer->frame) : RESULT_MEMORY;
    if (result == RESULT_MEMORY)
        log_error("no memory to time %d frames", race->frames_max);
    if (result == RESULT_OK)
        result = lod_create(&racer->options, race->terrain, &racer->lod);
    return result;
}

void race_end(Race *race) {
    for (int i = 0; i < race->count; i++) {
        Racer *racer = &race->racers[i];
        lod_destroy(&racer->lod);
        if (racer->frame)
            arena_destroy(&racer->frame);
        free(racer->ms);
    }
    race->count = 0;
}

Result racer_refine(Racer *racer, const LodView *view, double *ms) {
    lod_release(racer->lod, racer->cut.frame);
    arena_reset(racer->frame);
    int64_t begin = clock_now_ns();
    Result result = lod_update(racer->lod, view, racer->jobs, racer->frame, &racer->cut);
    *ms = (double)(clock_now_ns() - begin) * 1e-6;
    return result == RESULT_BUDGET ? RESULT_OK : result;
}

static void count_step(Racer *racer, double ms) {
    const LodStats *stats = &racer->cut.stats;
    racer->ms[racer->frames++] = ms;
    racer->triangles += (double)stats->triangles;
    racer->vertices += (double)stats->vertices;
    racer->cut_vertices += (double)stats->cut_vertices;
    racer->balance += stats->balance;
    racer->reached_px = fmax(racer->reached_px, racer->cut.reached_px);
}

Result race_step(Race *race, const LodView *view, bool counted) {
    Result result = RESULT_OK;
    for (int i = 0; i < race->count && result == RESULT_OK; i++) {
        Racer *racer = &race->racers[(race->turn + i) % race->count];
        double ms;
        result = racer_refine(racer, view, &ms);
        if (result == RESULT_OK && counted && racer->frames < race->frames_max)
            count_step(racer, ms);
    }
    race->turn++;
    return result;
}

Result race_measure(Race *race, Jobs *jobs) {
    Result result = RESULT_OK;
    for (int i = 0; i < race->count && result == RESULT_OK; i++) {
        Racer *racer = &race->racers[i];
        Measure measure;
        result = measure_cut(race->terrain, &racer->cut, jobs, &measure);
        if (result != RESULT_OK)
            break;
        racer->measures++;
        racer->max_px = fmax(racer->max_px, measure.max_px);
        racer->p999_px = fmax(racer->p999_px, measure.p999_px);
        racer->squares_px += measure.rms_px * measure.rms_px;
    }
    return result;
}

// ---- What came of it --------------------------------------------------------------------------------------------

RaceTimes race_times(const Race *race, int index) {
    const Racer *racer = &race->racers[index];
    double *sorted = racer->frames ? malloc(sizeof *sorted * (size_t)racer->frames) : NULL;
    if (!sorted)
        return (RaceTimes){NAN, NAN, NAN};
    double sum = 0.0;
    memcpy(sorted, racer->ms, sizeof *sorted * (size_t)racer->frames);
    for (int i = 0; i < racer->frames; i++)
        sum += sorted[i];
    statistics_sort(sorted, racer->frames);
    RaceTimes times = {statistics_percentile(sorted, racer->frames, 0.50),
                       statistics_percentile(sorted, racer->frames, 0.99), 1e3 * racer->frames / sum};
    free(sorted);
    return times;
}

double race_mean(const Race *race, int index, double sum) {
    int frames = race->racers[index].frames;
    return frames ? sum / frames : NAN;
}

double race_drawn_triangles(const Race *race, int index) {
    const Racer *racer = &race->racers[index];
    return racer->drawn ? racer->drawn_triangles / racer->drawn : NAN;
}

double race_drawn_fps(const Race *race, int index) {
    const Racer *racer = &race->racers[index];
    return racer->drawn ? 1e3 * racer->drawn / racer->drawn_ms : NAN;
}

double race_ratio(const Race *race, int slow, int fast) {
    const Racer *a = &race->racers[slow], *b = &race->racers[fast];
    int count = a->frames < b->frames ? a->frames : b->frames;
    double *ratios = count ? malloc(sizeof *ratios * (size_t)count) : NULL;
    if (!ratios)
        return NAN;
    for (int i = 0; i < count; i++)
        ratios[i] = a->ms[i] / b->ms[i];
    statistics_sort(ratios, count);
    double median = statistics_percentile(ratios, count, 0.5);
    free(ratios);
    return median;
}
