#include "app/commands/command.h"
#include "app/flight/fly.h"

Result cmd_fly(const Options *options) {
    return fly_run(options, NULL);
}
