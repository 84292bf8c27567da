#include "render/craft/craft_mesh.h"

#include "base/log.h"

#include <stdlib.h>
#include <string.h>

#define CREASE_COSINE 0.6428 // 50 degrees
#define RING_MAX 128

typedef struct Triangle {
    Vec3f corners[3];
    uint8_t finish;
} Triangle;

typedef struct Piece {
    CraftPieceSpec spec;
    int first, count; // triangles
} Piece;

struct CraftBuilder {
    Triangle *triangles;
    Piece *pieces;
    int triangle_count, triangle_room, piece_count, piece_room;
    CraftFinish finish;
    bool failed;
};

CraftBuilder *craft_builder_create(void) {
    return calloc(1, sizeof(CraftBuilder));
}

void craft_builder_destroy(CraftBuilder **builder) {
    CraftBuilder *self = *builder;
    if (!self)
        return;
    free(self->triangles);
    free(self->pieces);
    free(self);
    *builder = NULL;
}

// One more element, or NULL, and the builder has failed.
static void *grow(CraftBuilder *builder, void *block, size_t element_bytes, int count, int *room) {
    if (count < *room)
        return block;
    int more = *room ? *room * 2 : 256;
    void *grown = realloc(block, (size_t)more * element_bytes);
    if (!grown) {
        builder->failed = true;
        return block;
    }
    *room = more;
    return grown;
}

void craft_builder_begin_piece(CraftBuilder *builder, const CraftPieceSpec *spec) {
    builder->pieces =
        grow(builder, builder->pieces, sizeof *builder->pieces, builder->piece_count, &builder->piece_room);
    if (!builder->failed)
        builder->pieces[builder->piece_count++] = (Piece){*spec, builder->triangle_count, 0};
}

void craft_builder_set_finish(CraftBuilder *builder, CraftFinish finish) {
    builder->finish = finish;
}

int craft_builder_triangles(const CraftBuilder *builder) {
    return builder->triangle_count;
}

static bool same_point(Vec3f a, Vec3f b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

// Without those that have no area because two corners are one.
static void add_triangle(CraftBuilder *builder, Vec3f a, Vec3f b, Vec3f c) {
    builder->triangles =
        grow(builder, builder->triangles, sizeof *builder->triangles, builder->triangle_count, &builder->triangle_room);
    if (builder->failed || same_point(a, b) || same_point(b, c) || same_point(c, a))
        return;
    builder->triangles[builder->triangle_count++] = (Triangle){{a, b, c}, (uint8_t)builder->finish};
    builder->pieces[builder->piece_count - 1].count++;
}

// -0 becomes 0, and what is meant to be on the plane of symmetry is on it, so that equal points have equal bits.
static Vec3f place(const CraftBuilder *builder, Vec3d point) {
    double y = fabs(point.y) < 1e-9 ? 0.0 : point.y;
    if (builder->pieces[builder->piece_count - 1].spec.mirror)
        y = -y;
    return (Vec3f){(float)point.x + 0.0f, (float)y + 0.0f, (float)point.z + 0.0f};
}

void craft_builder_add_loft(CraftBuilder *builder, const Vec3d *rings, int count, int size) {
    craft_builder_add_strip(builder, rings, count, size, 0, size);
}

void craft_builder_add_strip(CraftBuilder *builder, const Vec3d *rings, int count, int size, int from, int to) {
    for (int ring = 0; ring + 1 < count && !builder->failed; ring++) {
        for (int i = from; i < to; i++) {
            int next = (i + 1) % size;
            Vec3f a = place(builder, rings[ring * size + i]), b = place(builder, rings[ring * size + next]);
            Vec3f c = place(builder, rings[(ring + 1) * size + next]), d = place(builder, rings[(ring + 1) * size + i]);
            bool second_half = i >= size / 2; // so that symmetric rings get symmetric diagonals
            add_triangle(builder, a, b, second_half ? d : c);
            add_triangle(builder, second_half ? b : a, c, d);
        }
    }
}

// --- caps: ears are cut off a polygon one by one

typedef struct Flat {
    double x[RING_MAX], y[RING_MAX];
    int order[RING_MAX], count;
} Flat;

static Vec3d ring_normal(const Vec3d *ring, int size) {
    Vec3d sum = {0};
    for (int i = 1; i + 1 < size; i++)
        sum = vec3d_add(sum, vec3d_cross(vec3d_sub(ring[i], ring[0]), vec3d_sub(ring[i + 1], ring[0])));
    return vec3d_normalize(sum);
}

// Into the ring's plane, turned to run counter-clockwise.
static Flat flatten(const Vec3d *ring, int size, Vec3d normal) {
    Flat flat = {.count = size};
    Vec3d aside = fabs(normal.x) < 0.7 ? vec3d(1.0, 0.0, 0.0) : vec3d(0.0, 1.0, 0.0);
    Vec3d u = vec3d_normalize(vec3d_cross(aside, normal)), v = vec3d_cross(normal, u);
    for (int i = 0; i < size; i++) {
        flat.x[i] = vec3d_dot(ring[i], u);
        flat.y[i] = vec3d_dot(ring[i], v);
        flat.order[i] = i;
    }
    return flat;
}

static double twice_area(const Flat *flat, int a, int b, int c) {
    return (flat->x[b] - flat->x[a]) * (flat->y[c] - flat->y[a]) -
           (flat->x[c] - flat->x[a]) * (flat->y[b] - flat->y[a]);
}

static bool holds_another(const Flat *flat, int a, int b, int c) {
    for (int i = 0; i < flat->count; i++) {
        int p = flat->order[i];
        if (p != a && p != b && p != c && twice_area(flat, a, b, p) >= 0.0 && twice_area(flat, b, c, p) >= 0.0 &&
            twice_area(flat, c, a, p) >= 0.0)
            return true;
    }
    return false;
}

// The ear whose smallest height is largest, so that no slivers are left for the end; -1: none.
static int best_ear(const Flat *flat) {
    int best = -1;
    double best_height = 0.0;
    for (int i = 0; i < flat->count; i++) {
        int a = flat->order[(i + flat->count - 1) % flat->count], b = flat->order[i];
        int c = flat->order[(i + 1) % flat->count];
        double area = twice_area(flat, a, b, c);
        double longest = fmax(hypot(flat->x[a] - flat->x[b], flat->y[a] - flat->y[b]),
                              fmax(hypot(flat->x[c] - flat->x[b], flat->y[c] - flat->y[b]),
                                   hypot(flat->x[c] - flat->x[a], flat->y[c] - flat->y[a])));
        if (area > 0.0 && area / longest > best_height && !holds_another(flat, a, b, c)) {
            best = i;
            best_height = area / longest;
        }
    }
    return best;
}

void craft_builder_add_cap(CraftBuilder *builder, const Vec3d *ring, int size, bool last) {
    if (size > RING_MAX) {
        builder->failed = true;
        return;
    }
    Flat flat = flatten(ring, size, ring_normal(ring, size));
    while (flat.count >= 3 && !builder->failed) {
        int ear = flat.count == 3 ? 1 : best_ear(&flat);
        ear = ear < 0 ? 1 : ear; // what is left has no area
        int a = flat.order[(ear + flat.count - 1) % flat.count], b = flat.order[ear];
        int c = flat.order[(ear + 1) % flat.count];
        add_triangle(builder, place(builder, ring[last ? a : c]), place(builder, ring[b]),
                     place(builder, ring[last ? c : a]));
        memmove(flat.order + ear, flat.order + ear + 1, (size_t)(flat.count - ear - 1) * sizeof flat.order[0]);
        flat.count--;
    }
}

// --- outwards

static Vec3d widen(Vec3f v) {
    return (Vec3d){v.x, v.y, v.z};
}

static double six_volumes(const Triangle *triangle) {
    return vec3d_dot(widen(triangle->corners[0]),
                     vec3d_cross(widen(triangle->corners[1]), widen(triangle->corners[2])));
}

void craft_builder_end_piece(CraftBuilder *builder) {
    if (builder->failed)
        return;
    const Piece *piece = &builder->pieces[builder->piece_count - 1];
    double volume = 0.0;
    for (int i = 0; i < piece->count; i++)
        volume += six_volumes(&builder->triangles[piece->first + i]);
    for (int i = 0; i < piece->count && volume < 0.0 && !piece->spec.open; i++) {
        Triangle *triangle = &builder->triangles[piece->first + i];
        Vec3f kept = triangle->corners[1];
        triangle->corners[1] = triangle->corners[2];
        triangle->corners[2] = kept;
    }
}

// --- normals

typedef struct Corner {
    Vec3f at;
    int group; // only corners of one group are smoothed together
    int index; // into the mesh's indices
    Vec3d face;
    double angle_rad;
    uint8_t finish;
} Corner;

static int compare_floats(float a, float b) {
    return (a > b) - (a < b);
}

static int compare_corners(const void *left, const void *right) {
    const Corner *a = left, *b = right;
    int order = compare_floats(a->at.x, b->at.x);
    order = order ? order : compare_floats(a->at.y, b->at.y);
    order = order ? order : compare_floats(a->at.z, b->at.z);
    order = order ? order : a->group - b->group;
    return order ? order : a->index - b->index;
}

static bool same_cluster(const Corner *a, const Corner *b) {
    return same_point(a->at, b->at) && a->group == b->group;
}

static void list_triangle(const Triangle *triangle, int group, int first_index, Corner corners[3]) {
    Vec3d at[3] = {widen(triangle->corners[0]), widen(triangle->corners[1]), widen(triangle->corners[2])};
    Vec3d face = vec3d_normalize(vec3d_cross(vec3d_sub(at[1], at[0]), vec3d_sub(at[2], at[0])));
    for (int i = 0; i < 3; i++) {
        Vec3d to_next = vec3d_normalize(vec3d_sub(at[(i + 1) % 3], at[i]));
        Vec3d to_last = vec3d_normalize(vec3d_sub(at[(i + 2) % 3], at[i]));
        double angle_rad = acos(fmin(fmax(vec3d_dot(to_next, to_last), -1.0), 1.0));
        corners[i] = (Corner){triangle->corners[i], group, first_index + i, face, angle_rad, triangle->finish};
    }
}

static Vec3d smooth_normal(const Corner *cluster, int count, const Corner *corner) {
    Vec3d sum = {0};
    for (int i = 0; i < count; i++)
        if (vec3d_dot(cluster[i].face, corner->face) > CREASE_COSINE)
            sum = vec3d_mad(sum, cluster[i].face, cluster[i].angle_rad);
    return vec3d_length(sum) > 1e-9 ? vec3d_normalize(sum) : corner->face;
}

static CraftVertex make_vertex(const Corner *corner, const CraftPieceSpec *spec, Vec3d normal) {
    return (CraftVertex){.position = {corner->at.x, corner->at.y, corner->at.z},
                         .normal = {(int16_t)lrint(normal.x * 32767.0), (int16_t)lrint(normal.y * 32767.0),
                                    (int16_t)lrint(normal.z * 32767.0), 0},
                         .finish = corner->finish,
                         .joint = (uint8_t)spec->joint,
                         .surface = (uint8_t)spec->surface};
}

// Corners that look the same become one vertex.
static void emit_cluster(const Corner *cluster, int count, CraftMesh *mesh) {
    const CraftPieceSpec spec = {.joint = (CraftJoint)(cluster[0].group >> 8),
                                 .surface = (CraftSurface)(cluster[0].group & 255)};
    int first = mesh->vertex_count;
    for (int i = 0; i < count; i++) {
        CraftVertex vertex = make_vertex(&cluster[i], &spec, smooth_normal(cluster, count, &cluster[i]));
        int at = first;
        while (at < mesh->vertex_count && memcmp(&mesh->vertices[at], &vertex, sizeof vertex) != 0)
            at++;
        if (at == mesh->vertex_count)
            mesh->vertices[mesh->vertex_count++] = vertex;
        mesh->indices[cluster[i].index] = (uint32_t)at;
    }
}

static void list_corners(const CraftBuilder *builder, Corner *corners, CraftMesh *mesh) {
    for (int p = 0; p < builder->piece_count; p++) {
        const Piece *piece = &builder->pieces[p];
        int group = (int)piece->spec.joint << 8 | (int)piece->spec.surface;
        for (int i = piece->first; i < piece->first + piece->count; i++)
            list_triangle(&builder->triangles[i], group, i * 3, corners + i * 3);
        mesh->pieces[p] = (CraftPiece){piece->first * 3, piece->count * 3, piece->spec.joint, !piece->spec.open};
    }
    mesh->piece_count = builder->piece_count;
    mesh->index_count = builder->triangle_count * 3;
}

static bool make_mesh(const CraftBuilder *builder, CraftMesh *mesh) {
    size_t count = (size_t)builder->triangle_count * 3;
    Corner *corners = malloc(count * sizeof *corners);
    mesh->vertices = malloc(count * sizeof *mesh->vertices);
    mesh->indices = malloc(count * sizeof *mesh->indices);
    mesh->pieces = malloc((size_t)builder->piece_count * sizeof *mesh->pieces);
    if (!corners || !mesh->vertices || !mesh->indices || !mesh->pieces) {
        free(corners);
        return false;
    }
    list_corners(builder, corners, mesh);
    qsort(corners, count, sizeof *corners, compare_corners);
    for (size_t begin = 0, end; begin < count; begin = end) {
        for (end = begin + 1; end < count && same_cluster(&corners[begin], &corners[end]);)
            end++;
        emit_cluster(corners + begin, (int)(end - begin), mesh);
    }
    free(corners);
    return true;
}

Result craft_builder_finish(CraftBuilder *builder, CraftMesh *mesh) {
    *mesh = (CraftMesh){0};
    if (!builder->failed && make_mesh(builder, mesh))
        return RESULT_OK;
    craft_mesh_free(mesh);
    log_error("out of memory for the aircraft's %d triangles", builder->triangle_count);
    return RESULT_MEMORY;
}

void craft_mesh_free(CraftMesh *mesh) {
    free(mesh->vertices);
    free(mesh->indices);
    free(mesh->pieces);
    *mesh = (CraftMesh){0};
}
