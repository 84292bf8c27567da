// input/devices/devices.h: sticks and gamepads of all buses, as events: what comes, what it says, what goes.
// Times as clock_now_ns; axes and hats as input/pad.h has them; seconds.
// A Devices owns its threads: blocking reads happen there, never in the caller. One thread polls; any may rumble.
#pragma once
#include "input/devices/device_event.h"

typedef struct Devices Devices;

// Starts to look for devices, and to read those found. A bus that cannot be looked at is left out, and
// devices_lack says why. `hook` NULL: nothing is done before a device is told of. MEMORY, DEVICE: logged.
MUST_USE Result devices_create(const DeviceHook *hook, Devices **devices);
// Within about a second: ends the threads, stops motors, hands devices back. NULL inside is accepted.
void devices_destroy(Devices **devices);

// The oldest `max` events into `out`, in order; their number. Waits for no device, and at most 0.2 ms for a mutex;
// where that is not enough, events come with the next poll. 256 events are kept at most: when nobody polls, a new
// report pushes out the oldest of the same device. Arrivals and departures are not lost, but those of a device that
// came and went between two polls are never told.
int devices_poll(Devices *devices, DeviceEvent *out, int max);
// Blocks until all devices that are there now were announced, at most so long. False: it took longer.
bool devices_wait(Devices *devices, double seconds_max);
// Reports that were pushed out, ever.
int64_t devices_lost(Devices *devices);
// "" or why a bus is left out, for people.
const char *devices_lack(const Devices *devices);

// Shares 0..1 of the strength of the heavy (low) and the light (high) motor, for at most 10 s, instead of what was
// asked before. Devices without motors, and HID, ignore it. Does not wait.
void devices_rumble(Devices *devices, int slot, double low, double high, double seconds);
