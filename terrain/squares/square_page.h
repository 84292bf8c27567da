// terrain/squares/square_page.h: the static vertices of a square patch, at one of its strides: what is uploaded once.
// Lattice units (grid.h) from the page's origin; strides in samples, powers of two up to the square's side.
// Pages belong to a SquarePageStore; they are made by workers, and taken and retired by the thread that owns it.
#pragma once
#include "terrain/lod/lod.h"
#include "terrain/squares/square_grid.h"
#include "terrain/terrain.h"

typedef struct SquarePage {
    LodPage shown;      // vertices in rows from the north-west corner, side / stride + 1 a row
    int32_t square;     // of the grid
    int stride, across; // samples between neighbours; vertices a row
    Vec3d centre_ecef;
    double radius_m;                  // of a sphere around all vertices
    bool filled;                      // square_page_fill has been here since the page was taken
    uint64_t last_frame;              // drawn last
    struct SquarePage *older, *newer; // least recently drawn first
    struct SquarePage *next_free;
} SquarePage;

#define SQUARE_PAGE_STRIDES 8 // 1, 2, 4 .. 128

typedef struct SquarePageStore {
    const SquareGrid *grid;
    SquarePage **pages;                          // [square][log2 stride]; NULL: not there
    SquarePage *free_pages[SQUARE_PAGE_STRIDES]; // by log2 of side / stride
    SquarePage *oldest, *newest;
    size_t bytes; // of all pages in use
    uint64_t next_id;
} SquarePageStore;

// `first_id`: ids count up from the one after. The grid is borrowed. MEMORY.
MUST_USE Result square_page_store_create(const SquareGrid *grid, uint64_t first_id, SquarePageStore *out);
void square_page_store_destroy(SquarePageStore *store);

// The page of a square at a stride, marked as drawn in `frame`: the one that is there, or one yet to be filled. NULL
// when memory is out.
SquarePage *square_page_take(SquarePageStore *store, int32_t square, int stride, uint64_t frame);
// Positions and sphere of a taken page. Pure but for the page: any thread.
void square_page_fill(SquarePage *page, const SquareGrid *grid, const Terrain *terrain);
// Drops pages drawn last in frame `released` or before, the least recently drawn first, until no more than `bytes_max`
// are in use.
void square_page_evict(SquarePageStore *store, uint64_t released, size_t bytes_max);

// The vertex at a sample of the square, which is a multiple of the stride.
static inline uint16_t square_page_vertex(const SquarePage *page, int col, int row) {
    int shift = __builtin_ctz((unsigned)page->stride);
    return (uint16_t)(((row - page->shown.row0) >> shift) * page->across + ((col - page->shown.col0) >> shift));
}
