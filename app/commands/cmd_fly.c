#include "app/commands/command.h"
#include "app/flight/fly.h"
#include "app/replay/playback.h"
#include "app/track/track_format.h"
#include "base/log.h"

// Who names a flight where a terrain is wanted means to see it again.
static Result check_terrain(const Options *options) {
    for (int i = 0; i < options_positional_count(options); i++) {
        const char *path = options_positionals(options)[i];
        if (!playback_is_recording(path) && !track_is_named(path))
            continue;
        log_error("%s: a recorded flight, expected a terrain; to fly it again: overfly replay %s", path, path);
        return RESULT_USAGE;
    }
    return RESULT_OK;
}

Result cmd_fly(const Options *options) {
    Result result = check_terrain(options);
    return result == RESULT_OK ? fly_run(options, NULL) : result;
}
