// app/commands/command.h: the subcommands.
// No units.
// Static tables; a command borrows its Options.
#pragma once
#include "config/options.h"

// Exit status of the program: RESULT_OK 0, RESULT_USAGE 2, everything else 1. Who detects an error has logged it;
// the caller adds nothing.
typedef Result CommandRun(const Options *options);

typedef struct Command {
    CommandId id;
    const char *name;
    const char *positionals; // in help: "[SCENE|DEM]..."
    int positional_max;      // -1: any number
    const char *summary;     // one line, no full stop
    CommandRun *run;
} Command;

// In the order of help; ends with a row without a name.
extern const Command command_table[];
const Command *command_find(const char *name); // NULL: no such subcommand

CommandRun cmd_fly;
CommandRun cmd_demo;
CommandRun cmd_replay;
CommandRun cmd_snapshot;
CommandRun cmd_mesh;
CommandRun cmd_bench;
CommandRun cmd_reproduce;
CommandRun cmd_info;
CommandRun cmd_convert;
CommandRun cmd_devices;
CommandRun cmd_aircraft;
CommandRun cmd_config;
