// terrain/mesh/mesh.h: a cut as one indexed mesh, and the files it is written to.
// ECEF metres in double; columns and rows of the DEM; local frames in metres, about the DEM's middle.
// A Mesh owns its arrays. One thread at a time.
#pragma once
#include "base/base.h"
#include "base/vec.h"
#include "terrain/lod/lod.h"
#include "terrain/terrain.h"

// East, north, up at the middle of the DEM, on the ellipsoid: local = enu_from_ecef (ecef - origin_ecef).
typedef struct MeshFrame {
    double lat_deg, lon_deg;
    Vec3d origin_ecef;
    Mat3d enu_from_ecef;
} MeshFrame;

typedef struct MeshVertex {
    Vec3d ecef;       // as drawn
    int32_t col, row; // of the DEM, unique
} MeshVertex;

typedef struct Mesh {
    MeshFrame frame;
    int64_t vertex_count, triangle_count; // each below 2^31
    MeshVertex *vertices;                 // in the order in which triangles use them first
    uint32_t *indices;                    // 3 a triangle, counter-clockwise seen from above
} Mesh;

// All triangles of the cut, in its order; a vertex that several patches draw occurs once. RANGE: more than 2^31
// triangles; MEMORY.
MUST_USE Result mesh_from_cut(const Terrain *terrain, const LodCut *cut, Mesh *out);
// The same without a Terrain.
MUST_USE Result mesh_from_cut_of(const Dem *dem, const Grid *grid, const LodCut *cut, Mesh *out);
void mesh_clear(Mesh *mesh);
Vec3d mesh_local(const MeshFrame *frame, Vec3d ecef);

// A half space: normal . (p - point) >= 0.
typedef struct MeshPlane {
    Vec3d point_ecef, normal;
} MeshPlane;
// Drops the triangles that lie wholly outside one of the planes, and the vertices that none uses. MEMORY.
MUST_USE Result mesh_cull(Mesh *mesh, const MeshPlane *planes, int plane_count);

typedef enum MeshFormat {
    MESH_PLY, // binary, little endian: double x y z (ECEF metres), double col row; one index list a face
    MESH_OBJ, // text: v, f; local metres, x east, y north, z up
    MESH_GLB, // glTF 2.0 binary: float positions and normals, x east, y up, z south; the frame in the node's extras
} MeshFormat;
// By the ending of the file's name, in any case. USAGE, with a message that names the endings.
MUST_USE Result mesh_format_of(const char *path, MeshFormat *out);

// Written beside the file first, then renamed: a file of that name is whole, or the one before. IO (the message names
// file and cause: a full disk, a missing folder), RANGE (GLB: above 4 GiB), MEMORY.
MUST_USE Result mesh_write(const Mesh *mesh, MeshFormat format, const char *path);
