#define _POSIX_C_SOURCE 200809L
#include "app/commands/command.h"
#include "app/flight/flight_session.h"
#include "app/json.h"
#include "app/outputs.h"
#include "app/replay/replay_events.h"
#include "app/replay/replay_scene.h"
#include "app/scene_load.h"
#include "app/track/track_options.h"
#include "app/track/track_time.h"
#include "base/log.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

typedef struct Convert {
    const Options *options;
    const char *in, *out;
    const TrackFormat *from, *to;
    World world; // of a recording
    Geoid *geoid;
    Track track;
    ReplayEvents events;           // of a recording
    int64_t first_difference_step; // from which on it was flown otherwise than recorded; -1: nowhere
} Convert;

#define RECORDING_ENDING ".ofr"
#define INTERVAL_S 0.5
#define INTERVAL_IGC_S 1.0 // which has whole seconds

// A row of its own beside the tracks: it is flown again rather than read, and made by flying alone.
static const TrackFormat recording = {.name = "ofr",
                                      .ending = RECORDING_ENDING,
                                      .what = "recording of overfly, flown again",
                                      .wants_geoid = true,
                                      .has_attitude = true};

static bool has_whole_seconds(const Convert *c) {
    return strcmp(c->to->name, "igc") == 0;
}

static Result find_format_to(Convert *c) {
    size_t length = strlen(c->out), ending = strlen(RECORDING_ENDING);
    if (length < ending || strcasecmp(c->out + length - ending, RECORDING_ENDING) != 0)
        return track_format_of_ending(c->out, &c->to);
    log_error("%s: a recording holds what the pilot did at every step, which no track tells; recordings are made by "
              "flying: overfly fly --record %s",
              c->out, c->out);
    return RESULT_USAGE;
}

static Result check_land(const Convert *c) {
    if (c->from == &recording || options_positional_count(c->options) == 2)
        return RESULT_OK;
    log_error("convert: expected two files: the flight to read, and what to write it as; found '%s' after them, but %s "
              "is %s, and only a recording (" RECORDING_ENDING ") is flown again, over land",
              options_positionals(c->options)[2], c->in, c->from->what);
    return RESULT_USAGE;
}

// What the input is comes first: without it nothing else matters.
static Result check_names(Convert *c) {
    if (options_positional_count(c->options) < 2) {
        log_error("convert: expected two files: the flight to read, and what to write it as");
        return RESULT_USAGE;
    }
    c->in = options_positionals(c->options)[0];
    c->out = options_positionals(c->options)[1];
    c->from = &recording;
    Result result = playback_is_recording(c->in) ? RESULT_OK : track_format_of_file(c->in, &c->from);
    if (result == RESULT_OK)
        result = find_format_to(c);
    if (result == RESULT_OK)
        result = check_land(c);
    return result == RESULT_OK ? outputs_check(c->options, "convert", c->out) : result;
}

static void warn_of_ignored(const Convert *c) {
    static const OptionId FLOWN[] = {OPTION_AIRCRAFT, OPTION_DATUM, OPTION_VOIDS, OPTION_SPACING, OPTION_BOUNDS};
    const Options *options = c->options;
    track_warn_of_unused(options, c->in, c->from == &recording ? NULL : c->from);
    for (size_t i = 0; i < COUNT_OF(FLOWN) && c->from != &recording; i++)
        if (options_source(options, FLOWN[i]) == SOURCE_COMMAND_LINE)
            log_warn("--%s changes nothing: %s is %s; only a recording (" RECORDING_ENDING ") is flown again",
                     option_spec(FLOWN[i])->name, c->in, c->from->what);
    if (has_whole_seconds(c) && options_is_set(options, OPTION_INTERVAL) &&
        floor(options_number(options, OPTION_INTERVAL)) != options_number(options, OPTION_INTERVAL))
        log_warn("--interval %g: an IGC file has whole seconds, and at most one point in each",
                 options_number(options, OPTION_INTERVAL));
}

// ---- reading ----

static Result read_start(const Options *options, double *start_unix_s) {
    const char *text = options_text(options, OPTION_START);
    *start_unix_s = NAN;
    if (!text || track_time_read(text, start_unix_s))
        return RESULT_OK;
    log_error("%s: found '%s'; expected a time as 2024-06-01T12:00:00Z", options_where(options, OPTION_START), text);
    return RESULT_USAGE;
}

static double interval_s(const Convert *c) {
    if (options_is_set(c->options, OPTION_INTERVAL))
        return options_number(c->options, OPTION_INTERVAL);
    return has_whole_seconds(c) ? INTERVAL_IGC_S : INTERVAL_S;
}

// A track sees but the steps near its points; where those are as recorded, all are flown.
static Result find_difference(Playback *playback, int64_t *step) {
    RecordingVerdict verdict;
    *step = playback_first_difference(playback);
    if (*step >= 0)
        return RESULT_OK;
    Result result = playback_verify(playback, &verdict);
    if (result == RESULT_OK)
        *step = verdict.first_difference_step;
    return result;
}

static Result fly_again(Convert *c, TrackReading how) {
    Result result = replay_check_scene(c->options, c->in);
    if (result == RESULT_OK)
        result = replay_load_scene(c->options, c->in, &c->world);
    if (result != RESULT_OK)
        return result;
    const PlaybackOptions options = {.how = how,
                                     .aircraft = replay_aircraft(c->options),
                                     .ground = session_ground(&c->world),
                                     .dem_hash = dem_hash(terrain_dem(c->world.terrain))};
    Playback *playback = NULL;
    result = playback_open(c->in, &options, &playback);
    if (result == RESULT_OK)
        result = playback_track(playback, interval_s(c), &c->track);
    if (result == RESULT_OK)
        result = find_difference(playback, &c->first_difference_step);
    if (result == RESULT_OK)
        result = replay_events_read(playback, &c->events);
    playback_close(&playback);
    return result;
}

static Result read_points(Convert *c, TrackReading how) {
    if (c->from == &recording)
        return fly_again(c, how);
    Result result = c->from->read(c->in, &how, &c->track);
    if (result == RESULT_OK && options_is_set(c->options, OPTION_INTERVAL))
        result = track_resample(&c->track, options_number(c->options, OPTION_INTERVAL));
    return result;
}

static Result read_track(Convert *c) {
    double start_unix_s;
    Result result = read_start(c->options, &start_unix_s);
    if (result == RESULT_OK && (c->from->wants_geoid || c->to->wants_geoid))
        result = scene_open_geoid(c->options, &c->geoid);
    if (result != RESULT_OK)
        return result;
    result = read_points(c, track_reading_of(c->options, c->geoid));
    if (result == RESULT_OK && isfinite(start_unix_s))
        c->track.start_unix_s = start_unix_s;
    return result;
}

// ---- what was done ----

static const char *attitude_name(const Track *track) {
    return track_is_derived(track) ? "derived" : "recorded";
}

static const char *start_text(const Track *track, char out[TRACK_TIME_BYTES]) {
    if (!isfinite(track->start_unix_s))
        return NULL;
    track_time_write(track->start_unix_s, out);
    return out;
}

static double longest_gap_s(const Track *track) {
    double longest = 0.0;
    for (int i = 1; i < track->count; i++)
        if (track->points[i].flags & TRACK_GAP)
            longest = fmax(longest, track->points[i].t_s - track->points[i - 1].t_s);
    return longest;
}

static Result print_json(const Convert *c) {
    const Track *track = &c->track;
    char start[TRACK_TIME_BYTES];
    Json *json = json_create();
    json_add_text(json, "file", c->in);
    json_add_text(json, "format", c->from->name);
    json_add_text(json, "name", track->name);
    json_add_integer(json, "points", track->count);
    json_add_text(json, "start_utc", start_text(track, start));
    json_add_number(json, "duration_s", track_duration_s(track));
    json_add_integer(json, "gaps", track_gap_count(track));
    json_add_number(json, "longest_gap_s", longest_gap_s(track));
    json_add_text(json, "heights", track_heights_name(track->heights));
    json_add_text(json, "attitude", attitude_name(track));
    Json *skipped = json_add_object(json, "skipped");
    for (int i = 0; i < TRACK_SKIP_COUNT; i++)
        json_add_integer(skipped, track_skip_name((TrackSkip)i), track->skipped[i]);
    if (c->from == &recording) {
        json_add_integer(json, "first_difference_step", c->first_difference_step);
        replay_events_add(&c->events, json);
    }
    json_add_text(json, "output", c->out);
    json_add_text(json, "output_format", c->to->name);
    json_add_bool(json, "output_attitude", c->to->has_attitude);
    json_add_bool(json, "output_pressure", c->to->has_pressure && track_has_pressure(track));
    Result result = json_print(json);
    json_destroy(&json);
    return result;
}

// NULL: nothing is left out that was known, or has a place.
static const char *pressure_left_out(const Convert *c) {
    bool known = track_has_pressure(&c->track);
    if (c->to->has_pressure)
        return known ? NULL : "none are known";
    return known && c->track.heights != TRACK_HEIGHTS_PRESSURE ? "the format has no place for them" : NULL;
}

static const char *points_word(int64_t count) {
    return count == 1 ? "point" : "points";
}

static void print_text(const Convert *c) {
    const Track *track = &c->track;
    char start[TRACK_TIME_BYTES];
    const char *begun = start_text(track, start);
    printf("read      %s: %s\n", c->in, c->from->what);
    printf("flight    %d %s, %.0f s, from %s\n", track->count, points_word(track->count), track_duration_s(track),
           begun ? begun : "an unknown day");
    printf("altitudes %s\n", track_heights_what(track->heights));
    printf("attitude  %s\n", track_is_derived(track) ? "derived from the path" : "as recorded");
    if (track_gap_count(track) > 0)
        printf("gaps      %d, the longest %.0f s\n", track_gap_count(track), longest_gap_s(track));
    for (int i = 0; i < TRACK_SKIP_COUNT; i++)
        if (track->skipped[i] > 0)
            printf("left out  %lld %s %s\n", (long long)track->skipped[i], points_word(track->skipped[i]),
                   track_skip_what((TrackSkip)i));
    if (pressure_left_out(c))
        printf("left out  pressure altitudes: %s\n", pressure_left_out(c));
    replay_events_print(&c->events, "events    ");
    printf("wrote     %s: %s%s\n", c->out, c->to->what, c->to->has_attitude ? "" : ", which has no attitude");
}

// It is written all the same: there may be no other way to have anything of the flight.
static Result check_same(const Convert *c) {
    char when[RECORDING_TIME_BYTES];
    if (c->first_difference_step < 0)
        return RESULT_OK;
    log_error("%s: written, but from %s on it is not the flight of %s, which was flown otherwise here; name its land, "
              "how that is read (--datum, --voids, --spacing, --bounds, --geoid) or its aircraft as they were",
              c->out, recording_time_text((uint64_t)c->first_difference_step, RECORDING_STEPS_PER_S, when), c->in);
    return RESULT_FORMAT;
}

Result cmd_convert(const Options *options) {
    Convert convert = {.options = options, .first_difference_step = -1};
    Result result = check_names(&convert);
    if (result == RESULT_OK) {
        warn_of_ignored(&convert);
        result = read_track(&convert);
    }
    if (result == RESULT_OK)
        result = track_save(convert.out, convert.to, &convert.track, convert.geoid);
    if (result == RESULT_OK && options_flag(options, OPTION_JSON))
        result = print_json(&convert);
    else if (result == RESULT_OK && !options_flag(options, OPTION_QUIET))
        print_text(&convert);
    if (result == RESULT_OK)
        result = check_same(&convert);
    track_clear(&convert.track);
    replay_events_clear(&convert.events);
    world_unload(&convert.world);
    geoid_close(&convert.geoid);
    return result;
}
