#define _POSIX_C_SOURCE 200809L
#include "terrain/mesh/mesh_file.h"

#include "base/log.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define BUFFER_BYTES (1 << 20)

struct MeshFile {
    FILE *stream;
    char *path, *temporary; // `temporary` NULL: written in place
    int error;              // errno of the first failure
};

static void file_free(MeshFile *file) {
    free(file->path);
    free(file->temporary);
    free(file);
}

static char *temporary_name(const char *path) {
    size_t bytes = strlen(path) + 32;
    char *name = malloc(bytes);
    if (name)
        snprintf(name, bytes, "%s.part-%ld", path, (long)getpid());
    return name;
}

static bool is_written_in_place(const char *path) {
    struct stat status;
    return stat(path, &status) == 0 && !S_ISREG(status.st_mode);
}

static Result open_stream(MeshFile *file) {
    const char *name = file->temporary ? file->temporary : file->path;
    int flags = O_WRONLY | O_CLOEXEC | (file->temporary ? O_CREAT | O_TRUNC : 0);
    int descriptor = open(name, flags, 0666);
    file->stream = descriptor >= 0 ? fdopen(descriptor, "wb") : NULL;
    if (!file->stream) {
        log_error("%s: cannot be written: %s; name another file", file->path, strerror(errno));
        if (descriptor >= 0)
            close(descriptor);
        return RESULT_IO;
    }
    setvbuf(file->stream, NULL, _IOFBF, BUFFER_BYTES);
    return RESULT_OK;
}

Result mesh_file_create(const char *path, MeshFile **out) {
    MeshFile *file = calloc(1, sizeof *file);
    if (!file) {
        log_error("%s: no memory to write it", path);
        return RESULT_MEMORY;
    }
    file->path = strdup(path);
    bool in_place = is_written_in_place(path);
    file->temporary = in_place ? NULL : temporary_name(path);
    Result result = RESULT_MEMORY;
    if (file->path && (in_place || file->temporary))
        result = open_stream(file);
    else
        log_error("%s: no memory to write it", path);
    if (result != RESULT_OK) {
        file_free(file);
        return result;
    }
    *out = file;
    return RESULT_OK;
}

static void keep_error(MeshFile *file) {
    if (!file->error)
        file->error = errno ? errno : EIO;
}

void mesh_file_bytes(MeshFile *file, const void *bytes, size_t count) {
    if (!file->error && fwrite(bytes, 1, count, file->stream) != count)
        keep_error(file);
}

void mesh_file_text(MeshFile *file, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    if (!file->error && vfprintf(file->stream, format, arguments) < 0)
        keep_error(file);
    va_end(arguments);
}

static void put_little_endian(MeshFile *file, uint64_t value, size_t count) {
    unsigned char bytes[8];
    for (size_t i = 0; i < count; i++)
        bytes[i] = (unsigned char)(value >> (8 * i));
    mesh_file_bytes(file, bytes, count);
}

void mesh_file_u8(MeshFile *file, uint8_t value) {
    put_little_endian(file, value, 1);
}

void mesh_file_u32(MeshFile *file, uint32_t value) {
    put_little_endian(file, value, 4);
}

void mesh_file_float(MeshFile *file, float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_little_endian(file, bits, sizeof bits);
}

void mesh_file_double(MeshFile *file, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_little_endian(file, bits, sizeof bits);
}

FILE *mesh_file_stream(MeshFile *file) {
    return file->stream;
}

// Everything on the disk before the name points to it: a full disk may show itself only here.
static void finish_stream(MeshFile *file) {
    if (!file->error && (fflush(file->stream) || ferror(file->stream)))
        keep_error(file);
    if (!file->error && file->temporary && fsync(fileno(file->stream)))
        keep_error(file);
    if (fclose(file->stream))
        keep_error(file);
    file->stream = NULL;
    if (!file->error && file->temporary && rename(file->temporary, file->path))
        keep_error(file);
}

Result mesh_file_commit(MeshFile **file) {
    MeshFile *f = *file;
    errno = 0;
    finish_stream(f);
    Result result = f->error ? RESULT_IO : RESULT_OK;
    if (f->error) {
        log_error("%s: writing failed: %s; %s", f->path, strerror(f->error),
                  f->error == ENOSPC ? "make room, or name a file elsewhere" : "name another file");
        if (f->temporary)
            unlink(f->temporary);
    }
    file_free(f);
    *file = NULL;
    return result;
}

void mesh_file_abandon(MeshFile **file) {
    if (!*file)
        return;
    fclose((*file)->stream);
    if ((*file)->temporary)
        unlink((*file)->temporary);
    file_free(*file);
    *file = NULL;
}

Result mesh_file_write(const char *path, const void *bytes, size_t count) {
    MeshFile *file = NULL;
    Result result = mesh_file_create(path, &file);
    if (result != RESULT_OK)
        return result;
    mesh_file_bytes(file, bytes, count);
    return mesh_file_commit(&file);
}
