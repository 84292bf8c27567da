// input/devices/xbox_report.h: the bytes that wired Xbox 360 pads speak on their interface of USB class ff/5d/01.
// Axes as input/pad.h has them, in the order and with the signs of a HID gamepad: forward and up are negative.
// Values; no device is touched. Any thread. Source: Linux, drivers/input/joystick/xpad.c (xpad360_process_packet,
// xpad_play_effect).
#pragma once
#include "input/pad.h"

#define XBOX_USB_CLASS 0xff
#define XBOX_USB_SUBCLASS 0x5d
#define XBOX_USB_PROTOCOL 0x01
#define XBOX_REPORT_BYTES 20
#define XBOX_RUMBLE_BYTES 8

// The order of axes: left stick x, y; right stick rx, ry; left trigger brake, right trigger accelerator, as Microsoft's
// pads that are HID call them, both -1 when let go.
enum { XBOX_LEFT_X, XBOX_LEFT_Y, XBOX_RIGHT_X, XBOX_RIGHT_Y, XBOX_LEFT_TRIGGER, XBOX_RIGHT_TRIGGER, XBOX_AXES };
// The order of buttons: that of Microsoft's driver, and the middle one after these ten.
enum {
    XBOX_A,
    XBOX_B,
    XBOX_X,
    XBOX_Y,
    XBOX_LB,
    XBOX_RB,
    XBOX_BACK,
    XBOX_START,
    XBOX_LEFT_STICK,
    XBOX_RIGHT_STICK,
    XBOX_GUIDE,
    XBOX_BUTTONS
};

typedef enum XboxMessage {
    XBOX_INPUT,   // `state` tells all of it
    XBOX_OTHER,   // of lamps, motors, headsets
    XBOX_DAMAGED, // it says that it is input, and has another length
} XboxMessage;

// The counts, and the kinds and ranges of axes; the rest of `info` stays.
void xbox_describe(PadInfo *info);
// `state` changes on XBOX_INPUT only. The cross is hat 0; opposite directions at once are none.
XboxMessage xbox_report_decode(const uint8_t *bytes, size_t count, PadState *state);
// The message that sets both motors, shares 0..1 of their strength: `low` the heavy one on the left, `high` the light
// one on the right.
void xbox_rumble_encode(double low, double high, uint8_t out[XBOX_RUMBLE_BYTES]);
