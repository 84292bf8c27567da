#include "config/joystick_profile.h"

#include "base/log.h"
#include "config/ini_read.h"
#include "config/quantity.h"
#include "config/suggest.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BUTTONS_MAX 128 // numbers of buttons and hats that profiles may name
#define HATS_MAX 4

typedef struct Reading {
    const JoystickNames *names;
    JoystickProfile *profile;
} Reading;

// ---- Words and numbers -----------------------------------------------------------------------------------------

static int index_of(const char *word, const char *const *list, int count) {
    for (int i = 0; i < count; i++)
        if (strcmp(word, list[i]) == 0)
            return i;
    return -1;
}

static bool refuse_word(const IniEntry *entry, const char *word, const char *what, const char *const *list, int count) {
    const char *nearest = suggest_nearest(word, list, count);
    if (nearest) {
        log_error("%s:%d: there is no %s '%s'; did you mean '%s'?", entry->file, entry->line, what, word, nearest);
        return false;
    }
    char all[900] = "";
    for (int i = 0; i < count; i++)
        snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", i ? ", " : "", list[i]);
    log_error("%s:%d: there is no %s '%s'; expected one of %s", entry->file, entry->line, what, word, all);
    return false;
}

static bool read_word(const IniEntry *entry, const char *const *list, int count, int *out) {
    *out = index_of(entry->value, list, count);
    return *out >= 0 || refuse_word(entry, entry->value, entry->name, list, count);
}

static bool read_number(const IniEntry *entry, double least, double greatest, JoystickNumber *out) {
    double value;
    if (quantity_parse(QUANTITY_PLAIN, entry->value, &value) != RESULT_OK || value < least || value > greatest) {
        log_error("%s:%d: %s: expected a number from %g to %g, found '%s'", entry->file, entry->line, entry->name,
                  least, greatest, entry->value);
        return false;
    }
    *out = (JoystickNumber){true, value};
    return true;
}

// One that is 0 would do nothing.
static bool read_effect(const IniEntry *entry, double greatest, JoystickNumber *out) {
    if (!read_number(entry, -greatest, greatest, out))
        return false;
    if (out->value != 0.0)
        return true;
    log_error("%s:%d: %s: 0 does nothing; leave the section out instead", entry->file, entry->line, entry->name);
    return false;
}

static bool read_yes(const IniEntry *entry, bool *out) {
    static const char *const words[] = {"no", "yes"};
    int index;
    if (!read_word(entry, words, COUNT_OF(words), &index))
        return false;
    *out = index == 1;
    return true;
}

// ---- Whom it is for --------------------------------------------------------------------------------------------

static bool read_hex(const char *text, uint16_t *out) {
    unsigned value = 0;
    for (int i = 0; i < 4; i++) {
        if (!isxdigit((unsigned char)text[i]))
            return false;
        int digit = tolower((unsigned char)text[i]);
        value = value << 4 | (unsigned)(digit <= '9' ? digit - '0' : digit - 'a' + 10);
    }
    *out = (uint16_t)value;
    return true;
}

bool joystick_id_parse(const char *text, uint16_t *vendor, uint16_t *product) {
    return strlen(text) == 9 && text[4] == ':' && read_hex(text, vendor) && read_hex(text + 5, product);
}

static bool refuse_many(const IniEntry *entry, int greatest) {
    log_error("%s:%d: more than %d of '%s'; split the profile", entry->file, entry->line, greatest, entry->name);
    return false;
}

static bool add_name(JoystickProfile *profile, const IniEntry *entry) {
    if (profile->name_count == JOYSTICK_MATCHES_MAX)
        return refuse_many(entry, JOYSTICK_MATCHES_MAX);
    size_t length = strlen(entry->value);
    if (length == 0 || length >= JOYSTICK_NAME_BYTES) {
        log_error("%s:%d: name: expected 1 to %d letters", entry->file, entry->line, JOYSTICK_NAME_BYTES - 1);
        return false;
    }
    memcpy(profile->names[profile->name_count++], entry->value, length + 1);
    return true;
}

static bool add_id(JoystickProfile *profile, const IniEntry *entry) {
    int i = profile->id_count;
    if (i == JOYSTICK_MATCHES_MAX)
        return refuse_many(entry, JOYSTICK_MATCHES_MAX);
    if (!joystick_id_parse(entry->value, &profile->vendors[i], &profile->products[i])) {
        log_error("%s:%d: id: expected VENDOR:PRODUCT as lsusb prints it, such as 046d:c215, found '%s'", entry->file,
                  entry->line, entry->value);
        return false;
    }
    profile->id_count++;
    return true;
}

static bool take_device(JoystickProfile *profile, const IniEntry *entry) {
    static const char *const keys[] = {"name", "id"};
    switch (index_of(entry->name, keys, COUNT_OF(keys))) {
    case 0:
        return add_name(profile, entry);
    case 1:
        return add_id(profile, entry);
    default:
        return refuse_word(entry, entry->name, "key", keys, COUNT_OF(keys));
    }
}

// ---- Axes ------------------------------------------------------------------------------------------------------

// A whole number from 1 to `greatest` and nothing else.
static bool read_ordinal(const char *text, int greatest, int *out) {
    char *end;
    if (!isdigit((unsigned char)*text))
        return false;
    long value = strtol(text, &end, 10);
    *out = (int)value;
    return *end == '\0' && value >= 1 && value <= greatest;
}

bool joystick_axis_parse(const char *text, const JoystickNames *names, int *axis, int *ordinal) {
    char word[32];
    size_t length = strcspn(text, " ");
    if (length == 0 || length >= sizeof word)
        return false;
    memcpy(word, text, length);
    word[length] = '\0';
    *axis = index_of(word, names->axes, names->axis_count);
    *ordinal = 1;
    return *axis >= 0 && (text[length] == '\0' || read_ordinal(text + length + 1, JOYSTICK_AXES_MAX, ordinal));
}

// NULL, and it was said, when there is no room.
static JoystickAxis *axis_of(JoystickProfile *profile, const IniEntry *entry, int axis, int ordinal) {
    for (int i = 0; i < profile->axis_count; i++)
        if (profile->axes[i].axis == axis && profile->axes[i].ordinal == ordinal)
            return &profile->axes[i];
    if (profile->axis_count == JOYSTICK_AXES_MAX) {
        log_error("%s:%d: more than %d axes", entry->file, entry->line, JOYSTICK_AXES_MAX);
        return NULL;
    }
    JoystickAxis *added = &profile->axes[profile->axis_count++];
    *added = (JoystickAxis){.line = entry->line, .axis = axis, .ordinal = ordinal, .control = -1};
    return added;
}

static bool take_axis_key(const Reading *reading, JoystickAxis *axis, const IniEntry *entry) {
    static const char *const keys[] = {"control", "invert", "dead-band", "power", "offset", "factor"};
    switch (index_of(entry->name, keys, COUNT_OF(keys))) {
    case 0:
        return read_word(entry, reading->names->controls, reading->names->control_count, &axis->control);
    case 1:
        return read_yes(entry, &axis->invert);
    case 2:
        return read_number(entry, 0.0, 0.9, &axis->dead_band);
    case 3:
        return read_number(entry, 0.2, 5.0, &axis->power);
    case 4:
        return read_number(entry, -10.0, 10.0, &axis->offset);
    case 5:
        return read_effect(entry, 10.0, &axis->factor);
    default:
        return refuse_word(entry, entry->name, "key", keys, COUNT_OF(keys));
    }
}

static bool take_axis(const Reading *reading, const char *which, const IniEntry *entry) {
    int axis, ordinal;
    if (!joystick_axis_parse(which, reading->names, &axis, &ordinal))
        return refuse_word(entry, which, "axis", reading->names->axes, reading->names->axis_count);
    JoystickAxis *mapping = axis_of(reading->profile, entry, axis, ordinal);
    return mapping && take_axis_key(reading, mapping, entry);
}

// ---- Buttons and hats ------------------------------------------------------------------------------------------

static JoystickButton *button_of(JoystickProfile *profile, const IniEntry *entry, const JoystickButton *like) {
    for (int i = 0; i < profile->button_count; i++) {
        JoystickButton *button = &profile->buttons[i];
        if (button->is_hat == like->is_hat && button->number == like->number && button->direction == like->direction)
            return button;
    }
    if (profile->button_count == JOYSTICK_BUTTONS_MAX) {
        log_error("%s:%d: more than %d buttons", entry->file, entry->line, JOYSTICK_BUTTONS_MAX);
        return NULL;
    }
    profile->buttons[profile->button_count] = *like;
    return &profile->buttons[profile->button_count++];
}

static bool take_button_key(const Reading *reading, const JoystickButton *like, const IniEntry *entry) {
    static const char *const keys[] = {"action", "control", "step", "hold"};
    JoystickButton *button = button_of(reading->profile, entry, like);
    if (!button)
        return false;
    switch (index_of(entry->name, keys, COUNT_OF(keys))) {
    case 0:
        return read_word(entry, reading->names->actions, reading->names->action_count, &button->action);
    case 1:
        return read_word(entry, reading->names->controls, reading->names->control_count, &button->control);
    case 2:
        return read_effect(entry, 1.0, &button->step);
    case 3:
        return read_effect(entry, 1.0, &button->hold);
    default:
        return refuse_word(entry, entry->name, "key", keys, COUNT_OF(keys));
    }
}

static bool take_button(const Reading *reading, const char *which, const IniEntry *entry) {
    JoystickButton like = {.line = entry->line, .action = -1, .control = -1};
    if (!read_ordinal(which, BUTTONS_MAX, &like.number)) {
        log_error("%s:%d: expected [button 1] to [button %d], found [%s]", entry->file, entry->line, BUTTONS_MAX,
                  entry->section);
        return false;
    }
    return take_button_key(reading, &like, entry);
}

static bool take_hat(const Reading *reading, const char *which, const IniEntry *entry) {
    static const char *const directions[] = {"up", "right", "down", "left"};
    JoystickButton like = {.line = entry->line, .is_hat = true, .action = -1, .control = -1};
    char number[8];
    size_t length = strcspn(which, " ");
    snprintf(number, sizeof number, "%.*s", (int)length, which);
    int direction = which[length] ? index_of(which + length + 1, directions, COUNT_OF(directions)) : -1;
    if (length >= sizeof number || !read_ordinal(number, HATS_MAX, &like.number) || direction < 0) {
        log_error("%s:%d: expected [hat 1 up] to [hat %d left], found [%s]", entry->file, entry->line, HATS_MAX,
                  entry->section);
        return false;
    }
    like.direction = 2 * direction;
    return take_button_key(reading, &like, entry);
}

// ---- The whole -------------------------------------------------------------------------------------------------

static bool visit_entry(void *user, const IniEntry *entry) {
    static const char *const sections[] = {"device", "axis", "button", "hat"};
    const Reading *reading = user;
    char kind[64];
    size_t length = strcspn(entry->section, " ");
    snprintf(kind, sizeof kind, "%.*s", (int)length, entry->section);
    const char *which = entry->section + length + (entry->section[length] == ' ');
    switch (index_of(kind, sections, COUNT_OF(sections))) {
    case 0:
        return take_device(reading->profile, entry);
    case 1:
        return take_axis(reading, which, entry);
    case 2:
        return take_button(reading, which, entry);
    case 3:
        return take_hat(reading, which, entry);
    default:
        return refuse_word(entry, kind, "section", sections, COUNT_OF(sections));
    }
}

static bool is_whole_button(const char *path, const JoystickButton *button) {
    bool moves = button->control >= 0, acts = button->action >= 0;
    if (moves && !acts && button->step.given != button->hold.given)
        return true;
    if (acts && !moves && !button->step.given && !button->hold.given)
        return true;
    log_error("%s:%d: a button has either 'action', or 'control' and one of 'step' and 'hold'", path, button->line);
    return false;
}

static Result check_whole(const char *path, const JoystickProfile *profile) {
    if (profile->name_count + profile->id_count == 0) {
        log_error("%s: the profile is for no device; expected 'id = VENDOR:PRODUCT' or 'name = PATTERN' under [device]",
                  path);
        return RESULT_FORMAT;
    }
    for (int i = 0; i < profile->axis_count; i++) {
        if (profile->axes[i].control >= 0)
            continue;
        log_error("%s:%d: the axis moves nothing; expected 'control = NAME' in its section", path,
                  profile->axes[i].line);
        return RESULT_FORMAT;
    }
    for (int i = 0; i < profile->button_count; i++)
        if (!is_whole_button(path, &profile->buttons[i]))
            return RESULT_FORMAT;
    return RESULT_OK;
}

Result joystick_profile_read(const char *path, const JoystickNames *names, JoystickProfile *out) {
    *out = (JoystickProfile){.axis_count = 0};
    Reading reading = {names, out};
    Result result = ini_read(path, visit_entry, &reading);
    if (result == RESULT_NOT_FOUND || result == RESULT_IO)
        log_error("%s: the joystick profile %s", path, result == RESULT_IO ? "cannot be read" : "does not exist");
    return result == RESULT_OK ? check_whole(path, out) : result;
}

// ---- Matching --------------------------------------------------------------------------------------------------

static bool is_like(char pattern, char letter) {
    return pattern == '?' || tolower((unsigned char)pattern) == tolower((unsigned char)letter);
}

// A later * makes an earlier one's choice final, so that the time is at most the product of the lengths.
static bool fits_pattern(const char *pattern, const char *name) {
    const char *star = NULL, *resume = name;
    while (*name) {
        if (*pattern == '*') {
            star = pattern++;
            resume = name;
        } else if (*pattern && is_like(*pattern, *name)) {
            pattern++;
            name++;
        } else if (star) {
            pattern = star + 1;
            name = ++resume;
        } else {
            return false;
        }
    }
    return pattern[strspn(pattern, "*")] == '\0';
}

JoystickFit joystick_profile_fit(const JoystickProfile *profile, uint16_t vendor, uint16_t product, const char *name) {
    for (int i = 0; i < profile->id_count; i++)
        if (profile->vendors[i] == vendor && profile->products[i] == product)
            return JOYSTICK_FITS_ID;
    for (int i = 0; i < profile->name_count; i++)
        if (fits_pattern(profile->names[i], name))
            return JOYSTICK_FITS_NAME;
    return JOYSTICK_FITS_NOT;
}
