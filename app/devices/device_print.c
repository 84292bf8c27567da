#include "app/devices/device_print.h"

#include "app/json.h"
#include "base/paths.h"
#include "input/devices/device_text.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

#define LOOKED_HID "HID joysticks, gamepads, multi-axis controllers and flight controls: /dev/hidraw*"
#define LOOKED_USB "wired Xbox 360 pads and those like them (USB class ff/5d/01): /dev/bus/usb"
#define RULES "70-overfly.rules"
#define RAW_BYTES 72

static const char *bus_name(const PadInfo *info) {
    return info->bus == PAD_BUS_HID ? "HID" : "USB";
}

static bool wants_rule(const DeviceRow *row) {
    return row->error == EACCES || row->error == EPERM;
}

// Without a sign before a zero.
static double shown(double value) {
    return fabs(value) < 0.0005 ? 0.0 : value;
}

// "812 of 0..1023"
static void write_raw(const DeviceRow *row, int axis, char out[RAW_BYTES]) {
    const PadRange *range = &row->info.ranges[axis];
    snprintf(out, RAW_BYTES, "%" PRId64 " of %" PRId64 "..%" PRId64, pad_raw(&row->info, &row->state, axis),
             range->least, range->most);
}

// ---- For people ---------------------------------------------------------------------------------------------------

static void print_axis(FILE *to, const DeviceRow *row, int axis) {
    char name[32], raw[RAW_BYTES] = "?";
    const AxisMapping *mapping = device_row_mapping(row, axis);
    bool known = !(row->state.axes_unknown >> axis & 1);
    device_row_axis_name(row, axis, name);
    if (known)
        write_raw(row, axis, raw);
    fprintf(to, "  %-12s%-24s", name, raw);
    if (known)
        fprintf(to, " %+7.3f", shown(row->state.axes[axis]));
    else
        fprintf(to, "       ?");
    if (mapping && known)
        fprintf(to, "   %-11s %+7.3f", pad_control_name(mapping->control), shown(device_row_mapped(row, axis)));
    else if (mapping)
        fprintf(to, "   %-11s       ?", pad_control_name(mapping->control));
    fputc('\n', to);
}

// What a hat between two directions does is what both do.
static void print_hat_does(FILE *to, const DeviceRow *row, int hat, int eighth) {
    char does[64];
    for (int direction = 0; direction < 8; direction += 2) {
        if ((eighth - direction + 9) % 8 > 2)
            continue;
        device_row_does(row, hat, direction, does);
        if (*does)
            fprintf(to, "   %s", does);
    }
}

static void print_hats(FILE *to, const DeviceRow *row) {
    static const char *const names[8] = {"up",   "up right",  "right", "down right",
                                         "down", "down left", "left",  "up left"};
    for (int i = 0; i < row->info.hat_count; i++) {
        int hat = row->state.hats[i];
        fprintf(to, "  hat %-8d%s", i + 1, hat == PAD_HAT_CENTRED ? "-" : names[hat]);
        if (hat != PAD_HAT_CENTRED)
            print_hat_does(to, row, i, hat);
        fputc('\n', to);
    }
}

static void print_buttons(FILE *to, const DeviceRow *row) {
    bool any = false;
    fprintf(to, "  %d buttons%s", row->info.button_count, row->info.button_count < 10 ? "   " : "  ");
    for (int i = 0; i < row->info.button_count; i++) {
        char does[64];
        if (!device_row_is_down(row, i))
            continue;
        device_row_does(row, i, -1, does);
        fprintf(to, "%s%d%s%s%s", any ? ", " : "", i + 1, *does ? " (" : "", does, *does ? ")" : "");
        any = true;
    }
    fprintf(to, "%s\n", any ? "" : "-");
}

static void print_remedy(FILE *to, const DeviceRow *row) {
    char rule[DEVICE_TEXT_BYTES], file[PATHS_BYTES_MAX];
    device_text_rule(&row->info, rule);
    fprintf(to, "  To use it, put this line into a file /etc/udev/rules.d/70-joystick.rules\n    %s\n", rule);
    if (paths_find_data("udev/" RULES, file) == RESULT_OK)
        fprintf(to, "  or copy the rules for joysticks and pads of all makers\n    sudo cp %s /etc/udev/rules.d/\n",
                file);
    fprintf(to, "  and have udev read them\n    sudo udevadm control --reload-rules && sudo udevadm trigger\n");
}

static void print_permission(FILE *to, const DeviceRow *row) {
    fprintf(to, "  permission  %s", row->error ? strerror(row->error) : "may be read and written");
    if (row->mode)
        fprintf(to, " (mode %04o, owner %u, group %u)", row->mode, row->owner, row->group);
    fprintf(to, "%s\n", row->error == EBUSY ? "; another program uses it: end that" : "");
    if (wants_rule(row))
        print_remedy(to, row);
}

static void print_row(FILE *to, const DeviceRow *row) {
    const PadInfo *info = &row->info;
    fprintf(to, "%s (%04x:%04x)\n  node        %s, %s\n", info->name, info->vendor, info->product, info->path,
            bus_name(info));
    print_permission(to, row);
    if (row->error)
        return;
    fprintf(to, "  profile     %s%s%s%s\n  axis        raw                        -1..1   control      mapped\n",
            row->profile.name, *row->profile_file ? " (" : "", row->profile_file, *row->profile_file ? ")" : "");
    for (int i = 0; i < info->axis_count; i++)
        print_axis(to, row, i);
    print_hats(to, row);
    print_buttons(to, row);
}

void device_print_list(FILE *to, const DeviceList *list, const char *lack) {
    for (int i = 0; i < DEVICES_MAX; i++)
        if (list->rows[i].there)
            print_row(to, &list->rows[i]);
    if (device_list_count(list) == 0)
        fprintf(to, "No joystick or gamepad was found. Looked for\n  " LOOKED_HID "\n  " LOOKED_USB "\n");
    if (*lack)
        fprintf(to, "Note: %s.\n", lack);
}

void device_print_state(FILE *to, const DeviceRow *row) {
    fprintf(to, "%s:", row->info.path);
    for (int i = 0; i < row->info.axis_count; i++) {
        char name[32], raw[RAW_BYTES];
        const AxisMapping *mapping = device_row_mapping(row, i);
        if (row->state.axes_unknown >> i & 1)
            continue;
        device_row_axis_name(row, i, name);
        write_raw(row, i, raw);
        fprintf(to, " %s %s: %+.3f", name, raw, shown(row->state.axes[i]));
        if (mapping)
            fprintf(to, " (%s %+.3f)", pad_control_name(mapping->control), shown(device_row_mapped(row, i)));
    }
    for (int i = 0; i < row->info.hat_count; i++)
        fprintf(to, " hat %d", row->state.hats[i]);
    for (int i = 0; i < row->info.button_count; i++)
        if (device_row_is_down(row, i))
            fprintf(to, " button %d", i + 1);
    fputc('\n', to);
}

// ---- For programs -------------------------------------------------------------------------------------------------

static void add_axes(Json *device, const DeviceRow *row) {
    Json *axes = json_add_array(device, "axes");
    for (int i = 0; i < row->info.axis_count; i++) {
        char name[32];
        Json *axis = json_append_object(axes);
        const AxisMapping *mapping = device_row_mapping(row, i);
        bool known = !(row->state.axes_unknown >> i & 1);
        device_row_axis_name(row, i, name);
        json_add_text(axis, "axis", name);
        json_add_number(axis, "raw", known ? row->state.axes[i] : NAN);
        json_add_number(axis, "raw_value", known ? (double)pad_raw(&row->info, &row->state, i) : (double)NAN);
        json_add_integer(axis, "raw_min", row->info.ranges[i].least);
        json_add_integer(axis, "raw_max", row->info.ranges[i].most);
        json_add_text(axis, "control", mapping ? pad_control_name(mapping->control) : NULL);
        json_add_number(axis, "mapped", known && mapping ? device_row_mapped(row, i) : NAN);
    }
}

static void add_switches(Json *device, const DeviceRow *row) {
    json_add_integer(device, "button_count", row->info.button_count);
    Json *down = json_add_array(device, "buttons_down");
    for (int i = 0; i < row->info.button_count; i++)
        if (device_row_is_down(row, i))
            json_append_number(down, i + 1);
    Json *hats = json_add_array(device, "hats");
    for (int i = 0; i < row->info.hat_count; i++)
        json_append_number(hats, row->state.hats[i]);
}

static void add_device(Json *array, const DeviceRow *row) {
    char text[DEVICE_TEXT_BYTES];
    Json *device = json_append_object(array);
    json_add_text(device, "name", row->info.name);
    snprintf(text, sizeof text, "%04x", row->info.vendor);
    json_add_text(device, "vendor", text);
    snprintf(text, sizeof text, "%04x", row->info.product);
    json_add_text(device, "product", text);
    json_add_text(device, "bus", bus_name(&row->info));
    json_add_text(device, "node", row->info.path);
    snprintf(text, sizeof text, "%04o", row->mode);
    json_add_text(device, "mode", row->mode ? text : NULL);
    json_add_bool(device, "readable", row->error == 0);
    json_add_text(device, "error", row->error ? strerror(row->error) : NULL);
    device_text_rule(&row->info, text);
    json_add_text(device, "udev_rule", text);
    json_add_text(device, "profile", row->profile.name);
    json_add_text(device, "profile_file", *row->profile_file ? row->profile_file : NULL);
    json_add_integer(device, "reports", row->reports);
    add_axes(device, row);
    add_switches(device, row);
}

Result device_print_json(const DeviceList *list, const char *lack) {
    char file[PATHS_BYTES_MAX];
    Json *json = json_create();
    Json *looked = json_add_array(json, "looked_for");
    json_append_text(looked, LOOKED_HID);
    json_append_text(looked, LOOKED_USB);
    json_add_text(json, "lack", *lack ? lack : NULL);
    json_add_text(json, "udev_rules", paths_find_data("udev/" RULES, file) == RESULT_OK ? file : NULL);
    Json *devices = json_add_array(json, "devices");
    for (int i = 0; i < DEVICES_MAX; i++)
        if (list->rows[i].there)
            add_device(devices, &list->rows[i]);
    Result result = json_print(json);
    json_destroy(&json);
    return result;
}
