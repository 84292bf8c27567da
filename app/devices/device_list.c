#define _POSIX_C_SOURCE 200809L
#include "app/devices/device_list.h"

#include "app/joystick/joystick_files.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

void device_list_init(DeviceList *list) {
    memset(list, 0, sizeof *list);
}

static void ask_node(DeviceRow *row) {
    struct stat node;
    if (stat(row->info.path, &node) != 0)
        return;
    row->mode = node.st_mode & 07777;
    row->owner = node.st_uid;
    row->group = node.st_gid;
}

static void come(DeviceRow *row, const DeviceEvent *event) {
    *row = (DeviceRow){.there = true, .error = event->error, .info = event->info, .state = pad_at_rest()};
    ask_node(row);
    if (joystick_find_profile(&row->info, &row->profile, row->profile_file) != RESULT_OK) {
        row->profile = profile_default(&row->info);
        row->profile_file[0] = '\0';
    }
    if (joystick_load_calibration(&row->info, &row->calibration) != RESULT_OK)
        row->calibration = (PadCalibration){.axes = {{.known = false}}};
}

void device_list_take(DeviceList *list, const DeviceEvent *event) {
    DeviceRow *row = &list->rows[event->slot];
    switch (event->kind) {
    case DEVICE_ARRIVED:
    case DEVICE_DENIED:
        come(row, event);
        break;
    case DEVICE_REPORT:
        row->state = event->state;
        row->reports++;
        break;
    case DEVICE_LEFT:
        row->there = false;
        break;
    }
}

int device_list_count(const DeviceList *list) {
    int count = 0;
    for (int i = 0; i < DEVICES_MAX; i++)
        count += list->rows[i].there;
    return count;
}

// From 1: which of its kind the axis is.
static int ordinal_of(const DeviceRow *row, int axis) {
    int ordinal = 0;
    for (int i = 0; i <= axis; i++)
        ordinal += row->info.axes[i] == row->info.axes[axis];
    return ordinal;
}

const AxisMapping *device_row_mapping(const DeviceRow *row, int axis) {
    int ordinal = ordinal_of(row, axis);
    for (int i = 0; i < row->profile.axis_count; i++) {
        const AxisMapping *mapping = &row->profile.axes[i];
        if (mapping->axis == row->info.axes[axis] && mapping->ordinal == ordinal)
            return mapping;
    }
    return NULL;
}

double device_row_mapped(const DeviceRow *row, int axis) {
    const AxisMapping *mapping = device_row_mapping(row, axis);
    bool has_centre = pad_control_least(mapping->control) < 0.0;
    double calibrated = calibration_apply(&row->calibration.axes[axis], row->state.axes[axis], has_centre);
    return profile_axis_value(mapping, calibrated);
}

void device_row_axis_name(const DeviceRow *row, int axis, char out[32]) {
    int ordinal = ordinal_of(row, axis);
    snprintf(out, 32, ordinal > 1 ? "%s %d" : "%s", pad_axis_name(row->info.axes[axis]), ordinal);
}

bool device_row_is_down(const DeviceRow *row, int button) {
    return row->state.buttons[button / 64] >> (button % 64) & 1;
}

static bool is_of(const ButtonMapping *mapping, int number, int direction) {
    return mapping->number == number + 1 && mapping->is_hat == (direction >= 0) &&
           (direction < 0 || mapping->direction == direction);
}

void device_row_does(const DeviceRow *row, int number, int direction, char out[64]) {
    out[0] = '\0';
    for (int i = 0; i < row->profile.button_count; i++) {
        const ButtonMapping *mapping = &row->profile.buttons[i];
        if (!is_of(mapping, number, direction))
            continue;
        if (mapping->does == BUTTON_ACTION)
            snprintf(out, 64, "%s", action_help(mapping->action));
        else
            snprintf(out, 64, "%s %+.2f%s", pad_control_name(mapping->control), mapping->amount,
                     mapping->does == BUTTON_STEP ? " a press" : "");
        return;
    }
}
