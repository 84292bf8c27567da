#define _POSIX_C_SOURCE 200809L
#include "config/named_files.h"

#include "base/log.h"
#include "config/files.h"
#include "config/suggest.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LIST_BYTES 1024 // of the names in a message

// ---- listing ----

static int by_name(const void *a, const void *b) {
    return strcmp(a, b);
}

// Bytes of the name without its ending; 0: of another kind.
static size_t name_bytes(const NamedFileKind *kind, const char *file) {
    size_t length = strlen(file), ending = strlen(kind->ending);
    bool is_one = file[0] != '.' && length > ending && strcmp(file + length - ending, kind->ending) == 0;
    return is_one ? length - ending : 0;
}

static void collect(const NamedFileKind *kind, const char *folder, DIR *directory, NamedFiles *out) {
    for (const struct dirent *file; (file = readdir(directory));) {
        size_t bytes = name_bytes(kind, file->d_name);
        if (bytes > 0 && out->count == NAMED_FILES_MAX) {
            log_warn("%s: more than %d files (%s); the others are left out", folder, NAMED_FILES_MAX, kind->ending);
            return;
        }
        if (bytes > 0)
            snprintf(out->names[out->count++], NAMED_FILES_BYTES, "%.*s", (int)bytes, file->d_name);
    }
}

Result named_files_list(const NamedFileKind *kind, const char *folder, NamedFiles *out) {
    DIR *directory = opendir(folder);
    out->count = 0;
    if (!directory) {
        log_error("%s: the folder cannot be read: %s", folder, strerror(errno));
        return RESULT_IO;
    }
    collect(kind, folder, directory, out);
    closedir(directory);
    qsort(out->names, (size_t)out->count, sizeof out->names[0], by_name);
    return RESULT_OK;
}

Result named_files_of_program(const NamedFileKind *kind, NamedFiles *out) {
    char folder[PATHS_BYTES_MAX];
    Result result = paths_find_data(kind->folder, folder);
    return result == RESULT_OK ? named_files_list(kind, folder, out) : result;
}

// ---- finding ----

static bool is_file(const NamedFileKind *kind, const char *name) {
    return strchr(name, '/') || strstr(name, kind->ending) || (files_exists(name) && !files_is_folder(name));
}

static Result refuse(const NamedFileKind *kind, const char *where, const char *name, const NamedFiles *files) {
    const char *names[NAMED_FILES_MAX];
    char all[LIST_BYTES] = "", question[SUGGEST_BYTES];
    for (int i = 0; i < files->count; i++) {
        size_t used = strlen(all);
        names[i] = files->names[i];
        snprintf(all + used, sizeof all - used, "%s%s", i ? ", " : "", names[i]);
    }
    if (is_file(kind, name))
        log_error("%s: there is no file '%s'; expected the file of %s (%s), or one of %s", where, name, kind->what,
                  kind->ending, all);
    else
        log_error("%s: expected the file of %s (%s), or one of %s; found '%s'%s", where, kind->what, kind->ending, all,
                  name, suggest_question(name, names, files->count, question));
    return RESULT_NOT_FOUND;
}

static Result print_path(const char *where, const char *folder, const char *name, const char *ending,
                         char path[PATHS_BYTES_MAX]) {
    if (snprintf(path, PATHS_BYTES_MAX, "%s%s%s%s", folder, *folder ? "/" : "", name, ending) < PATHS_BYTES_MAX)
        return RESULT_OK;
    log_error("%s: '%.60s...' is too long a path; name a file of a shorter one", where, name);
    return RESULT_RANGE;
}

Result named_files_find(const NamedFileKind *kind, const char *where, const char *name, char path[PATHS_BYTES_MAX]) {
    NamedFiles files;
    char folder[PATHS_BYTES_MAX];
    bool named = !is_file(kind, name);
    if (!named && files_exists(name))
        return print_path(where, "", name, "", path);
    Result result = paths_find_data(kind->folder, folder);
    if (result == RESULT_OK)
        result = named_files_list(kind, folder, &files);
    for (int i = 0; result == RESULT_OK && named && i < files.count; i++)
        if (strcmp(files.names[i], name) == 0)
            return print_path(where, folder, name, kind->ending, path);
    return result == RESULT_OK ? refuse(kind, where, name, &files) : result;
}
