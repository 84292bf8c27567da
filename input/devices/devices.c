#define _POSIX_C_SOURCE 200809L
#include "input/devices/devices.h"

#include "base/clock.h"
#include "base/log.h"
#include "input/devices/devices_hid.h"
#include "input/devices/devices_usb.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>

#define LOOK_NS 5000000

struct Devices {
    DeviceQueue *queue;
    HidSource *hid;
    UsbSource *usb; // NULL: there is no USB
};

// Signals are for the threads that are there already, not for those that are started here or by libusb.
static Result start(Devices *devices) {
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before);
    Result result = hid_source_create(devices->queue, &devices->hid);
    if (result == RESULT_OK) {
        result = usb_source_create(devices->queue, &devices->usb);
        if (result == RESULT_DEVICE)
            result = RESULT_OK;
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return result;
}

Result devices_create(const DeviceHook *hook, Devices **out) {
    Devices *devices = calloc(1, sizeof *devices);
    if (!devices) {
        log_error("devices: no memory");
        return RESULT_MEMORY;
    }
    Result result = device_queue_create(hook, &devices->queue);
    if (result == RESULT_OK)
        result = start(devices);
    if (result != RESULT_OK)
        devices_destroy(&devices);
    else
        *out = devices;
    return result;
}

void devices_destroy(Devices **devices) {
    if (!*devices)
        return;
    usb_source_destroy(&(*devices)->usb);
    hid_source_destroy(&(*devices)->hid);
    device_queue_destroy(&(*devices)->queue);
    free(*devices);
    *devices = NULL;
}

int devices_poll(Devices *devices, DeviceEvent *out, int max) {
    return device_queue_take(devices->queue, out, max);
}

static bool looked(const Devices *devices) {
    return hid_source_looked(devices->hid) && (!devices->usb || usb_source_looked(devices->usb));
}

bool devices_wait(Devices *devices, double seconds_max) {
    int64_t until_ns = clock_now_ns() + (int64_t)(seconds_max * 1e9);
    while (!looked(devices) && clock_now_ns() < until_ns)
        clock_sleep_until_ns(clock_now_ns() + LOOK_NS);
    return looked(devices);
}

int64_t devices_lost(Devices *devices) {
    return device_queue_lost(devices->queue);
}

const char *devices_lack(const Devices *devices) {
    return devices->usb ? "" : "this system has no USB (/dev/bus/usb), so no gamepads that are not HID";
}

void devices_rumble(Devices *devices, int slot, double low, double high, double seconds) {
    if (devices->usb)
        usb_source_rumble(devices->usb, slot, low, high, seconds);
}
