#include "app/commands/command.h"
#include "app/json.h"
#include "base/log.h"
#include "config/files.h"

#include <stdio.h>

// Where subcommands differ in an option of one name, the first stands for it, unless one of them is asked for.
static bool is_listed(OptionId id, unsigned commands) {
    bool asks_only = id == OPTION_HELP || id == OPTION_VERSION;
    bool first = (OptionId)option_find(option_spec(id)->name, COMMAND_CONFIG) == id;
    return !asks_only && (option_spec(id)->commands & commands) && (commands != COMMANDS_ALL || first);
}

static void print_option(const Options *options, OptionId id) {
    const char *text = options_text(options, id), *where = options_where(options, id);
    printf("%-16s %-24s %s%s%s\n", option_spec(id)->name, text ? text : "-",
           option_source_name(options_source(options, id)), *where ? ", " : "", where);
}

static void add_option(Json *array, const Options *options, OptionId id) {
    char environment[64];
    option_environment_name(id, environment);
    Json *row = json_append_object(array);
    json_add_text(row, "name", option_spec(id)->name);
    json_add_text(row, "value", options_text(options, id));
    json_add_text(row, "source", option_source_name(options_source(options, id)));
    json_add_text(row, "where", options_where(options, id));
    json_add_text(row, "environment", environment);
    json_add_text(row, "help", option_spec(id)->help);
}

static Result print_json(const Options *options, unsigned commands, const char *file) {
    Json *json = json_create();
    json_add_text(json, "file", file);
    Json *array = json_add_array(json, "options");
    for (int i = 0; i < OPTION_COUNT; i++)
        if (is_listed((OptionId)i, commands))
            add_option(array, options, (OptionId)i);
    Result result = json_print(json);
    json_destroy(&json);
    return result;
}

Result cmd_config(const Options *options) {
    unsigned commands = COMMANDS_ALL;
    if (options_positional_count(options) == 1) {
        const Command *command = command_find(options_positionals(options)[0]);
        if (!command) {
            log_error("config: expected a subcommand's name; found '%s'", options_positionals(options)[0]);
            return RESULT_USAGE;
        }
        commands = command->id;
    }
    char file[PATHS_BYTES_MAX] = "";
    bool has_home = files_user_config(file);
    if (options_flag(options, OPTION_JSON))
        return print_json(options, commands, has_home ? file : NULL);
    printf("# %s%s\n", file, has_home && !files_exists(file) ? " (does not exist)" : "");
    for (int i = 0; i < OPTION_COUNT; i++)
        if (is_listed((OptionId)i, commands))
            print_option(options, (OptionId)i);
    return RESULT_OK;
}
