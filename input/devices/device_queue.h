// input/devices/device_queue.h: from the threads that read devices to the one that flies. Also gives devices their
// slots. Times as clock_now_ns. The queue owns its events; any thread, each call holds one mutex for as long as events
// are copied.
#pragma once
#include "input/devices/device_event.h"

#define DEVICE_QUEUE_EVENTS 256
#define DEVICE_QUEUE_WAIT_NS 200000 // that taking waits for the mutex

typedef struct DeviceQueue DeviceQueue;

MUST_USE Result device_queue_create(const DeviceHook *hook, DeviceQueue **queue); // MEMORY
void device_queue_destroy(DeviceQueue **queue);

// A free slot for a device, and ARRIVED, after the hook was called, or DENIED where `error`, of errno, is not 0. -1:
// all slots are taken.
int device_queue_join(DeviceQueue *queue, const PadInfo *info, int error);
bool device_queue_has_room(DeviceQueue *queue);
// A device that was denied: it can be read now (ARRIVED), or not for another reason (DENIED).
void device_queue_change(DeviceQueue *queue, int slot, const PadInfo *info, int error);
void device_queue_report(DeviceQueue *queue, int slot, int64_t time_ns, const PadState *state);
// LEFT, and the slot is free.
void device_queue_leave(DeviceQueue *queue, int slot);

// The oldest `max` events, in order; their number. None as well when the mutex is not to be had within
// DEVICE_QUEUE_WAIT_NS: they come next time. A full queue loses, for a new report, the oldest report of the same
// slot, else the oldest of all. An arrival is lost only together with its departure; a device that left before its
// reports were taken takes them along.
int device_queue_take(DeviceQueue *queue, DeviceEvent *out, int max);
// How many reports were lost so, ever.
int64_t device_queue_lost(DeviceQueue *queue);
