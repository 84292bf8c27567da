// input/pad.h: what a stick, a throttle, pedals or a gamepad is, and what it says now, whichever bus it hangs on.
// Axes -1..1 over their logical range, uncalibrated; hats in eighths of a turn clockwise from ahead.
// Values.
#pragma once
#include "base/base.h"

#define PAD_AXES_MAX 32
#define PAD_BUTTONS_MAX 128
#define PAD_HATS_MAX 4
#define PAD_HAT_CENTRED (-1)
#define PAD_NAME_BYTES 128
#define PAD_PATH_BYTES 256

// ROW(identifier, name in profiles and reports); an axis is called X, so the macro is not
#define PAD_AXIS_TABLE(ROW)                                                                                            \
    ROW(X, "x")                                                                                                        \
    ROW(Y, "y")                                                                                                        \
    ROW(Z, "z")                                                                                                        \
    ROW(RX, "rx")                                                                                                      \
    ROW(RY, "ry")                                                                                                      \
    ROW(RZ, "rz")                                                                                                      \
    ROW(SLIDER, "slider")                                                                                              \
    ROW(DIAL, "dial")                                                                                                  \
    ROW(WHEEL, "wheel")                                                                                                \
    ROW(AILERON, "aileron")                                                                                            \
    ROW(ELEVATOR, "elevator")                                                                                          \
    ROW(RUDDER, "rudder")                                                                                              \
    ROW(THROTTLE, "throttle")                                                                                          \
    ROW(ACCELERATOR, "accelerator")                                                                                    \
    ROW(BRAKE, "brake")                                                                                                \
    ROW(OTHER, "other")

typedef enum PadAxisKind {
#define PAD_AXIS_ENUM(id, name) PAD_AXIS_##id,
    PAD_AXIS_TABLE(PAD_AXIS_ENUM) PAD_AXIS_KIND_COUNT
#undef PAD_AXIS_ENUM
} PadAxisKind;

typedef enum PadBus { PAD_BUS_HID, PAD_BUS_USB } PadBus; // a node of hidraw; a wired gamepad that is not HID

// Of an axis, as the device's own integers: least < most.
typedef struct PadRange {
    int64_t least, most;
} PadRange;

typedef struct PadInfo {
    PadBus bus;
    uint16_t vendor, product; // of USB
    char name[PAD_NAME_BYTES];
    char path[PAD_PATH_BYTES]; // of the node
    int axis_count, button_count, hat_count;
    PadAxisKind axes[PAD_AXES_MAX]; // in the order of the descriptor; two of a kind may be there
    PadRange ranges[PAD_AXES_MAX];
} PadInfo;

typedef struct PadState {
    double axes[PAD_AXES_MAX];
    uint32_t raw[PAD_AXES_MAX];             // as reported, also outside the range: see pad_raw
    uint32_t axes_unknown;                  // bit i: no report has told axis i yet, and its value means nothing
    uint64_t buttons[PAD_BUTTONS_MAX / 64]; // bit i of word i / 64: button i, from 0, is down
    int8_t hats[PAD_HATS_MAX];              // PAD_HAT_CENTRED, or 0 ahead, 1 ahead right .. 7
} PadState;

// As before the first report: axes unknown, buttons up, hats centred.
PadState pad_at_rest(void);
// The integer that the device reported of an axis.
int64_t pad_raw(const PadInfo *info, const PadState *state, int axis);
const char *pad_axis_name(PadAxisKind kind);
