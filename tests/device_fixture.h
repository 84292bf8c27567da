// tests/device_fixture.h: a bed of devices and their reader, and how long both take, for tests of either kind of
// device. Milliseconds. A DeviceFixture is the state of a cmocka test, made by its set_up and freed by
// device_fixture_tear_down.
#pragma once
#include "tests/device_support.h"
#include "tests/device_timing.h"

#include <semaphore.h>

typedef struct DeviceFixture {
    FakeBed *bed;
    Devices *devices; // NULL until the test's set_up makes them
    DeviceTiming timing;
    sem_t turn;
} DeviceFixture;

DeviceFixture *device_fixture_create(void); // an empty bed
int device_fixture_tear_down(void **state);
void device_fixture_sleep_ms(int ms);

// Has a device, an own type of the test's, say x.
typedef void DeviceSend(void *device, double x);
// Waiting for the report is a part of it: a flight polls once a step, which the median must be within. `within`: of x.
void device_fixture_time_reports(DeviceFixture *fixture, DeviceSend *send, void *device, double within,
                                 const char *what);

// Plugs in the device of a round; has it say something, and pulls it.
typedef void *DevicePlug(DeviceFixture *fixture, int round);
typedef void DevicePull(DeviceFixture *fixture, void *device);
// By another hand, while the test polls: no poll may wait.
void device_fixture_time_changes(DeviceFixture *fixture, DevicePlug *plug, DevicePull *pull, int rounds,
                                 const char *what);
