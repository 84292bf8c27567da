#include "app/outputs.h"

#include "app/replay/replay_scene.h"
#include "app/scene_load.h"
#include "base/log.h"
#include "config/files.h"

#include <stdio.h>
#include <string.h>

// A file, or those of a folder whose names begin so.
typedef struct Output {
    const char *what, *path;
    const char *const *begins; // NULL: a file
} Output;

static bool is_in_folder(const Output *output, const char *input) {
    char folder[PATHS_BYTES_MAX];
    const char *slash = strrchr(input, '/'), *name = slash ? slash + 1 : input;
    if (!files_exists(input) || files_beside(input, ".", folder) != RESULT_OK || !files_are_same(folder, output->path))
        return false;
    for (const char *const *begin = output->begins; *begin; begin++)
        if (strncmp(name, *begin, strlen(*begin)) == 0)
            return true;
    return false;
}

static Result check_input(void *user, const char *input) {
    const Output *output = user;
    if (!input || !(output->begins ? is_in_folder(output, input) : files_are_same(output->path, input)))
        return RESULT_OK;
    if (output->begins)
        log_error("%s: %s lies in the folder %s, is read, and could be written over; name another folder", output->what,
                  input, output->path);
    else
        log_error("%s: %s is a file that is read, %s; name another", output->what, output->path, input);
    return RESULT_USAGE;
}

// The flights of a benchmark, separated by commas.
static Result check_list(Output *output, const char *list) {
    Result result = RESULT_OK;
    while (result == RESULT_OK && list && *list) {
        char one[PATHS_BYTES_MAX];
        int length = (int)strcspn(list, ",");
        if (snprintf(one, sizeof one, "%.*s", length, list) < (int)sizeof one)
            result = check_input(output, one);
        list += length + (list[length] == ',');
    }
    return result;
}

static Result check_named(const Options *options, Output *output) {
    static const OptionId files[] = {OPTION_GEOID, OPTION_IMAGE, OPTION_AIRCRAFT};
    bool converts = options_command(options) == COMMAND_CONVERT; // its second word is what it writes
    Result result = RESULT_OK;
    for (int i = 0; i < options_positional_count(options) && result == RESULT_OK; i += i == 0 && converts ? 2 : 1)
        result = check_input(output, options_positionals(options)[i]);
    for (size_t i = 0; i < COUNT_OF(files) && result == RESULT_OK; i++)
        result = check_input(output, options_text(options, files[i]));
    return result == RESULT_OK ? check_list(output, options_text(options, OPTION_TRACK)) : result;
}

// A benchmark measures each scene by itself.
static Result check_scenes(const Options *options, Output *output) {
    const char *const *names = options_positionals(options);
    int count = options_positional_count(options);
    CommandId command = options_command(options);
    Result result = RESULT_OK;
    if (command == COMMAND_CONVERT || command == COMMAND_REPLAY)
        return replay_visit_files(options, names[0], check_input, output);
    if (command != COMMAND_BENCH || count == 0)
        return world_visit_files(options, check_input, output);
    for (int i = 0; i < count && result == RESULT_OK; i++)
        result = world_visit_listed(names + i, 1, check_input, output);
    return result;
}

static Result check(const Options *options, Output *output) {
    Result result = check_named(options, output);
    return result == RESULT_OK ? check_scenes(options, output) : result;
}

Result outputs_check(const Options *options, const char *what, const char *file) {
    Output output = {what, file, NULL};
    return files_exists(file) ? check(options, &output) : RESULT_OK;
}

Result outputs_check_folder(const Options *options, const char *what, const char *folder, const char *const *begins) {
    Output output = {what, folder, begins};
    return files_exists(folder) ? check(options, &output) : RESULT_OK;
}
