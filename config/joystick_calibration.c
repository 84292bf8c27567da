#define _POSIX_C_SOURCE 200809L
#include "config/joystick_calibration.h"

#include "base/log.h"
#include "base/paths.h"
#include "config/ini_read.h"
#include "config/quantity.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

typedef struct Reading {
    const JoystickNames *names;
    JoystickCalibration *out;
} Reading;

static bool refuse(const IniEntry *entry, const char *expected) {
    log_error("%s:%d: expected %s; delete the file to begin anew", entry->file, entry->line, expected);
    return false;
}

static bool is_sound(const JoystickAxisCalibration *axis) {
    return axis->min >= -1.0 && axis->min <= axis->centre && axis->centre <= axis->max && axis->max <= 1.0 &&
           axis->min < axis->max;
}

static bool visit_entry(void *user, const IniEntry *entry) {
    const Reading *reading = user;
    JoystickAxisCalibration axis = {.axis = 0};
    if (!joystick_id_parse(entry->section, &axis.vendor, &axis.product))
        return refuse(entry, "a section such as [046d:c215]");
    if (!joystick_axis_parse(entry->name, reading->names, &axis.axis, &axis.ordinal))
        return refuse(entry, "an axis such as 'x' or 'slider 2'");
    const QuantityKind kinds[3] = {QUANTITY_PLAIN, QUANTITY_PLAIN, QUANTITY_PLAIN};
    double numbers[3];
    if (quantity_parse_list(kinds, 3, entry->value, numbers) != RESULT_OK)
        return refuse(entry, "CENTRE, MIN, MAX");
    axis.centre = numbers[0];
    axis.min = numbers[1];
    axis.max = numbers[2];
    if (!is_sound(&axis))
        return refuse(entry, "-1 <= MIN <= CENTRE <= MAX <= 1");
    if (reading->out->count == JOYSTICK_CALIBRATIONS_MAX)
        return refuse(entry, "fewer axes");
    reading->out->axes[reading->out->count++] = axis;
    return true;
}

Result joystick_calibration_read(const char *path, const JoystickNames *names, JoystickCalibration *out) {
    out->count = 0;
    Reading reading = {names, out};
    Result result = ini_read(path, visit_entry, &reading);
    if (result == RESULT_IO)
        log_error("%s: the calibration of joysticks cannot be read", path);
    return result;
}

static void print_axis(FILE *file, const JoystickNames *names, const JoystickAxisCalibration *axis, bool new_device) {
    if (new_device)
        fprintf(file, "\n[%04x:%04x]\n", axis->vendor, axis->product);
    fprintf(file, "%s", names->axes[axis->axis]);
    if (axis->ordinal > 1)
        fprintf(file, " %d", axis->ordinal);
    fprintf(file, " = %.6f, %.6f, %.6f\n", axis->centre, axis->min, axis->max);
}

static void print_all(FILE *file, const JoystickNames *names, const JoystickCalibration *calibration) {
    fprintf(file, "# Where the axes of joysticks rest and end: AXIS = CENTRE, MIN, MAX. Written by overfly.\n");
    for (int i = 0; i < calibration->count; i++) {
        const JoystickAxisCalibration *axis = &calibration->axes[i], *before = i > 0 ? axis - 1 : NULL;
        bool same = before && before->vendor == axis->vendor && before->product == axis->product;
        print_axis(file, names, axis, !same);
    }
}

static Result report_failure(const char *path) {
    log_error("%s: cannot be written: %s; check the rights and the space of its folder", path, strerror(errno));
    return RESULT_IO;
}

Result joystick_calibration_write(const char *path, const JoystickNames *names,
                                  const JoystickCalibration *calibration) {
    char fresh[PATHS_BYTES_MAX];
    int printed = snprintf(fresh, sizeof fresh, "%s.%ld", path, (long)getpid());
    errno = ENAMETOOLONG;
    FILE *file = printed > 0 && printed < (int)sizeof fresh ? fopen(fresh, "w") : NULL;
    if (!file)
        return report_failure(path);
    print_all(file, names, calibration);
    bool failed = ferror(file) != 0;
    if (fclose(file) != 0 || failed || rename(fresh, path) != 0) {
        Result result = report_failure(path);
        unlink(fresh);
        return result;
    }
    return RESULT_OK;
}
