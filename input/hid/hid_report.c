#include "input/hid/hid_descriptor.h"

static uint32_t read_bits(const uint8_t *report, uint32_t bit, int bits) {
    uint64_t value = 0;
    uint32_t first = bit / 8, last = (bit + (uint32_t)bits - 1) / 8;
    for (uint32_t byte = first; byte <= last; byte++)
        value |= (uint64_t)report[byte] << (8 * (byte - first));
    return (uint32_t)(value >> bit % 8 & (UINT64_MAX >> (64 - bits)));
}

static int64_t read_value(const HidField *field, const uint8_t *report, uint32_t bit) {
    int64_t value = read_bits(report, bit, field->bits), sign = (int64_t)1 << (field->bits - 1);
    return field->logical_min < 0 ? (value ^ sign) - sign : value;
}

static bool is_in_range(const HidField *field, int64_t value) {
    return value >= field->logical_min && value <= field->logical_max;
}

static void decode_axis(const HidField *field, int64_t value, PadState *state) {
    if (field->has_null && !is_in_range(field, value))
        return;
    state->raw[field->index] = (uint32_t)value;
    if (value < field->logical_min)
        value = field->logical_min;
    if (value > field->logical_max)
        value = field->logical_max;
    double share = (double)(value - field->logical_min) / (double)(field->logical_max - field->logical_min);
    state->axes[field->index] = 2.0 * share - 1.0;
    state->axes_unknown &= ~(1u << field->index);
}

// Where a hat has neither 4 nor 8 directions, the physical range, degrees, tells what its values mean, if it is there.
static int hat_eighths(const HidField *field, int64_t value) {
    int64_t directions = field->logical_max - field->logical_min + 1;
    double turned = (double)(value - field->logical_min);
    double degrees = (double)(field->physical_max - field->physical_min);
    bool has_degrees = degrees > 0.0 && degrees <= 360.0;
    double eighths = directions == 4 || directions == 8 || !has_degrees
                         ? turned * 8.0 / (double)directions
                         : turned * degrees / (double)(directions - 1) / 45.0;
    return (int)(eighths + 0.5) % 8;
}

static void decode_hat(const HidField *field, int64_t value, PadState *state) {
    state->hats[field->index] = (int8_t)(is_in_range(field, value) ? hat_eighths(field, value) : PAD_HAT_CENTRED);
}

static void set_button(PadState *state, int button, bool down) {
    uint64_t bit = (uint64_t)1 << (button % 64);
    if (down)
        state->buttons[button / 64] |= bit;
    else
        state->buttons[button / 64] &= ~bit;
}

// A switch has two values; what presses softly is down from the middle on.
static void decode_button(const HidField *field, int64_t value, PadState *state) {
    if (is_in_range(field, value))
        set_button(state, field->index, 2 * value > field->logical_min + field->logical_max);
}

// Each value names a button that is down; those that none names are up.
static void decode_array(const HidField *field, const uint8_t *report, PadState *state) {
    for (int i = 0; i < field->button_count; i++)
        set_button(state, field->index + i, false);
    for (uint32_t slot = 0; slot < field->slots; slot++) {
        int64_t button = read_value(field, report, field->bit + slot * field->bits) - field->first_value;
        if (button >= 0 && button < field->button_count)
            set_button(state, field->index + (int)button, true);
    }
}

static void decode_field(const HidField *field, const uint8_t *report, PadState *state) {
    if (field->kind == HID_FIELD_BUTTON_ARRAY) {
        decode_array(field, report, state);
        return;
    }
    int64_t value = read_value(field, report, field->bit);
    if (field->kind == HID_FIELD_AXIS)
        decode_axis(field, value, state);
    else if (field->kind == HID_FIELD_HAT)
        decode_hat(field, value, state);
    else
        decode_button(field, value, state);
}

bool hid_report_decode(const HidDescriptor *descriptor, const uint8_t *report, size_t count, PadState *state) {
    if (count == 0)
        return false;
    uint8_t id = descriptor->has_report_ids ? report[0] : 0;
    if (descriptor->report_bytes[id] == 0 || count < descriptor->report_bytes[id])
        return false;
    for (int i = 0; i < descriptor->field_count; i++)
        if (descriptor->fields[i].report_id == id)
            decode_field(&descriptor->fields[i], report, state);
    return true;
}
