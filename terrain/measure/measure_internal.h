// terrain/measure/measure_internal.h: what the halves of the measuring share: the mesh's wholeness, its distance.
// Columns and rows of the DEM; pixels.
// A MeasureRun owns its arrays; it lives for one call of measure_cut.
#pragma once
#include "terrain/measure/measure.h"

#include <stdatomic.h>
#include <string.h>

// An undirected edge and how many triangles run along it each way. (col, row) is the end that comes first in
// row-major order, (dcol, drow) the step to the other.
typedef struct MeasureEdge {
    int32_t col, row, dcol, drow;
    uint32_t forward, backward; // both 0: an empty place of the table
} MeasureEdge;

typedef struct MeasureWorker {
    MeasureEdge *table; // [table_size], open addressing, for the edges of one item
    MeasureEdge *open;  // edges that one item does not pair, of all items this worker had
    int64_t open_count, open_capacity;
    uint8_t *used;   // [65536], vertices of one item that triangles use
    int64_t area2;   // doubled area of all triangles, cells
    int64_t unsound; // triangles that are degenerate, clockwise, or outside the DEM
    double max_px;   // -1: nothing measured
    int64_t worst;   // sample of max_px; the first in row-major order of several
    bool out_of_memory;
} MeasureWorker;

// Bits of `vertices`: an ordinal, 1 + the position in the pages of all items one after another; 0 where no vertex is.
#define MEASURE_SPLIT UINT32_C(0x80000000)    // drawn at two positions
#define MEASURE_JUNCTION UINT32_C(0x40000000) // inside the edge of a triangle
#define MEASURE_ORDINAL UINT32_C(0x3fffffff)

// Bits of `cells`, for a point in the northern and one in the southern quarter of each cell: any triangle whose
// edges follow the grid or its diagonals covers half a cell, and exactly one of the two.
enum { MEASURE_NORTH = 1, MEASURE_NORTH_TWICE = 2, MEASURE_SOUTH = 4, MEASURE_SOUTH_TWICE = 8 };

// Samples that are looked at again, and the squares of the DEM with any of them.
#define MEASURE_BLOCK_SHIFT 5
typedef struct MeasureTouched {
    _Atomic uint8_t *samples; // [height][width], 1: touched
    _Atomic uint8_t *blocks;  // [block_rows][block_cols]
    int block_cols, block_rows;
} MeasureTouched;

typedef struct MeasureRun {
    const Dem *dem;
    const Grid *grid;
    const LodCut *cut;
    const MeasurePace *pace; // NULL: measured without a pause
    atomic_bool ended;       // by `pace`
    // For `pace`: the doubled area of the items done, and the bits of the largest error in them.
    _Atomic int64_t done_area2;
    _Atomic uint32_t done_max;
    int64_t samples, cell_count;
    _Atomic uint32_t *vertices;    // [height][width]
    _Atomic uint32_t *errors;      // [height][width], bits of a float >= 0, the larger of the triangles that share it
    _Atomic uint32_t *rises;       // [height][width], measure_key of the highest rise; NULL: not wanted
    const MeasureTouched *touched; // of its samples `rises` alone is wanted; NULL: all is, of all
    _Atomic uint8_t *cells;        // [height - 1][width - 1]
    int64_t *first_ordinal;        // [item_count]
    int64_t table_size;            // a power of two
    MeasureWorker *workers;
    int worker_count;
} MeasureRun;

#define MEASURE_NOT_COVERED UINT32_C(0xffffffff) // in `errors`

// Keys of floats, as large as the floats are; above MEASURE_NO_KEY for every number.
#define MEASURE_NO_KEY UINT32_C(0)
static inline uint32_t measure_key(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits & UINT32_C(0x80000000) ? ~bits : bits | UINT32_C(0x80000000);
}
static inline float measure_value_of_key(uint32_t key) {
    uint32_t bits = key & UINT32_C(0x80000000) ? key & UINT32_C(0x7fffffff) : ~key;
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

typedef struct MeasureTriangle {
    int64_t col[3], row[3];
    uint16_t vertex[3]; // of the page
    int64_t area2;      // doubled, cells, > 0: counter-clockwise seen from above
} MeasureTriangle;

// Whether the measuring goes on; asked where it may pause.
bool measure_goes_on(MeasureRun *run);

// False for a triangle that covers nothing of the DEM: unsound in the sense of MeasureWorker.
bool measure_triangle(const MeasureRun *run, const LodItem *item, int64_t triangle, MeasureTriangle *out);
GridPoint measure_drawn(const LodPage *page, uint16_t vertex);

// One worker's part over items [begin, end).
void measure_mark_vertices(MeasureRun *run, MeasureWorker *worker, int64_t begin, int64_t end);
void measure_find_junctions(MeasureRun *run, int64_t begin, int64_t end);
void measure_rasterise(MeasureRun *run, MeasureWorker *worker, int64_t begin, int64_t end);
// Every sample that the item's triangles cover.
void measure_touch(const MeasureRun *run, const LodItem *item, const MeasureTouched *touched);
// The item's rises at the samples of run->touched.
void measure_rasterise_touched(MeasureRun *run, const LodItem *item);

// As measure_popping, over the touched samples alone; NULL: over all.
MUST_USE Result measure_popping_touched(const Terrain *terrain, const LodView *view, const float *const rise_m[2],
                                        const MeasureTouched *touched, Jobs *jobs, MeasurePopping *out);

// Joins what the workers found: edges, vertices, cells into holes, overlaps and T-junctions of `out`.
MUST_USE Result measure_join_edges(const MeasureRun *run, Measure *out);
