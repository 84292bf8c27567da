// glTF 2.0 (ISO/IEC 12113:2022): one scene, one node, one mesh, one buffer of indices, positions and normals.
#include "terrain/mesh/mesh_formats.h"

#include "base/log.h"

#include <float.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAGIC UINT32_C(0x46546c67)      // "glTF"
#define CHUNK_JSON UINT32_C(0x4e4f534a) // "JSON"
#define CHUNK_BIN UINT32_C(0x004e4942)  // "BIN"
#define JSON_BYTES_MAX 4096

typedef struct Glb {
    const Mesh *mesh;
    Vec3d centre;     // whole metres, y up: the node's translation, which keeps the floats small
    Vec3f *positions; // about the centre
    Vec3f *normals;
    float least[3], greatest[3]; // of the positions
    uint32_t index_bytes, vector_bytes;
} Glb;

static Vec3d y_up(Vec3d enu) {
    return vec3d(enu.x, enu.z, -enu.y);
}

static Vec3d position_of(const Mesh *mesh, int64_t vertex) {
    return y_up(mesh_local(&mesh->frame, mesh->vertices[vertex].ecef));
}

static void find_centre(Glb *glb) {
    Vec3d least = {DBL_MAX, DBL_MAX, DBL_MAX}, greatest = {-DBL_MAX, -DBL_MAX, -DBL_MAX};
    for (int64_t i = 0; i < glb->mesh->vertex_count; i++) {
        Vec3d p = position_of(glb->mesh, i);
        least = vec3d(fmin(least.x, p.x), fmin(least.y, p.y), fmin(least.z, p.z));
        greatest = vec3d(fmax(greatest.x, p.x), fmax(greatest.y, p.y), fmax(greatest.z, p.z));
    }
    if (glb->mesh->vertex_count)
        glb->centre = vec3d(round(0.5 * (least.x + greatest.x)), round(0.5 * (least.y + greatest.y)),
                            round(0.5 * (least.z + greatest.z)));
}

static void fill_positions(Glb *glb) {
    for (int k = 0; k < 3; k++)
        glb->least[k] = FLT_MAX, glb->greatest[k] = -FLT_MAX;
    for (int64_t i = 0; i < glb->mesh->vertex_count; i++) {
        Vec3d p = vec3d_sub(position_of(glb->mesh, i), glb->centre);
        float v[3] = {(float)p.x, (float)p.y, (float)p.z};
        glb->positions[i] = (Vec3f){v[0], v[1], v[2]};
        for (int k = 0; k < 3; k++) {
            glb->least[k] = fminf(glb->least[k], v[k]);
            glb->greatest[k] = fmaxf(glb->greatest[k], v[k]);
        }
    }
}

static Vec3d face_normal(const Glb *glb, const uint32_t *index) { // length: twice the area
    Vec3d p[3];
    for (int k = 0; k < 3; k++)
        p[k] = position_of(glb->mesh, index[k]);
    return vec3d_cross(vec3d_sub(p[1], p[0]), vec3d_sub(p[2], p[0]));
}

static void fill_normals(Glb *glb) {
    const Mesh *mesh = glb->mesh;
    memset(glb->normals, 0, sizeof *glb->normals * (size_t)mesh->vertex_count);
    for (int64_t i = 0; i < 3 * mesh->triangle_count; i += 3) {
        Vec3d normal = face_normal(glb, &mesh->indices[i]);
        for (int k = 0; k < 3; k++) {
            Vec3f *sum = &glb->normals[mesh->indices[i + k]];
            *sum = (Vec3f){sum->x + (float)normal.x, sum->y + (float)normal.y, sum->z + (float)normal.z};
        }
    }
    for (int64_t i = 0; i < mesh->vertex_count; i++) {
        Vec3f sum = glb->normals[i];
        Vec3d unit = vec3d_normalize(vec3d((double)sum.x, (double)sum.y, (double)sum.z));
        if (vec3d_dot(unit, unit) == 0.0)
            unit.y = 1.0;
        glb->normals[i] = (Vec3f){(float)unit.x, (float)unit.y, (float)unit.z};
    }
}

static Result glb_begin(const Mesh *mesh, Glb *glb) {
    int64_t index_bytes = 12 * mesh->triangle_count, vector_bytes = 12 * mesh->vertex_count;
    if (!mesh->triangle_count || index_bytes + 2 * vector_bytes + JSON_BYTES_MAX + 28 > UINT32_MAX) {
        log_error("glb: %" PRId64 " triangles; a GLB file holds at least one and at most 4 GiB: write a .ply",
                  mesh->triangle_count);
        return RESULT_RANGE;
    }
    *glb = (Glb){.mesh = mesh, .index_bytes = (uint32_t)index_bytes, .vector_bytes = (uint32_t)vector_bytes};
    glb->positions = malloc((size_t)vector_bytes);
    glb->normals = malloc((size_t)vector_bytes);
    if (!glb->positions || !glb->normals) {
        log_error("glb: no memory for %" PRId64 " vertices; write a .ply", mesh->vertex_count);
        return RESULT_MEMORY;
    }
    find_centre(glb);
    fill_positions(glb);
    fill_normals(glb);
    return RESULT_OK;
}

static void glb_end(Glb *glb) {
    free(glb->positions);
    free(glb->normals);
}

// ---- JSON ----

static int print_node(const Glb *glb, char *to, size_t room) {
    const MeshFrame *f = &glb->mesh->frame;
    const double(*m)[3] = f->enu_from_ecef.m;
    return snprintf(
        to, room,
        "{\"asset\":{\"version\":\"2.0\",\"generator\":\"Overfly\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
        "\"nodes\":[{\"name\":\"terrain\",\"mesh\":0,\"translation\":[%.0f,%.0f,%.0f],\"extras\":{"
        "\"axes\":\"x east, y up, z south; metres about the origin\",\"origin_lat_lon_deg\":[%.9f,%.9f],"
        "\"origin_ecef_m\":[%.4f,%.4f,%.4f],\"enu_from_ecef\":[[%.17g,%.17g,%.17g],[%.17g,%.17g,%.17g],"
        "[%.17g,%.17g,%.17g]]}}],",
        glb->centre.x, glb->centre.y, glb->centre.z, f->lat_deg, f->lon_deg, f->origin_ecef.x, f->origin_ecef.y,
        f->origin_ecef.z, m[0][0], m[0][1], m[0][2], m[1][0], m[1][1], m[1][2], m[2][0], m[2][1], m[2][2]);
}

static int print_mesh(const Glb *glb, char *to, size_t room) {
    return snprintf(
        to, room,
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":1,\"NORMAL\":2},\"indices\":0,\"material\":0}]}],"
        "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,0.48,0.42,1],\"metallicFactor\":0,"
        "\"roughnessFactor\":1}}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5125,\"count\":%" PRId64 ",\"type\":\"SCALAR\"},"
        "{\"bufferView\":1,\"componentType\":5126,\"count\":%" PRId64 ",\"type\":\"VEC3\",\"min\":[%.9g,%.9g,%.9g],"
        "\"max\":[%.9g,%.9g,%.9g]},"
        "{\"bufferView\":2,\"componentType\":5126,\"count\":%" PRId64 ",\"type\":\"VEC3\"}],",
        3 * glb->mesh->triangle_count, glb->mesh->vertex_count, (double)glb->least[0], (double)glb->least[1],
        (double)glb->least[2], (double)glb->greatest[0], (double)glb->greatest[1], (double)glb->greatest[2],
        glb->mesh->vertex_count);
}

static int print_buffer(const Glb *glb, char *to, size_t room) {
    uint32_t positions = glb->index_bytes, normals = positions + glb->vector_bytes;
    return snprintf(to, room,
                    "\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":%" PRIu32 ",\"target\":34963},"
                    "{\"buffer\":0,\"byteOffset\":%" PRIu32 ",\"byteLength\":%" PRIu32 ",\"target\":34962},"
                    "{\"buffer\":0,\"byteOffset\":%" PRIu32 ",\"byteLength\":%" PRIu32 ",\"target\":34962}],"
                    "\"buffers\":[{\"byteLength\":%" PRIu32 "}]}",
                    glb->index_bytes, positions, glb->vector_bytes, normals, glb->vector_bytes,
                    normals + glb->vector_bytes);
}

// Padded with spaces to a multiple of four, as the format demands. Returns the length.
static uint32_t print_json(const Glb *glb, char json[JSON_BYTES_MAX]) {
    size_t length = (size_t)print_node(glb, json, JSON_BYTES_MAX);
    length += (size_t)print_mesh(glb, json + length, JSON_BYTES_MAX - length);
    length += (size_t)print_buffer(glb, json + length, JSON_BYTES_MAX - length);
    while (length % 4)
        json[length++] = ' ';
    return (uint32_t)length;
}

// ---- the file ----

static void put_vectors(MeshFile *file, const Vec3f *vectors, int64_t count) {
    for (int64_t i = 0; i < count; i++) {
        mesh_file_float(file, vectors[i].x);
        mesh_file_float(file, vectors[i].y);
        mesh_file_float(file, vectors[i].z);
    }
}

static void put_chunks(const Glb *glb, MeshFile *file) {
    char json[JSON_BYTES_MAX];
    uint32_t json_bytes = print_json(glb, json), data_bytes = glb->index_bytes + 2 * glb->vector_bytes;
    mesh_file_u32(file, MAGIC);
    mesh_file_u32(file, 2);
    mesh_file_u32(file, 12 + 8 + json_bytes + 8 + data_bytes);
    mesh_file_u32(file, json_bytes);
    mesh_file_u32(file, CHUNK_JSON);
    mesh_file_bytes(file, json, json_bytes);
    mesh_file_u32(file, data_bytes);
    mesh_file_u32(file, CHUNK_BIN);
    for (int64_t i = 0; i < 3 * glb->mesh->triangle_count; i++)
        mesh_file_u32(file, glb->mesh->indices[i]);
    put_vectors(file, glb->positions, glb->mesh->vertex_count);
    put_vectors(file, glb->normals, glb->mesh->vertex_count);
}

Result mesh_put_glb(const Mesh *mesh, MeshFile *file) {
    Glb glb = {0};
    Result result = glb_begin(mesh, &glb);
    if (result == RESULT_OK)
        put_chunks(&glb, file);
    glb_end(&glb);
    return result;
}
