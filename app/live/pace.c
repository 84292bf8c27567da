#define _GNU_SOURCE
#include "app/live/pace.h"

#include "base/log.h"

#include <math.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#define NICE_LOWEST 19
#define SHARE_MOST 0.5

int64_t pace_thread_ns(void) {
    struct timespec used;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
    return (int64_t)used.tv_sec * 1000000000 + used.tv_nsec;
}

// On Linux a priority is a thread's own. Without it the share still holds.
static void lower_priority(void) {
    if (setpriority(PRIO_PROCESS, (id_t)syscall(SYS_gettid), NICE_LOWEST) != 0)
        log_debug("a background thread keeps its priority");
}

Pace pace_begin(double share) {
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    lower_priority();
    return (Pace){.share = fmin(share * (double)(processors > 0 ? processors : 1), SHARE_MOST),
                  .rested_at_ns = pace_thread_ns()};
}

int64_t pace_worked_ns(const Pace *pace) {
    return pace_thread_ns() - pace->rested_at_ns;
}

int64_t pace_rest_ns(Pace *pace) {
    int64_t worked_ns = pace_worked_ns(pace);
    double share = pace->hurry_ns > 0 ? fmin(PACE_HURRY * pace->share, SHARE_MOST) : pace->share;
    pace->rested_at_ns += worked_ns;
    pace->hurry_ns -= worked_ns < pace->hurry_ns ? worked_ns : pace->hurry_ns;
    return (int64_t)((double)worked_ns * (1.0 / share - 1.0));
}
