// terrain/geomipmap/geomip_tiles.h: the geomipmap methods' tiles: squares, who touches whom, errors of their levels.
// Samples and cells of the DEM; level m has a vertex every 2^m samples; errors in metres.
// A GeomipTiles owns its tables and borrows the terrain; constant after creation, any thread may read it.
//
// Sources: de Boer 2000 (errors of the levels, computed once); Ye, Wang, section 2.1. Our own: errors that bound.
#pragma once
#include "base/vec.h"
#include "terrain/squares/square_grid.h"
#include "terrain/terrain.h"

#define GEOMIP_LEVELS_MAX 8 // sides of 1, 2, 4 .. 128 cells
#define GEOMIP_OUTSIDE (-1) // beyond the DEM's edge

// Sides are numbered clockwise from the north; `t` runs along a side clockwise from its first corner, `depth` inwards.
// The four frames (t, depth) are the tile's own (column, row), turned by quarters.
enum { GEOMIP_NORTH, GEOMIP_EAST, GEOMIP_SOUTH, GEOMIP_WEST, GEOMIP_SIDES };

// A piece of a tile's border, shared with one other tile.
typedef struct GeomipLink {
    int32_t tile; // on the other side, or GEOMIP_OUTSIDE
    int16_t begin, end;
    uint8_t side;
} GeomipLink;

typedef struct GeomipTile {
    Vec3d centre_ecef;     // the middle sample
    float low[3], high[3]; // with bounds: the box around all samples, in geomip_frame's axes from the centre, metres
    int32_t first_link;    // the next tile's first_link ends them
    int8_t log_side;       // the level of two triangles
    int8_t cap;            // the coarsest level that it may be drawn at
} GeomipTile;

typedef struct GeomipTiles {
    const Terrain *terrain;
    SquareGrid squares;
    int levels;        // log2 of the greatest side, and 1
    GeomipTile *tiles; // [squares.count + 1]
    GeomipLink *links; // by tile, side, and t
    float *delta;      // [tile][levels], geomip_delta
    float *strip;      // [tile][side][levels][levels], geomip_strip; NULL without bounds
} GeomipTiles;

typedef enum GeomipBorder {
    GEOMIP_OMITTED, // de Boer: the finer tile omits border vertices that the coarser one lacks
    GEOMIP_FANNED,  // Ye: the coarser tile's border triangles become fans that meet the finer one's vertices
} GeomipBorder;

typedef struct GeomipInput {
    const Terrain *terrain;
    int side;            // of a tile, cells: a power of two, 2..128
    GeomipBorder border; // what the errors of strips are computed for
    bool bounds;         // errors that bound the deviation at every sample, and boxes; false: de Boer's errors
} GeomipInput;
// The same bytes for any number of workers. MEMORY.
MUST_USE Result geomip_tiles_create(const GeomipInput *input, Jobs *jobs, GeomipTiles *out);
void geomip_tiles_destroy(GeomipTiles *tiles);

// The error of a level in a tile. Without bounds: the largest vertical deviation of the tile's samples from the level's
// mesh, rounded up. With bounds: at least the distance from each sample to the mesh at its column and row, growing with
// the level.
static inline float geomip_delta(const GeomipTiles *tiles, int32_t tile, int level) {
    return tiles->delta[(size_t)tile * (size_t)tiles->levels + (size_t)level];
}
// With bounds: the same for the whole tile at `level` where the border of a side is drawn at `border`, which is not
// finer; growing with both.
static inline float geomip_strip(const GeomipTiles *tiles, int32_t tile, int side, int level, int border) {
    size_t n = (size_t)tiles->levels;
    return tiles->strip[(((size_t)tile * GEOMIP_SIDES + (size_t)side) * n + (size_t)level) * n + (size_t)border];
}

// The sample, from the tile's north-west corner, at (t, depth) of a side.
static inline void geomip_turn(int side_cells, int side, int t, int depth, int *col, int *row) {
    *col = side == GEOMIP_NORTH   ? t
           : side == GEOMIP_EAST  ? side_cells - depth
           : side == GEOMIP_SOUTH ? side_cells - t
                                  : depth;
    *row = side == GEOMIP_NORTH   ? depth
           : side == GEOMIP_EAST  ? t
           : side == GEOMIP_SOUTH ? side_cells - depth
                                  : side_cells - t;
}
// Whether the cell of side `stride` with this north-west sample is split from south-west to north-east. Cells alternate
// as in the longest-edge bisection, so that every level's mesh contains the edges of the next coarser one.
static inline bool geomip_is_rising(int col, int row, int stride) {
    return (col / stride + row / stride) & 1;
}

// East, north, up at a place, from its position: unit vectors.
typedef struct GeomipFrame {
    Vec3d axis[3];
} GeomipFrame;
GeomipFrame geomip_frame(Vec3d ecef);
