// input/action.h: everything a key can do, and which key does it.
// Key codes name positions on a US keyboard; their values are GLFW's, which render/context hands on.
// Static tables; any thread.
#pragma once
#include "base/base.h"

#define KEY_ESCAPE 256
#define KEY_ENTER 257
#define KEY_BACKSPACE 259
#define KEY_RIGHT 262
#define KEY_LEFT 263
#define KEY_DOWN 264
#define KEY_UP 265
#define KEY_PAGE_UP 266
#define KEY_PAGE_DOWN 267
#define KEY_HOME 268
#define KEY_END 269
#define KEY_F1 290
#define KEY_F2 291
#define KEY_F3 292
#define KEY_F5 294
#define KEY_PAD_0 320
#define KEY_PAD_2 322
#define KEY_PAD_4 324
#define KEY_PAD_5 325
#define KEY_PAD_6 326
#define KEY_PAD_8 328
#define KEY_PAD_ENTER 335

#define KEY_SHIFT 1u // modifiers, bits
#define KEY_CONTROL 2u

// clang-format off
// X(identifier, keys for people, help). Held actions move a control for as long as their key is down; the others happen
// once a press.
#define ACTION_HELD_TABLE(X)                                                                                           \
    X(STICK_FORWARD, "Up", "nose down")                                                                                \
    X(STICK_BACK, "Down", "nose up")                                                                                   \
    X(STICK_LEFT, "Left", "roll left")                                                                                 \
    X(STICK_RIGHT, "Right", "roll right")                                                                              \
    X(RUDDER_LEFT, "0", "rudder left")                                                                                 \
    X(RUDDER_RIGHT, "Enter", "rudder right")                                                                           \
    X(THROTTLE_UP, "PgUp", "more throttle")                                                                            \
    X(THROTTLE_DOWN, "PgDn", "less throttle")                                                                          \
    X(TRIM_DOWN, "Home", "trim nose down")                                                                             \
    X(TRIM_UP, "End", "trim nose up")                                                                                  \
    X(BRAKES, "b", "wheel brakes")

#define ACTION_FLYING_TABLE(X)                                                                                         \
    X(RESET, "r", "start anew")                                                                                        \
    X(AUTOPILOT, "o", "autopilot: hold height, heading and speed, on and off")                                         \
    X(CENTRE, "5", "centre stick and rudder")                                                                          \
    X(FLAPS_UP, "[", "flaps up a notch")                                                                               \
    X(FLAPS_DOWN, "]", "flaps down a notch")                                                                           \
    X(GEAR_UP, "g", "gear up")                                                                                         \
    X(GEAR_DOWN, "G", "gear down")                                                                                     \
    X(PAUSE, "p", "pause")                                                                                             \
    X(TIME_FASTER, "a", "time runs faster")                                                                            \
    X(TIME_SLOWER, "A", "time runs slower")

// Of any picture, flown or replayed.
#define ACTION_ONCE_TABLE(X)                                                                                           \
    X(VIEW_NEXT, "v", "next view")                                                                                     \
    X(VIEW_PREVIOUS, "V", "previous view")                                                                             \
    X(ZOOM_IN, "x", "narrower field of view")                                                                          \
    X(ZOOM_OUT, "X", "wider field of view")                                                                            \
    X(HUD, "h", "head-up display on and off")                                                                          \
    X(ACCURACY, "F2", "what accuracy costs in time, on and off")                                                       \
    X(SCREENSHOT, "F3", "write a picture")                                                                             \
    X(SAVE, "F5", "save the last ten minutes as a recording")                                                          \
    X(FINER, "t", "smaller tolerated error")                                                                           \
    X(COARSER, "T", "larger tolerated error")                                                                          \
    X(METHOD, "m", "next level-of-detail method")                                                                      \
    X(METHOD_RIGHT, "M", "next method of the right half")                                                              \
    X(COMPARE, "c", "two methods side by side, on and off")                                                            \
    X(WIREFRAME, "w", "triangle edges on and off")                                                                     \
    X(COLOURING, "l", "next colouring: land, level, cache, partition")                                                 \
    X(HELP, "F1", "help on and off")                                                                                   \
    X(LEAVE, "Esc", "leave")
// clang-format on

// What keys do while a recorded flight is shown, instead of flying. Hops go on for as long as their key is down.
// clang-format off
#define ACTION_REPLAY_TABLE(X)                                                                                         \
    X(REPLAY_BACK, "Left", "5 s back")                                                                                 \
    X(REPLAY_AHEAD, "Right", "5 s ahead")                                                                              \
    X(REPLAY_BACK_MINUTE, "Shift+Left", "1 min back")                                                                  \
    X(REPLAY_AHEAD_MINUTE, "Shift+Right", "1 min ahead")                                                               \
    X(REPLAY_BACK_FAR, "Ctrl+Left", "10 min back")                                                                     \
    X(REPLAY_AHEAD_FAR, "Ctrl+Right", "10 min ahead")                                                                  \
    X(REPLAY_FASTER, "Up", "faster")                                                                                   \
    X(REPLAY_SLOWER, "Down", "slower")                                                                                 \
    X(REPLAY_PLAY, "Space", "play, pause")                                                                             \
    X(REPLAY_TURN, "Backspace", "the other way round")                                                                 \
    X(REPLAY_START, "Home", "to the start")                                                                            \
    X(REPLAY_END, "End", "to the end")                                                                                 \
    X(REPLAY_TENTH, "0-9", "to so many tenths of the flight")                                                       \
    X(REPLAY_TAKE_OVER, "Enter", "take over the controls")
// clang-format on

typedef enum Action {
#define ACTION_ENUM(id, keys, help) ACTION_##id,
    ACTION_HELD_TABLE(ACTION_ENUM) ACTION_HELD_COUNT,
    ACTION_HELD_LAST = ACTION_HELD_COUNT - 1,
    ACTION_FLYING_TABLE(ACTION_ENUM) ACTION_ONCE_TABLE(ACTION_ENUM) ACTION_REPLAY_TABLE(ACTION_ENUM) ACTION_COUNT,
    ACTION_FLYING_FIRST = ACTION_HELD_COUNT,
    ACTION_FLYING_LAST = ACTION_VIEW_NEXT - 1,
#undef ACTION_ENUM
    ACTION_NONE = -1
} Action;

// What the key does; ACTION_NONE: nothing.
Action action_of_key(int key, bool shift);
// The same of ACTION_REPLAY_TABLE.
Action action_of_replay_key(int key, unsigned modifiers);
double action_hop_s(Action action);     // that it goes along a replay, below 0: back; 0: it does not hop
const char *action_keys(Action action); // "PgUp"
const char *action_help(Action action);

#define ACTION_NAME_BYTES 32
// As files write it: "view-next".
void action_name(Action action, char out[ACTION_NAME_BYTES]);
