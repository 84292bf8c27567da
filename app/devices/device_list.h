// app/devices/device_list.h: the sticks and gamepads that are there, kept up to date from events, with what they move.
// Axes -1..1; controls as input/profile.h has them.
// A DeviceList is a value of some hundred kilobytes; one thread at a time.
#pragma once
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
    PadCalibration calibration;
    unsigned mode, owner, group; // of the node; mode 0: it could not be asked
} DeviceRow;

typedef struct DeviceList {
    DeviceRow rows[DEVICES_MAX]; // by slot
} DeviceList;

void device_list_init(DeviceList *list);
void device_list_take(DeviceList *list, const DeviceEvent *event);
// How many are there.
int device_list_count(const DeviceList *list);

// Which axis of the profile is the pad's axis `axis`; NULL: it moves nothing.
const AxisMapping *device_row_mapping(const DeviceRow *row, int axis);
// What it makes of its control now.
double device_row_mapped(const DeviceRow *row, int axis);
// "x", or "slider 2" for the second of a kind.
void device_row_axis_name(const DeviceRow *row, int axis, char out[32]);
bool device_row_is_down(const DeviceRow *row, int button); // from 0
