#define _POSIX_C_SOURCE 200809L
#include "app/flight/fly_outputs.h"

#include "app/flight/flight_loop.h"
#include "app/flight/telemetry.h"
#include "app/outputs.h"
#include "app/pipeline/picture.h"
#include "app/replay/playback.h"
#include "base/log.h"
#include "config/files.h"

#include <math.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#define RECORDING_ENDING ".ofr"

// Pictures that repeat must not depend on how long the one before took.
static Result check_target(const Options *options) {
    if (!options_is_set(options, OPTION_TARGET_MS) || !options_flag(options, OPTION_LOCKSTEP))
        return RESULT_OK;
    log_error(
        "--target-ms and --lockstep: expected one of them: a tolerance that follows the frame time would make the "
        "pictures depend on the clock; take --tau or --max-triangles with --lockstep");
    return RESULT_USAGE;
}

// A film has whole frames a second.
static Result check_video(const Options *options) {
    const char *video = options_text(options, OPTION_VIDEO);
    double fps = options_number(options, OPTION_FPS);
    if (!video)
        return RESULT_OK;
    if (fps != floor(fps)) {
        log_error("--fps with --video: expected a whole number of frames a second; found %g", fps);
        return RESULT_USAGE;
    }
    Result result = video_check_name(video, "--video");
    if (result == RESULT_OK)
        result = files_check_writable(video);
    return result == RESULT_OK ? outputs_check(options, "--video", video) : result;
}

// What stands has neither speed nor trim. In a file of settings both may wait for a flight that starts in the air.
static Result check_start(const Options *options) {
    static const OptionId FLYING[] = {OPTION_SPEED, OPTION_TRIM};
    if (!options_flag(options, OPTION_ON_GROUND))
        return RESULT_OK;
    for (size_t i = 0; i < COUNT_OF(FLYING); i++) {
        OptionSource source = options_source(options, FLYING[i]);
        if (source != SOURCE_COMMAND_LINE && source != SOURCE_ENVIRONMENT)
            continue;
        log_error("%s: an aircraft that starts standing on the ground (%s) has none of that; leave one of them out",
                  options_where(options, FLYING[i]), options_where(options, OPTION_ON_GROUND));
        return RESULT_USAGE;
    }
    return RESULT_OK;
}

static bool has_recording_ending(const char *path) {
    size_t length = strlen(path), ending = strlen(RECORDING_ENDING);
    return length > ending && strcasecmp(path + length - ending, RECORDING_ENDING) == 0;
}

// Whether a file is there with something in it that could be lost; of a pipe or a device nothing can.
static bool holds_something(const char *path) {
    struct stat about;
    return stat(path, &about) == 0 && S_ISREG(about.st_mode) && about.st_size > 0;
}

// An earlier recording takes another name, where nothing may lie that is read or is none.
static Result check_kept(const Options *options, const char *record) {
    char kept[PATHS_BYTES_MAX];
    if (!recorder_keeps(record, kept))
        return RESULT_OK;
    Result result = outputs_check(options, "--record: the earlier recording's new name", kept);
    if (result != RESULT_OK || !files_exists(kept) || playback_is_recording(kept))
        return result;
    log_error("--record: %s is there, and would be kept as %s, which is no recording of this program; name another "
              "file",
              record, kept);
    return RESULT_USAGE;
}

static Result check_record_name(const char *record) {
    if (!has_recording_ending(record))
        log_error("--record: expected a file name that ends in " RECORDING_ENDING "; found '%s'", record);
    else if (holds_something(record) && !playback_is_recording(record))
        log_error("--record: %s is there, and is no recording of this program; name another file", record);
    else
        return files_check_writable(record);
    return RESULT_USAGE;
}

static Result check_record(const Options *options) {
    const char *record = options_text(options, OPTION_RECORD);
    if (!record)
        return RESULT_OK;
    Result result = outputs_check(options, "--record", record);
    if (result == RESULT_OK)
        result = check_record_name(record);
    return result == RESULT_OK ? check_kept(options, record) : result;
}

// As of recordings; a file of --record, which need not be there yet, is known by its ending.
static Result check_telemetry(const Options *options) {
    const char *telemetry = options_text(options, OPTION_TELEMETRY);
    if (!telemetry || strcmp(telemetry, "-") == 0)
        return RESULT_OK;
    Result result = outputs_check(options, "--telemetry", telemetry);
    if (result != RESULT_OK)
        return result;
    if (has_recording_ending(telemetry))
        log_error("--telemetry: names that end in " RECORDING_ENDING " are of recordings; expected another, as "
                  "flight.csv; found '%s'",
                  telemetry);
    else if (holds_something(telemetry) && !telemetry_is_one(telemetry))
        log_error("--telemetry: %s is there, and is no telemetry of this program; name another file", telemetry);
    else
        return files_check_writable(telemetry);
    return RESULT_USAGE;
}

static Result check_pictures(const Options *options) {
    const char *screenshot = options_text(options, OPTION_SCREENSHOT),
               *pictures = options_text(options, OPTION_PICTURES);
    static const char *const begins[] = {FLIGHT_PICTURE_BEGIN, NULL};
    Result result = screenshot ? picture_check_name(screenshot, "--screenshot") : RESULT_OK;
    if (result == RESULT_OK && screenshot)
        result = outputs_check(options, "--screenshot", screenshot);
    if (result == RESULT_OK && pictures)
        result = files_make_folder(pictures);
    if (result == RESULT_OK && pictures)
        result = files_check_folder(pictures);
    return result == RESULT_OK && pictures ? outputs_check_folder(options, "--pictures", pictures, begins) : result;
}

// In a file of settings it may wait for its time.
static bool is_asked_for(const Options *options, OptionId id) {
    return options_is_set(options, id) && options_source(options, id) == SOURCE_COMMAND_LINE;
}

static void warn_of_ignored(const Options *options) {
    if (is_asked_for(options, OPTION_IDLE) && !options_flag(options, OPTION_KIOSK))
        log_warn("--idle changes nothing without --kiosk");
    if (is_asked_for(options, OPTION_EVERY) && !options_text(options, OPTION_PICTURES))
        log_warn("--every changes nothing without --pictures DIR");
}

Result fly_check_outputs(const Options *options) {
    Result result = check_target(options);
    if (result == RESULT_OK)
        result = check_start(options);
    if (result == RESULT_OK)
        result = check_record(options);
    if (result == RESULT_OK)
        result = check_telemetry(options);
    if (result == RESULT_OK)
        result = check_pictures(options);
    if (result == RESULT_OK)
        result = check_video(options);
    if (result == RESULT_OK)
        warn_of_ignored(options);
    return result;
}
