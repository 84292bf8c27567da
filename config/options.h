// config/options.h: typed, range-checked options from the command line, the environment, the user's file and defaults.
// Units per type below; flags and choices are integers.
// An Options owns its texts; what it hands out lives until options_destroy. One thread at a time may change it.
#pragma once
#include "base/base.h"

// Which subcommands take an option: a set of these bits.
typedef enum CommandId {
    COMMAND_FLY = 1 << 0,
    COMMAND_SNAPSHOT = 1 << 1,
    COMMAND_MESH = 1 << 2,
    COMMAND_BENCH = 1 << 3,
    COMMAND_INFO = 1 << 4,
    COMMAND_CONFIG = 1 << 5,
    COMMAND_REPRODUCE = 1 << 6,
    COMMAND_CONVERT = 1 << 7,
    COMMAND_REPLAY = 1 << 8,
    COMMAND_DEVICES = 1 << 9,
    COMMAND_DEMO = 1 << 10,
    COMMAND_AIRCRAFT = 1 << 11,
    COMMANDS_ALL = (1 << 12) - 1,
} CommandId;

#include "config/option_table.h"

typedef enum OptionType {
    OPTION_TYPE_FLAG, // --name and --no-name; true, false, yes, no, on, off, 1, 0
    OPTION_TYPE_INTEGER,
    OPTION_TYPE_NUMBER,
    OPTION_TYPE_LENGTH, // metres
    OPTION_TYPE_SPEED,  // metres a second
    OPTION_TYPE_ANGLE,  // degrees
    OPTION_TYPE_BYTES,  // bytes; K, M, G are powers of 1024
    OPTION_TYPE_CHOICE, // integer: the index among the choices; of one that ends with ":N" the number as well
    OPTION_TYPE_TEXT,
    OPTION_TYPE_PATH,
    OPTION_TYPE_POSITION,  // latitude, longitude in degrees, altitude in metres
    OPTION_TYPE_DIRECTION, // heading, pitch in degrees
    OPTION_TYPE_SIZE,      // width, height in pixels
    OPTION_TYPE_BOUNDS,    // west, south, east, north in degrees
} OptionType;

typedef enum OptionId {
#define OPTION_ENUM(id, ...) OPTION_##id,
    OPTION_TABLE(OPTION_ENUM)
#undef OPTION_ENUM
        OPTION_COUNT
} OptionId;

// One row of the table.
typedef struct OptionSpec {
    const char *name;
    char letter; // 0: none
    OptionType type;
    const char *argument;     // in help; NULL: the type says
    const char *default_text; // NULL: unset
    double least, greatest;
    const char *choices; // separated by '|'
    unsigned commands;
    const char *help;
} OptionSpec;
const OptionSpec *option_spec(OptionId id);
// "OVERFLY_PATCH_SIDE"; at most 63 characters.
void option_environment_name(OptionId id, char out[64]);

typedef enum OptionSource {
    SOURCE_UNSET,
    SOURCE_DEFAULT,
    SOURCE_FILE,
    SOURCE_ENVIRONMENT,
    SOURCE_COMMAND_LINE
} OptionSource;
const char *option_source_name(OptionSource source); // "command line"

typedef struct Options Options;

// All defaults set.
MUST_USE Result options_create(CommandId command, Options **out);
void options_destroy(Options **options);

// How the program was called, for commands that people are told; borrowed. "overfly" if never named.
void options_name_program(Options *options, const char *program);
const char *options_program(const Options *options);

// Sets an option from its text. A source of lower precedence than the present one changes nothing, but is checked all
// the same. `where` names the place for messages ("--tau", "OVERFLY_TAU", "overfly.conf:12: tau") and is kept. USAGE:
// the value is not of the type or outside the range; the message says what was expected.
MUST_USE Result options_set(Options *options, OptionId id, const char *text, OptionSource source, const char *where);

// Reads a text as the option's value, without setting it. `numbers`: as options_numbers would give them. USAGE: it is
// none; nothing is said.
MUST_USE Result option_parse(OptionId id, const char *text, double numbers[4]);

// How many of the arguments come before the first that is neither an option of any subcommand nor the value of one: the
// subcommand's place, if there is one. Says nothing about what is wrong.
int options_count_leading(int argc, char *const *argv);
// Reads the command line after the subcommand's name. USAGE with the nearest valid name.
MUST_USE Result options_read_arguments(Options *options, int argc, char *const *argv);
// Reads OVERFLY_* from `environment` ("NAME=value", NULL at the end); unknown OVERFLY_* names are a warning.
MUST_USE Result options_read_environment(Options *options, char *const *environment);
// Reads an INI file: `name = value`, for all subcommands or under [subcommand]. NOT_FOUND says nothing; USAGE names
// file, line and what was expected.
MUST_USE Result options_read_file(Options *options, const char *path);

CommandId options_command(const Options *options);
int options_positional_count(const Options *options);
const char *const *options_positionals(const Options *options);
// Where the values came from: the source and its place, "" for defaults.
OptionSource options_source(const Options *options, OptionId id);
const char *options_where(const Options *options, OptionId id);
bool options_is_set(const Options *options, OptionId id);   // by anyone, defaults included
bool options_is_given(const Options *options, OptionId id); // by file, environment or command line

// Values. Asking for another type than the table's is a programmer's mistake.
bool options_flag(const Options *options, OptionId id);
int64_t options_integer(const Options *options, OptionId id); // INTEGER, BYTES
int options_choice(const Options *options, OptionId id);
// The N of "total:N", a power of two in the row's range; 0 for a choice without.
int options_choice_number(const Options *options, OptionId id);
double options_number(const Options *options, OptionId id); // NUMBER, LENGTH, SPEED, ANGLE
// POSITION 3, DIRECTION 2, SIZE 2, BOUNDS 4 numbers.
const double *options_numbers(const Options *options, OptionId id);
// The text as it was given, any type; NULL when unset.
const char *options_text(const Options *options, OptionId id);

// The row of that name that `command` takes, else any row of that name, else -1.
int option_find(const char *name, CommandId command);
// The nearest name that `command` takes, or NULL when none is near.
const char *option_nearest(const char *name, CommandId command);
