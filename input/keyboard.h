// input/keyboard.h: from key presses to controls and actions. Knows no window.
// Seconds; shares of full deflection.
// A Keyboard is a value; one thread at a time.
#pragma once
#include "input/action.h"
#include "input/controls.h"

#define KEYBOARD_QUEUE 64       // presses kept between two looks; later ones are dropped
#define KEYBOARD_STICK_S 0.45   // from centre to full deflection while a key is held
#define KEYBOARD_CENTRE_S 0.25  // from full deflection back, after the key is let go
#define KEYBOARD_RUDDER_S 1.0   // from centre to full deflection while a key is held: slower, to steer by on the ground
#define KEYBOARD_THROTTLE_S 2.5 // from idle to full; stays
#define KEYBOARD_TRIM_S 8.0     // from the middle to the end; stays
#define KEYBOARD_FLAPS 3        // notches from up to full

typedef struct Keyboard {
    uint8_t held[ACTION_HELD_COUNT]; // how many keys hold the action
    uint32_t keys_down[12];          // bit per key code below 384: ignores repeats and stray releases
    Action queue[KEYBOARD_QUEUE];
    int queue_begin, queue_count;
    Controls controls;
} Keyboard;

Keyboard keyboard_create(double throttle);

// As the window reports them. A release frees what the press held, whatever shift is by then.
void keyboard_on_key(Keyboard *keyboard, int key, bool pressed, bool shift);
// The same for what a pad's button does; a release follows each press.
void keyboard_on_action(Keyboard *keyboard, Action action, bool pressed);
// The next action that happens once, in order of presses; ACTION_NONE when there is none left.
Action keyboard_next_action(Keyboard *keyboard);

// Moves the controls on by `dt_s`, and gives them. Stick and rudder: deflect while held, as springs hold real ones,
// re-centre when let go; opposite keys cancel. Throttle and trim stay where they are left. Brakes: full while held.
Controls keyboard_sample(Keyboard *keyboard, double dt_s);
void keyboard_centre(Keyboard *keyboard);
// To the next notch, down or up.
void keyboard_move_flaps(Keyboard *keyboard, bool down);
void keyboard_set_gear(Keyboard *keyboard, bool up);
// -1, 0 or 1: which of two held actions is held; opposite ones cancel.
int keyboard_direction(const Keyboard *keyboard, Action negative, Action positive);
bool keyboard_touches_controls(const Keyboard *keyboard); // a control key is down
