#include "input/pad.h"

#include <string.h>

PadState pad_at_rest(void) {
    PadState state = {.axes_unknown = UINT32_MAX};
    memset(state.hats, PAD_HAT_CENTRED, sizeof state.hats);
    return state;
}

static const char *const names[PAD_AXIS_KIND_COUNT] = {
#define PAD_AXIS_NAME(id, name) [PAD_AXIS_##id] = name,
    PAD_AXIS_TABLE(PAD_AXIS_NAME)
#undef PAD_AXIS_NAME
};

const char *pad_axis_name(PadAxisKind kind) {
    return names[kind];
}
