// terrain/geomipmap/geomip_mesh.h: the triangles of a tile between neighbours of any levels.
// Samples from the tile's north-west corner; levels as in geomip_levels.h.
// Pure; outputs are the caller's.
//
// Sources: de Boer 2000 (GEOMIP_OMITTED); Ye, Wang, section 3.2 (GEOMIP_FANNED).
#pragma once
#include "terrain/geomipmap/geomip_levels.h"

#define GEOMIP_OUTLINE_MAX (4 * 128)

typedef struct GeomipSize {
    int32_t triangles, vertices;
} GeomipSize;
// Exact. `drawn`: the levels of all tiles.
GeomipSize geomip_mesh_size(const GeomipTiles *tiles, const int16_t *drawn, int32_t tile, GeomipBorder border);

// The vertices on a tile's border, clockwise from the north-west corner. Vertices are numbered by rows of the level's
// grid, then those of the border that the level lacks, in this order, then the middle of a star.
typedef struct GeomipOutline {
    int side, stride, across; // of the tile, cells; of its level, samples; vertices a row
    int count;
    int begin[GEOMIP_SIDES + 1]; // of each side's points
    int16_t t[GEOMIP_OUTLINE_MAX + 1];
    uint16_t vertex[GEOMIP_OUTLINE_MAX + 1]; // the last is the first once more
    int vertex_count;
    bool star; // two triangles only, but neighbours have vertices between their corners: a fan around the middle
} GeomipOutline;
void geomip_mesh_outline(const GeomipTiles *tiles, const int16_t *drawn, int32_t tile, GeomipBorder border,
                         GeomipOutline *out);

// 3 indices a triangle, counter-clockwise seen from above, as many as geomip_mesh_size says; gives their number.
int32_t geomip_mesh_indices(const GeomipOutline *outline, const ForestTile *square, GeomipBorder border,
                            uint16_t *indices);
