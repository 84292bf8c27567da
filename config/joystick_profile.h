// config/joystick_profile.h: joystick profiles: which control each axis, button and hat of a kind of pad moves.
// Plain numbers; axis values -1..1.
// A JoystickProfile is a value; it owns nothing. Any thread.
#pragma once
#include "base/base.h"

#define JOYSTICK_AXES_MAX 32
#define JOYSTICK_BUTTONS_MAX 160
#define JOYSTICK_MATCHES_MAX 16
#define JOYSTICK_NAME_BYTES 64

// The words that profiles may use; what is read are indices into these lists.
typedef struct JoystickNames {
    const char *const *axes, *const *controls, *const *actions;
    int axis_count, control_count, action_count;
} JoystickNames;

typedef struct JoystickNumber {
    bool given;
    double value;
} JoystickNumber;

typedef struct JoystickAxis {
    int line;          // where the file first speaks of it
    int axis, ordinal; // ordinal 1: the first axis of that kind
    int control;
    bool invert;
    JoystickNumber dead_band, power, offset, factor; // 0..0.9, 0.2..5, -10..10, -10..10 without 0
} JoystickAxis;

typedef struct JoystickButton {
    int line;
    bool is_hat;
    int number;                // 1..128 of buttons, 1..4 of hats
    int direction;             // of hats: 0 up, 2 right, 4 down, 6 left
    int action, control;       // one of them; the other is -1
    JoystickNumber step, hold; // -1..1; one of them with a control
} JoystickButton;

// INI:
//   [device]              name = PATTERN  id = VENDOR:PRODUCT  both may come again
//   [axis KIND [NUMBER]]  control, invert, dead-band, power, offset, factor
//   [button NUMBER], [hat NUMBER up|right|down|left]   action; or control with step or hold
// In patterns * stands for any letters and ? for one; upper and lower case are alike.
typedef struct JoystickProfile {
    char names[JOYSTICK_MATCHES_MAX][JOYSTICK_NAME_BYTES];
    uint16_t vendors[JOYSTICK_MATCHES_MAX], products[JOYSTICK_MATCHES_MAX];
    int name_count, id_count;
    JoystickAxis axes[JOYSTICK_AXES_MAX];
    JoystickButton buttons[JOYSTICK_BUTTONS_MAX];
    int axis_count, button_count;
} JoystickProfile;

// NOT_FOUND, IO, FORMAT; one message names the file, the line and what was expected.
MUST_USE Result joystick_profile_read(const char *path, const JoystickNames *names, JoystickProfile *out);

typedef enum JoystickFit { JOYSTICK_FITS_NOT, JOYSTICK_FITS_NAME, JOYSTICK_FITS_ID } JoystickFit;
JoystickFit joystick_profile_fit(const JoystickProfile *profile, uint16_t vendor, uint16_t product, const char *name);

// ---- shared with calibration files ----

// "slider 2": an axis' kind, and its ordinal where it is not the first. False: no such kind, or an ordinal that is not
// 1..JOYSTICK_AXES_MAX.
bool joystick_axis_parse(const char *text, const JoystickNames *names, int *axis, int *ordinal);
// "046d:c215", four hexadecimal digits each.
bool joystick_id_parse(const char *text, uint16_t *vendor, uint16_t *product);
