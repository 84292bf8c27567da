#define _POSIX_C_SOURCE 200809L
#include "app/replay/replay_scene.h"

#include "app/replay/playback.h"
#include "base/log.h"
#include "config/files.h"

#include <stdio.h>
#include <string.h>

#define NAMES_MOST 64

// What a recording is flown over again.
typedef struct Land {
    RecordingHeader header;
    char text[RECORDING_VALUE_BYTES]; // the words of its command line
    char found[NAMES_MOST][PATHS_BYTES_MAX];
    const char *recorded[NAMES_MOST], *words[NAMES_MOST]; // as they were named, in `text`; as they are found now
    int count;
    bool read_known; // else it does not say how its elevation was read
    DemOptions read_as;
} Land;

// The second word of a conversion is where it writes to.
static int first_name(const Options *options) {
    return options_command(options) == COMMAND_CONVERT ? 2 : 1;
}

static bool is_named(const Options *options) {
    bool takes = (options_command(options) & (COMMAND_REPLAY | COMMAND_CONVERT)) != 0;
    return takes && options_positional_count(options) > first_name(options);
}

// ---- where it lies now ----

// A scene that came with the program, though a file here may have its name by now.
static bool find_bundled(const Land *land, const char *word, char out[PATHS_BYTES_MAX]) {
    const char *dem = land->header.environment[RECORDING_DEM];
    size_t length = strlen(word);
    bool was_file = strncmp(dem, word, length) == 0 && (dem[length] == '/' || !dem[length]);
    return !was_file && files_exists(word) && world_find_scene(word, out);
}

static bool find_in(const char *folder, const char *word, char out[PATHS_BYTES_MAX]) {
    int printed = snprintf(out, PATHS_BYTES_MAX, "%s/%s", folder, word);
    return *folder && *word != '/' && printed > 0 && printed < PATHS_BYTES_MAX && files_exists(out);
}

static bool find_beside(const char *track, const char *word, char out[PATHS_BYTES_MAX]) {
    return files_beside(track, word, out) == RESULT_OK && files_exists(out);
}

// As it was named; where it lay; beside the recording, with its folders or without. Else as it was named.
static const char *find(const Land *land, const char *track, const char *word, char out[PATHS_BYTES_MAX]) {
    const char *slash = strrchr(word, '/');
    if (find_bundled(land, word, out))
        return out;
    if (files_exists(word))
        return word;
    bool found = find_in(land->header.environment[RECORDING_FOLDER], word, out) || find_beside(track, word, out) ||
                 (slash && find_beside(track, slash + 1, out));
    return found ? out : word;
}

static void find_names(const char *track, Land *land) {
    char *rest = NULL;
    memcpy(land->text, land->header.environment[RECORDING_SCENE], sizeof land->text);
    for (char *word = strtok_r(land->text, "|", &rest); word && land->count < NAMES_MOST;
         word = strtok_r(NULL, "|", &rest)) {
        land->recorded[land->count] = word;
        land->words[land->count] = find(land, track, word, land->found[land->count]);
        land->count++;
    }
}

// ---- how its elevation is read ----

// What the command line says, else the recording; `said`: whether one does.
static Result read_value(const Options *options, const char *track, const Land *land, RecordingKey key, OptionId id,
                         double numbers[4], bool *said) {
    bool typed = options_source(options, id) == SOURCE_COMMAND_LINE;
    const char *text = typed ? options_text(options, id) : land->header.environment[key];
    *said = *text != '\0';
    if (!*said || option_parse(id, text, numbers) == RESULT_OK)
        return RESULT_OK;
    log_error("%s: the header: %s is '%s', which this overfly does not know; say it with --%s", track,
              recording_key_name(key), text, option_spec(id)->name);
    return RESULT_FORMAT;
}

static Result find_reading(const Options *options, const char *track, Land *land) {
    static const struct {
        RecordingKey key;
        OptionId id;
    } ROWS[] = {{RECORDING_DATUM, OPTION_DATUM},
                {RECORDING_VOIDS, OPTION_VOIDS},
                {RECORDING_SPACING, OPTION_SPACING},
                {RECORDING_BOUNDS, OPTION_BOUNDS}};
    double values[COUNT_OF(ROWS)][4] = {{0}};
    bool said[COUNT_OF(ROWS)];
    DemOptions *dem = &land->read_as;
    land->read_known = land->header.environment[RECORDING_DATUM][0] != '\0';
    for (size_t i = 0; i < COUNT_OF(ROWS) && land->read_known; i++) {
        Result result = read_value(options, track, land, ROWS[i].key, ROWS[i].id, values[i], &said[i]);
        if (result != RESULT_OK)
            return result;
    }
    *dem = dem_default_options();
    dem->datum_given = values[0][0] > 0.0;
    dem->datum = values[0][0] == 2.0 ? DEM_DATUM_ELLIPSOID : DEM_DATUM_EGM96;
    dem->voids = (DemVoids)values[1][0];
    dem->spacing_m = values[2][0];
    dem->bounds_given = land->read_known && said[3];
    dem->west_deg = values[3][0];
    dem->south_deg = values[3][1];
    dem->east_deg = values[3][2];
    dem->north_deg = values[3][3];
    return RESULT_OK;
}

static Result read_land(const Options *options, const char *track, Land *land) {
    *land = (Land){.count = 0};
    Result result = playback_read_header(track, &land->header);
    if (result == RESULT_OK)
        result = find_reading(options, track, land);
    if (result == RESULT_OK)
        find_names(track, land);
    return result;
}

static void tell_remedy(const Options *options, const char *track, const Land *land) {
    bool converts = options_command(options) == COMMAND_CONVERT;
    if (land->count > 0)
        log_info("%s was recorded over '%s', named as it was there; name it as it is here:\n  overfly %s %s %s"
                 "SCENE|DEM...",
                 track, land->recorded[0], converts ? "convert" : "replay", track, converts ? "OUT " : "");
}

const char *replay_aircraft(const Options *options) {
    bool named = options_source(options, OPTION_AIRCRAFT) == SOURCE_COMMAND_LINE;
    return named ? options_text(options, OPTION_AIRCRAFT) : NULL;
}

Result replay_check_scene(const Options *options, const char *track) {
    Land land;
    if (is_named(options) || !playback_is_recording(track))
        return world_check_inputs(options);
    Result result = read_land(options, track, &land);
    if (result != RESULT_OK)
        return result;
    result = world_check_listed(options, land.words, land.count);
    if (result != RESULT_OK)
        tell_remedy(options, track, &land);
    return result;
}

Result replay_load_scene(const Options *options, const char *track, World *out) {
    Land land;
    if (!playback_is_recording(track))
        return world_load(options, out);
    Result result = read_land(options, track, &land);
    if (result != RESULT_OK)
        return result;
    const DemOptions *read_as = land.read_known ? &land.read_as : NULL;
    int first = first_name(options);
    if (is_named(options))
        return world_load_listed(options, options_positionals(options) + first,
                                 options_positional_count(options) - first, read_as, out);
    return world_load_listed(options, land.words, land.count, read_as, out);
}

Result replay_visit_files(const Options *options, const char *track, WorldVisit *visit, void *user) {
    Land land;
    bool recorded = playback_is_recording(track);
    if (options_command(options) == COMMAND_CONVERT && !recorded)
        return RESULT_OK; // it is over no land
    if (is_named(options) || !recorded)
        return world_visit_files(options, visit, user);
    Result result = replay_check_scene(options, track); // it tells the remedy
    if (result == RESULT_OK)
        result = read_land(options, track, &land);
    return result == RESULT_OK ? world_visit_listed(land.words, land.count, visit, user) : result;
}
