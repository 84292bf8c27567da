// app/devices/device_list.h: the sticks and gamepads that are there, kept up to date from events, with what they move.
// Axes -1..1; controls as input/profile.h has them.
// A DeviceList is a value of some hundred kilobytes; one thread at a time.
#pragma once
#include "base/paths.h"
#include "input/calibration.h"
#include "input/devices/devices.h"
#include "input/profile.h"

typedef struct DeviceRow {
    bool there;
    int error; // of errno: why it cannot be read; 0: it is read
    PadInfo info;
    PadState state; // as reported last, or pad_at_rest
    int64_t reports;
    PadProfile profile;
    char profile_file[PATHS_BYTES_MAX]; // "": profile_default
    PadCalibration calibration;
    unsigned mode, owner, group; // of the node; mode 0: it could not be asked
} DeviceRow;

typedef struct DeviceList {
    DeviceRow rows[DEVICES_MAX]; // by slot
} DeviceList;

void device_list_init(DeviceList *list);
// Looks for the profile and the calibration of a device that arrives.
void device_list_take(DeviceList *list, const DeviceEvent *event);
// How many are there.
int device_list_count(const DeviceList *list);

// Which axis of the profile is the pad's axis `axis`; NULL: it moves nothing.
const AxisMapping *device_row_mapping(const DeviceRow *row, int axis);
// What it makes of its control now.
double device_row_mapped(const DeviceRow *row, int axis);
// "x", or "slider 2" for the second of a kind.
void device_row_axis_name(const DeviceRow *row, int axis, char out[32]);
// What the profile has the button (from 0; direction -1), or the hat pushed in a direction (0, 2, 4, 6), do: "look-x
// +1.00", "view-next"; "": nothing.
void device_row_does(const DeviceRow *row, int number, int direction, char out[64]);
bool device_row_is_down(const DeviceRow *row, int button); // from 0
