// app/commands/help.h: help from the tables of subcommands and options.
// No units.
// Owns nothing.
#pragma once
#include "app/commands/command.h"

// On stdout: what the program is, its subcommands, where more help is.
void help_print_program(void);
// On stdout: one subcommand, its options with defaults, its environment variables and files.
void help_print_command(const Command *command);
void help_print_version(void);
