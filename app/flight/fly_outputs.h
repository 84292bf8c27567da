// app/flight/fly_outputs.h: before anything slow, whether a flight can write what it is asked for.
// No units.
// Owns nothing. Main thread.
#pragma once
#include "config/options.h"

// Of --record, --telemetry, --screenshot, --pictures and --video: names, folders, and that nothing is written over that
// is read or not of their kind; and options that exclude each other. Those that change nothing are warned of. USAGE,
// NOT_FOUND, IO, RANGE; logged; errors of outputs_check.
MUST_USE Result fly_check_outputs(const Options *options);
