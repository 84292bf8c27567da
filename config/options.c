#define _POSIX_C_SOURCE 200809L
#include "config/options.h"

#include "base/log.h"
#include "config/options_internal.h"
#include "config/quantity.h"
#include "config/suggest.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const OptionSpec specs[OPTION_COUNT] = {
#define OPTION_ROW(id, name, letter, type, argument, text, least, greatest, choices, commands, help)                   \
    [OPTION_##id] = {name, letter, OPTION_TYPE_##type, argument, text, least, greatest, choices, commands, help},
    OPTION_TABLE(OPTION_ROW)
#undef OPTION_ROW
};

// What a type is read as.
typedef struct TypeRow {
    int count; // numbers, or 0: not a number
    QuantityKind kinds[4];
    double least[4], greatest[4];
    const char *expected;
} TypeRow;

static const TypeRow types[] = {
    [OPTION_TYPE_FLAG] = {0, {0}, {0}, {0}, "yes or no"},
    [OPTION_TYPE_INTEGER] = {1, {QUANTITY_PLAIN}, {-9e15}, {9e15}, "a whole number"},
    [OPTION_TYPE_NUMBER] = {1, {QUANTITY_PLAIN}, {-1e300}, {1e300}, "a number"},
    [OPTION_TYPE_LENGTH] = {1, {QUANTITY_LENGTH}, {-1e9}, {1e9}, "a length such as 30, 30m or 100ft"},
    [OPTION_TYPE_SPEED] = {1, {QUANTITY_SPEED}, {-1e9}, {1e9}, "a speed such as 80, 80m/s or 160kt"},
    [OPTION_TYPE_ANGLE] = {1, {QUANTITY_ANGLE}, {-1e6}, {1e6}, "an angle in degrees"},
    [OPTION_TYPE_BYTES] = {1, {QUANTITY_BYTES}, {0}, {9e15}, "an amount of memory such as 512M or 2G"},
    [OPTION_TYPE_CHOICE] = {0, {0}, {0}, {0}, ""},
    [OPTION_TYPE_TEXT] = {0, {0}, {0}, {0}, "a text"},
    [OPTION_TYPE_PATH] = {0, {0}, {0}, {0}, "a file name"},
    [OPTION_TYPE_POSITION] = {3,
                              {QUANTITY_ANGLE, QUANTITY_ANGLE, QUANTITY_LENGTH},
                              {-90, -540, -20000},
                              {90, 540, 1e9},
                              "LATITUDE,LONGITUDE,ALTITUDE such as 36.58,-84.2,1500m (latitude -90 to 90, longitude "
                              "-540 to 540 degrees)"},
    [OPTION_TYPE_DIRECTION] = {2,
                               {QUANTITY_ANGLE, QUANTITY_ANGLE},
                               {-360, -90},
                               {360, 90},
                               "two angles in degrees such as 270,-10 (-360 to 360, and -90 to 90)"},
    [OPTION_TYPE_SIZE] = {2, {QUANTITY_PLAIN, QUANTITY_PLAIN}, {1, 1}, {65536, 65536}, "WIDTHxHEIGHT such as 1280x800"},
    [OPTION_TYPE_BOUNDS] = {4,
                            {QUANTITY_ANGLE, QUANTITY_ANGLE, QUANTITY_ANGLE, QUANTITY_ANGLE},
                            {-540, -90, -540, -90},
                            {540, 90, 540, 90},
                            "WEST,SOUTH,EAST,NORTH in degrees such as -84.4,36.4,-84.1,36.7"},
};

typedef struct Value {
    OptionSource source;
    char *text, *where; // owned; NULL while unset
    double numbers[4];  // flags, integers and choices in the first
} Value;

struct Options {
    CommandId command;
    const char *program;
    Value values[OPTION_COUNT];
    const char **positionals; // [positional_capacity], borrowed from argv
    int positional_count, positional_capacity;
};

const OptionSpec *option_spec(OptionId id) {
    return &specs[id];
}

const char *option_source_name(OptionSource source) {
    static const char *const names[] = {"unset", "default", "file", "environment", "command line"};
    return names[source];
}

void option_environment_name(OptionId id, char out[64]) {
    int length = snprintf(out, 64, "OVERFLY_%s", specs[id].name);
    for (int i = 0; i < length && i < 63; i++)
        out[i] = out[i] == '-' ? '_' : (char)toupper((unsigned char)out[i]);
}

const OptionCommand option_commands[OPTION_COMMANDS] = {
    {COMMAND_FLY, "fly"},
    {COMMAND_DEMO, "demo"},
    {COMMAND_REPLAY, "replay"},
    {COMMAND_SNAPSHOT, "snapshot"},
    {COMMAND_MESH, "mesh"},
    {COMMAND_BENCH, "bench"},
    {COMMAND_REPRODUCE, "reproduce"},
    {COMMAND_INFO, "info"},
    {COMMAND_CONVERT, "convert"},
    {COMMAND_DEVICES, "devices"},
    {COMMAND_AIRCRAFT, "aircraft"},
    {COMMAND_CONFIG, "config"},
};

bool option_belongs_to(OptionId id, CommandId command) {
    return command == COMMAND_CONFIG || (specs[id].commands & command);
}

int option_find(const char *name, CommandId command) {
    int found = -1;
    for (int i = 0; i < OPTION_COUNT; i++) {
        if (strcmp(specs[i].name, name) != 0)
            continue;
        if (option_belongs_to((OptionId)i, command))
            return i;
        found = i;
    }
    return found;
}

const char *option_nearest(const char *name, CommandId command) {
    const char *names[OPTION_COUNT];
    int count = 0;
    for (int i = 0; i < OPTION_COUNT; i++)
        if (option_belongs_to((OptionId)i, command))
            names[count++] = specs[i].name;
    return suggest_nearest(name, names, count);
}

static Result parse_flag(const char *text, double *out) {
    static const char *const words[] = {"false", "no", "off", "0", "true", "yes", "on", "1"};
    for (size_t i = 0; i < COUNT_OF(words); i++) {
        if (strcasecmp(text, words[i]) == 0) {
            *out = i >= 4;
            return RESULT_OK;
        }
    }
    return RESULT_USAGE;
}

// The number behind the colon of "total:8", where the choice is "total:N": a power of two in the row's range.
static Result parse_choice_number(const OptionSpec *spec, const char *text, double *out) {
    char *end;
    long number = strtol(text, &end, 10);
    bool read = *text >= '0' && *text <= '9' && *end == '\0';
    if (!read || number < (long)spec->least || number > (long)spec->greatest || (number & (number - 1)) != 0)
        return RESULT_USAGE;
    *out = (double)number;
    return RESULT_OK;
}

// The length of "total:" where the choice is "total:N" and the text begins with that; else 0.
static size_t numbered_stem(const char *choice, size_t length, const char *text) {
    bool numbered = length > 2 && strncmp(choice + length - 2, ":N", 2) == 0;
    return numbered && strncasecmp(choice, text, length - 1) == 0 ? length - 1 : 0;
}

static Result parse_choice(const OptionSpec *spec, const char *text, double *out) {
    size_t typed = strlen(text);
    int index = 0;
    for (const char *choice = spec->choices; *choice; index++) {
        size_t length = strcspn(choice, "|"), stem = numbered_stem(choice, length, text);
        out[0] = index;
        if (stem)
            return parse_choice_number(spec, text + stem, &out[1]);
        if (length == typed && strncasecmp(choice, text, length) == 0)
            return RESULT_OK;
        choice += length + (choice[length] == '|');
    }
    return RESULT_USAGE;
}

static bool is_whole(double number) {
    return number == floor(number);
}

static Result parse_size(const char *text, double *out) {
    char copy[64];
    if (strlen(text) >= sizeof copy)
        return RESULT_USAGE;
    strcpy(copy, text);
    char *cross = strpbrk(copy, "xX");
    if (!cross)
        return RESULT_USAGE;
    *cross = ',';
    Result result = quantity_parse_list(types[OPTION_TYPE_SIZE].kinds, 2, copy, out);
    return result == RESULT_OK && is_whole(out[0]) && is_whole(out[1]) ? RESULT_OK : RESULT_USAGE;
}

static bool in_range(const OptionSpec *spec, const double *numbers) {
    const TypeRow *type = &types[spec->type];
    bool own = spec->least != 0 || spec->greatest != 0;
    for (int i = 0; i < type->count; i++) {
        if (numbers[i] < type->least[i] || numbers[i] > type->greatest[i])
            return false;
        if (own && (numbers[i] < spec->least || numbers[i] > spec->greatest))
            return false;
    }
    return spec->type != OPTION_TYPE_BOUNDS || (numbers[0] < numbers[2] && numbers[1] < numbers[3]);
}

static Result parse_numbers(const OptionSpec *spec, const char *text, double *out) {
    const TypeRow *type = &types[spec->type];
    Result result = spec->type == OPTION_TYPE_SIZE ? parse_size(text, out)
                                                   : quantity_parse_list(type->kinds, type->count, text, out);
    if (result != RESULT_OK || !in_range(spec, out))
        return RESULT_USAGE;
    bool whole = spec->type == OPTION_TYPE_INTEGER || spec->type == OPTION_TYPE_BYTES;
    return whole && !is_whole(out[0]) ? RESULT_USAGE : RESULT_OK;
}

static Result parse_value(const OptionSpec *spec, const char *text, double *out) {
    switch (spec->type) {
    case OPTION_TYPE_FLAG:
        return parse_flag(text, out);
    case OPTION_TYPE_CHOICE:
        return parse_choice(spec, text, out);
    case OPTION_TYPE_TEXT:
    case OPTION_TYPE_PATH:
        return *text ? RESULT_OK : RESULT_USAGE;
    default:
        return parse_numbers(spec, text, out);
    }
}

void option_describe_expected(const OptionSpec *spec, char *out, size_t size) {
    if (spec->type == OPTION_TYPE_CHOICE) {
        size_t used = (size_t)snprintf(out, size, "one of ");
        for (const char *c = spec->choices; *c && used + 4 < size; c++)
            used += (size_t)snprintf(out + used, size - used, *c == '|' ? ", " : "%c", *c);
        if (spec->greatest > 0.0 && used < size)
            snprintf(out + used, size - used, " with N a power of two from %g to %g", spec->least, spec->greatest);
        return;
    }
    bool seconds = spec->argument && strcmp(spec->argument, "S") == 0;
    const char *expected = seconds ? "a number of seconds" : types[spec->type].expected;
    if (spec->least != 0 || spec->greatest != 0)
        snprintf(out, size, "%s, from %.12g to %.12g", expected, spec->least, spec->greatest);
    else
        snprintf(out, size, "%s", expected);
}

// NULL where none is near, or where only the number is wrong, whose range has been told.
static const char *nearest_choice(const OptionSpec *spec, const char *text, char *buffer, size_t size) {
    const char *names[16];
    int count = 0;
    snprintf(buffer, size, "%s", spec->choices);
    for (char *rest = buffer; rest && count < (int)COUNT_OF(names);) {
        names[count++] = rest;
        rest = strchr(rest, '|');
        if (rest)
            *rest++ = '\0';
        if (numbered_stem(names[count - 1], strlen(names[count - 1]), text))
            return NULL;
    }
    return suggest_nearest(text, names, count);
}

static void report_value(const OptionSpec *spec, const char *text, const char *where) {
    char expected[320], choices[160];
    option_describe_expected(spec, expected, sizeof expected);
    const char *nearest = spec->type == OPTION_TYPE_CHOICE ? nearest_choice(spec, text, choices, sizeof choices) : NULL;
    if (nearest)
        log_error("%s: expected %s; found '%s'; did you mean '%s'?", where, expected, text, nearest);
    else
        log_error("%s: expected %s; found '%s'", where, expected, text);
}

static Result store(Value *value, const char *text, const char *where, OptionSource source, const double numbers[4]) {
    char *new_text = strdup(text), *new_where = strdup(where);
    if (!new_text || !new_where) {
        free(new_text);
        free(new_where);
        return RESULT_MEMORY;
    }
    free(value->text);
    free(value->where);
    *value = (Value){.source = source, .text = new_text, .where = new_where};
    memcpy(value->numbers, numbers, sizeof value->numbers);
    return RESULT_OK;
}

Result option_parse(OptionId id, const char *text, double numbers[4]) {
    return parse_value(&specs[id], text, numbers);
}

Result option_check(OptionId id, const char *text, const char *where, double numbers[4]) {
    Result result = parse_value(&specs[id], text, numbers);
    if (result != RESULT_OK)
        report_value(&specs[id], text, where);
    return result;
}

Result options_set(Options *options, OptionId id, const char *text, OptionSource source, const char *where) {
    double numbers[4] = {0};
    Result result = option_check(id, text, where, numbers);
    if (result != RESULT_OK)
        return result;
    if (source < options->values[id].source)
        return RESULT_OK;
    return store(&options->values[id], text, where, source, numbers);
}

Result options_create(CommandId command, Options **out) {
    Options *options = calloc(1, sizeof *options);
    if (!options)
        return RESULT_MEMORY;
    options->command = command;
    options->program = "overfly";
    for (int i = 0; i < OPTION_COUNT; i++) {
        if (!specs[i].default_text)
            continue;
        Result result = options_set(options, (OptionId)i, specs[i].default_text, SOURCE_DEFAULT, "");
        if (result != RESULT_OK) {
            options_destroy(&options);
            return result;
        }
    }
    *out = options;
    return RESULT_OK;
}

void options_destroy(Options **options) {
    if (!*options)
        return;
    for (int i = 0; i < OPTION_COUNT; i++) {
        free((*options)->values[i].text);
        free((*options)->values[i].where);
    }
    free((*options)->positionals);
    free(*options);
    *options = NULL;
}

Result options_add_positional(Options *options, const char *text) {
    if (options->positional_count == options->positional_capacity) {
        int capacity = options->positional_capacity * 2 + 8;
        const char **grown = realloc(options->positionals, sizeof *grown * (size_t)capacity);
        if (!grown)
            return RESULT_MEMORY;
        options->positionals = grown;
        options->positional_capacity = capacity;
    }
    options->positionals[options->positional_count++] = text;
    return RESULT_OK;
}

void options_name_program(Options *options, const char *program) {
    options->program = program;
}

const char *options_program(const Options *options) {
    return options->program;
}

CommandId options_command(const Options *options) {
    return options->command;
}

int options_positional_count(const Options *options) {
    return options->positional_count;
}

const char *const *options_positionals(const Options *options) {
    return options->positionals;
}

OptionSource options_source(const Options *options, OptionId id) {
    return options->values[id].source;
}

const char *options_where(const Options *options, OptionId id) {
    return options->values[id].where ? options->values[id].where : "";
}

bool options_is_set(const Options *options, OptionId id) {
    return options->values[id].source != SOURCE_UNSET;
}

bool options_is_given(const Options *options, OptionId id) {
    return options->values[id].source > SOURCE_DEFAULT;
}

bool options_flag(const Options *options, OptionId id) {
    return options->values[id].numbers[0] != 0;
}

int64_t options_integer(const Options *options, OptionId id) {
    return (int64_t)options->values[id].numbers[0];
}

int options_choice(const Options *options, OptionId id) {
    return (int)options->values[id].numbers[0];
}

int options_choice_number(const Options *options, OptionId id) {
    return (int)options->values[id].numbers[1];
}

double options_number(const Options *options, OptionId id) {
    return options->values[id].numbers[0];
}

const double *options_numbers(const Options *options, OptionId id) {
    return options->values[id].numbers;
}

const char *options_text(const Options *options, OptionId id) {
    return options->values[id].text;
}
