// app/signals.h: SIGINT and SIGTERM as a question instead of an interruption.
// No units.
// Nothing is owned; the mask belongs to the calling thread and to threads it starts.
#pragma once
#include "base/base.h"

#include <signal.h>

// From here on the two signals wait; `before` is for signals_restore.
void signals_hold(sigset_t *before);
void signals_restore(const sigset_t *before);
// For threads about to be started: none of them shall take a signal.
void signals_hold_all(sigset_t *before);
// Whether one came since signals_hold. Takes it.
bool signals_leave_wanted(void);
