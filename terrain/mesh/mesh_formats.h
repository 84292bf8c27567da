// terrain/mesh/mesh_formats.h: one function per file format, between mesh_write and the file.
// As terrain/mesh/mesh.h.
// The file is borrowed; the caller commits or abandons it.
#pragma once
#include "terrain/mesh/mesh.h"
#include "terrain/mesh/mesh_file.h"

MUST_USE Result mesh_put_ply(const Mesh *mesh, MeshFile *file);
MUST_USE Result mesh_put_obj(const Mesh *mesh, MeshFile *file);
MUST_USE Result mesh_put_glb(const Mesh *mesh, MeshFile *file);
