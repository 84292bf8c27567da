// input/devices/device_text.h: what people are told about a stick or a gamepad.
// UTF-8.
// The caller owns the buffers. Any thread.
#pragma once
#include "input/pad.h"

#include <wchar.h>

#define DEVICE_TEXT_BYTES 512

// The maker's and the product's name, either of them NULL or empty, without what a terminal would take for commands;
// the maker is left out where the product's name has it already. Without names: the ids.
void device_text_name(const wchar_t *maker, const wchar_t *product, PadInfo *info);
// The same of ASCII; other bytes are replaced.
void device_text_name_bytes(const char *maker, const char *product, PadInfo *info);

// "T.Flight Stick X (044f:b106) at /dev/hidraw0: 4 axes, 12 buttons, 1 hat".
void device_text_summary(const PadInfo *info, char out[DEVICE_TEXT_BYTES]);
// A line for /etc/udev/rules.d that lets whoever sits at the machine use this device, on any bus.
void device_text_rule(const PadInfo *info, char out[DEVICE_TEXT_BYTES]);
// Why a device cannot be read, and the remedy. `error` is one of errno.
void device_text_denied(const PadInfo *info, int error, char out[DEVICE_TEXT_BYTES]);
