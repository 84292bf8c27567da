#define _POSIX_C_SOURCE 200809L
#include "base/paths.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/log.h"

// From CMake: PATHS_DATA_PREFIX and PATHS_MODULE_PREFIX, absolute; PATHS_DATA_FROM_BIN and PATHS_MODULE_FROM_BIN,
// from the folder of the installed executable.

#define PLACES_MAX 4

// Folders to look in, best first; `count` of them are valid.
typedef struct Places {
    char folder[PLACES_MAX][PATHS_BYTES_MAX];
    int count;
} Places;

static bool fits(int printed) {
    return printed >= 0 && printed < PATHS_BYTES_MAX;
}

static void add_place(Places *places, const char *base, const char *folder) {
    char *slot = places->folder[places->count];
    if (!fits(snprintf(slot, PATHS_BYTES_MAX, "%s%s", base, folder)))
        return;
    for (int i = 0; i < places->count; i++)
        if (strcmp(places->folder[i], slot) == 0)
            return;
    places->count++;
}

// The folder of the running executable with a trailing '/', or false where /proc is missing.
static bool executable_folder(char out[PATHS_BYTES_MAX]) {
    ssize_t length = readlink("/proc/self/exe", out, PATHS_BYTES_MAX - 1);
    if (length <= 0 || length >= PATHS_BYTES_MAX - 1)
        return false;
    out[length] = '\0';
    char *slash = strrchr(out, '/');
    if (!slash)
        return false;
    slash[1] = '\0';
    return true;
}

// Where a chosen folder is named by the environment, it alone. Else: in the build tree the program lies beside `folder`
// and the tests one folder below.
static void collect_places(Places *places, const char *variable, const char *folder, const char *from_bin,
                           const char *prefix) {
    const char *chosen = getenv(variable);
    if (chosen && *chosen) {
        add_place(places, chosen, "");
        return;
    }
    char executable[PATHS_BYTES_MAX];
    if (executable_folder(executable)) {
        char parent[PATHS_BYTES_MAX + 3];
        snprintf(parent, sizeof parent, "%s../", executable);
        add_place(places, executable, folder);
        add_place(places, parent, folder);
        add_place(places, executable, from_bin);
    }
    add_place(places, prefix, "");
}

static bool find_in(const Places *places, const char *relative, char out[PATHS_BYTES_MAX]) {
    for (int i = 0; i < places->count; i++)
        if (fits(snprintf(out, PATHS_BYTES_MAX, "%s/%s", places->folder[i], relative)) && access(out, R_OK) == 0)
            return true;
    return false;
}

static Result find_or_log(const Places *places, const char *relative, const char *variable, char out[PATHS_BYTES_MAX]) {
    if (find_in(places, relative, out))
        return RESULT_OK;
    char looked[PLACES_MAX * (PATHS_BYTES_MAX + 2)] = "";
    size_t used = 0;
    for (int i = 0; i < places->count; i++)
        used += (size_t)snprintf(looked + used, sizeof looked - used, "%s%s", i ? ", " : "", places->folder[i]);
    log_error("%s: not found in %s; install overfly again, or set %s to the folder that holds it", relative, looked,
              variable);
    return RESULT_NOT_FOUND;
}

Result paths_find_data(const char *relative, char out[PATHS_BYTES_MAX]) {
    Places places = {.count = 0};
    collect_places(&places, "OVERFLY_DATA_DIR", "share/overfly", PATHS_DATA_FROM_BIN, PATHS_DATA_PREFIX);
    return find_or_log(&places, relative, "OVERFLY_DATA_DIR", out);
}

Result paths_find_module(const char *file_name, char out[PATHS_BYTES_MAX]) {
    Places places = {.count = 0};
    collect_places(&places, "OVERFLY_MODULE_DIR", "lib/overfly", PATHS_MODULE_FROM_BIN, PATHS_MODULE_PREFIX);
    return find_or_log(&places, file_name, "OVERFLY_MODULE_DIR", out);
}
