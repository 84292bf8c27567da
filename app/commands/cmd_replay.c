#include "app/commands/command.h"
#include "app/flight/fly.h"
#include "app/replay/replay_verify.h"
#include "base/log.h"

// Whether only the numbers are asked for: JSON of a recording, and nothing that must be drawn.
static bool wants_only_verdict(const Options *options, const char *track) {
    static const OptionId DRAWN[] = {OPTION_VIDEO, OPTION_PICTURES, OPTION_SCREENSHOT, OPTION_FRAMES};
    if (options_flag(options, OPTION_VERIFY))
        return true;
    for (size_t i = 0; i < COUNT_OF(DRAWN); i++)
        if (options_is_set(options, DRAWN[i]) && options_source(options, DRAWN[i]) == SOURCE_COMMAND_LINE)
            return false;
    return options_flag(options, OPTION_JSON) && playback_is_recording(track);
}

static Result check_verify(const Options *options) {
    static const OptionId DRAWN[] = {OPTION_VIDEO, OPTION_PICTURES, OPTION_SCREENSHOT};
    for (size_t i = 0; i < COUNT_OF(DRAWN) && options_flag(options, OPTION_VERIFY); i++)
        if (options_is_set(options, DRAWN[i]) && options_source(options, DRAWN[i]) == SOURCE_COMMAND_LINE) {
            log_error("replay: --verify draws nothing: expected no --%s with it", option_spec(DRAWN[i])->name);
            return RESULT_USAGE;
        }
    return RESULT_OK;
}

Result cmd_replay(const Options *options) {
    if (options_positional_count(options) == 0) {
        log_error("replay: expected a recorded flight: a recording (.ofr), or a file of one of the formats of "
                  "'overfly convert'; found nothing");
        return RESULT_USAGE;
    }
    if (check_verify(options) != RESULT_OK)
        return RESULT_USAGE;
    const char *track = options_positionals(options)[0];
    return wants_only_verdict(options, track) ? replay_verify(options, track) : fly_run(options, track);
}
