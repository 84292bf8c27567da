// app/devices/device_print.h: a DeviceList for people and for programs.
// Axes -1..1; controls in shares of full deflection.
// Nothing is owned.
#pragma once
#include "app/devices/device_list.h"

#include <stdio.h>

// `lack`: why a bus could not be looked at, or "".
void device_print_list(FILE *to, const DeviceList *list, const char *lack);
// What one device says now, on one line.
void device_print_state(FILE *to, const DeviceRow *row);
// On stdout. MEMORY, IO.
MUST_USE Result device_print_json(const DeviceList *list, const char *lack);
