// config/joystick_calibration.h: the file that keeps where the axes of sticks rest and end.
// Axis values -1..1 over the range that the device states.
// Values; nothing is owned. One thread at a time writes a file.
#pragma once
#include "config/joystick_profile.h"

#define JOYSTICK_CALIBRATIONS_MAX 512

typedef struct JoystickAxisCalibration {
    uint16_t vendor, product;
    int axis, ordinal;       // as in JoystickAxis
    double centre, min, max; // -1 <= min <= centre <= max <= 1, min < max
} JoystickAxisCalibration;

typedef struct JoystickCalibration {
    JoystickAxisCalibration axes[JOYSTICK_CALIBRATIONS_MAX];
    int count;
} JoystickCalibration;

// INI: a section [VENDOR:PRODUCT] for each device, in it AXIS = CENTRE, MIN, MAX.
// NOT_FOUND: nothing is logged, `out` is empty. IO, FORMAT; one message names the file and the line.
MUST_USE Result joystick_calibration_read(const char *path, const JoystickNames *names, JoystickCalibration *out);
// Writes a new file and puts it in place of the old one, which stays whole if that fails. IO, logged.
MUST_USE Result joystick_calibration_write(const char *path, const JoystickNames *names,
                                           const JoystickCalibration *calibration);
