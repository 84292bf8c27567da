// render/craft/craft_mesh.h: triangles with smooth normals from lofted rings of points.
// Metres, body axes. Triangles are counter-clockwise seen from outside.
// A CraftBuilder owns what was added until craft_builder_finish; any thread, one at a time.
#pragma once
#include "render/craft/craft_shape.h"

// What moves on its own.
typedef enum CraftJoint {
    CRAFT_FIXED,
    CRAFT_AILERON_LEFT,
    CRAFT_AILERON_RIGHT,
    CRAFT_FLAP_LEFT,
    CRAFT_FLAP_RIGHT,
    CRAFT_ELEVATOR_LEFT,
    CRAFT_ELEVATOR_RIGHT,
    CRAFT_RUDDER_JOINT,
    CRAFT_NOSE_LEG,
    CRAFT_LEFT_LEG,
    CRAFT_RIGHT_LEG,
    CRAFT_PROPELLER_JOINT,
    CRAFT_JOINT_COUNT
} CraftJoint;

typedef struct CraftVertex {
    float position[3];
    int16_t normal[4]; // unit, of 32767; w: 0
    uint8_t finish, joint, surface, zero;
} CraftVertex;
_Static_assert(sizeof(CraftVertex) == 24, "as render/craft/craft_pass.c tells the driver");

// A solid of its own, or a sheet.
typedef struct CraftPiece {
    int first_index, index_count;
    CraftJoint joint;
    bool closed; // a solid
} CraftPiece;

typedef struct CraftMesh {
    CraftVertex *vertices;
    uint32_t *indices;
    CraftPiece *pieces;
    int vertex_count, index_count, piece_count;
} CraftMesh;

typedef struct CraftBuilder CraftBuilder;

// NULL: no memory.
CraftBuilder *craft_builder_create(void);
void craft_builder_destroy(CraftBuilder **builder);

typedef struct CraftPieceSpec {
    CraftJoint joint;
    CraftSurface surface;
    bool mirror; // what is added has its y negated
    bool open;   // a sheet, with the winding as added
} CraftPieceSpec;
// Until craft_builder_end_piece, which turns a solid's triangles outwards.
void craft_builder_begin_piece(CraftBuilder *builder, const CraftPieceSpec *spec);
void craft_builder_end_piece(CraftBuilder *builder);

// The finish of what is added from here on.
void craft_builder_set_finish(CraftBuilder *builder, CraftFinish finish);

// Joins closed rings of `size` points each with triangles. rings[ring * size + i].
void craft_builder_add_loft(CraftBuilder *builder, const Vec3d *rings, int count, int size);
// The part of it between the rings' points `from` and `to`; the last point is followed by the first.
void craft_builder_add_strip(CraftBuilder *builder, const Vec3d *rings, int count, int size, int from, int to);
// Fills a plane ring, which may be concave but not cross itself; `last`: as the end of a loft, else as its beginning.
void craft_builder_add_cap(CraftBuilder *builder, const Vec3d *ring, int size, bool last);

int craft_builder_triangles(const CraftBuilder *builder); // so far

// Normals are means over the triangles that meet at a point at less than 50 degrees, weighted by their angles. The
// caller frees the mesh with craft_mesh_free. MEMORY also where an addition failed before.
MUST_USE Result craft_builder_finish(CraftBuilder *builder, CraftMesh *mesh);
void craft_mesh_free(CraftMesh *mesh);
