// base/rate.h: how a rate of time is written, wherever people read it.
// Seconds of the flight a second that passes; below zero backwards.
// The text is the caller's; any thread.
#pragma once
#include "base/base.h"

#define RATE_BYTES 24

// "4 ×", "1/4 ×", with a real minus backwards. `rate` is not zero; between whole numbers it is rounded.
void rate_write(double rate, char out[RATE_BYTES]);
