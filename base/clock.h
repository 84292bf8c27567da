// base/clock.h: the monotonic clock.
// Nanoseconds since an arbitrary start.
// Owns nothing; any thread.
#pragma once
#include "base/base.h"

int64_t clock_now_ns(void);
void clock_sleep_until_ns(int64_t when_ns);
