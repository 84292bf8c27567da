// input/devices/devices_usb.h: wired Xbox 360 pads and those that speak like them, by libusb: they are not HID.
// Times as clock_now_ns; seconds; shares of a motor's strength.
// A UsbSource borrows its queue, which must outlive it; it owns one thread, which talks to all pads.
#pragma once
#include "input/devices/device_queue.h"

typedef struct UsbSource UsbSource;

// MEMORY; DEVICE: the system has no USB that libusb could use. Logged.
MUST_USE Result usb_source_create(DeviceQueue *queue, UsbSource **source);
// Within 1 s: stops the motors, ends the thread; pads still there leave, and the kernel's driver takes them back.
void usb_source_destroy(UsbSource **source);
// Whether it has once looked at all devices.
bool usb_source_looked(const UsbSource *source);
// From now on for `seconds`; instead of what was asked before. Nothing happens to slots that hold no such pad. Any
// thread; never waits for the device.
void usb_source_rumble(UsbSource *source, int slot, double low, double high, double seconds);
