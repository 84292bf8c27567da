// terrain/geomipmap/geomip_zip.h: de Boer's border strip, between few vertices of the border and the level's inside.
// Samples along the side (geomip_tiles.h).
// Pure; owns nothing.
#pragma once
#include "base/base.h"

// One triangle: (outer[at], inner `t`, outer[at + 1]) where `outer`, else (outer[at], inner `t`, inner t + stride).
typedef struct GeomipZip {
    int16_t at, t;
    bool outer;
} GeomipZip;
#define GEOMIP_ZIP_MAX (2 * 128)

// `outer`: [outer_count] from 0 to `side_cells`, rising, multiples of `stride`; inner: stride, 2 stride .. side_cells -
// stride, one at least. Writes outer_count - 1 + (inner vertices - 1) triangles and gives their number. Where the outer
// vertices are as dense as the inner ones the triangles are those of the level's mesh.
int geomip_zip(const int16_t *outer, int outer_count, int side_cells, int stride, GeomipZip *out);
