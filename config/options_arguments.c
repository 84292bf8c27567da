#define _POSIX_C_SOURCE 200809L
#include "base/log.h"
#include "config/options.h"
#include "config/options_internal.h"

#include <stdio.h>
#include <string.h>

// Where the reading stands: argv[next] comes next.
typedef struct Reading {
    Options *options;
    CommandId command;
    int argc, next;
    char *const *argv;
} Reading;

static Result refuse_unknown(const Reading *reading, const char *name) {
    const char *nearest = option_nearest(name, reading->command);
    if (nearest)
        log_error("unknown option '--%s'; did you mean '--%s'? --help lists all", name, nearest);
    else
        log_error("unknown option '--%s'; --help lists all", name);
    return RESULT_USAGE;
}

static bool is_taken_by(const char *name, CommandId command) {
    for (int id = 0; id < OPTION_COUNT; id++)
        if (strcmp(option_spec((OptionId)id)->name, name) == 0 && (option_spec((OptionId)id)->commands & command))
            return true;
    return false;
}

static Result refuse_other_command(const char *shown, const char *name) {
    char takers[128] = "";
    for (int i = 0; i < OPTION_COMMANDS; i++)
        if (is_taken_by(name, option_commands[i].id))
            snprintf(takers + strlen(takers), sizeof takers - strlen(takers), "%s%s", *takers ? ", " : "",
                     option_commands[i].name);
    log_error("option '%s' is known, but not to this subcommand; it is one of %s", shown, takers);
    return RESULT_USAGE;
}

// What comes next as a value. An option in its place is what follows a forgotten value, and no file is meant by it.
static const char *next_value(Reading *reading, OptionId id, const char *shown) {
    char expected[320];
    const char *next = reading->next < reading->argc ? reading->argv[reading->next] : NULL;
    bool is_option = next && strncmp(next, "--", 2) == 0;
    if (next && !is_option) {
        reading->next++;
        return next;
    }
    option_describe_expected(option_spec(id), expected, sizeof expected);
    if (!is_option)
        log_error("%s: a value is missing; expected %s", shown, expected);
    else if (option_spec(id)->type == OPTION_TYPE_PATH)
        log_error("%s: a value is missing; expected %s; found '%s' (for a file of that name: ./%s)", shown, expected,
                  next, next);
    else
        log_error("%s: a value is missing; expected %s; found '%s'", shown, expected, next);
    return NULL;
}

static Result take_value(Reading *reading, OptionId id, const char *attached, const char *shown) {
    const char *text = attached ? attached : next_value(reading, id, shown);
    return text ? options_set(reading->options, id, text, SOURCE_COMMAND_LINE, shown) : RESULT_USAGE;
}

static bool is_flag(int id) {
    return option_spec((OptionId)id)->type == OPTION_TYPE_FLAG;
}

static Result set_flag(Reading *reading, OptionId id, const char *value, const char *shown) {
    return options_set(reading->options, id, value, SOURCE_COMMAND_LINE, shown);
}

static Result read_long(Reading *reading, const char *argument) {
    char name[64];
    size_t length = strcspn(argument + 2, "=");
    if (length >= sizeof name - 2) {
        log_error("unknown option '%s'; --help lists all", argument);
        return RESULT_USAGE;
    }
    memcpy(name, argument + 2, length);
    name[length] = '\0';
    char shown[68];
    snprintf(shown, sizeof shown, "--%s", name);
    const char *attached = argument[2 + length] == '=' ? argument + 2 + length + 1 : NULL;
    int id = option_find(name, reading->command);
    bool negated = id < 0 && strncmp(name, "no-", 3) == 0;
    if (negated)
        id = option_find(name + 3, reading->command);
    if (id < 0 || (negated && (!is_flag(id) || attached)))
        return refuse_unknown(reading, name);
    if (!option_belongs_to((OptionId)id, reading->command))
        return refuse_other_command(shown, option_spec((OptionId)id)->name);
    if (is_flag(id) && !attached)
        return set_flag(reading, (OptionId)id, negated ? "false" : "true", shown);
    return take_value(reading, (OptionId)id, attached, shown);
}

static int find_letter(char letter, CommandId command) {
    for (int i = 0; i < OPTION_COUNT; i++)
        if (option_spec((OptionId)i)->letter == letter && option_belongs_to((OptionId)i, command))
            return i;
    return -1;
}

// -v, -qv, -t2, -t 2
static Result read_short(Reading *reading, const char *argument) {
    for (const char *letter = argument + 1; *letter; letter++) {
        char shown[3] = {'-', *letter, '\0'};
        int id = find_letter(*letter, reading->command);
        if (id < 0) {
            log_error("unknown option '%s'; --help lists all", shown);
            return RESULT_USAGE;
        }
        if (!is_flag(id))
            return take_value(reading, (OptionId)id, letter[1] ? letter + 1 : NULL, shown);
        Result result = set_flag(reading, (OptionId)id, "true", shown);
        if (result != RESULT_OK)
            return result;
    }
    return RESULT_OK;
}

static bool takes_next(int id, bool attached) {
    return id >= 0 && !is_flag(id) && !attached;
}

// Whether the argument after this option is its value.
static bool option_takes_next(const char *option) {
    char name[64];
    if (option[1] == '-') {
        size_t length = strcspn(option + 2, "=");
        snprintf(name, sizeof name, "%.*s", (int)length, option + 2);
        return takes_next(option_find(name, COMMANDS_ALL), option[2 + length] == '=');
    }
    for (const char *letter = option + 1; *letter; letter++) {
        int id = find_letter(*letter, COMMANDS_ALL);
        if (id < 0 || !is_flag(id))
            return takes_next(id, letter[1] != '\0');
    }
    return false;
}

int options_count_leading(int argc, char *const *argv) {
    int count = 0;
    while (count < argc && argv[count][0] == '-' && argv[count][1] != '\0') {
        if (strcmp(argv[count], "--") == 0)
            return argc; // all others are no subcommand
        count += option_takes_next(argv[count]) ? 2 : 1;
    }
    return count < argc ? count : argc;
}

Result options_read_arguments(Options *options, int argc, char *const *argv) {
    Reading reading = {options, options_command(options), argc, 0, argv};
    bool only_positionals = false;
    while (reading.next < argc) {
        const char *argument = argv[reading.next++];
        Result result;
        if (only_positionals || argument[0] != '-' || argument[1] == '\0') {
            result = options_add_positional(options, argument);
        } else if (strcmp(argument, "--") == 0) {
            only_positionals = true;
            result = RESULT_OK;
        } else {
            result = argument[1] == '-' ? read_long(&reading, argument) : read_short(&reading, argument);
        }
        if (result != RESULT_OK)
            return result;
    }
    return RESULT_OK;
}
