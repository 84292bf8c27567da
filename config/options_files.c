#define _POSIX_C_SOURCE 200809L
#include "base/log.h"
#include "config/ini_read.h"
#include "config/options.h"
#include "config/options_internal.h"
#include "config/suggest.h"

#include <stdio.h>
#include <string.h>

#define ENVIRONMENT_PREFIX "OVERFLY_"

// --help in a file would make the program useless, and only the command line says which.
static bool is_command_line_only(int id) {
    return id == OPTION_HELP || id == OPTION_VERSION;
}

static int find_environment_name(const char *name, size_t length, CommandId command) {
    int found = -1;
    for (int i = 0; i < OPTION_COUNT; i++) {
        char own[64];
        option_environment_name((OptionId)i, own);
        if (is_command_line_only(i) || strlen(own) != length || strncmp(own, name, length) != 0)
            continue;
        if (option_belongs_to((OptionId)i, command))
            return i;
        found = i;
    }
    return found;
}

static void warn_unknown_environment(const char *name, size_t length) {
    char names[OPTION_COUNT][64], typed[64];
    const char *tails[OPTION_COUNT]; // without the prefix, which would make everything look near
    for (int i = 0; i < OPTION_COUNT; i++) {
        option_environment_name((OptionId)i, names[i]);
        tails[i] = names[i] + strlen(ENVIRONMENT_PREFIX);
    }
    snprintf(typed, sizeof typed, "%.*s", (int)length, name);
    const char *nearest = suggest_nearest(typed + strlen(ENVIRONMENT_PREFIX), tails, OPTION_COUNT);
    if (nearest)
        log_warn("environment variable %s is not known and does nothing; did you mean %s%s?", typed, ENVIRONMENT_PREFIX,
                 nearest);
}

Result options_read_environment(Options *options, char *const *environment) {
    for (; *environment; environment++) {
        const char *entry = *environment;
        size_t length = strcspn(entry, "=");
        if (strncmp(entry, ENVIRONMENT_PREFIX, strlen(ENVIRONMENT_PREFIX)) != 0 || entry[length] != '=')
            continue;
        int id = find_environment_name(entry, length, options_command(options));
        if (id < 0) {
            warn_unknown_environment(entry, length);
            continue;
        }
        char where[64];
        option_environment_name((OptionId)id, where);
        Result result = options_set(options, (OptionId)id, entry + length + 1, SOURCE_ENVIRONMENT, where);
        if (result != RESULT_OK)
            return result;
    }
    return RESULT_OK;
}

static bool find_section(const IniEntry *entry, CommandId *out) {
    const char *names[OPTION_COMMANDS];
    if (!*entry->section) {
        *out = COMMANDS_ALL;
        return true;
    }
    for (int i = 0; i < OPTION_COMMANDS; i++) {
        names[i] = option_commands[i].name;
        if (strcmp(names[i], entry->section) == 0) {
            *out = option_commands[i].id;
            return true;
        }
    }
    const char *nearest = suggest_nearest(entry->section, names, OPTION_COMMANDS);
    log_error("%s:%d: in section [%s]: expected a subcommand's name%s%s%s", entry->file, entry->line, entry->section,
              nearest
                  ? "; did you mean ["
                  : " (fly, replay, demo, snapshot, mesh, bench, reproduce, info, convert, devices, aircraft, config)",
              nearest ? nearest : "", nearest ? "]?" : "");
    return false;
}

static void report_unknown_name(const IniEntry *entry, CommandId section) {
    const char *nearest = option_nearest(entry->name, section);
    if (nearest)
        log_error("%s:%d: expected the name of an option; found '%s'; did you mean '%s'?", entry->file, entry->line,
                  entry->name, nearest);
    else
        log_error("%s:%d: expected the name of an option ('overfly config' lists them); found '%s'", entry->file,
                  entry->line, entry->name);
}

// Whose options are read: 'overfly config fly' shows what fly would take.
static CommandId reads_for(const Options *options) {
    CommandId command = options_command(options);
    if (command == COMMAND_CONFIG && options_positional_count(options) > 0)
        for (int i = 0; i < OPTION_COMMANDS; i++)
            if (strcmp(option_commands[i].name, options_positionals(options)[0]) == 0)
                return option_commands[i].id;
    return command;
}

static bool visit_entry(void *user, const IniEntry *entry) {
    Options *options = user;
    CommandId section;
    if (!find_section(entry, &section))
        return false;
    CommandId command = reads_for(options);
    bool for_us = (section & command) || (command == COMMAND_CONFIG);
    int id = option_find(entry->name, section == COMMANDS_ALL ? command : section);
    if (id < 0 || is_command_line_only(id)) {
        report_unknown_name(entry, section == COMMANDS_ALL ? COMMAND_CONFIG : section);
        return false;
    }
    char where[512];
    snprintf(where, sizeof where, "%s:%d: %s", entry->file, entry->line, entry->name);
    if (for_us)
        return options_set(options, (OptionId)id, entry->value, SOURCE_FILE, where) == RESULT_OK;
    double numbers[4];
    return option_check((OptionId)id, entry->value, where, numbers) == RESULT_OK;
}

Result options_read_file(Options *options, const char *path) {
    Result result = ini_read(path, visit_entry, options);
    if (result == RESULT_IO)
        log_error("%s: cannot be read; mend its permissions or remove it", path);
    return result == RESULT_FORMAT ? RESULT_USAGE : result;
}
