// Fuzz target of the readers of joystick profiles and calibrations, for libFuzzer: the bytes become a file, which must
// be read or refused.
//   cmake --build --preset fuzz && build/fuzz/tests/fuzz_profile CORPUS_FOLDER
#define _GNU_SOURCE
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/log.h"
#include "config/joystick_calibration.h"

static void drop_message(void *user, LogLevel level, const char *message) {
    (void)user, (void)level, (void)message;
}

static void check_axes(const JoystickProfile *profile, const JoystickNames *names) {
    for (int i = 0; i < profile->axis_count; i++) {
        const JoystickAxis *axis = &profile->axes[i];
        if (axis->axis < 0 || axis->axis >= names->axis_count || axis->control < 0 ||
            axis->control >= names->control_count || axis->ordinal < 1 || axis->ordinal > JOYSTICK_AXES_MAX)
            abort();
    }
}

static void check_buttons(const JoystickProfile *profile, const JoystickNames *names) {
    for (int i = 0; i < profile->button_count; i++) {
        const JoystickButton *button = &profile->buttons[i];
        if (button->number < 1 || button->number > (button->is_hat ? 4 : 128) ||
            button->action >= names->action_count || button->control >= names->control_count ||
            (button->action < 0) == (button->control < 0))
            abort();
    }
}

static void read_both(const char *path) {
    static const char *const axes[] = {"x", "y", "slider"}, *const controls[] = {"aileron", "throttle"};
    static const char *const actions[] = {"pause", "view-next"};
    const JoystickNames names = {axes, controls, actions, COUNT_OF(axes), COUNT_OF(controls), COUNT_OF(actions)};
    JoystickProfile profile;
    JoystickCalibration calibration;
    if (joystick_profile_read(path, &names, &profile) == RESULT_OK) {
        check_axes(&profile, &names);
        check_buttons(&profile, &names);
        joystick_profile_fit(&profile, 0x046d, 0xc215, "a pad of some name");
    }
    if (joystick_calibration_read(path, &names, &calibration) == RESULT_OK &&
        calibration.count > JOYSTICK_CALIBRATIONS_MAX)
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count) {
    int file = memfd_create("profile", 0);
    char path[64];
    log_set_sink(drop_message, NULL);
    if (file < 0)
        return 0;
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    if (write(file, bytes, count) == (ssize_t)count)
        read_both(path);
    close(file);
    return 0;
}
