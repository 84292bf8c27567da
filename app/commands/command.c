#include "app/commands/command.h"

#include <stddef.h>
#include <string.h>

const Command command_table[] = {
    {COMMAND_FLY, "fly", "[SCENE|DEM]...", -1, "fly over a terrain, in a window or without one", cmd_fly},
    {COMMAND_DEMO, "demo", "list|NAME|FILE [SCENE|DEM]...", -1, "fly a demonstration, also on a stand", cmd_demo},
    {COMMAND_REPLAY, "replay", "TRACK [SCENE|DEM]...", -1, "fly a recorded flight again, or film it", cmd_replay},
    {COMMAND_SNAPSHOT, "snapshot", "[SCENE|DEM]...", -1, "one picture, without a window", cmd_snapshot},
    {COMMAND_MESH, "mesh", "[SCENE|DEM]...", -1, "measure the triangles for one view, and write them to a file",
     cmd_mesh},
    {COMMAND_BENCH, "bench", "[preprocess|refine|partitions|governor|panel] [SCENE|DEM]...", -1,
     "show what accuracy costs in time; or time one part", cmd_bench},
    {COMMAND_REPRODUCE, "reproduce", "loeffler|biedermann|yalcin|ye [SCENE|DEM]...", -1,
     "run a paper's experiment, and show its figures beside ours", cmd_reproduce},
    {COMMAND_INFO, "info", "DEM...", -1, "what is in elevation files: size, spacing, datum, bounds, range, voids",
     cmd_info},
    {COMMAND_CONVERT, "convert", "IN OUT [SCENE|DEM]...", -1,
     "turn a recorded flight into another format: IGC, GPX, KML, ACMI, CSV", cmd_convert},
    {COMMAND_DEVICES, "devices", "", 0, "joysticks and gamepads: their nodes, permissions, and what they say",
     cmd_devices},
    {COMMAND_AIRCRAFT, "aircraft", "[NAME|FILE]...", -1,
     "list the aircraft; of those named, set the simulation against theory and what is published", cmd_aircraft},
    {COMMAND_CONFIG, "config", "[SUBCOMMAND]", 1, "show the effective options and where each came from", cmd_config},
    {0},
};

const Command *command_find(const char *name) {
    for (const Command *command = command_table; command->name; command++)
        if (strcmp(command->name, name) == 0)
            return command;
    return NULL;
}
