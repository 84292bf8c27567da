#define _POSIX_C_SOURCE 200809L
#include "app/signals.h"

#include <pthread.h>
#include <time.h>

static void fill_leaving(sigset_t *set) {
    sigemptyset(set);
    sigaddset(set, SIGINT);
    sigaddset(set, SIGTERM);
}

void signals_hold(sigset_t *before) {
    sigset_t leaving;
    fill_leaving(&leaving);
    pthread_sigmask(SIG_BLOCK, &leaving, before);
}

void signals_hold_all(sigset_t *before) {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, before);
}

void signals_restore(const sigset_t *before) {
    pthread_sigmask(SIG_SETMASK, before, NULL);
}

bool signals_leave_wanted(void) {
    sigset_t leaving;
    struct timespec now = {0};
    fill_leaving(&leaving);
    return sigtimedwait(&leaving, NULL, &now) > 0;
}
