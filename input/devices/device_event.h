// input/devices/device_event.h: what happens to sticks and gamepads: they come, they say something, they go.
// Times as clock_now_ns.
// Values.
#pragma once
#include "input/pad.h"

#define DEVICES_MAX 16 // at a time, those that cannot be read included

typedef enum DeviceEventKind {
    DEVICE_ARRIVED, // it is read from now on
    DEVICE_DENIED,  // it is there and cannot be read; DEVICE_ARRIVED in the same slot follows when that changes
    DEVICE_REPORT,
    DEVICE_LEFT, // also after DEVICE_DENIED; the slot may be another device's afterwards
} DeviceEventKind;

typedef struct DeviceEvent {
    DeviceEventKind kind;
    int slot;        // 0 .. DEVICES_MAX - 1
    int64_t time_ns; // when the report was read; when the change was noticed
    int error;       // DENIED: why, of errno
    PadInfo info;    // ARRIVED, DENIED
    PadState state;  // REPORT: all of it, not only what changed
} DeviceEvent;

// What is to be done before a device is told of, which may take its time. `make`, NULL for nothing, is called by the
// thread that found the device, before its DEVICE_ARRIVED can be taken, with no mutex held; several may call at once,
// for different slots. On USB that thread reads all pads, whose reports wait meanwhile.
typedef struct DeviceHook {
    void (*make)(void *user, int slot, const PadInfo *info);
    void *user;
} DeviceHook;
