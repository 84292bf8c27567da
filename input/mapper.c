#include "input/mapper.h"

#include <math.h>
#include <string.h>

static const MapperDriver keys = {.kind = MAPPER_KEYS, .slot = -1, .mapping = -1};

void mapper_init(Mapper *mapper) {
    memset(mapper, 0, sizeof *mapper);
    for (int control = 0; control < PAD_CONTROL_COUNT; control++)
        mapper->drivers[control] = keys;
}

static double clamp(double value, double least, double greatest) {
    return fmin(fmax(value, least), greatest);
}

// The first and the last control that the name stands for.
static void span_of(PadControl control, int *first, int *last) {
    *first = control == PAD_CONTROL_BRAKES ? PAD_CONTROL_BRAKE_LEFT : (int)control;
    *last = control == PAD_CONTROL_BRAKES ? PAD_CONTROL_BRAKE_RIGHT : (int)control;
}

// NULL: no key moves it.
static double *of_keyboard(Controls *controls, int control) {
    switch (control) {
    case PAD_CONTROL_AILERON:
        return &controls->aileron;
    case PAD_CONTROL_ELEVATOR:
        return &controls->elevator;
    case PAD_CONTROL_RUDDER:
        return &controls->rudder;
    case PAD_CONTROL_THROTTLE:
        return &controls->throttle;
    case PAD_CONTROL_FLAPS:
        return &controls->flaps;
    case PAD_CONTROL_TRIM:
        return &controls->trim;
    case PAD_CONTROL_BRAKE_LEFT:
        return &controls->brake_left;
    case PAD_CONTROL_BRAKE_RIGHT:
        return &controls->brake_right;
    default:
        return NULL;
    }
}

// ---- Who drives ------------------------------------------------------------------------------------------------

// The axis that loses the control has to be moved again before it may have it back.
static void set_driver(Mapper *mapper, int control, MapperDriver driver) {
    MapperDriver before = mapper->drivers[control];
    if (before.kind == MAPPER_AXIS) {
        MapperAxis *axis = &mapper->slots[before.slot].axes[before.mapping];
        axis->moved = false;
        axis->looked = axis->value;
    }
    mapper->drivers[control] = driver;
    mapper->offsets[control] = 0.0;
}

// Sets the control to where the keyboard then goes on from.
static void set_value(Mapper *mapper, int control, double value, Keyboard *keyboard) {
    mapper->values[control] = value;
    mapper->keys[control] = value;
    double *slot = of_keyboard(&keyboard->controls, control);
    if (slot)
        *slot = value;
}

static bool drives(const Mapper *mapper, int control, int slot, int mapping) {
    MapperDriver driver = mapper->drivers[control];
    return driver.kind == MAPPER_AXIS && driver.slot == slot && driver.mapping == mapping;
}

// ---- Axes ------------------------------------------------------------------------------------------------------

static int index_of_axis(const PadInfo *info, const AxisMapping *mapping) {
    int ordinal = 0;
    for (int i = 0; i < info->axis_count; i++)
        if (info->axes[i] == mapping->axis && ++ordinal == mapping->ordinal)
            return i;
    return -1;
}

static double mapped(const MapperSlot *pad, int mapping, double value) {
    const AxisMapping *axis = &pad->profile.axes[mapping];
    bool has_centre = pad_control_least(axis->control) < 0.0;
    return profile_axis_value(axis,
                              calibration_apply(&pad->calibration.axes[pad->axes[mapping].index], value, has_centre));
}

// Whether the axis, which was at `before` and is moved, may have a control that it does not drive.
static bool may_take(const Mapper *mapper, int slot, int mapping, int control, double before) {
    const MapperSlot *pad = &mapper->slots[slot];
    const MapperAxis *axis = &pad->axes[mapping];
    if (!axis->moved || pad_control_rests((PadControl)control))
        return axis->moved;
    double now = mapped(pad, mapping, axis->value), past = mapped(pad, mapping, before);
    double present = mapper->values[control];
    bool crossed = (past < present && now > present) || (past > present && now < present);
    return axis->value != before && (crossed || fabs(now - present) <= MAPPER_PICK_UP);
}

// `looked`: where the axis lay before it was moved. The control moves as the axis did, but towards it only: a device
// whose first report was wrong would else move it away.
static void take(Mapper *mapper, int slot, int mapping, int control, double looked) {
    const MapperSlot *pad = &mapper->slots[slot];
    double present = mapper->values[control], there = mapped(pad, mapping, pad->axes[mapping].value);
    double moved = present + there - mapped(pad, mapping, looked);
    set_driver(mapper, control, (MapperDriver){MAPPER_AXIS, slot, mapping});
    if (!pad_control_rests((PadControl)control))
        return;
    mapper->offsets[control] = clamp(moved, fmin(present, there), fmax(present, there)) - there;
    mapper->fade_per_s[control] = fabs(mapper->offsets[control]) / MAPPER_FADE_S;
}

// What the axis that drives the control makes of it.
static void follow_axis(Mapper *mapper, int control) {
    MapperDriver driver = mapper->drivers[control];
    const MapperSlot *pad = &mapper->slots[driver.slot];
    double value = mapped(pad, driver.mapping, pad->axes[driver.mapping].value) + mapper->offsets[control];
    mapper->values[control] = clamp(value, pad_control_least((PadControl)control), 1.0);
}

static void move_controls(Mapper *mapper, int slot, int mapping, double before, double looked) {
    int first, last;
    span_of(mapper->slots[slot].profile.axes[mapping].control, &first, &last);
    for (int control = first; control <= last; control++) {
        if (!drives(mapper, control, slot, mapping)) {
            if (!may_take(mapper, slot, mapping, control, before))
                continue;
            take(mapper, slot, mapping, control, looked);
        }
        follow_axis(mapper, control);
    }
}

static void report_axis(Mapper *mapper, int slot, int mapping, const PadState *state) {
    MapperAxis *axis = &mapper->slots[slot].axes[mapping];
    if (axis->index < 0 || state->axes_unknown >> axis->index & 1 || !isfinite(state->axes[axis->index]))
        return;
    double before = axis->value, looked = axis->looked, now = clamp(state->axes[axis->index], -1.0, 1.0);
    axis->value = now;
    if (!axis->known) {
        axis->known = true;
        axis->looked = now;
        return;
    }
    if (fabs(now - axis->looked) > MAPPER_MOVED) {
        axis->moved = true;
        axis->looked = now;
    }
    move_controls(mapper, slot, mapping, before, looked);
}

// ---- Buttons ---------------------------------------------------------------------------------------------------

static bool is_down(const ButtonMapping *button, const PadState *state) {
    if (!button->is_hat)
        return state->buttons[(button->number - 1) / 64] >> ((button->number - 1) % 64) & 1;
    int hat = state->hats[button->number - 1];
    return hat != PAD_HAT_CENTRED && (hat - button->direction + 9) % 8 <= 2;
}

static void step_control(Mapper *mapper, const ButtonMapping *button, Keyboard *keyboard) {
    int first, last;
    span_of(button->control, &first, &last);
    for (int control = first; control <= last; control++) {
        double value = mapper->values[control] + button->amount;
        set_driver(mapper, control, keys);
        set_value(mapper, control, clamp(value, pad_control_least((PadControl)control), 1.0), keyboard);
    }
}

// What the pad's buttons that are down make of the control, together; false: none of them is down.
static bool sum_of_holds(const MapperSlot *pad, PadControl name, double *out) {
    bool any = false;
    double sum = 0.0;
    for (int i = 0; i < pad->profile.button_count; i++) {
        const ButtonMapping *button = &pad->profile.buttons[i];
        if (button->does != BUTTON_HOLD || button->control != name || !is_down(button, &pad->state))
            continue;
        any = true;
        sum += button->amount;
    }
    *out = clamp(sum, pad_control_least(name), 1.0);
    return any;
}

static void hold_control(Mapper *mapper, int slot, PadControl name, Keyboard *keyboard) {
    int first, last;
    double value;
    bool held = sum_of_holds(&mapper->slots[slot], name, &value);
    span_of(name, &first, &last);
    for (int control = first; control <= last; control++) {
        MapperDriver driver = mapper->drivers[control];
        bool ours = driver.kind == MAPPER_BUTTONS && driver.slot == slot;
        if (held) {
            set_driver(mapper, control, (MapperDriver){MAPPER_BUTTONS, slot, -1});
            mapper->values[control] = value;
        } else if (ours) {
            set_driver(mapper, control, keys);
            set_value(mapper, control, pad_control_rests((PadControl)control) ? 0.0 : mapper->values[control],
                      keyboard);
        }
    }
}

static void change_action(MapperSlot *pad, int index, bool down, Keyboard *keyboard) {
    if (down == pad->pressed[index])
        return;
    pad->pressed[index] = down;
    keyboard_on_action(keyboard, pad->profile.buttons[index].action, down);
}

// The pad's state is already the new one.
static void change_button(Mapper *mapper, int slot, int index, bool down, Keyboard *keyboard) {
    const ButtonMapping *button = &mapper->slots[slot].profile.buttons[index];
    if (button->does == BUTTON_ACTION)
        change_action(&mapper->slots[slot], index, down, keyboard);
    else if (button->does == BUTTON_HOLD)
        hold_control(mapper, slot, button->control, keyboard);
    else if (down)
        step_control(mapper, button, keyboard);
}

static void report_buttons(Mapper *mapper, int slot, const PadState *before, Keyboard *keyboard) {
    const MapperSlot *pad = &mapper->slots[slot];
    for (int i = 0; i < pad->profile.button_count; i++) {
        const ButtonMapping *button = &pad->profile.buttons[i];
        bool down = is_down(button, &pad->state);
        if (down != is_down(button, before))
            change_button(mapper, slot, i, down, keyboard);
    }
}

void mapper_keep(Mapper *mapper, Keyboard *keyboard) {
    for (int control = 0; control < PAD_CONTROL_COUNT; control++) {
        const double *set = of_keyboard(&keyboard->controls, control);
        if (!set || pad_control_rests((PadControl)control))
            continue;
        set_driver(mapper, control, keys);
        set_value(mapper, control, *set, keyboard);
    }
}

// ---- Plugging --------------------------------------------------------------------------------------------------

static void let_go(Mapper *mapper, int control) {
    double value = mapper->values[control];
    bool rests = pad_control_rests((PadControl)control) && value != 0.0;
    set_driver(mapper, control, rests ? (MapperDriver){MAPPER_RESTING, -1, -1} : keys);
    mapper->rest_per_s[control] = fabs(value) / MAPPER_CENTRE_S;
}

static void let_go_of_all(Mapper *mapper, int slot) {
    for (int control = 0; control < PAD_CONTROL_COUNT; control++) {
        MapperDriver driver = mapper->drivers[control];
        if ((driver.kind == MAPPER_AXIS || driver.kind == MAPPER_BUTTONS) && driver.slot == slot)
            let_go(mapper, control);
    }
}

void mapper_connect(Mapper *mapper, int slot, const PadInfo *info, const PadProfile *profile,
                    const PadCalibration *calibration) {
    MapperSlot *pad = &mapper->slots[slot];
    let_go_of_all(mapper, slot); // of one whose departure nobody told
    *pad = (MapperSlot){.connected = true, .state = pad_at_rest()};
    pad->profile = profile ? *profile : profile_default(info);
    if (calibration)
        pad->calibration = *calibration;
    for (int i = 0; i < pad->profile.axis_count; i++)
        pad->axes[i].index = index_of_axis(info, &pad->profile.axes[i]);
}

void mapper_disconnect(Mapper *mapper, int slot, Keyboard *keyboard) {
    MapperSlot *pad = &mapper->slots[slot];
    if (!pad->connected)
        return;
    let_go_of_all(mapper, slot);
    for (int i = 0; i < pad->profile.button_count; i++)
        change_action(pad, i, false, keyboard);
    *pad = (MapperSlot){.connected = false};
}

void mapper_report(Mapper *mapper, int slot, const PadState *state, Keyboard *keyboard) {
    MapperSlot *pad = &mapper->slots[slot];
    if (!pad->connected)
        return;
    for (int i = 0; i < pad->profile.axis_count; i++)
        report_axis(mapper, slot, i, state);
    PadState before = pad->reported ? pad->state : *state;
    pad->state = *state;
    pad->reported = true;
    report_buttons(mapper, slot, &before, keyboard);
}

// ---- Sampling --------------------------------------------------------------------------------------------------

static const struct {
    Action less, more;
} held_actions[PAD_CONTROL_COUNT] = {
    [PAD_CONTROL_AILERON] = {ACTION_STICK_LEFT, ACTION_STICK_RIGHT},
    [PAD_CONTROL_ELEVATOR] = {ACTION_STICK_FORWARD, ACTION_STICK_BACK},
    [PAD_CONTROL_RUDDER] = {ACTION_RUDDER_LEFT, ACTION_RUDDER_RIGHT},
    [PAD_CONTROL_THROTTLE] = {ACTION_THROTTLE_DOWN, ACTION_THROTTLE_UP},
    [PAD_CONTROL_TRIM] = {ACTION_TRIM_DOWN, ACTION_TRIM_UP},
};

static bool was_pressed(const Mapper *mapper, const Keyboard *keyboard, Action action) {
    return keyboard->held[action] > mapper->held_before[action];
}

// A key of the control went down; or, while none is down, it was set, and not by the keyboard's return to rest.
static bool is_touched(const Mapper *mapper, const Keyboard *keyboard, int control, double now) {
    double before = mapper->keys[control];
    Action less = held_actions[control].less, more = held_actions[control].more;
    if (less != more && (was_pressed(mapper, keyboard, less) || was_pressed(mapper, keyboard, more)))
        return true;
    if (less != more && (keyboard->held[less] > 0 || keyboard->held[more] > 0))
        return false;
    return pad_control_rests((PadControl)control) ? fabs(now) > fabs(before) : now != before;
}

static double towards_zero(double value, double step) {
    return copysign(fmax(fabs(value) - step, 0.0), value);
}

static void rest(Mapper *mapper, int control, double dt_s) {
    mapper->values[control] = towards_zero(mapper->values[control], mapper->rest_per_s[control] * dt_s);
    if (mapper->values[control] == 0.0)
        mapper->drivers[control] = keys;
}

static void fade(Mapper *mapper, int control, double dt_s) {
    mapper->offsets[control] = towards_zero(mapper->offsets[control], mapper->fade_per_s[control] * dt_s);
    follow_axis(mapper, control);
}

static void sample_control(Mapper *mapper, Keyboard *keyboard, int control, double dt_s) {
    double *of_keys = of_keyboard(&keyboard->controls, control);
    if (of_keys && is_touched(mapper, keyboard, control, *of_keys))
        set_driver(mapper, control, keys);
    if (mapper->drivers[control].kind == MAPPER_KEYS && of_keys)
        mapper->values[control] = *of_keys;
    else if (mapper->drivers[control].kind == MAPPER_RESTING)
        rest(mapper, control, dt_s);
    else if (mapper->drivers[control].kind == MAPPER_AXIS && mapper->offsets[control] != 0.0)
        fade(mapper, control, dt_s);
    set_value(mapper, control, mapper->values[control], keyboard);
}

Controls mapper_sample(Mapper *mapper, Keyboard *keyboard, double dt_s) {
    keyboard_sample(keyboard, dt_s);
    for (int control = 0; control < PAD_CONTROL_COUNT; control++)
        sample_control(mapper, keyboard, control, dt_s);
    memcpy(mapper->held_before, keyboard->held, sizeof mapper->held_before);
    return keyboard->controls;
}

void mapper_look(const Mapper *mapper, double *right, double *up) {
    *right = mapper->values[PAD_CONTROL_LOOK_X];
    *up = mapper->values[PAD_CONTROL_LOOK_Y];
}
