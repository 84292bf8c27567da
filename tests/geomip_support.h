// tests/geomip_support.h: ground cut into tiles, and cuts of levels that a test chooses.
// As terrain/geomipmap/geomip_tiles.h.
// What is created here is destroyed by the test. Failures end the test through cmocka.
#pragma once
#include "terrain/geomipmap/geomip_page.h"
#include "terrain/squares/square_page.h"
#include "tests/cut_support.h"

typedef struct GeomipGround {
    Jobs *jobs;
    Terrain *terrain;
    GeomipTiles tiles;
} GeomipGround;

// Rough ground of this many samples, in tiles of `side` cells.
GeomipGround geomip_support_ground(int width, int height, int side, GeomipBorder border, bool bounds);
void geomip_support_ground_end(GeomipGround *g);

typedef struct GeomipDrawn {
    LodCut cut;
    LodItem *items;
    GeomipPageStore pages;
    SquarePageStore squares;
} GeomipDrawn;

// All tiles at these levels, seen from 5 km above a corner. It promises nothing.
GeomipDrawn geomip_support_draw(const GeomipGround *g, const int16_t *levels, GeomipBorder border);
void geomip_support_draw_end(GeomipDrawn *d);

typedef struct GeomipPoint {
    double col, row, h;
} GeomipPoint;

// Doubled, signed.
double geomip_support_area(GeomipPoint a, GeomipPoint b, GeomipPoint c);
