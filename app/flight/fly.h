// app/flight/fly.h: a flight from its options to its end: everything it needs made, flown or shown, told of, and freed.
// No units.
// Borrows its options. Main thread.
#pragma once
#include "base/base.h"
#include "config/options.h"

// `track`: a recorded flight that is shown instead of flown, or NULL.
MUST_USE Result fly_run(const Options *options, const char *track);
