// input/profile.h: what the axes, buttons and hats of one kind of pad move.
// Shares of full deflection; axes -1..1.
// Values.
#pragma once
#include "input/action.h"
#include "input/pad.h"

#define PROFILE_BUTTONS_MAX 160
#define PROFILE_NAME_BYTES 64

// ROW(identifier, name in profiles, least, rests at its centre). Those that do not rest stay where they are left.
#define PAD_CONTROL_TABLE(ROW)                                                                                         \
    ROW(AILERON, "aileron", -1.0, true)                                                                                \
    ROW(ELEVATOR, "elevator", -1.0, true)                                                                              \
    ROW(RUDDER, "rudder", -1.0, true)                                                                                  \
    ROW(THROTTLE, "throttle", 0.0, false)                                                                              \
    ROW(FLAPS, "flaps", 0.0, false)                                                                                    \
    ROW(TRIM, "trim", -1.0, false)                                                                                     \
    ROW(BRAKE_LEFT, "brake-left", 0.0, true)                                                                           \
    ROW(BRAKE_RIGHT, "brake-right", 0.0, true)                                                                         \
    ROW(LOOK_X, "look-x", -1.0, true)                                                                                  \
    ROW(LOOK_Y, "look-y", -1.0, true)

typedef enum PadControl {
#define PAD_CONTROL_ENUM(id, name, least, rests) PAD_CONTROL_##id,
    PAD_CONTROL_TABLE(PAD_CONTROL_ENUM) PAD_CONTROL_COUNT,
#undef PAD_CONTROL_ENUM
    PAD_CONTROL_BRAKES = PAD_CONTROL_COUNT, // both at once
    PAD_CONTROL_NAMES,
    PAD_CONTROL_NONE = -1
} PadControl;

// "aileron" ... "look-y", and "brakes".
const char *pad_control_name(PadControl control);
double pad_control_least(PadControl control); // -1, or 0 for what has one direction; the greatest is 1
bool pad_control_rests(PadControl control);

// An axis: v = calibrated value, negated where inverted; the dead band taken out and the rest spread over the whole
// again; bent by the power; then (v + offset) factor, clamped to the control's range.
typedef struct AxisMapping {
    PadAxisKind axis;
    int ordinal; // 1: the first of that kind, in the order of the descriptor
    PadControl control;
    bool invert;
    double dead_band; // 0..0.9, about the centre; at both ends for controls with one direction
    double power;     // 0.2..5: sign(v) |v|^power; from one end for controls with one direction
    double offset, factor;
} AxisMapping;

typedef enum ButtonDoes { BUTTON_ACTION, BUTTON_STEP, BUTTON_HOLD } ButtonDoes;

// A button, or a hat pushed in one direction: an action (once a press, or for as long as it is down, as its key would),
// a step of a control a press, or a value of a control while down.
typedef struct ButtonMapping {
    bool is_hat;
    int number;    // of the button or the hat, from 1
    int direction; // of the hat: 0 up, 2 right, 4 down, 6 left; a hat between two pushes both
    ButtonDoes does;
    Action action;
    PadControl control;
    double amount; // of the step, or the value
} ButtonMapping;

typedef struct PadProfile {
    char name[PROFILE_NAME_BYTES];
    AxisMapping axes[PAD_AXES_MAX];
    ButtonMapping buttons[PROFILE_BUTTONS_MAX];
    int axis_count, button_count;
} PadProfile;

// What the axis makes of its control when its calibrated value is `value`: continuous, and monotonic up to the clamp.
double profile_axis_value(const AxisMapping *mapping, double value);

// A plain mapping of the axis: dead band 0.03 (0.01 at the ends), no curve, the control's whole range.
AxisMapping profile_axis(PadAxisKind axis, int ordinal, PadControl control);

// For a pad that nobody wrote a profile for. X or aileron: aileron; Y or elevator: elevator, back is nose up; rudder,
// else Rz, else the third axis where that is no lever: rudder; throttle, else slider, else Z: throttle; brake: both
// brakes; the first hat looks around. Sliders and Z are full at their least, as levers pushed away are.
PadProfile profile_default(const PadInfo *info);
