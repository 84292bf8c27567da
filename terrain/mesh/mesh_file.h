// terrain/mesh/mesh_file.h: a file that appears whole or not at all, written in little-endian pieces.
// Bytes.
// A MeshFile owns its stream; it ends with mesh_file_commit or mesh_file_abandon. One thread.
#pragma once
#include "base/base.h"

#include <stdio.h>

typedef struct MeshFile MeshFile;

// Opens a file beside `path`. What is not a regular file (a device, a pipe) is written in place. IO, MEMORY; logged.
MUST_USE Result mesh_file_create(const char *path, MeshFile **out);
// Errors of these are kept, and reported by mesh_file_commit.
void mesh_file_bytes(MeshFile *file, const void *bytes, size_t count);
void mesh_file_text(MeshFile *file, const char *format, ...) PRINTF_LIKE(2, 3);
void mesh_file_u8(MeshFile *file, uint8_t value);
void mesh_file_u32(MeshFile *file, uint32_t value);
void mesh_file_float(MeshFile *file, float value);
void mesh_file_double(MeshFile *file, double value);

// For who writes with stdio; what fails there is reported as well.
FILE *mesh_file_stream(MeshFile *file);

// Closes it and gives it its name. IO: one message names the file and the cause, and the file of that name, if there
// was one, is as before.
MUST_USE Result mesh_file_commit(MeshFile **file);
void mesh_file_abandon(MeshFile **file);

// A whole file of `count` bytes. As mesh_file_create and mesh_file_commit.
MUST_USE Result mesh_file_write(const char *path, const void *bytes, size_t count);
