#include "terrain/mesh/mesh_formats.h"

#include <inttypes.h>

static void put_header(const Mesh *mesh, MeshFile *file) {
    const MeshFrame *frame = &mesh->frame;
    mesh_file_text(file,
                   "# Terrain, metres: x east, y north, z up, about the middle of the elevation model:\n"
                   "# latitude %.9f, longitude %.9f degrees, on the WGS84 ellipsoid,\n"
                   "# ECEF %.4f %.4f %.4f metres\n"
                   "# %" PRId64 " vertices, %" PRId64 " faces, counter-clockwise seen from above\n",
                   frame->lat_deg, frame->lon_deg, frame->origin_ecef.x, frame->origin_ecef.y, frame->origin_ecef.z,
                   mesh->vertex_count, mesh->triangle_count);
}

Result mesh_put_obj(const Mesh *mesh, MeshFile *file) {
    put_header(mesh, file);
    for (int64_t i = 0; i < mesh->vertex_count; i++) {
        Vec3d p = mesh_local(&mesh->frame, mesh->vertices[i].ecef);
        mesh_file_text(file, "v %.4f %.4f %.4f\n", p.x, p.y, p.z);
    }
    for (int64_t i = 0; i < 3 * mesh->triangle_count; i += 3)
        mesh_file_text(file, "f %" PRIu32 " %" PRIu32 " %" PRIu32 "\n", mesh->indices[i] + 1, mesh->indices[i + 1] + 1,
                       mesh->indices[i + 2] + 1);
    return RESULT_OK;
}
