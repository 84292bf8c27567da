#define _DEFAULT_SOURCE // strsep
#include "app/accuracy/accuracy.h"
#include "app/replay/playback.h"
#include "app/scene_load.h"
#include "app/track/track_options.h"
#include "base/log.h"
#include "config/suggest.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROUNDS_LEAST 5 // fewer show no spread
#define FULL_METHODS "hybrid,patch,roam,roam-parallel,geomipmap,geomipmap:centre,geomipmap-ye,diamond"
#define QUICK_METHODS "hybrid,patch,roam,geomipmap,geomipmap-ye,diamond"
#define FULL_TAUS "0.5,1,2,4"
#define QUICK_TAUS "1,2,4"
#define FULL_KINDS "midpoint,total:8,total"
#define QUICK_KINDS "midpoint"
#define FLIGHTS "valley,ridge,pass,dive,turn"
#define FULL_FRAMES 12
#define QUICK_FRAMES 6
#define QUICK_WIDTH 400
#define QUICK_HEIGHT 250
#define CENTRE ":centre"
#define WORD_BYTES 24 // more than any name needs

typedef struct Word {
    char text[WORD_BYTES + 8]; // "..." behind what is longer than any name
} Word;

// The next part of a list separated by commas, "" before a comma too many; the list becomes NULL behind its last one.
static Word next_word(const char **list) {
    Word word;
    size_t length = strcspn(*list, ",");
    snprintf(word.text, sizeof word.text, "%.*s%s", length < WORD_BYTES ? (int)length : WORD_BYTES - 1, *list,
             length < WORD_BYTES ? "" : "...");
    *list = (*list)[length] ? *list + length + 1 : NULL;
    return word;
}

// As messages tell it.
static Word shown(const char *text) {
    Word word;
    snprintf(word.text, sizeof word.text, *text ? "'%.26s'" : "an empty entry", text);
    return word;
}

static const char *text_or(const Options *options, OptionId id, const char *otherwise) {
    return options_is_set(options, id) ? options_text(options, id) : otherwise;
}

// ---- kinds of errors ----

static Result add_kind(AccuracyPlan *plan, const char *name) {
    for (int i = 0; i < plan->kind_count; i++)
        if (strcmp(plan->kinds[i].name, name) == 0)
            return RESULT_OK;
    if (plan->kind_count == ACCURACY_KINDS_MAX) {
        log_error("--errors: expected at most %d kinds", ACCURACY_KINDS_MAX);
        return RESULT_USAGE;
    }
    AccuracyKind *kind = &plan->kinds[plan->kind_count];
    Result result = scene_error_kind(plan->options, name, &kind->terrain);
    if (result != RESULT_OK) {
        log_error("--errors: expected 'midpoint', 'total' or 'total:N' with N a power of two up to 1024, separated by "
                  "commas; found %s",
                  shown(name).text);
        return RESULT_USAGE;
    }
    snprintf(kind->name, sizeof kind->name, "%s", name);
    plan->kind_count++;
    return RESULT_OK;
}

static Result read_kinds(AccuracyPlan *plan) {
    const char *list = text_or(plan->options, OPTION_ERRORS, plan->quick ? QUICK_KINDS : FULL_KINDS);
    Result result = add_kind(plan, options_text(plan->options, OPTION_ERROR));
    while (result == RESULT_OK && list)
        result = add_kind(plan, next_word(&list).text);
    return result;
}

// ---- methods ----

static Result refuse_method(const char *name) {
    const char *names[2 * LOD_METHOD_COUNT]; // with CENTRE in the second half
    Word centre[LOD_METHOD_COUNT];
    char all[256];
    size_t used = 0;
    for (int i = 0; i < LOD_METHOD_COUNT; i++) {
        names[i] = lod_method_name((LodMethod)i);
        snprintf(centre[i].text, sizeof centre[i].text, "%.16s" CENTRE, names[i]);
        names[LOD_METHOD_COUNT + i] = centre[i].text;
        used += (size_t)snprintf(all + used, sizeof all - used, "%s%s", i ? ", " : "", names[i]);
    }
    char question[SUGGEST_BYTES];
    log_error("--methods: expected some of %s, separated by commas, each with '" CENTRE
              "' behind it where its bound is to be kept at every sample; found %s%s",
              all, shown(name).text, suggest_question(name, names, 2 * LOD_METHOD_COUNT, question));
    return RESULT_USAGE;
}

static Result add_variant(AccuracyPlan *plan, const AccuracyVariant *variant) {
    if (plan->variant_count == ACCURACY_VARIANTS_MAX) {
        log_error("--methods: expected at most %d", ACCURACY_VARIANTS_MAX);
        return RESULT_USAGE;
    }
    plan->variants[plan->variant_count++] = *variant;
    return RESULT_OK;
}

// Methods named twice are run once.
static bool is_planned(const AccuracyPlan *plan, const AccuracyVariant *variant) {
    for (int i = 0; i < plan->variant_count; i++)
        if (plan->variants[i].method == variant->method && plan->variants[i].bound == variant->bound)
            return true;
    return false;
}

static Result add_method(AccuracyPlan *plan, const char *name) {
    AccuracyVariant variant = {.bound = scene_lod_options(plan->options).bound};
    size_t length = strlen(name), suffix = strlen(CENTRE);
    if (length > suffix && strcmp(name + length - suffix, CENTRE) == 0) {
        variant.bound = LOD_BOUND_CENTRE;
        length -= suffix;
    }
    for (int i = 0; i < LOD_METHOD_COUNT; i++) {
        const char *known = lod_method_name((LodMethod)i);
        if (strlen(known) != length || strncmp(known, name, length) != 0)
            continue;
        variant.method = (LodMethod)i;
        snprintf(variant.name, sizeof variant.name, "%s", name);
        if (!is_planned(plan, &variant))
            return add_variant(plan, &variant);
        if (options_is_given(plan->options, OPTION_METHODS))
            log_warn("--methods: '%s' is there already, and run once", name);
        return RESULT_OK;
    }
    return refuse_method(name);
}

bool accuracy_is_nested(LodMethod method) {
    return method == LOD_HYBRID || method == LOD_PATCH || method == LOD_ROAM || method == LOD_ROAM_PARALLEL;
}

int accuracy_variant_of_kind(const AccuracyPlan *plan, int kind) {
    for (int i = 0; i < plan->variant_count; i++)
        if (plan->variants[i].kind == kind && accuracy_is_nested(plan->variants[i].method))
            return i;
    return -1;
}

// What the other kinds of errors cost is shown by the first method that uses them.
static Result add_kind_variants(AccuracyPlan *plan) {
    Result result = RESULT_OK;
    int first = accuracy_variant_of_kind(plan, 0);
    if (first < 0)
        plan->kind_count = 1;
    for (int kind = 1; kind < plan->kind_count && result == RESULT_OK; kind++) {
        AccuracyVariant variant = plan->variants[first];
        variant.kind = kind;
        snprintf(variant.name, sizeof variant.name, "%.20s, %.20s", plan->variants[first].name, plan->kinds[kind].name);
        result = add_variant(plan, &variant);
    }
    return result;
}

static Result read_methods(AccuracyPlan *plan) {
    const char *list = options_text(plan->options, OPTION_METHODS);
    if (!list && options_is_given(plan->options, OPTION_METHOD))
        list = options_text(plan->options, OPTION_METHOD);
    if (!list)
        list = plan->quick ? QUICK_METHODS : FULL_METHODS;
    Result result = RESULT_OK;
    while (result == RESULT_OK && list)
        result = add_method(plan, next_word(&list).text);
    return result == RESULT_OK ? add_kind_variants(plan) : result;
}

// ---- tolerances ----

static int compare_numbers(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static Result add_tau(AccuracyPlan *plan, const char *text) {
    char *end;
    double tau = strtod(text, &end);
    if (end == text || *end || !(tau >= 0.01 && tau <= 1000.0)) {
        log_error("--tau: expected numbers from 0.01 to 1000, separated by commas; found %s", shown(text).text);
        return RESULT_USAGE;
    }
    for (int i = 0; i < plan->tau_count; i++)
        if (plan->tau_px[i] == tau) {
            log_warn("--tau: %s is there already, and run once", text);
            return RESULT_OK;
        }
    if (plan->tau_count == ACCURACY_TAUS_MAX) {
        log_error("--tau: expected at most %d numbers", ACCURACY_TAUS_MAX);
        return RESULT_USAGE;
    }
    plan->tau_px[plan->tau_count++] = tau;
    return RESULT_OK;
}

static Result read_taus(AccuracyPlan *plan) {
    const char *list = text_or(plan->options, OPTION_BENCH_TAU, plan->quick ? QUICK_TAUS : FULL_TAUS);
    Result result = RESULT_OK;
    while (result == RESULT_OK && list)
        result = add_tau(plan, next_word(&list).text);
    qsort(plan->tau_px, (size_t)plan->tau_count, sizeof *plan->tau_px, compare_numbers);
    return result;
}

// ---- flights ----

static Result refuse_flight(const char *name) {
    const char *names[TRACK_KIND_COUNT];
    char question[SUGGEST_BYTES];
    for (int i = 0; i < TRACK_KIND_COUNT; i++)
        names[i] = track_kind_name((TrackKind)i);
    log_error("--track: expected some of " FLIGHTS
              ", or files of flights, as 'overfly convert' reads them, separated by "
              "commas; found '%s'%s",
              name, suggest_question(name, names, TRACK_KIND_COUNT, question));
    return RESULT_USAGE;
}

static Result read_file(const Options *options, const char *path, Track *out) {
    RecordingHeader header;
    Geoid *geoid = NULL;
    if (playback_is_recording(path))
        return playback_read_header(path, &header);
    Result result = scene_open_geoid(options, &geoid);
    TrackReading how = track_reading_of(options, geoid);
    if (result == RESULT_OK)
        result = track_load(path, &how, out);
    geoid_close(&geoid);
    return result;
}

static Result read_flight(AccuracyPlan *plan, const char *name) {
    TrackKind kind;
    Result result = track_kind_find(name, &kind) ? RESULT_OK
                    : strpbrk(name, "./")        ? read_file(plan->options, name, &plan->read[plan->flight_count])
                                                 : refuse_flight(name);
    if (result == RESULT_OK)
        plan->flights[plan->flight_count++] = name;
    return result;
}

static Result read_flights(AccuracyPlan *plan) {
    const char *list = text_or(plan->options, OPTION_TRACK, FLIGHTS);
    if (strlen(list) >= sizeof plan->flight_text) {
        log_error("--track: expected at most %zu bytes", sizeof plan->flight_text - 1);
        return RESULT_USAGE;
    }
    strcpy(plan->flight_text, list);
    char *rest = plan->flight_text;
    for (char *name; (name = strsep(&rest, ",")) != NULL;) {
        if (plan->flight_count == ACCURACY_FLIGHTS_MAX) {
            log_error("--track: expected at most %d flights", ACCURACY_FLIGHTS_MAX);
            return RESULT_USAGE;
        }
        Result result = read_flight(plan, name);
        if (result != RESULT_OK)
            return result;
    }
    return RESULT_OK;
}

// ---- the rest ----

static Result read_dems(AccuracyPlan *plan) {
    plan->dem_count = options_positional_count(plan->options);
    if (plan->dem_count > ACCURACY_DEMS_MAX) {
        log_error("bench: expected at most %d scenes and DEMs, found %d", ACCURACY_DEMS_MAX, plan->dem_count);
        return RESULT_USAGE;
    }
    for (int i = 0; i < plan->dem_count; i++)
        plan->dems[i] = options_positionals(plan->options)[i];
    if (plan->dem_count == 0)
        plan->dem_count = 1; // the default scene
    Result result = RESULT_OK;
    for (int i = 0; i < plan->dem_count && result == RESULT_OK; i++) // before the first is measured for minutes
        result = world_check_named(plan->options, plan->dems[i]);
    return result;
}

static void read_counts(AccuracyPlan *plan) {
    const Options *options = plan->options;
    const double *size = options_numbers(options, OPTION_SIZE);
    bool sized = options_is_given(options, OPTION_SIZE);
    int frames = (int)fmin((double)options_integer(options, OPTION_FRAMES), 1e6);
    if (frames == 0)
        frames = plan->quick ? QUICK_FRAMES : FULL_FRAMES;
    plan->frames = (frames + ACCURACY_BURST - 1) / ACCURACY_BURST * ACCURACY_BURST;
    plan->stretch = plan->quick ? ACCURACY_STRETCH_QUICK : ACCURACY_STRETCH;
    plan->rounds = (int)options_integer(options, OPTION_ROUNDS);
    plan->width = plan->quick && !sized ? QUICK_WIDTH : (int)size[0];
    plan->height = plan->quick && !sized ? QUICK_HEIGHT : (int)size[1];
    plan->fov_rad = options_number(options, OPTION_FOV) * GEODESY_RAD_PER_DEG;
    if (options_is_given(options, OPTION_FRAMES) && frames != plan->frames)
        log_info("--frames %d: %d a flight, in bursts of %d", frames, plan->frames, ACCURACY_BURST);
    if (plan->rounds < ROUNDS_LEAST)
        log_warn("--rounds %d: the spread of fewer than %d rounds says little", plan->rounds, ROUNDS_LEAST);
}

// Options of the benchmarks of single parts.
static void warn_of_unused(const Options *options) {
#define FLOWN "only of 'bench refine', 'partitions', 'governor' and 'panel'; flights are chosen with --track here"
    static const struct {
        OptionId id;
        const char *why;
    } unused[] = {{OPTION_EYE, FLOWN},
                  {OPTION_LOOK, FLOWN},
                  {OPTION_SPEED, FLOWN},
                  {OPTION_HEIGHT, "only of 'bench refine'; ignored here"},
                  {OPTION_SIDES, "only of 'bench preprocess'; ignored here"},
                  {OPTION_VERTICES, "only of 'bench partitions'; ignored here"},
                  {OPTION_TARGET_MS, "only of 'bench governor'; ignored here"}};
    for (size_t i = 0; i < COUNT_OF(unused); i++)
        if (options_source(options, unused[i].id) == SOURCE_COMMAND_LINE)
            log_warn("--%s: %s", option_spec(unused[i].id)->name, unused[i].why);
}

Result accuracy_plan(const Options *options, AccuracyPlan *out) {
    *out = (AccuracyPlan){.options = options, .quick = options_flag(options, OPTION_BENCH_QUICK)};
    warn_of_unused(options);
    Result result = read_kinds(out);
    if (result == RESULT_OK)
        result = read_methods(out);
    if (result == RESULT_OK)
        result = read_taus(out);
    if (result == RESULT_OK)
        result = read_flights(out);
    if (result == RESULT_OK)
        result = read_dems(out);
    if (result == RESULT_OK)
        read_counts(out);
    return result;
}

void accuracy_plan_clear(AccuracyPlan *plan) {
    for (int i = 0; i < ACCURACY_FLIGHTS_MAX; i++)
        track_clear(&plan->read[i]);
}
