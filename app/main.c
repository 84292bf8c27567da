#define _POSIX_C_SOURCE 200809L
#include "app/commands/command.h"
#include "app/commands/help.h"
#include "base/log.h"
#include "config/files.h"
#include "config/suggest.h"

#include <string.h>
#include <unistd.h>

extern char **environ;

static const char *nearest_command(const char *typed) {
    const char *names[32];
    int count = 0;
    for (const Command *command = command_table; command->name && count < (int)COUNT_OF(names); command++)
        names[count++] = command->name;
    return suggest_nearest(typed, names, count);
}

// Read after help and version were answered: a damaged file must not hide the help.
static Result read_surroundings(Options *options) {
    char file[PATHS_BYTES_MAX];
    if (files_user_config(file)) {
        Result result = options_read_file(options, file);
        if (result != RESULT_OK && result != RESULT_NOT_FOUND)
            return result;
    }
    return options_read_environment(options, environ);
}

static void set_log_level(const Options *options) {
    if (options_flag(options, OPTION_VERBOSE))
        log_set_level(LOG_DEBUG);
    else if (options_flag(options, OPTION_QUIET))
        log_set_level(LOG_ERROR);
}

static Result check_positionals(const Command *command, const Options *options, bool command_typed) {
    int count = options_positional_count(options);
    const char *first = count > 0 ? options_positionals(options)[0] : NULL;
    if (!command_typed && first && !files_exists(first) && nearest_command(first)) {
        log_error("'%s' is neither a file nor a subcommand; did you mean 'overfly %s'?", first, nearest_command(first));
        return RESULT_USAGE;
    }
    if (command->positional_max >= 0 && count > command->positional_max) {
        log_error("overfly %s: unexpected argument '%s'; usage: overfly %s %s", command->name,
                  options_positionals(options)[command->positional_max], command->name, command->positionals);
        return RESULT_USAGE;
    }
    return RESULT_OK;
}

static Result run_command(const Command *command, bool command_typed, const char *program, int argc, char **argv) {
    Options *options = NULL;
    Result result = options_create(command->id, &options);
    if (result != RESULT_OK)
        return result;
    options_name_program(options, program);
    result = options_read_arguments(options, argc, argv);
    if (result != RESULT_OK)
        goto end;
    if (options_flag(options, OPTION_HELP)) {
        command_typed ? help_print_command(command) : help_print_program();
    } else if (options_flag(options, OPTION_VERSION)) {
        help_print_version();
    } else if ((result = check_positionals(command, options, command_typed)) == RESULT_OK &&
               (result = read_surroundings(options)) == RESULT_OK) {
        set_log_level(options);
        result = command->run(options);
    }
end:
    options_destroy(&options);
    return result;
}

// The subcommand's name, wherever it stands among leading options, moves to the front.
static const Command *take_command(int argc, char **argv) {
    int place = options_count_leading(argc, argv);
    const Command *command = place < argc ? command_find(argv[place]) : NULL;
    if (!command)
        return NULL;
    char *name = argv[place];
    memmove(argv + 1, argv, (size_t)place * sizeof *argv);
    argv[0] = name;
    return command;
}

int main(int argc, char **argv) {
    int count = argc > 1 ? argc - 1 : 0;
    const Command *command = take_command(count, argv + 1);
    bool typed = command != NULL;
    if (!typed)
        command = command_find("fly");
    const char *program = argc > 0 && argv[0][0] ? argv[0] : "overfly";
    Result result = run_command(command, typed, program, count - typed, argv + 1 + typed);
    return result == RESULT_OK ? 0 : result == RESULT_USAGE ? 2 : 1;
}
