// input/devices/devices_hid.h: sticks, throttles, pedals and gamepads that are HID, by hidapi over Linux's hidraw
// nodes. Times as clock_now_ns. A HidSource borrows its queue, which must outlive it; it owns a thread that looks for
// nodes and one for each device that is read.
#pragma once
#include "input/devices/device_queue.h"

typedef struct HidSource HidSource;

// MEMORY, DEVICE: logged.
MUST_USE Result hid_source_create(DeviceQueue *queue, HidSource **source);
// Within 0.2 s: ends the threads; devices still there leave.
void hid_source_destroy(HidSource **source);
// Whether it has once looked at all nodes.
bool hid_source_looked(const HidSource *source);
