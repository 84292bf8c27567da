#include "input/profile.h"

#include <math.h>

#define DEAD_BAND_CENTRE 0.03
#define DEAD_BAND_ENDS 0.01

static const struct {
    const char *name;
    double least;
    bool rests;
} controls[PAD_CONTROL_NAMES] = {
#define PAD_CONTROL_ROW(id, name, least, rests) [PAD_CONTROL_##id] = {name, least, rests},
    PAD_CONTROL_TABLE(PAD_CONTROL_ROW)
#undef PAD_CONTROL_ROW
        [PAD_CONTROL_BRAKES] = {"brakes", 0.0, true},
};

const char *pad_control_name(PadControl control) {
    return controls[control].name;
}

double pad_control_least(PadControl control) {
    return controls[control].least;
}

bool pad_control_rests(PadControl control) {
    return controls[control].rests;
}

AxisMapping profile_axis(PadAxisKind axis, int ordinal, PadControl control) {
    bool one_way = pad_control_least(control) == 0.0;
    return (AxisMapping){.axis = axis,
                         .ordinal = ordinal,
                         .control = control,
                         .dead_band = one_way ? DEAD_BAND_ENDS : DEAD_BAND_CENTRE,
                         .power = 1.0,
                         .offset = one_way ? 1.0 : 0.0,
                         .factor = one_way ? 0.5 : 1.0};
}

static double clamp(double value, double least, double greatest) {
    return fmin(fmax(value, least), greatest);
}

static double bend_about_centre(const AxisMapping *mapping, double value) {
    double beyond = clamp((fabs(value) - mapping->dead_band) / (1.0 - mapping->dead_band), 0.0, 1.0);
    return copysign(pow(beyond, mapping->power), value);
}

static double bend_from_end(const AxisMapping *mapping, double value) {
    double share = 0.5 + 0.5 * clamp(value / (1.0 - mapping->dead_band), -1.0, 1.0);
    return 2.0 * pow(share, mapping->power) - 1.0;
}

double profile_axis_value(const AxisMapping *mapping, double value) {
    double least = pad_control_least(mapping->control), along = mapping->invert ? -value : value;
    double bent = least == 0.0 ? bend_from_end(mapping, along) : bend_about_centre(mapping, along);
    return clamp((bent + mapping->offset) * mapping->factor, least, 1.0);
}

static bool has(const PadInfo *info, PadAxisKind kind) {
    for (int i = 0; i < info->axis_count; i++)
        if (info->axes[i] == kind)
            return true;
    return false;
}

// The first of `kinds` that the pad has; PAD_AXIS_KIND_COUNT: none.
static PadAxisKind first_of(const PadInfo *info, const PadAxisKind *kinds, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (has(info, kinds[i]))
            return kinds[i];
    return PAD_AXIS_KIND_COUNT;
}

static void map_axis(PadProfile *profile, PadAxisKind axis, PadControl control, bool invert) {
    if (axis == PAD_AXIS_KIND_COUNT)
        return;
    AxisMapping mapping = profile_axis(axis, 1, control);
    mapping.invert = invert;
    profile->axes[profile->axis_count++] = mapping;
}

static void map_hat(PadProfile *profile, int direction, PadControl control, double value) {
    profile->buttons[profile->button_count++] = (ButtonMapping){.is_hat = true,
                                                                .number = 1,
                                                                .direction = direction,
                                                                .does = BUTTON_HOLD,
                                                                .action = ACTION_NONE,
                                                                .control = control,
                                                                .amount = value};
}

static PadAxisKind default_throttle(const PadInfo *info, PadAxisKind rudder) {
    const PadAxisKind kinds[] = {PAD_AXIS_THROTTLE, PAD_AXIS_SLIDER};
    PadAxisKind found = first_of(info, kinds, COUNT_OF(kinds));
    return found == PAD_AXIS_KIND_COUNT && rudder != PAD_AXIS_Z && has(info, PAD_AXIS_Z) ? PAD_AXIS_Z : found;
}

// The third axis turns the rudder only where it can be nothing else.
static PadAxisKind default_rudder(const PadInfo *info) {
    const PadAxisKind kinds[] = {PAD_AXIS_RUDDER, PAD_AXIS_RZ};
    PadAxisKind found = first_of(info, kinds, COUNT_OF(kinds));
    if (found != PAD_AXIS_KIND_COUNT || info->axis_count < 3)
        return found;
    PadAxisKind third = info->axes[2];
    bool turns = third == PAD_AXIS_RX || third == PAD_AXIS_RY || third == PAD_AXIS_Z;
    return turns ? third : PAD_AXIS_KIND_COUNT;
}

PadProfile profile_default(const PadInfo *info) {
    static const PadAxisKind ailerons[] = {PAD_AXIS_AILERON, PAD_AXIS_X};
    static const PadAxisKind elevators[] = {PAD_AXIS_ELEVATOR, PAD_AXIS_Y};
    PadProfile profile = {.name = "default"};
    PadAxisKind rudder = default_rudder(info), throttle = default_throttle(info, rudder);
    map_axis(&profile, first_of(info, ailerons, COUNT_OF(ailerons)), PAD_CONTROL_AILERON, false);
    map_axis(&profile, first_of(info, elevators, COUNT_OF(elevators)), PAD_CONTROL_ELEVATOR, false);
    map_axis(&profile, rudder, PAD_CONTROL_RUDDER, false);
    map_axis(&profile, throttle, PAD_CONTROL_THROTTLE, throttle != PAD_AXIS_THROTTLE);
    map_axis(&profile, has(info, PAD_AXIS_BRAKE) ? PAD_AXIS_BRAKE : PAD_AXIS_KIND_COUNT, PAD_CONTROL_BRAKES, false);
    if (info->hat_count > 0) {
        map_hat(&profile, 0, PAD_CONTROL_LOOK_Y, 1.0);
        map_hat(&profile, 2, PAD_CONTROL_LOOK_X, 1.0);
        map_hat(&profile, 4, PAD_CONTROL_LOOK_Y, -1.0);
        map_hat(&profile, 6, PAD_CONTROL_LOOK_X, -1.0);
    }
    return profile;
}
