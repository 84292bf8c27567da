// tests/device_timing.h: how long a poll takes while devices come and go, and from a report to its event.
// Milliseconds in what is printed.
// A DeviceTiming is the test's.
#pragma once
#include "base/clock.h"
#include "base/statistics.h"
#include "input/devices/devices.h"

#include <stdio.h>
#include <sys/resource.h>
#include <time.h>

#define DEVICE_TIMING_MAX 200000

typedef struct DeviceTiming {
    double ms[DEVICE_TIMING_MAX];
    int count;
    double busy_ms; // most processor time of one, which no other program's work lengthens
    long sleeps;    // how often the thread gave the processor away in them
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

static inline double device_timing_busy_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

// Polls as often as can be until an event of `kind` comes, for at most 20 s.
static inline bool device_timing_poll_until(DeviceTiming *timing, Devices *devices, DeviceEventKind kind) {
    int64_t until_ns = clock_now_ns() + 20 * INT64_C(1000000000), begin_ns;
    DeviceEvent event;
    bool found = false;
    long sleeps = device_timing_sleeps();
    while (!found && (begin_ns = clock_now_ns()) < until_ns) {
        double busy_ms = device_timing_busy_ms();
        int count = devices_poll(devices, &event, 1);
        busy_ms = device_timing_busy_ms() - busy_ms;
        device_timing_add(timing, begin_ns, clock_now_ns());
        timing->busy_ms = busy_ms > timing->busy_ms ? busy_ms : timing->busy_ms;
        found = count == 1 && event.kind == kind;
    }
    timing->sleeps += device_timing_sleeps() - sleeps;
    return found;
}

// The median, in ms.
static inline double device_timing_print(DeviceTiming *timing, const char *what) {
    statistics_sort(timing->ms, timing->count);
    double median = statistics_percentile(timing->ms, timing->count, 0.5);
    printf("%s: median %.4f ms, 99 %% within %.4f ms, largest %.4f ms, of %d", what, median,
           statistics_percentile(timing->ms, timing->count, 0.99),
           statistics_percentile(timing->ms, timing->count, 1.0), timing->count);
    if (timing->busy_ms > 0.0)
        printf("; at most %.4f ms of the processor's time, asleep %ld times", timing->busy_ms, timing->sleeps);
    printf("\n");
    return median;
}
