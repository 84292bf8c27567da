// base/paths.h: where the program's own data and modules lie.
// File system paths, UTF-8, '/' between parts.
// The caller owns every buffer. Any thread, as long as none changes the environment.
#pragma once
#include "base/base.h"

#define PATHS_BYTES_MAX 4096 // a buffer of this size holds every path that is given back

// The data file or folder `relative` ("shaders/terrain.vert", "scenes/jacksboro.scene") that the program brought
// along. Looked for in this order: $OVERFLY_DATA_DIR; share/overfly beside the executable (the build tree);
// ../share/overfly from the executable (an installation that was moved); the prefix it was built for. Where
// OVERFLY_DATA_DIR is set, only that is looked at. NOT_FOUND, with the places looked at in the log.
MUST_USE Result paths_find_data(const char *relative, char out[PATHS_BYTES_MAX]);

// The loadable module `file_name` ("overfly_image.so"), by the same rule: $OVERFLY_MODULE_DIR, lib/overfly. Programs of
// others that link the terrain library lie elsewhere: for them the prefix it was built for counts, or the variable.
MUST_USE Result paths_find_module(const char *file_name, char out[PATHS_BYTES_MAX]);
