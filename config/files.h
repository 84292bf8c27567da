// config/files.h: small questions about files that people name.
// No units.
// The caller owns the buffers.
#pragma once
#include "base/base.h"
#include "base/paths.h"

// $XDG_CONFIG_HOME/overfly/overfly.conf, else ~/.config/overfly/overfly.conf. False when the environment names neither.
bool files_user_config(char out[PATHS_BYTES_MAX]);
// The same of another file or folder beside it.
bool files_user_config_of(const char *name, char out[PATHS_BYTES_MAX]);
// What the program keeps from run to run: $XDG_STATE_HOME/overfly/`name`, else ~/.local/state/overfly/`name`.
bool files_user_state(const char *name, char out[PATHS_BYTES_MAX]);
bool files_exists(const char *path);
bool files_is_folder(const char *path);
bool files_are_same(const char *a, const char *b); // one file, by whatever names; false where one is not there
// A file or folder that is there and may be read; else NOT_FOUND or IO, with path, cause and remedy in the log.
MUST_USE Result files_check_readable(const char *path);
// A folder that is there and in which files can be made; else NOT_FOUND or IO, with path, cause and remedy in the log.
MUST_USE Result files_check_folder(const char *path);
// The same of the folder that `file`, which need not be there, is named in. RANGE, logged: too long.
MUST_USE Result files_check_folder_of(const char *file);
// Whether a file can be written: one that is there, or else a new one in its folder. NOT_FOUND, IO, RANGE, logged.
MUST_USE Result files_check_writable(const char *path);
// Makes the folder and those above it. IO, with the cause in the log.
MUST_USE Result files_make_folder(const char *path);
// `name` relative to the folder of `file`; absolute names stay. RANGE when too long.
MUST_USE Result files_beside(const char *file, const char *name, char out[PATHS_BYTES_MAX]);
// Where screenshots go: $XDG_PICTURES_DIR, else ~/Pictures, whichever is a folder, else ".".
void files_pictures_folder(char out[PATHS_BYTES_MAX]);
