#define _POSIX_C_SOURCE 200809L
#include "input/devices/device_queue.h"

#include "base/clock.h"
#include "base/log.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

// Of a slot at most LEFT and what came after it wait, so that a full queue always has a report to lose.
_Static_assert(DEVICE_QUEUE_EVENTS > 2 * DEVICES_MAX, "the queue holds more than all that may not be lost");

struct DeviceQueue {
    DeviceHook hook;
    pthread_mutex_t mutex;
    DeviceEvent events[DEVICE_QUEUE_EVENTS]; // oldest first
    int count;
    bool taken[DEVICES_MAX];
    bool told[DEVICES_MAX]; // whether the device now in the slot was handed out
    int64_t lost;
};

Result device_queue_create(const DeviceHook *hook, DeviceQueue **queue) {
    *queue = calloc(1, sizeof **queue);
    if (!*queue) {
        log_error("devices: no memory for a queue of %zu bytes", sizeof **queue);
        return RESULT_MEMORY;
    }
    if (hook)
        (*queue)->hook = *hook;
    pthread_mutex_init(&(*queue)->mutex, NULL);
    return RESULT_OK;
}

void device_queue_destroy(DeviceQueue **queue) {
    if (!*queue)
        return;
    pthread_mutex_destroy(&(*queue)->mutex);
    free(*queue);
    *queue = NULL;
}

static void remove_event(DeviceQueue *queue, int index) {
    queue->count--;
    memmove(&queue->events[index], &queue->events[index + 1], (size_t)(queue->count - index) * sizeof queue->events[0]);
}

// slot < 0: of any slot.
static int oldest_report(const DeviceQueue *queue, int slot) {
    for (int i = 0; i < queue->count; i++)
        if (queue->events[i].kind == DEVICE_REPORT && (slot < 0 || queue->events[i].slot == slot))
            return i;
    return -1;
}

static void make_room(DeviceQueue *queue, int slot) {
    if (queue->count < DEVICE_QUEUE_EVENTS)
        return;
    int own = oldest_report(queue, slot);
    remove_event(queue, own >= 0 ? own : oldest_report(queue, -1));
    queue->lost++;
}

static DeviceEvent *append(DeviceQueue *queue, DeviceEventKind kind, int slot) {
    make_room(queue, slot);
    DeviceEvent *event = &queue->events[queue->count++];
    *event = (DeviceEvent){.kind = kind, .slot = slot, .time_ns = clock_now_ns()};
    return event;
}

static void forget(DeviceQueue *queue, int slot, bool reports_too) {
    for (int i = queue->count - 1; i >= 0; i--) {
        const DeviceEvent *event = &queue->events[i];
        if (event->slot == slot && event->kind != DEVICE_LEFT && (reports_too || event->kind != DEVICE_REPORT))
            remove_event(queue, i);
    }
}

// DEVICES_MAX: none.
static int free_slot(const DeviceQueue *queue) {
    int slot = 0;
    while (slot < DEVICES_MAX && queue->taken[slot])
        slot++;
    return slot;
}

bool device_queue_has_room(DeviceQueue *queue) {
    pthread_mutex_lock(&queue->mutex);
    bool has_room = free_slot(queue) < DEVICES_MAX;
    pthread_mutex_unlock(&queue->mutex);
    return has_room;
}

void device_queue_change(DeviceQueue *queue, int slot, const PadInfo *info, int error) {
    if (!error && queue->hook.make)
        queue->hook.make(queue->hook.user, slot, info);
    pthread_mutex_lock(&queue->mutex);
    forget(queue, slot, false);
    DeviceEvent *event = append(queue, error ? DEVICE_DENIED : DEVICE_ARRIVED, slot);
    event->error = error;
    event->info = *info;
    pthread_mutex_unlock(&queue->mutex);
}

int device_queue_join(DeviceQueue *queue, const PadInfo *info, int error) {
    pthread_mutex_lock(&queue->mutex);
    int slot = free_slot(queue);
    if (slot < DEVICES_MAX) {
        queue->taken[slot] = true;
        queue->told[slot] = false;
    }
    pthread_mutex_unlock(&queue->mutex);
    if (slot == DEVICES_MAX)
        return -1;
    device_queue_change(queue, slot, info, error);
    return slot;
}

void device_queue_report(DeviceQueue *queue, int slot, int64_t time_ns, const PadState *state) {
    pthread_mutex_lock(&queue->mutex);
    DeviceEvent *event = append(queue, DEVICE_REPORT, slot);
    event->time_ns = time_ns;
    event->state = *state;
    pthread_mutex_unlock(&queue->mutex);
}

void device_queue_leave(DeviceQueue *queue, int slot) {
    pthread_mutex_lock(&queue->mutex);
    forget(queue, slot, true);
    if (queue->told[slot])
        append(queue, DEVICE_LEFT, slot);
    queue->taken[slot] = false;
    pthread_mutex_unlock(&queue->mutex);
}

// Who puts may have been stopped by the scheduler just when it held the mutex.
static bool lock_soon(pthread_mutex_t *mutex) {
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_nsec += DEVICE_QUEUE_WAIT_NS;
    until.tv_sec += until.tv_nsec / 1000000000;
    until.tv_nsec %= 1000000000;
    return pthread_mutex_timedlock(mutex, &until) == 0;
}

int device_queue_take(DeviceQueue *queue, DeviceEvent *out, int max) {
    if (!lock_soon(&queue->mutex))
        return 0;
    int count = queue->count < max ? queue->count : max;
    for (int i = 0; i < count; i++) {
        out[i] = queue->events[i];
        if (out[i].kind == DEVICE_ARRIVED || out[i].kind == DEVICE_DENIED)
            queue->told[out[i].slot] = true;
    }
    queue->count -= count;
    memmove(queue->events, queue->events + count, (size_t)queue->count * sizeof queue->events[0]);
    pthread_mutex_unlock(&queue->mutex);
    return count;
}

int64_t device_queue_lost(DeviceQueue *queue) {
    pthread_mutex_lock(&queue->mutex);
    int64_t lost = queue->lost;
    pthread_mutex_unlock(&queue->mutex);
    return lost;
}
