#include "app/replay/replay_verify.h"

#include "app/flight/flight_session.h"
#include "app/replay/replay_events.h"
#include "app/replay/replay_scene.h"
#include "base/log.h"
#include "config/files.h"

#include <inttypes.h>
#include <stdio.h>

static void add_hash(Json *json, const char *name, uint64_t hash) {
    char text[24];
    snprintf(text, sizeof text, "%016" PRIx64, hash);
    json_add_text(json, name, text);
}

static Result print_json(const char *track, const RecordingVerdict *verdict, const ReplayEvents *events) {
    Json *json = json_create();
    json_add_text(json, "file", track);
    json_add_integer(json, "steps", verdict->steps);
    json_add_integer(json, "steps_missing", verdict->steps_missing);
    add_hash(json, "hash", verdict->hash);
    add_hash(json, "expected_hash", verdict->expected_hash);
    json_add_bool(json, "equal", verdict->equal);
    json_add_integer(json, "first_difference_step", verdict->first_difference_step);
    json_add_number(json, "realtime_factor", verdict->realtime_factor);
    replay_events_add(events, json);
    Result result = json_print(json);
    json_destroy(&json);
    return result;
}

static void print_text(const char *track, const RecordingVerdict *verdict, const ReplayEvents *events) {
    char when[RECORDING_TIME_BYTES];
    printf("%s: %" PRIu32 " steps flown again, %.0f times as fast as time: ", track, verdict->steps,
           verdict->realtime_factor);
    if (verdict->equal)
        printf("%sthe same flight, hash %016" PRIx64 "\n", verdict->steps_missing > 0 ? "what is left is " : "",
               verdict->hash);
    else
        printf("another flight from step %" PRId64 " on (%s)\n", verdict->first_difference_step,
               recording_time_text((uint64_t)verdict->first_difference_step, RECORDING_STEPS_PER_S, when));
    if (verdict->steps_missing > 0)
        printf("%" PRIu32 " steps are lost in the file\n", verdict->steps_missing);
    replay_events_print(events, "events: ");
}

static Result verify(const Options *options, const char *track, const World *world) {
    PlaybackOptions playback_options = {.how = track_reading_default(),
                                        .aircraft = replay_aircraft(options),
                                        .ground = session_ground(world),
                                        .dem_hash = dem_hash(terrain_dem(world->terrain))};
    Playback *playback = NULL;
    ReplayEvents events = {0};
    RecordingVerdict verdict;
    playback_options.how.geoid = world->geoid;
    Result result = playback_open(track, &playback_options, &playback);
    if (result == RESULT_OK)
        result = playback_verify(playback, &verdict);
    if (result == RESULT_OK)
        result = replay_events_read(playback, &events);
    if (result == RESULT_OK && options_flag(options, OPTION_JSON))
        result = print_json(track, &verdict, &events);
    else if (result == RESULT_OK)
        print_text(track, &verdict, &events);
    replay_events_clear(&events);
    playback_close(&playback);
    return result == RESULT_OK && !verdict.equal ? RESULT_FORMAT : result;
}

Result replay_verify(const Options *options, const char *track) {
    World world = {0};
    Result result = files_check_readable(track);
    if (result != RESULT_OK)
        return result;
    if (!playback_is_recording(track)) {
        log_error("%s: is no recording of this program (.ofr), whose steps could be flown again", track);
        return RESULT_USAGE;
    }
    result = replay_check_scene(options, track);
    if (result == RESULT_OK)
        result = replay_load_scene(options, track, &world);
    if (result == RESULT_OK)
        result = verify(options, track, &world);
    world_unload(&world);
    return result;
}
