#include "app/pilot/pilot.h"

#include "app/pilot/pad_setups.h"
#include "base/log.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EVENTS_MOST 256 // between two frames
#define LOST_BYTES 96
_Static_assert(MAPPER_SLOTS >= DEVICES_MAX, "each device has a slot");

struct Pilot {
    PadSetups *setups;
    Devices *devices; // NULL: none can be looked for
    Mapper mapper;
    bool connected[DEVICES_MAX];
    PadInfo infos[DEVICES_MAX];
    PadState before[DEVICES_MAX]; // when it was touched last
    bool reported[DEVICES_MAX];
    bool touched;
    DeviceEvent events[EVENTS_MOST];
    int event_count, heard;
};

Result pilot_create(Pilot **out) {
    Pilot *pilot = calloc(1, sizeof *pilot);
    if (!pilot) {
        log_error("no memory for sticks and gamepads");
        return RESULT_MEMORY;
    }
    mapper_init(&pilot->mapper);
    Result result = pad_setups_create(&pilot->setups);
    if (result != RESULT_OK) {
        free(pilot);
        return result;
    }
    DeviceHook hook = pad_setups_hook(pilot->setups);
    if (devices_create(&hook, &pilot->devices) != RESULT_OK)
        log_warn("flying without sticks and gamepads");
    *out = pilot;
    return RESULT_OK;
}

void pilot_destroy(Pilot **pilot) {
    if (!*pilot)
        return;
    if ((*pilot)->devices)
        devices_destroy(&(*pilot)->devices);
    pad_setups_destroy(&(*pilot)->setups);
    free(*pilot);
    *pilot = NULL;
}

// What was not heard yet stays in front.
void pilot_poll(Pilot *pilot) {
    if (!pilot->devices)
        return;
    pilot->event_count -= pilot->heard;
    memmove(pilot->events, pilot->events + pilot->heard, sizeof *pilot->events * (size_t)pilot->event_count);
    pilot->heard = 0;
    pilot->event_count +=
        devices_poll(pilot->devices, pilot->events + pilot->event_count, EVENTS_MOST - pilot->event_count);
}

// ---- what happens to pads ----

static void connect(Pilot *pilot, const DeviceEvent *event, char message[PILOT_MESSAGE_BYTES]) {
    PadSetup *setup = pad_setups_take(pilot->setups, event->slot, &event->info);
    bool has_profile = setup && setup->has_profile;
    mapper_connect(&pilot->mapper, event->slot, &event->info, has_profile ? &setup->profile : NULL,
                   setup && setup->is_calibrated ? &setup->calibration : NULL);
    pilot->connected[event->slot] = true;
    pilot->reported[event->slot] = false;
    pilot->infos[event->slot] = event->info;
    snprintf(message, PILOT_MESSAGE_BYTES, "%.60s: %s", event->info.name,
             has_profile ? setup->profile.name : "no profile of its own, flying with the usual one");
    log_info("joystick: %s (%04x:%04x): %s", event->info.name, event->info.vendor, event->info.product,
             has_profile ? setup->path : "no profile; overfly devices shows what moves what");
    free(setup);
}

// ", with it throttle, rudder": what its axes drive.
static void write_lost(const Pilot *pilot, int slot, char out[LOST_BYTES]) {
    size_t used = 0;
    out[0] = '\0';
    for (int control = 0; control < PAD_CONTROL_LOOK_X && used < LOST_BYTES; control++) {
        const MapperDriver *driver = &pilot->mapper.drivers[control];
        if (driver->kind == MAPPER_AXIS && driver->slot == slot)
            used += (size_t)snprintf(out + used, LOST_BYTES - used, "%s%s", used ? ", " : ", with it ",
                                     pad_control_name((PadControl)control));
    }
}

static void disconnect(Pilot *pilot, Keyboard *keyboard, int slot, char message[PILOT_MESSAGE_BYTES]) {
    if (!pilot->connected[slot])
        return;
    char lost[LOST_BYTES];
    write_lost(pilot, slot, lost);
    mapper_disconnect(&pilot->mapper, slot, keyboard);
    pilot->connected[slot] = false;
    snprintf(message, PILOT_MESSAGE_BYTES, "%.60s was unplugged%s%s", pilot->infos[slot].name, lost,
             pilot_drives_stick(pilot) ? "" : ": the keyboard flies");
    log_info("joystick: %s was unplugged", pilot->infos[slot].name);
}

static void deny(const DeviceEvent *event, char message[PILOT_MESSAGE_BYTES]) {
    snprintf(message, PILOT_MESSAGE_BYTES, "%.60s cannot be read: see overfly devices", event->info.name);
}

static bool differs(const PadState *a, const PadState *b) {
    bool differs =
        memcmp(a->buttons, b->buttons, sizeof a->buttons) != 0 || memcmp(a->hats, b->hats, sizeof a->hats) != 0;
    for (int i = 0; i < PAD_AXES_MAX; i++)
        differs = differs || fabs(a->axes[i] - b->axes[i]) > MAPPER_MOVED;
    return differs;
}

static void hear_report(Pilot *pilot, Keyboard *keyboard, const DeviceEvent *event) {
    PadState *before = &pilot->before[event->slot];
    bool first = !pilot->reported[event->slot];
    mapper_report(&pilot->mapper, event->slot, &event->state, keyboard);
    pilot->touched = pilot->touched || (!first && differs(before, &event->state));
    if (first || differs(before, &event->state))
        *before = event->state;
    pilot->reported[event->slot] = true;
}

static void hear_event(Pilot *pilot, Keyboard *keyboard, const DeviceEvent *event, char message[PILOT_MESSAGE_BYTES]) {
    switch (event->kind) {
    case DEVICE_ARRIVED:
        connect(pilot, event, message);
        return;
    case DEVICE_DENIED:
        deny(event, message);
        return;
    case DEVICE_LEFT:
        disconnect(pilot, keyboard, event->slot, message);
        return;
    case DEVICE_REPORT:
        if (pilot->connected[event->slot])
            hear_report(pilot, keyboard, event);
        return;
    }
}

void pilot_hear(Pilot *pilot, Keyboard *keyboard, int64_t until_ns, char message[PILOT_MESSAGE_BYTES]) {
    message[0] = '\0';
    for (; pilot->heard < pilot->event_count && pilot->events[pilot->heard].time_ns < until_ns; pilot->heard++)
        hear_event(pilot, keyboard, &pilot->events[pilot->heard], message);
}

Controls pilot_sample(Pilot *pilot, Keyboard *keyboard, double dt_s) {
    return mapper_sample(&pilot->mapper, keyboard, dt_s);
}

void pilot_keep(Pilot *pilot, Keyboard *keyboard) {
    mapper_keep(&pilot->mapper, keyboard);
}

bool pilot_drives_stick(const Pilot *pilot) {
    const MapperDriver *drivers = pilot->mapper.drivers;
    return drivers[PAD_CONTROL_AILERON].kind == MAPPER_AXIS || drivers[PAD_CONTROL_ELEVATOR].kind == MAPPER_AXIS;
}

bool pilot_was_touched(Pilot *pilot) {
    bool touched = pilot->touched;
    pilot->touched = false;
    return touched;
}

void pilot_look(const Pilot *pilot, double *right, double *up) {
    mapper_look(&pilot->mapper, right, up);
}

void pilot_rumble(Pilot *pilot, double low, double high, double seconds) {
    for (int slot = 0; slot < DEVICES_MAX; slot++)
        if (pilot->connected[slot] && pilot->devices)
            devices_rumble(pilot->devices, slot, low, high, seconds);
}
