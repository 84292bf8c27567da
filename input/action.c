#include "input/action.h"

#include <ctype.h>

typedef enum Shift { ANY, PLAIN, SHIFTED } Shift;

static const struct {
    int key;
    Shift shift;
    Action action;
} bindings[] = {
    {KEY_UP, ANY, ACTION_STICK_FORWARD},
    {KEY_PAD_8, ANY, ACTION_STICK_FORWARD},
    {KEY_DOWN, ANY, ACTION_STICK_BACK},
    {KEY_PAD_2, ANY, ACTION_STICK_BACK},
    {KEY_LEFT, ANY, ACTION_STICK_LEFT},
    {KEY_PAD_4, ANY, ACTION_STICK_LEFT},
    {KEY_RIGHT, ANY, ACTION_STICK_RIGHT},
    {KEY_PAD_6, ANY, ACTION_STICK_RIGHT},
    {'0', ANY, ACTION_RUDDER_LEFT},
    {KEY_PAD_0, ANY, ACTION_RUDDER_LEFT},
    {KEY_ENTER, ANY, ACTION_RUDDER_RIGHT},
    {KEY_PAD_ENTER, ANY, ACTION_RUDDER_RIGHT},
    {KEY_PAGE_UP, ANY, ACTION_THROTTLE_UP},
    {KEY_PAGE_DOWN, ANY, ACTION_THROTTLE_DOWN},
    {KEY_HOME, ANY, ACTION_TRIM_DOWN},
    {KEY_END, ANY, ACTION_TRIM_UP},
    {'B', ANY, ACTION_BRAKES},
    {'[', ANY, ACTION_FLAPS_UP},
    {']', ANY, ACTION_FLAPS_DOWN},
    {'G', PLAIN, ACTION_GEAR_UP},
    {'G', SHIFTED, ACTION_GEAR_DOWN},
    {'O', ANY, ACTION_AUTOPILOT},
    {'R', ANY, ACTION_RESET},
    {KEY_F5, ANY, ACTION_SAVE},
    {'5', ANY, ACTION_CENTRE},
    {KEY_PAD_5, ANY, ACTION_CENTRE},
    {'V', PLAIN, ACTION_VIEW_NEXT},
    {'V', SHIFTED, ACTION_VIEW_PREVIOUS},
    {'X', PLAIN, ACTION_ZOOM_IN},
    {'X', SHIFTED, ACTION_ZOOM_OUT},
    {'P', ANY, ACTION_PAUSE},
    {'A', PLAIN, ACTION_TIME_FASTER},
    {'A', SHIFTED, ACTION_TIME_SLOWER},
    {'H', ANY, ACTION_HUD},
    {KEY_F2, ANY, ACTION_ACCURACY},
    {KEY_F3, ANY, ACTION_SCREENSHOT},
    {'T', PLAIN, ACTION_FINER},
    {'T', SHIFTED, ACTION_COARSER},
    {'M', PLAIN, ACTION_METHOD},
    {'M', SHIFTED, ACTION_METHOD_RIGHT},
    {'C', ANY, ACTION_COMPARE},
    {'W', ANY, ACTION_WIREFRAME},
    {'L', ANY, ACTION_COLOURING},
    {KEY_F1, ANY, ACTION_HELP},
    {KEY_ESCAPE, ANY, ACTION_LEAVE},
};

Action action_of_key(int key, bool shift) {
    for (size_t i = 0; i < COUNT_OF(bindings); i++) {
        bool fits = bindings[i].shift == ANY || (bindings[i].shift == SHIFTED) == shift;
        if (bindings[i].key == key && fits)
            return bindings[i].action;
    }
    return ACTION_NONE;
}

static const struct {
    int key;
    unsigned modifiers; // that must be down
    Action action;
} replay_bindings[] = {
    {KEY_LEFT, KEY_CONTROL, ACTION_REPLAY_BACK_FAR},
    {KEY_RIGHT, KEY_CONTROL, ACTION_REPLAY_AHEAD_FAR},
    {KEY_LEFT, KEY_SHIFT, ACTION_REPLAY_BACK_MINUTE},
    {KEY_RIGHT, KEY_SHIFT, ACTION_REPLAY_AHEAD_MINUTE},
    {KEY_LEFT, 0, ACTION_REPLAY_BACK},
    {KEY_RIGHT, 0, ACTION_REPLAY_AHEAD},
    {KEY_UP, 0, ACTION_REPLAY_FASTER},
    {KEY_DOWN, 0, ACTION_REPLAY_SLOWER},
    {' ', 0, ACTION_REPLAY_PLAY},
    {KEY_BACKSPACE, 0, ACTION_REPLAY_TURN},
    {KEY_HOME, 0, ACTION_REPLAY_START},
    {KEY_END, 0, ACTION_REPLAY_END},
    {KEY_ENTER, 0, ACTION_REPLAY_TAKE_OVER},
    {KEY_PAD_ENTER, 0, ACTION_REPLAY_TAKE_OVER},
};

Action action_of_replay_key(int key, unsigned modifiers) {
    for (size_t i = 0; i < COUNT_OF(replay_bindings); i++)
        if (replay_bindings[i].key == key && (replay_bindings[i].modifiers & ~modifiers) == 0)
            return replay_bindings[i].action;
    return key >= '0' && key <= '9' ? ACTION_REPLAY_TENTH : ACTION_NONE;
}

double action_hop_s(Action action) {
    switch (action) {
    case ACTION_REPLAY_BACK:
        return -5.0;
    case ACTION_REPLAY_AHEAD:
        return 5.0;
    case ACTION_REPLAY_BACK_MINUTE:
        return -60.0;
    case ACTION_REPLAY_AHEAD_MINUTE:
        return 60.0;
    case ACTION_REPLAY_BACK_FAR:
        return -600.0;
    case ACTION_REPLAY_AHEAD_FAR:
        return 600.0;
    default:
        return 0.0;
    }
}

static const struct {
    const char *identifier, *keys, *help;
} texts[ACTION_COUNT] = {
#define ACTION_TEXT(id, keys, help) [ACTION_##id] = {#id, keys, help},
    ACTION_HELD_TABLE(ACTION_TEXT) ACTION_FLYING_TABLE(ACTION_TEXT) ACTION_ONCE_TABLE(ACTION_TEXT)
        ACTION_REPLAY_TABLE(ACTION_TEXT)
#undef ACTION_TEXT
};

const char *action_keys(Action action) {
    return texts[action].keys;
}

const char *action_help(Action action) {
    return texts[action].help;
}

void action_name(Action action, char out[ACTION_NAME_BYTES]) {
    const char *identifier = texts[action].identifier;
    size_t i = 0;
    for (; identifier[i] && i < ACTION_NAME_BYTES - 1; i++)
        out[i] = (char)(identifier[i] == '_' ? '-' : tolower((unsigned char)identifier[i]));
    out[i] = '\0';
}
