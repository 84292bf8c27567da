#define _GNU_SOURCE // RUSAGE_THREAD
#include "tests/device_fixture.h"

#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

#define REPORTS 200

DeviceFixture *device_fixture_create(void) {
    DeviceFixture *fixture = calloc(1, sizeof *fixture);
    assert_non_null(fixture);
    fixture->bed = fake_bed_create();
    return fixture;
}

int device_fixture_tear_down(void **state) {
    DeviceFixture *fixture = *state;
    devices_destroy(&fixture->devices);
    fake_bed_destroy(&fixture->bed);
    free(fixture);
    return 0;
}

void device_fixture_sleep_ms(int ms) {
    clock_sleep_until_ns(clock_now_ns() + (int64_t)ms * 1000000);
}

void device_fixture_time_reports(DeviceFixture *fixture, DeviceSend *send, void *device, double within,
                                 const char *what) {
    DeviceEvent event;
    for (int i = 0; i < REPORTS; i++) {
        double x = i / (double)REPORTS;
        int64_t begin_ns = clock_now_ns();
        send(device, x);
        assert_true(fake_wait(fixture->devices, DEVICE_REPORT, &event));
        int64_t end_ns = clock_now_ns();
        assert_true(event.time_ns >= begin_ns && event.time_ns <= end_ns);
        assert_true(fabs(event.state.axes[0] - x) < within);
        device_timing_add(&fixture->timing, begin_ns, end_ns);
    }
    device_timing_print(&fixture->timing, what);
}

typedef struct Hand {
    DeviceFixture *fixture;
    DevicePlug *plug;
    DevicePull *pull;
    int rounds;
} Hand;

static void *plug_and_pull(void *argument) {
    const Hand *hand = argument;
    for (int round = 0; round < hand->rounds; round++) {
        sem_wait(&hand->fixture->turn);
        void *device = hand->plug(hand->fixture, round);
        sem_wait(&hand->fixture->turn);
        hand->pull(hand->fixture, device);
    }
    return NULL;
}

void device_fixture_time_changes(DeviceFixture *fixture, DevicePlug *plug, DevicePull *pull, int rounds,
                                 const char *what) {
    Hand hand = {fixture, plug, pull, rounds};
    pthread_t thread;
    assert_int_equal(sem_init(&fixture->turn, 0, 0), 0);
    assert_int_equal(pthread_create(&thread, NULL, plug_and_pull, &hand), 0);
    for (int change = 0; change < 2 * rounds; change++) {
        sem_post(&fixture->turn);
        assert_true(device_timing_poll_until(&fixture->timing, fixture->devices,
                                             change % 2 == 0 ? DEVICE_ARRIVED : DEVICE_LEFT));
    }
    pthread_join(thread, NULL);
    sem_destroy(&fixture->turn);
    device_timing_print(&fixture->timing, what);
    assert_true(fixture->timing.sleeps < rounds); // who waits for a device sleeps at each change; for a mutex, rarely
}
