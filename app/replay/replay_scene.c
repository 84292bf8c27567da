#define _POSIX_C_SOURCE 200809L
#include "app/replay/replay_scene.h"

#include "app/replay/playback.h"
#include "base/log.h"

#include <string.h>

#define NAMES_MOST 64

// The words of a recording's command line, in `text`, which they point into.
typedef struct Names {
    char text[RECORDING_VALUE_BYTES];
    const char *words[NAMES_MOST];
    int count;
} Names;

static void split(Names *names) {
    char *rest = NULL;
    for (char *word = strtok_r(names->text, "|", &rest); word && names->count < NAMES_MOST;
         word = strtok_r(NULL, "|", &rest))
        names->words[names->count++] = word;
}

// A conversion's second word is where it writes to.
static bool is_named(const Options *options) {
    return options_command(options) == COMMAND_REPLAY && options_positional_count(options) > 1;
}

static Result read_names(const char *track, Names *names) {
    RecordingHeader header;
    names->count = 0;
    Result result = playback_read_header(track, &header);
    if (result != RESULT_OK)
        return result;
    memcpy(names->text, header.environment[RECORDING_SCENE], sizeof names->text);
    split(names);
    return RESULT_OK;
}

static void tell_remedy(const Options *options, const char *track, const Names *names) {
    if (names->count > 0 && options_command(options) == COMMAND_REPLAY)
        log_info("%s was recorded over '%s', named as it was there; name it as it is here:\n  overfly replay %s "
                 "SCENE|DEM...",
                 track, names->words[0], track);
    else if (names->count > 0)
        log_info("%s was recorded over '%s', named as it was there, and is flown over it again; have it under that "
                 "name, from where you are",
                 track, names->words[0]);
}

const char *replay_aircraft(const Options *options) {
    bool named = options_source(options, OPTION_AIRCRAFT) == SOURCE_COMMAND_LINE;
    return named ? options_text(options, OPTION_AIRCRAFT) : NULL;
}

Result replay_check_scene(const Options *options, const char *track) {
    Names names;
    if (is_named(options) || !playback_is_recording(track))
        return world_check_inputs(options);
    Result result = read_names(track, &names);
    if (result != RESULT_OK)
        return result;
    result = world_check_listed(options, names.words, names.count);
    if (result != RESULT_OK)
        tell_remedy(options, track, &names);
    return result;
}

Result replay_load_scene(const Options *options, const char *track, World *out) {
    Names names;
    if (is_named(options) || !playback_is_recording(track))
        return world_load(options, out);
    Result result = read_names(track, &names);
    return result == RESULT_OK ? world_load_listed(options, names.words, names.count, out) : result;
}

Result replay_visit_files(const Options *options, const char *track, WorldVisit *visit, void *user) {
    Names names;
    bool recorded = playback_is_recording(track);
    if (options_command(options) == COMMAND_CONVERT && !recorded)
        return RESULT_OK; // it is over no land
    if (is_named(options) || !recorded)
        return world_visit_files(options, visit, user);
    Result result = replay_check_scene(options, track); // it tells the remedy
    if (result == RESULT_OK)
        result = read_names(track, &names);
    return result == RESULT_OK ? world_visit_listed(names.words, names.count, visit, user) : result;
}
