#include "input/keyboard.h"

#include <math.h>

#define KEY_LIMIT 384

Keyboard keyboard_create(double throttle) {
    return (Keyboard){.controls = {.throttle = throttle}};
}

static bool is_down(const Keyboard *keyboard, int key) {
    return keyboard->keys_down[key / 32] >> (key % 32) & 1u;
}

static void set_down(Keyboard *keyboard, int key, bool down) {
    uint32_t bit = 1u << (key % 32);
    if (down)
        keyboard->keys_down[key / 32] |= bit;
    else
        keyboard->keys_down[key / 32] &= ~bit;
}

static void push(Keyboard *keyboard, Action action) {
    if (keyboard->queue_count == KEYBOARD_QUEUE)
        return;
    keyboard->queue[(keyboard->queue_begin + keyboard->queue_count) % KEYBOARD_QUEUE] = action;
    keyboard->queue_count++;
}

void keyboard_on_key(Keyboard *keyboard, int key, bool pressed, bool shift) {
    if (key < 0 || key >= KEY_LIMIT || is_down(keyboard, key) == pressed)
        return;
    set_down(keyboard, key, pressed);
    keyboard_on_action(keyboard, action_of_key(key, shift), pressed);
}

void keyboard_on_action(Keyboard *keyboard, Action action, bool pressed) {
    if (action == ACTION_NONE)
        return;
    if (action < ACTION_HELD_COUNT)
        keyboard->held[action] = (uint8_t)(keyboard->held[action] + (pressed ? 1 : -1));
    else if (pressed)
        push(keyboard, action);
}

Action keyboard_next_action(Keyboard *keyboard) {
    if (keyboard->queue_count == 0)
        return ACTION_NONE;
    Action action = keyboard->queue[keyboard->queue_begin];
    keyboard->queue_begin = (keyboard->queue_begin + 1) % KEYBOARD_QUEUE;
    keyboard->queue_count--;
    return action;
}

int keyboard_direction(const Keyboard *keyboard, Action negative, Action positive) {
    return (keyboard->held[positive] > 0) - (keyboard->held[negative] > 0);
}

static double approach(double value, double target, double step) {
    return value < target ? fmin(value + step, target) : fmax(value - step, target);
}

// `full_s`: from centre to full deflection.
static double move_sprung(double value, int wanted, double full_s, double dt_s) {
    bool returns = wanted == 0 || value * wanted < 0.0;
    return approach(value, wanted, dt_s / (returns ? KEYBOARD_CENTRE_S : full_s));
}

static double clamp(double value, double least, double greatest) {
    return fmin(fmax(value, least), greatest);
}

Controls keyboard_sample(Keyboard *keyboard, double dt_s) {
    Controls *controls = &keyboard->controls;
    int pitch = keyboard_direction(keyboard, ACTION_STICK_FORWARD, ACTION_STICK_BACK);
    int roll = keyboard_direction(keyboard, ACTION_STICK_LEFT, ACTION_STICK_RIGHT);
    int yaw = keyboard_direction(keyboard, ACTION_RUDDER_LEFT, ACTION_RUDDER_RIGHT);
    controls->elevator = move_sprung(controls->elevator, pitch, KEYBOARD_STICK_S, dt_s);
    controls->aileron = move_sprung(controls->aileron, roll, KEYBOARD_STICK_S, dt_s);
    controls->rudder = move_sprung(controls->rudder, yaw, KEYBOARD_RUDDER_S, dt_s);
    controls->throttle +=
        keyboard_direction(keyboard, ACTION_THROTTLE_DOWN, ACTION_THROTTLE_UP) * dt_s / KEYBOARD_THROTTLE_S;
    controls->throttle = clamp(controls->throttle, 0.0, 1.0);
    controls->trim += keyboard_direction(keyboard, ACTION_TRIM_DOWN, ACTION_TRIM_UP) * dt_s / KEYBOARD_TRIM_S;
    controls->trim = clamp(controls->trim, -1.0, 1.0);
    controls->brake_left = controls->brake_right = keyboard->held[ACTION_BRAKES] > 0 ? 1.0 : 0.0;
    return *controls;
}

void keyboard_move_flaps(Keyboard *keyboard, bool down) {
    double notch = keyboard->controls.flaps * KEYBOARD_FLAPS;
    notch = down ? floor(notch + 1e-6) + 1.0 : ceil(notch - 1e-6) - 1.0;
    keyboard->controls.flaps = clamp(notch / KEYBOARD_FLAPS, 0.0, 1.0);
}

void keyboard_set_gear(Keyboard *keyboard, bool up) {
    keyboard->controls.gear_up = up;
}

void keyboard_centre(Keyboard *keyboard) {
    keyboard->controls.elevator = keyboard->controls.aileron = keyboard->controls.rudder = 0.0;
}

bool keyboard_touches_controls(const Keyboard *keyboard) {
    for (int i = 0; i < ACTION_HELD_COUNT; i++)
        if (keyboard->held[i] > 0)
            return true;
    return false;
}
