// tests/device_timing.h: how long a poll takes while devices come and go, and from a report to its event.
// Milliseconds in what is printed.
// A DeviceTiming is the test's.
#pragma once
#include "base/clock.h"
#include "base/statistics.h"
#include "input/devices/devices.h"

#include <stdio.h>
#include <sys/resource.h>

#define DEVICE_TIMING_MAX 200000

typedef struct DeviceTiming {
    double ms[DEVICE_TIMING_MAX];
    int count;
    long sleeps; // how often the thread gave the processor away in them
} DeviceTiming;

static inline void device_timing_add(DeviceTiming *timing, int64_t begin_ns, int64_t end_ns) {
    if (timing->count < DEVICE_TIMING_MAX)
        timing->ms[timing->count++] = (double)(end_ns - begin_ns) * 1e-6;
}

static inline long device_timing_sleeps(void) {
    struct rusage usage;
    getrusage(RUSAGE_THREAD, &usage);
    return usage.ru_nvcsw;
}

// Polls as often as can be until an event of `kind` comes, for at most 3 s.
static inline bool device_timing_poll_until(DeviceTiming *timing, Devices *devices, DeviceEventKind kind) {
    int64_t until_ns = clock_now_ns() + 3 * INT64_C(1000000000), begin_ns;
    DeviceEvent event;
    bool found = false;
    long sleeps = device_timing_sleeps();
    while (!found && (begin_ns = clock_now_ns()) < until_ns) {
        int count = devices_poll(devices, &event, 1);
        device_timing_add(timing, begin_ns, clock_now_ns());
        found = count == 1 && event.kind == kind;
    }
    timing->sleeps += device_timing_sleeps() - sleeps;
    return found;
}

// The median, in ms.
static inline double device_timing_print(DeviceTiming *timing, const char *what) {
    statistics_sort(timing->ms, timing->count);
    double median = statistics_percentile(timing->ms, timing->count, 0.5);
    printf("%s: median %.4f ms, 99 %% within %.4f ms, largest %.4f ms, of %d, in which the thread slept %ld times\n",
           what, median, statistics_percentile(timing->ms, timing->count, 0.99),
           statistics_percentile(timing->ms, timing->count, 1.0), timing->count, timing->sleeps);
    return median;
}
