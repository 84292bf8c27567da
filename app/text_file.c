#define _POSIX_C_SOURCE 200809L
#include "app/text_file.h"

#include "base/log.h"
#include "terrain/mesh/mesh_file.h"

#include <stdlib.h>

static Result no_memory(const char *path) {
    log_error("%s: no memory to write it", path);
    return RESULT_MEMORY;
}

Result text_file_begin(const char *path, TextFile *out) {
    *out = (TextFile){.path = path};
    out->to = open_memstream(&out->bytes, &out->count);
    return out->to ? RESULT_OK : no_memory(path);
}

Result text_file_end(TextFile *file, Result printed) {
    bool complete = !ferror(file->to);
    complete = fclose(file->to) == 0 && complete;
    Result result = printed == RESULT_OK && !complete ? no_memory(file->path) : printed;
    if (result == RESULT_OK)
        result = mesh_file_write(file->path, file->bytes, file->count);
    free(file->bytes);
    *file = (TextFile){0};
    return result;
}
