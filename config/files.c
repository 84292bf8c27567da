#define _POSIX_C_SOURCE 200809L
#include "config/files.h"

#include "base/log.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define NAME_BYTES 64 // left for the names of files in a folder

static bool fits(int printed) {
    return printed > 0 && printed < PATHS_BYTES_MAX;
}

static bool user_file(const char *variable, const char *beside_home, const char *name, char out[PATHS_BYTES_MAX]) {
    const char *folder = getenv(variable), *home = getenv("HOME");
    if (folder && folder[0] == '/') // the XDG specification: a relative one is ignored
        return fits(snprintf(out, PATHS_BYTES_MAX, "%s/overfly/%s", folder, name));
    return home && *home && fits(snprintf(out, PATHS_BYTES_MAX, "%s/%s/overfly/%s", home, beside_home, name));
}

bool files_user_config(char out[PATHS_BYTES_MAX]) {
    return files_user_config_of("overfly.conf", out);
}

bool files_user_config_of(const char *name, char out[PATHS_BYTES_MAX]) {
    return user_file("XDG_CONFIG_HOME", ".config", name, out);
}

bool files_user_state(const char *name, char out[PATHS_BYTES_MAX]) {
    return user_file("XDG_STATE_HOME", ".local/state", name, out);
}

bool files_exists(const char *path) {
    struct stat status;
    return stat(path, &status) == 0;
}

bool files_is_folder(const char *path) {
    struct stat status;
    return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

bool files_are_same(const char *a, const char *b) {
    struct stat first, second;
    return stat(a, &first) == 0 && stat(b, &second) == 0 && first.st_dev == second.st_dev &&
           first.st_ino == second.st_ino;
}

Result files_check_readable(const char *path) {
    if (access(path, R_OK) == 0)
        return RESULT_OK;
    int cause = errno;
    log_error("%s: %s; %s", path, strerror(cause), cause == EACCES ? "make it readable" : "check the path");
    return cause == ENOENT || cause == ENOTDIR ? RESULT_NOT_FOUND : RESULT_IO;
}

static bool is_file(const char *path) {
    return files_exists(path) && !files_is_folder(path);
}

static Result refuse_file(const char *path) {
    log_error("%s: is a file, not a folder; name another one", path);
    return RESULT_IO;
}

// One is made: rights alone do not tell, of a read-only disk or for root.
Result files_check_folder(const char *path) {
    char probe[PATHS_BYTES_MAX];
    if (is_file(path))
        return refuse_file(path);
    if (!files_is_folder(path)) {
        log_error("%s: not a folder; expected one that is there: mkdir -p '%s'", path, path);
        return RESULT_NOT_FOUND;
    }
    errno = ENAMETOOLONG;
    int printed = snprintf(probe, sizeof probe, "%s/.overfly-%ld", path, (long)getpid());
    FILE *file = printed > 0 && printed < (int)sizeof probe - NAME_BYTES ? fopen(probe, "w") : NULL;
    if (!file) {
        log_error("%s: no file can be made in it: %s; name another folder", path, strerror(errno));
        return RESULT_IO;
    }
    fclose(file);
    unlink(probe);
    return RESULT_OK;
}

Result files_check_folder_of(const char *file) {
    char folder[PATHS_BYTES_MAX];
    const char *slash = strrchr(file, '/');
    int length = slash == file ? 1 : slash ? (int)(slash - file) : 0; // of "/x", x's folder is "/"
    if (!fits(snprintf(folder, sizeof folder, "%.*s", slash ? length : 1, slash ? file : "."))) {
        log_error("%s: too long; name a file of a shorter path", file);
        return RESULT_RANGE;
    }
    return files_check_folder(folder);
}

Result files_check_writable(const char *path) {
    if (!files_exists(path))
        return files_check_folder_of(path);
    bool folder = files_is_folder(path);
    if (!folder && access(path, W_OK) == 0)
        return RESULT_OK;
    log_error("%s: cannot be written: %s; name another file", path, folder ? "a folder" : strerror(errno));
    return RESULT_IO;
}

Result files_make_folder(const char *path) {
    char part[PATHS_BYTES_MAX];
    if (!fits(snprintf(part, sizeof part, "%s", path)))
        return RESULT_RANGE;
    for (char *slash = strchr(part + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        mkdir(part, 0777); // one that exists is fine; the last one tells
        *slash = '/';
    }
    int cause = mkdir(part, 0777) == 0 ? 0 : errno; // of asking what is there, another one would come
    if (cause == 0 || files_is_folder(part))
        return RESULT_OK;
    if (is_file(part))
        return refuse_file(path);
    log_error("%s: the folder cannot be made: %s", path, strerror(cause));
    return RESULT_IO;
}

Result files_beside(const char *file, const char *name, char out[PATHS_BYTES_MAX]) {
    const char *slash = strrchr(file, '/');
    int printed = name[0] == '/' || !slash ? snprintf(out, PATHS_BYTES_MAX, "%s", name)
                                           : snprintf(out, PATHS_BYTES_MAX, "%.*s/%s", (int)(slash - file), file, name);
    return fits(printed) ? RESULT_OK : RESULT_RANGE;
}

void files_pictures_folder(char out[PATHS_BYTES_MAX]) {
    const char *pictures = getenv("XDG_PICTURES_DIR"), *home = getenv("HOME");
    if (pictures && fits(snprintf(out, PATHS_BYTES_MAX, "%s", pictures)) && files_is_folder(out))
        return;
    if (home && fits(snprintf(out, PATHS_BYTES_MAX, "%s/Pictures", home)) && files_is_folder(out))
        return;
    strcpy(out, ".");
}
