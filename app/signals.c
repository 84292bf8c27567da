#define _POSIX_C_SOURCE 200809L
#include "app/signals.h"

#include <pthread.h>
#include <time.h>

static const int LEAVING[] = {SIGINT, SIGTERM};

void signals_hold(sigset_t *before) {
    sigset_t held;
    struct sigaction now;
    sigemptyset(&held);
    for (size_t i = 0; i < COUNT_OF(LEAVING); i++)
        if (sigaction(LEAVING[i], NULL, &now) == 0 && now.sa_handler != SIG_IGN)
            sigaddset(&held, LEAVING[i]);
    pthread_sigmask(SIG_BLOCK, &held, before);
}

void signals_hold_all(sigset_t *before) {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, before);
}

void signals_restore(const sigset_t *before) {
    pthread_sigmask(SIG_SETMASK, before, NULL);
}

int signals_take(void) {
    sigset_t leaving;
    struct timespec now = {0};
    sigemptyset(&leaving);
    for (size_t i = 0; i < COUNT_OF(LEAVING); i++)
        sigaddset(&leaving, LEAVING[i]);
    int came = sigtimedwait(&leaving, NULL, &now);
    return came > 0 ? came : 0;
}

bool signals_leave_wanted(void) {
    return signals_take() != 0;
}
