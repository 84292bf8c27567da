#include "terrain/mesh/mesh_formats.h"

#include <inttypes.h>

static void put_header(const Mesh *mesh, MeshFile *file) {
    mesh_file_text(file,
                   "ply\n"
                   "format binary_little_endian 1.0\n"
                   "comment x y z: WGS84 Earth-centred, Earth-fixed, metres; col row: position in the elevation model\n"
                   "comment faces are counter-clockwise seen from above\n"
                   "element vertex %" PRId64 "\n"
                   "property double x\n"
                   "property double y\n"
                   "property double z\n"
                   "property double col\n"
                   "property double row\n"
                   "element face %" PRId64 "\n"
                   "property list uchar int vertex_indices\n"
                   "end_header\n",
                   mesh->vertex_count, mesh->triangle_count);
}

Result mesh_put_ply(const Mesh *mesh, MeshFile *file) {
    put_header(mesh, file);
    for (int64_t i = 0; i < mesh->vertex_count; i++) {
        const MeshVertex *v = &mesh->vertices[i];
        mesh_file_double(file, v->ecef.x);
        mesh_file_double(file, v->ecef.y);
        mesh_file_double(file, v->ecef.z);
        mesh_file_double(file, v->col);
        mesh_file_double(file, v->row);
    }
    for (int64_t i = 0; i < 3 * mesh->triangle_count; i += 3) {
        mesh_file_u8(file, 3);
        for (int k = 0; k < 3; k++)
            mesh_file_u32(file, mesh->indices[i + k]);
    }
    return RESULT_OK;
}
