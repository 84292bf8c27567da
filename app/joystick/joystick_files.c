#include "app/joystick/joystick_files.h"

#include "base/log.h"
#include "config/files.h"
#include "config/joystick_calibration.h"
#include "config/joystick_profile.h"
#include "config/named_files.h"

#include <stdio.h>
#include <string.h>

#define CALIBRATION_FILE "calibration.conf"

// What input calls things, as the lists that config reads files by.
typedef struct Names {
    const char *axes[PAD_AXIS_KIND_COUNT], *controls[PAD_CONTROL_NAMES], *actions[ACTION_COUNT];
    char action_texts[ACTION_COUNT][ACTION_NAME_BYTES];
    JoystickNames lists;
} Names;

static void list_names(Names *names) {
    for (int i = 0; i < PAD_AXIS_KIND_COUNT; i++)
        names->axes[i] = pad_axis_name((PadAxisKind)i);
    for (int i = 0; i < PAD_CONTROL_NAMES; i++)
        names->controls[i] = pad_control_name((PadControl)i);
    for (int i = 0; i < ACTION_COUNT; i++) {
        action_name((Action)i, names->action_texts[i]);
        names->actions[i] = names->action_texts[i];
    }
    names->lists = (JoystickNames){names->axes,         names->controls,   names->actions,
                                   PAD_AXIS_KIND_COUNT, PAD_CONTROL_NAMES, ACTION_COUNT};
}

// ---- Profiles --------------------------------------------------------------------------------------------------

static double given_or(JoystickNumber number, double otherwise) {
    return number.given ? number.value : otherwise;
}

static AxisMapping axis_of(const JoystickAxis *read) {
    AxisMapping axis = profile_axis((PadAxisKind)read->axis, read->ordinal, (PadControl)read->control);
    axis.invert = read->invert;
    axis.dead_band = given_or(read->dead_band, axis.dead_band);
    axis.power = given_or(read->power, axis.power);
    axis.offset = given_or(read->offset, axis.offset);
    axis.factor = given_or(read->factor, axis.factor);
    return axis;
}

static ButtonMapping button_of(const JoystickButton *read) {
    bool acts = read->action >= 0;
    return (ButtonMapping){.is_hat = read->is_hat,
                           .number = read->number,
                           .direction = read->direction,
                           .does = acts               ? BUTTON_ACTION
                                   : read->step.given ? BUTTON_STEP
                                                      : BUTTON_HOLD,
                           .action = acts ? (Action)read->action : ACTION_NONE,
                           .control = acts ? PAD_CONTROL_NONE : (PadControl)read->control,
                           .amount = read->step.given ? read->step.value : read->hold.value};
}

_Static_assert(JOYSTICK_AXES_MAX <= PAD_AXES_MAX && JOYSTICK_BUTTONS_MAX <= PROFILE_BUTTONS_MAX,
               "a profile that can be read can be used");

static void convert(const char *path, const JoystickProfile *read, PadProfile *out) {
    const char *slash = strrchr(path, '/');
    const char *stem = slash ? slash + 1 : path;
    memset(out, 0, sizeof *out);
    snprintf(out->name, sizeof out->name, "%.*s", (int)strcspn(stem, "."), stem);
    for (int i = 0; i < read->axis_count; i++)
        out->axes[out->axis_count++] = axis_of(&read->axes[i]);
    for (int i = 0; i < read->button_count; i++)
        out->buttons[out->button_count++] = button_of(&read->buttons[i]);
}

Result joystick_read_profile(const char *path, PadProfile *out) {
    Names names;
    JoystickProfile read;
    list_names(&names);
    Result result = joystick_profile_read(path, &names.lists, &read);
    if (result == RESULT_OK)
        convert(path, &read, out);
    return result;
}

// ---- Folders ---------------------------------------------------------------------------------------------------

static const NamedFileKind KIND = {"joysticks", ".joystick", "a joystick's profile"};

// The best of the folder so far is `out` and `fit`.
static void try_profile(const char *path, const Names *names, const PadInfo *info, JoystickFit *fit, PadProfile *out,
                        char best[PATHS_BYTES_MAX]) {
    JoystickProfile read;
    if (joystick_profile_read(path, &names->lists, &read) != RESULT_OK)
        return;
    JoystickFit found = joystick_profile_fit(&read, info->vendor, info->product, info->name);
    if (found <= *fit)
        return;
    *fit = found;
    convert(path, &read, out);
    snprintf(best, PATHS_BYTES_MAX, "%s", path);
}

static bool find_in(const char *folder, const Names *names, const PadInfo *info, PadProfile *out,
                    char best[PATHS_BYTES_MAX]) {
    NamedFiles files = {.count = 0};
    JoystickFit fit = JOYSTICK_FITS_NOT;
    if (files_is_folder(folder) && named_files_list(&KIND, folder, &files) != RESULT_OK)
        return false;
    for (int i = 0; i < files.count; i++) {
        char path[PATHS_BYTES_MAX];
        int printed = snprintf(path, sizeof path, "%s/%s%s", folder, files.names[i], KIND.ending);
        if (printed > 0 && printed < (int)sizeof path)
            try_profile(path, names, info, &fit, out, best);
    }
    return fit != JOYSTICK_FITS_NOT;
}

Result joystick_find_profile(const PadInfo *info, PadProfile *out, char path[PATHS_BYTES_MAX]) {
    Names names;
    char folder[PATHS_BYTES_MAX];
    list_names(&names);
    if (files_user_config_of(KIND.folder, folder) && find_in(folder, &names, info, out, path))
        return RESULT_OK;
    if (paths_find_data(KIND.folder, folder) == RESULT_OK && find_in(folder, &names, info, out, path))
        return RESULT_OK;
    return RESULT_NOT_FOUND;
}

// ---- Calibration -----------------------------------------------------------------------------------------------

static int axis_index(const PadInfo *info, int kind, int ordinal) {
    for (int i = 0; i < info->axis_count; i++)
        if (info->axes[i] == (PadAxisKind)kind && --ordinal == 0)
            return i;
    return -1;
}

static int ordinal_of(const PadInfo *info, int axis) {
    int ordinal = 0;
    for (int i = 0; i <= axis; i++)
        ordinal += info->axes[i] == info->axes[axis];
    return ordinal;
}

static bool is_of(const JoystickAxisCalibration *kept, const PadInfo *info) {
    return kept->vendor == info->vendor && kept->product == info->product;
}

bool joystick_calibration_file(char path[PATHS_BYTES_MAX]) {
    return files_user_state(CALIBRATION_FILE, path);
}

static Result read_kept(const Names *names, JoystickCalibration *out, char path[PATHS_BYTES_MAX]) {
    out->count = 0;
    if (!joystick_calibration_file(path))
        return RESULT_NOT_FOUND;
    return joystick_calibration_read(path, &names->lists, out);
}

Result joystick_load_calibration(const PadInfo *info, PadCalibration *out) {
    Names names;
    JoystickCalibration kept;
    char path[PATHS_BYTES_MAX];
    bool any = false;
    list_names(&names);
    Result result = read_kept(&names, &kept, path);
    if (result != RESULT_OK)
        return result;
    memset(out, 0, sizeof *out);
    for (int i = 0; i < kept.count; i++) {
        const JoystickAxisCalibration *axis = &kept.axes[i];
        int index = is_of(axis, info) ? axis_index(info, axis->axis, axis->ordinal) : -1;
        if (index < 0)
            continue;
        out->axes[index] = (AxisCalibration){true, axis->centre, axis->min, axis->max};
        any = true;
    }
    return any ? RESULT_OK : RESULT_NOT_FOUND;
}

// Without those of the pad, and with its new ones at the end. RANGE: there is no room.
static Result replace(JoystickCalibration *kept, const PadInfo *info, const PadCalibration *calibration) {
    int count = 0;
    for (int i = 0; i < kept->count; i++)
        if (!is_of(&kept->axes[i], info))
            kept->axes[count++] = kept->axes[i];
    for (int i = 0; i < info->axis_count; i++) {
        const AxisCalibration *axis = &calibration->axes[i];
        if (!axis->known)
            continue;
        if (count == JOYSTICK_CALIBRATIONS_MAX)
            return RESULT_RANGE;
        kept->axes[count++] = (JoystickAxisCalibration){
            info->vendor, info->product, (int)info->axes[i], ordinal_of(info, i), axis->centre, axis->min, axis->max};
    }
    kept->count = count;
    return RESULT_OK;
}

static Result write_kept(const Names *names, const JoystickCalibration *kept, const char *path) {
    char folder[PATHS_BYTES_MAX];
    snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(path, '/') - path), path);
    Result result = files_make_folder(folder);
    return result == RESULT_OK ? joystick_calibration_write(path, &names->lists, kept) : result;
}

Result joystick_save_calibration(const PadInfo *info, const PadCalibration *calibration) {
    Names names;
    JoystickCalibration kept;
    char path[PATHS_BYTES_MAX] = "";
    list_names(&names);
    Result result = read_kept(&names, &kept, path);
    if (result != RESULT_OK && result != RESULT_NOT_FOUND)
        return result;
    if (!*path) {
        log_error("neither XDG_STATE_HOME nor HOME is set; the calibration of joysticks cannot be kept");
        return RESULT_IO;
    }
    result = replace(&kept, info, calibration);
    if (result == RESULT_RANGE)
        log_error("%s: it keeps %d axes already; delete the file to begin anew", path, JOYSTICK_CALIBRATIONS_MAX);
    return result == RESULT_OK ? write_kept(&names, &kept, path) : result;
}
