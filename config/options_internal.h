// config/options_internal.h: what the parts of config/options share.
// No units.
// As config/options.h.
#pragma once
#include "config/options.h"

#define OPTION_COMMANDS 12

// The subcommands by name, in the order of help.
typedef struct OptionCommand {
    CommandId id;
    const char *name;
} OptionCommand;
extern const OptionCommand option_commands[OPTION_COMMANDS];

// Whether `command` takes the option. COMMAND_CONFIG takes all, to show them.
bool option_belongs_to(OptionId id, CommandId command);
// "a number, from 0.01 to 1000" into `out`.
void option_describe_expected(const OptionSpec *spec, char *out, size_t size);
// What options_set checks and says, without setting. `numbers`: as options_numbers gives them.
MUST_USE Result option_check(OptionId id, const char *text, const char *where, double numbers[4]);
// `text` is borrowed for the life of the Options.
MUST_USE Result options_add_positional(Options *options, const char *text);
