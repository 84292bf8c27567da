// app/devices/device_calibrate.h: calibrates all sticks and pads with a person before the terminal.
// Seconds.
// Nothing is owned. Main thread.
#pragma once
#include "input/devices/devices.h"

// Asks on stdout to leave everything alone, then to move everything; ends with a line on stdin (Enter), or after
// `seconds_max`; shows what was learned and keeps it. SIGINT and SIGTERM end it, and nothing is kept. NOT_FOUND: there
// is no device; RANGE: something moved all the time; IO, FORMAT: it cannot be kept; logged.
MUST_USE Result device_calibrate(Devices *devices, double seconds_max);
