#include "app/commands/command.h"
#include "app/flight/fly.h"
#include "base/log.h"

Result cmd_replay(const Options *options) {
    if (options_positional_count(options) > 0)
        return fly_run(options, options_positionals(options)[0]);
    log_error("replay: expected a recorded flight: a file of one of the formats of 'overfly convert'; found nothing");
    return RESULT_USAGE;
}
