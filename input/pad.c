#include "input/pad.h"

#include <string.h>

PadState pad_at_rest(void) {
    PadState state = {.axes_unknown = UINT32_MAX};
    memset(state.hats, PAD_HAT_CENTRED, sizeof state.hats);
    return state;
}

// Signed where the range is, as HID has it.
int64_t pad_raw(const PadInfo *info, const PadState *state, int axis) {
    uint32_t raw = state->raw[axis];
    return info->ranges[axis].least < 0 ? (int64_t)(int32_t)raw : (int64_t)raw;
}

static const char *const names[PAD_AXIS_KIND_COUNT] = {
#define PAD_AXIS_NAME(id, name) [PAD_AXIS_##id] = name,
    PAD_AXIS_TABLE(PAD_AXIS_NAME)
#undef PAD_AXIS_NAME
};

const char *pad_axis_name(PadAxisKind kind) {
    return names[kind];
}
