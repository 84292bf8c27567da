// app/joystick/joystick_files.h: the profile and the calibration of a pad that was plugged in, from files.
// Axis values -1..1.
// Values; nothing is owned. Main thread.
#pragma once
#include "base/paths.h"
#include "input/calibration.h"
#include "input/profile.h"

// The profile that fits the pad best, and the file it is from: of the user's (joysticks/*.joystick in the XDG
// configuration folder), else of those that came with the program; in either, by vendor and product, else by name, of
// several the first of the alphabet. Files that are damaged are reported and passed over. NOT_FOUND: none fits.
MUST_USE Result joystick_find_profile(const PadInfo *info, PadProfile *out, char path[PATHS_BYTES_MAX]);
// One file. NOT_FOUND, IO, FORMAT; logged.
MUST_USE Result joystick_read_profile(const char *path, PadProfile *out);

// What was kept for pads of this vendor and product (calibration.conf in the XDG state folder). NOT_FOUND: nothing.
// IO, FORMAT; logged.
MUST_USE Result joystick_load_calibration(const PadInfo *info, PadCalibration *out);
// Where that is. False: neither XDG_STATE_HOME nor HOME is set.
bool joystick_calibration_file(char path[PATHS_BYTES_MAX]);
// Keeps it, in place of what was kept for such pads. IO, FORMAT (of the old file); logged.
MUST_USE Result joystick_save_calibration(const PadInfo *info, const PadCalibration *calibration);
