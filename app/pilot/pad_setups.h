// app/pilot/pad_setups.h: what files say of a pad that was plugged in, read by the thread that found the pad, so that
// no frame waits for a disk.
// A PadSetups owns what was read until it is taken, and must outlive the devices it is the hook of. One thread takes.
#pragma once
#include "app/joystick/joystick_files.h"
#include "input/devices/device_event.h"

typedef struct PadSetup {
    PadInfo info;
    bool has_profile, is_calibrated;
    char path[PATHS_BYTES_MAX]; // of the profile
    PadProfile profile;
    PadCalibration calibration;
} PadSetup;

typedef struct PadSetups PadSetups;

MUST_USE Result pad_setups_create(PadSetups **out); // MEMORY: logged
void pad_setups_destroy(PadSetups **setups);        // NULL inside is accepted
// For devices_create.
DeviceHook pad_setups_hook(PadSetups *setups);
// What was read of the pad that arrived in the slot, free() ends it. Opens files only where the slot had
// another arrival since, or memory lacked. NULL: no memory.
PadSetup *pad_setups_take(PadSetups *setups, int slot, const PadInfo *info);
