#include "app/pilot/pad_setups.h"

#include "base/log.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

struct PadSetups {
    _Atomic(PadSetup *) read[DEVICES_MAX]; // by slot; whoever takes one out owns it
};

Result pad_setups_create(PadSetups **out) {
    *out = calloc(1, sizeof **out);
    if (*out)
        return RESULT_OK;
    log_error("no memory for what files say of sticks and gamepads");
    return RESULT_MEMORY;
}

void pad_setups_destroy(PadSetups **setups) {
    if (!*setups)
        return;
    for (int slot = 0; slot < DEVICES_MAX; slot++)
        free(atomic_load(&(*setups)->read[slot]));
    free(*setups);
    *setups = NULL;
}

static PadSetup *read_files(const PadInfo *info) {
    PadSetup *setup = calloc(1, sizeof *setup);
    if (!setup)
        return NULL;
    setup->info = *info;
    setup->has_profile = joystick_find_profile(info, &setup->profile, setup->path) == RESULT_OK;
    setup->is_calibrated = joystick_load_calibration(info, &setup->calibration) == RESULT_OK;
    return setup;
}

static void make(void *user, int slot, const PadInfo *info) {
    PadSetups *setups = user;
    free(atomic_exchange(&setups->read[slot], read_files(info)));
}

DeviceHook pad_setups_hook(PadSetups *setups) {
    return (DeviceHook){make, setups};
}

static bool is_same(const PadInfo *a, const PadInfo *b) {
    return a->vendor == b->vendor && a->product == b->product && !strcmp(a->name, b->name) && !strcmp(a->path, b->path);
}

PadSetup *pad_setups_take(PadSetups *setups, int slot, const PadInfo *info) {
    PadSetup *setup = atomic_exchange(&setups->read[slot], NULL);
    if (setup && is_same(&setup->info, info))
        return setup;
    free(setup);
    return read_files(info);
}
