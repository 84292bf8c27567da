// app/signals.h: SIGINT and SIGTERM as a question instead of an interruption.
// No units.
// Nothing is owned; the mask belongs to the calling thread and to threads it starts.
#pragma once
#include "base/base.h"

#include <signal.h>

// From here on the two signals wait, but for those that are ignored (as in the background of a script); `before` is for
// signals_restore.
void signals_hold(sigset_t *before);
void signals_restore(const sigset_t *before);
// For threads about to be started: none of them shall take a signal.
void signals_hold_all(sigset_t *before);
// The one that came since signals_hold; 0: none. Takes it.
int signals_take(void);
bool signals_leave_wanted(void); // whether one came; takes it
