#include "input/devices/xbox_report.h"

#include <string.h>

#define TYPE_INPUT 0x00

void xbox_describe(PadInfo *info) {
    static const PadAxisKind axes[XBOX_AXES] = {PAD_AXIS_X,  PAD_AXIS_Y,     PAD_AXIS_RX,
                                                PAD_AXIS_RY, PAD_AXIS_BRAKE, PAD_AXIS_ACCELERATOR};
    info->axis_count = XBOX_AXES;
    info->button_count = XBOX_BUTTONS;
    info->hat_count = 1;
    memcpy(info->axes, axes, sizeof axes);
    for (int i = 0; i < XBOX_AXES; i++)
        info->ranges[i] = i < XBOX_LEFT_TRIGGER ? (PadRange){INT16_MIN, INT16_MAX} : (PadRange){0, UINT8_MAX};
}

// -32768..32767, lowest byte first.
static void take_stick(PadState *state, int axis, const uint8_t *bytes, double sign) {
    int value = ((bytes[0] | bytes[1] << 8) ^ 0x8000) - 0x8000;
    state->raw[axis] = (uint32_t)value;
    state->axes[axis] = sign * ((value + 0x8000) * (2.0 / 65535.0) - 1.0);
}

static void take_trigger(PadState *state, int axis, uint8_t byte) {
    state->raw[axis] = byte;
    state->axes[axis] = byte * (2.0 / 255.0) - 1.0;
}

// Bits: up, down, left, right.
static int8_t hat(uint8_t cross) {
    static const int8_t eighths[3][3] = {{7, 0, 1}, {6, PAD_HAT_CENTRED, 2}, {5, 4, 3}}; // by row from ahead, column
    int row = 1 - (cross & 1) + (cross >> 1 & 1), column = 1 - (cross >> 2 & 1) + (cross >> 3 & 1);
    return eighths[row][column];
}

static uint64_t buttons(uint8_t low, uint8_t high) {
    static const struct {
        uint8_t byte, bit;
    } places[XBOX_BUTTONS] = {{1, 4}, {1, 5}, {1, 6}, {1, 7}, {1, 0}, {1, 1}, {0, 5}, {0, 4}, {0, 6}, {0, 7}, {1, 2}};
    uint64_t down = 0;
    for (int i = 0; i < XBOX_BUTTONS; i++)
        down |= (uint64_t)((places[i].byte ? high : low) >> places[i].bit & 1) << i;
    return down;
}

XboxMessage xbox_report_decode(const uint8_t *bytes, size_t count, PadState *state) {
    if (count > 0 && bytes[0] != TYPE_INPUT)
        return XBOX_OTHER;
    if (count != XBOX_REPORT_BYTES || bytes[1] != XBOX_REPORT_BYTES)
        return XBOX_DAMAGED;
    take_stick(state, XBOX_LEFT_X, bytes + 6, 1.0);
    take_stick(state, XBOX_LEFT_Y, bytes + 8, -1.0);
    take_stick(state, XBOX_RIGHT_X, bytes + 10, 1.0);
    take_stick(state, XBOX_RIGHT_Y, bytes + 12, -1.0);
    take_trigger(state, XBOX_LEFT_TRIGGER, bytes[4]);
    take_trigger(state, XBOX_RIGHT_TRIGGER, bytes[5]);
    state->axes_unknown &= ~((1u << XBOX_AXES) - 1);
    state->buttons[0] = buttons(bytes[2], bytes[3]);
    state->hats[0] = hat(bytes[2]);
    return XBOX_INPUT;
}

static uint8_t strength(double share) {
    double bounded = share > 0.0 ? share < 1.0 ? share : 1.0 : 0.0;
    return (uint8_t)(bounded * 255.0 + 0.5);
}

void xbox_rumble_encode(double low, double high, uint8_t out[XBOX_RUMBLE_BYTES]) {
    const uint8_t message[XBOX_RUMBLE_BYTES] = {0x00, XBOX_RUMBLE_BYTES, 0x00, strength(low), strength(high)};
    memcpy(out, message, sizeof message);
}
