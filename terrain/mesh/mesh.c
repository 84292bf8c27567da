#define _POSIX_C_SOURCE 200809L // strcasecmp
#include "terrain/mesh/mesh.h"

#include "base/log.h"
#include "terrain/geodesy.h"
#include "terrain/mesh/mesh_formats.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

static MeshFrame frame_of(const Dem *dem, const Grid *grid) {
    MeshFrame frame;
    grid_geodetic(grid, 0.5 * (dem->width - 1), 0.5 * (dem->height - 1), &frame.lat_deg, &frame.lon_deg);
    Geodetic middle = {frame.lat_deg * GEODESY_RAD_PER_DEG, frame.lon_deg * GEODESY_RAD_PER_DEG, 0.0};
    frame.origin_ecef = geodesy_to_ecef(middle);
    frame.enu_from_ecef = geodesy_enu_from_ecef(middle.lat_rad, middle.lon_rad);
    return frame;
}

Vec3d mesh_local(const MeshFrame *frame, Vec3d ecef) {
    return mat3d_mul_vec(&frame->enu_from_ecef, vec3d_sub(ecef, frame->origin_ecef));
}

// ---- gathering ----

typedef struct Gather {
    uint32_t *number; // [width * height]: 1 + the vertex there, 0: none yet
    int64_t width;
    int64_t vertex_capacity;
    Mesh *mesh;
} Gather;

static bool grow_vertices(Gather *gather) {
    int64_t capacity = gather->vertex_capacity ? 2 * gather->vertex_capacity : 1 << 14;
    MeshVertex *grown = realloc(gather->mesh->vertices, sizeof *grown * (size_t)capacity);
    if (!grown)
        return false;
    gather->mesh->vertices = grown;
    gather->vertex_capacity = capacity;
    return true;
}

// The number of the vertex, which is made when it is new. False: out of memory.
static bool gather_vertex(Gather *gather, const LodPage *page, uint16_t index, uint32_t *out) {
    const LodVertex *v = &page->vertices[index];
    int32_t col = page->col0 + v->col, row = page->row0 + v->row;
    uint32_t *number = &gather->number[row * gather->width + col];
    Mesh *mesh = gather->mesh;
    if (!*number) {
        if (mesh->vertex_count == gather->vertex_capacity && !grow_vertices(gather))
            return false;
        GridPoint drawn = {page->origin.x + v->x, page->origin.y + v->y, page->origin.z + v->z};
        mesh->vertices[mesh->vertex_count++] = (MeshVertex){grid_point_ecef(drawn), col, row};
        *number = (uint32_t)mesh->vertex_count;
    }
    *out = *number - 1;
    return true;
}

// Around voids that are to stay holes every vertex is active, so a triangle at a void sample lies in the hole.
static bool is_in_hole(const Dem *dem, const LodPage *page, const uint16_t *triangle) {
    for (int k = 0; k < 3 && dem->void_bits; k++)
        if (dem_is_void(dem, page->col0 + page->vertices[triangle[k]].col,
                        page->row0 + page->vertices[triangle[k]].row))
            return true;
    return false;
}

static bool gather_triangle(Gather *gather, const LodPage *page, const uint16_t *triangle) {
    uint32_t *to = gather->mesh->indices + 3 * gather->mesh->triangle_count;
    for (int k = 0; k < 3; k++)
        if (!gather_vertex(gather, page, triangle[k], &to[k]))
            return false;
    gather->mesh->triangle_count++;
    return true;
}

static Result gather_items(Gather *gather, const Dem *dem, const LodCut *cut) {
    for (int32_t i = 0; i < cut->item_count; i++) {
        const LodItem *item = &cut->items[i];
        for (int32_t k = 0; k < item->index_count; k += 3)
            if (!is_in_hole(dem, item->page, item->indices + k) &&
                !gather_triangle(gather, item->page, item->indices + k))
                return RESULT_MEMORY;
    }
    return RESULT_OK;
}

static int64_t count_triangles(const LodCut *cut) {
    int64_t count = 0;
    for (int32_t i = 0; i < cut->item_count; i++)
        count += cut->items[i].index_count / 3;
    return count;
}

Result mesh_from_cut_of(const Dem *dem, const Grid *grid, const LodCut *cut, Mesh *out) {
    Mesh mesh = {.frame = frame_of(dem, grid)};
    int64_t most = count_triangles(cut);
    if (most > INT32_MAX) {
        log_error("mesh: %lld triangles, at most %d can be written; raise --tau", (long long)most, INT32_MAX);
        return RESULT_RANGE;
    }
    Gather gather = {.width = dem->width, .mesh = &mesh};
    gather.number = calloc((size_t)dem->width * (size_t)dem->height, sizeof *gather.number);
    mesh.indices = malloc(sizeof *mesh.indices * (size_t)(3 * most + 1));
    Result result = gather.number && mesh.indices ? gather_items(&gather, dem, cut) : RESULT_MEMORY;
    free(gather.number);
    if (result != RESULT_OK) {
        log_error("mesh: no memory for %lld triangles; raise --tau", (long long)most);
        mesh_clear(&mesh);
        return result;
    }
    *out = mesh;
    return RESULT_OK;
}

Result mesh_from_cut(const Terrain *terrain, const LodCut *cut, Mesh *out) {
    return mesh_from_cut_of(terrain_dem(terrain), terrain_grid(terrain), cut, out);
}

void mesh_clear(Mesh *mesh) {
    free(mesh->vertices);
    free(mesh->indices);
    *mesh = (Mesh){0};
}

// ---- culling ----

static bool is_outside(const Mesh *mesh, const uint32_t *index, const MeshPlane *plane) {
    for (int k = 0; k < 3; k++) {
        Vec3d away = vec3d_sub(mesh->vertices[index[k]].ecef, plane->point_ecef);
        if (vec3d_dot(plane->normal, away) >= 0.0)
            return false;
    }
    return true;
}

static bool is_kept(const Mesh *mesh, const uint32_t *index, const MeshPlane *planes, int plane_count) {
    for (int i = 0; i < plane_count; i++)
        if (is_outside(mesh, index, &planes[i]))
            return false;
    return true;
}

static void keep_triangles(Mesh *mesh, const MeshPlane *planes, int plane_count) {
    int64_t kept = 0;
    for (int64_t i = 0; i < mesh->triangle_count; i++)
        if (is_kept(mesh, &mesh->indices[3 * i], planes, plane_count))
            memmove(&mesh->indices[3 * kept++], &mesh->indices[3 * i], 3 * sizeof *mesh->indices);
    mesh->triangle_count = kept;
}

// Vertices keep their order.
static void keep_used_vertices(Mesh *mesh, uint32_t *number) {
    for (int64_t i = 0; i < 3 * mesh->triangle_count; i++)
        number[mesh->indices[i]] = 1;
    uint32_t kept = 0;
    for (int64_t i = 0; i < mesh->vertex_count; i++)
        if (number[i]) {
            mesh->vertices[kept] = mesh->vertices[i];
            number[i] = kept++;
        }
    for (int64_t i = 0; i < 3 * mesh->triangle_count; i++)
        mesh->indices[i] = number[mesh->indices[i]];
    mesh->vertex_count = kept;
}

Result mesh_cull(Mesh *mesh, const MeshPlane *planes, int plane_count) {
    uint32_t *number = calloc((size_t)mesh->vertex_count + 1, sizeof *number);
    if (!number) {
        log_error("mesh: no memory to cull %lld vertices", (long long)mesh->vertex_count);
        return RESULT_MEMORY;
    }
    keep_triangles(mesh, planes, plane_count);
    keep_used_vertices(mesh, number);
    free(number);
    return RESULT_OK;
}

// ---- files ----

Result mesh_format_of(const char *path, MeshFormat *out) {
    static const struct {
        const char *ending;
        MeshFormat format;
    } ENDINGS[] = {{".ply", MESH_PLY}, {".obj", MESH_OBJ}, {".glb", MESH_GLB}};
    size_t length = strlen(path);
    for (size_t i = 0; i < COUNT_OF(ENDINGS); i++)
        if (length > 4 && strcasecmp(path + length - 4, ENDINGS[i].ending) == 0) {
            *out = ENDINGS[i].format;
            return RESULT_OK;
        }
    log_error("%s: a mesh is written as .ply, .obj or .glb; end the file's name with one of them", path);
    return RESULT_USAGE;
}

static Result put_mesh(const Mesh *mesh, MeshFormat format, MeshFile *file) {
    switch (format) {
    case MESH_PLY:
        return mesh_put_ply(mesh, file);
    case MESH_OBJ:
        return mesh_put_obj(mesh, file);
    case MESH_GLB:
        return mesh_put_glb(mesh, file);
    }
    return RESULT_UNSUPPORTED;
}

Result mesh_write(const Mesh *mesh, MeshFormat format, const char *path) {
    MeshFile *file = NULL;
    Result result = mesh_file_create(path, &file);
    if (result != RESULT_OK)
        return result;
    result = put_mesh(mesh, format, file);
    if (result != RESULT_OK) {
        mesh_file_abandon(&file);
        return result;
    }
    return mesh_file_commit(&file);
}
